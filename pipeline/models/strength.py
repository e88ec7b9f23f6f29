# SPDX-License-Identifier: GPL-3.0-or-later
"""What a model can be asked for by default, going by its name: strong ones write programs, others choose from a list.

Under a weak one the built-in analysis is a floor (`ask_floor`).
"""

from __future__ import annotations

import re
from typing import Literal

_SMALL = re.compile(
    r"(?:^|[-_:./ ])(?:mini|nano|tiny|small|lite|haiku|flash|[1-9]\d?(?:\.\d)?b|\d{2,3}m)(?:$|[-_:./ ])"
)
_BUILTIN, _LOCAL = "builtin", "ollama"


def modelling_of(client: str) -> Literal["programs", "library"]:
    """How objects are modelled with a client of this name: "programs" that the model writes, or "library" pieces.

    The artist's own setting counts before this.
    """
    return "library" if client.lower().startswith(_BUILTIN) or is_weak(client) else "programs"


def is_weak(client: str) -> bool:
    """Whether the model of a client of this name, such as "openai:smollm2-135m", is known to be a weak one."""
    name = client.lower()
    return not name.startswith(_BUILTIN) and (name.startswith(_LOCAL) or bool(_SMALL.search(name)))
