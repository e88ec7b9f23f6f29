# SPDX-License-Identifier: GPL-3.0-or-later
"""What a model can be asked for by default, going by its name: strong ones write programs, others choose from a list."""

from __future__ import annotations

import re
from typing import Literal

_SMALL = re.compile(r"(?:^|[-_:./ ])(?:mini|nano|tiny|small|lite|haiku|flash|[1-9]\d?(?:\.\d)?b)(?:$|[-_:./ ])")
_LOCAL = ("builtin", "ollama")


def modelling_of(client: str) -> Literal["programs", "library"]:
    """How objects are modelled with a client of this name: "programs" that the model writes, or "library" pieces.

    The artist's own setting counts before this.
    """
    name = client.lower()
    return "library" if name.startswith(_LOCAL) or _SMALL.search(name) else "programs"
