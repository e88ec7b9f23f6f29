# SPDX-License-Identifier: GPL-3.0-or-later
"""The words for materials, for a model that is to say what things look like: drawn from the constructors' docstrings."""

from __future__ import annotations

import functools

from .prelude.registry import LOOKS
from .reference import entry

_MAPS = ("noise_map", "wave_map", "voronoi_map", "brick_map", "picture", "ramp", "mix", "bump")
_INTRODUCTION = """\
# Looks
A look is what a surface is made of. Colours are "#RRGGBB" (sRGB, in neutral light), lengths metres, all else 0..1.
finish(id, {key: look, ...}): key is a part's name, else a material role, "" for everything else; a part counts before a role.
A name makes a look read well: oak = wood("#6A4A32"), then oak wherever it is meant.
"""


@functools.lru_cache(maxsize=1)
def looks_reference() -> str:
    """Every family of looks, then what a look of one's own is made of."""
    families = [entry(name, LOOKS[name]) for name in LOOKS if name not in (*_MAPS, "principled")]
    own = [entry(name, LOOKS[name]) for name in ("principled", *_MAPS)]
    return "\n".join([_INTRODUCTION + "## Families", *families, "## Where no family fits", *own, ""])
