# SPDX-License-Identifier: GPL-3.0-or-later
"""Which of an object's measured colours each of its parts has: the largest goes to the largest that is seen."""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from ..artifacts.objects import MeasuredColour, ObjectDescription
from ..light.tone import luminance
from ..objects.colours import from_code, to_code
from ..objects.lying_on import COVER
from ..objects.tinting import FIXED, calm
from ..program.prelude.palette import ROLE_COLOURS
from ..program.prelude.shape import Shape
from .difference import difference, lab_of
from .parts import Cell, cells_of

SURE = 0.18
"""An object of which less is seen keeps the colours of its program."""
_LEAST = 0.03
_SHOWN = 0.02
"""Share of an object that has to be seen between what lies on it."""
_NEAR = 14.0
"""CIEDE2000 within which a program's own colour and a measured one are taken for the same thing."""
_MOST = 4
_WHITE, _SHADED, _GREYISH, _CAST = 86.0, 72.0, 9.0, 15.0
"""CIELAB lightness of white things, and of those that stand in the room's shade; the chroma of white, and of white beside a
coloured floor. White things keep the hue of the white that they were given, or each fold of a bed and each side of a wardrobe would
have a tint of its own, by where its shadow fell."""


def uncovered(cells: Sequence[Cell], shapes: Sequence[Shape], covers: Sequence[Shape]) -> list[Cell]:
    """The cells with their shares of what is seen between the things that lie on an object: a made bed shows no mattress.

    Args:
        covers: boxes of what lies on it, in its own frame (`objects/lying_on.py`).
    """
    if not covers:
        return list(cells)
    shown = {(c.part, c.material): c.share for c in cells_of([*shapes, *covers]) if c.material != COVER}
    total = sum(shown.values())
    if total < _SHOWN:
        return list(cells)
    return [replace(c, share=round(shown.get((c.part, c.material), 0.0) / total, 4)) for c in cells]


def part_colours(cells: Sequence[Cell], described: ObjectDescription) -> dict[str, str]:
    """Six sRGB digits for each material of an object that the picture tells a colour for.

    A program's own colours were chosen by somebody who saw the picture; they give way to what was measured when they
    are near it, or when hardly anything else can be meant.
    """
    colours = list(described.measured) if described.seen >= SURE else []
    if not colours and described.code:
        colours = [MeasuredColour(code=described.code, share=1.0)]
    shares: dict[str, float] = {}
    for cell in cells:
        if cell.role not in FIXED and cell.share > _LEAST:
            shares[cell.material] = shares.get(cell.material, 0.0) + cell.share
    if not colours or not shares:
        return {}
    own = {cell.material: cell for cell in cells}
    materials = sorted(shares, key=lambda m: -shares[m])[:_MOST]
    total = sum(shares[m] for m in materials)
    best = min(_pairings(materials, colours, shares), key=lambda pairs: _cost(pairs, shares, total, own, colours))
    return {m: calm(_as_seen(own[m], c)) for m, c in best if _may(own[m], c, shares[m] / total)}


def _pairings(
    materials: Sequence[str], colours: Sequence[MeasuredColour], shares: Mapping[str, float]
) -> list[list[tuple[str, MeasuredColour]]]:
    """All ways to give a colour each to one of the larger materials and to some others; colours may be left over."""
    count = min(len(materials), len(colours))
    large = shares[materials[0]] / 2
    return [
        list(zip(chosen, given, strict=True))
        for chosen in itertools.combinations(materials, count)
        if shares[chosen[0]] >= large
        for given in itertools.permutations(colours, count)
    ]


def _cost(
    pairs: Sequence[tuple[str, MeasuredColour]],
    shares: Mapping[str, float],
    total: float,
    own: Mapping[str, Cell],
    colours: Sequence[MeasuredColour],
) -> float:
    cost = 0.0
    for material, colour in pairs:
        cell = own[material]
        expected = cell.code or (ROLE_COLOURS[cell.role][0] if cell.role in ROLE_COLOURS else "A9A39B")
        likeness = 3.0 if cell.role == "shade" else 2.0 if cell.code else 1.0
        cost += 1.2 * abs(shares[material] / total - colour.share) + likeness * difference(expected, colour.code) / 60
    return cost + 0.8 * sum(c.share for c in colours if c not in [given for _, given in pairs])


def _as_seen(cell: Cell, colour: MeasuredColour) -> str:
    """The measured colour; of white things the white that they were given, half as much darker as it was measured."""
    if not _is_shaded_white(cell, colour):
        return colour.code
    own, seen = from_code(cell.code), from_code(colour.code)
    return to_code(own * (0.5 + 0.5 * min(1.0, float(luminance(seen)) / float(luminance(own)))))


def _is_shaded_white(cell: Cell, colour: MeasuredColour) -> bool:
    return bool(cell.code) and _is_white(cell.code, _WHITE, _GREYISH) and _is_white(colour.code, _SHADED, _CAST)


def _is_white(code: str, least: float, most: float) -> bool:
    light, a, b = lab_of(code)
    return light > least and float(np.hypot(a, b)) < most


def _may(cell: Cell, colour: MeasuredColour, share: float) -> bool:
    light, a, b = lab_of(colour.code)
    if cell.role == "foliage":
        # Leaves stay green: what is measured between them is the floor or a shadow.
        return a < -3 and b > 0
    if cell.role == "shade" and light < 45:
        return False
    if not cell.code:
        return True
    if _is_shaded_white(cell, colour):
        return True
    return difference(cell.code, colour.code) < (2 * _NEAR if share > 0.6 and colour.share > 0.6 else _NEAR)
