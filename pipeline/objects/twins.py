# SPDX-License-Identifier: GPL-3.0-or-later
"""Things that are made alike in other colours, such as four balls: one geometry, and for each its own colours."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

import numpy as np

from ..artifacts.objects import MeasuredColour, ObjectDescription
from ..materials.difference import difference
from ..program.prelude.palette import coloured_role, split_role
from ..program.prelude.shape import Shape
from .colours import from_code, to_code
from .tinting import FIXED, calm

OTHER = 12.0
"""CIEDE2000 above which two things are not of one colour."""
_MEANT = 14.0
"""CIEDE2000 within which a part of the first one has the colour that was measured on it."""
_SURE = 0.18
"""Of a thing of which less is seen the measured colours say too little."""
_COLOURED = frozenset({"rubber"})
"""Materials that have their own colours on most things, and any where a program gives them one."""
_LIGHT = np.array((0.2126, 0.7152, 0.0722))


def other_colours(first: ObjectDescription, own: ObjectDescription) -> bool:
    """Whether two things are surely of different colours."""
    if not first.measured or not own.measured or min(first.seen, own.seen) < _SURE:
        return False
    return difference(first.measured[0].code, own.measured[0].code) > OTHER


def codes_of(shapes: Iterable[Shape], tints: Mapping[str, str] | None = None) -> dict[str, str]:
    """The colours of the shapes, six sRGB digits, by what `tint` calls them: a role, or a role with one of its colours."""
    found: dict[str, set[str]] = {}
    for shape in shapes:
        role, code = split_role(shape.material)
        found.setdefault(role, set()).add((tints or {}).get(role, "").lstrip("#") or code)
    one = {role: next(iter(codes)) for role, codes in found.items() if len(codes) == 1}
    several = {coloured_role(role, c): c for role, codes in found.items() if role not in one for c in codes}
    return {key: code for key, code in {**one, **several}.items() if code}


def twin_tints(codes: Mapping[str, str], first: ObjectDescription, own: ObjectDescription) -> dict[str, str]:
    """A colour "#RRGGBB" for each material in which a thing differs from the first one of its kind; {} for none.

    Args:
        codes: the colours of the first one's materials.
    """
    free = {key: code for key, code in codes.items() if split_role(key)[0] not in FIXED - _COLOURED}
    pairs = [(difference(m.code, code), n, key) for key, code in free.items() for n, m in enumerate(first.measured)]
    meant: dict[str, int] = {}
    for apart, number, key in sorted(pairs):
        if apart <= _MEANT:
            meant.setdefault(key, number)
    if pairs and 0 not in meant.values():
        # Whoever wrote the program gave the main colour otherwise than it was measured.
        main = [(apart, key) for apart, number, key in sorted(pairs) if number == 0 and key not in meant]
        meant |= {main[0][1]: 0} if main else {}
    found = {}
    for key, number in meant.items():
        old = first.measured[number]
        if any(difference(old.code, c.code) < OTHER for c in own.measured):
            continue
        found[key] = f"#{calm(_in_place_of(free[key], old, own.measured[min(number, len(own.measured) - 1)]))}"
    return found


def _in_place_of(code: str, meant: MeasuredColour, new: MeasuredColour) -> str:
    """The new colour, as much darker or lighter as the part of the first one was than what was measured there."""
    light, measured = float(from_code(code) @ _LIGHT), float(from_code(meant.code) @ _LIGHT)
    return to_code(from_code(new.code) * float(np.clip(light / max(measured, 1e-3), 0.6, 1.5)))
