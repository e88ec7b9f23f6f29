# SPDX-License-Identifier: GPL-3.0-or-later
"""Which colour of the picture goes to which material role of a library piece.

A piece's roles are weighed by what a camera above it sees of them; the colours by their share of the object in the
picture. Large goes to large, and a colour rather to a role that is usually like it.
"""

from __future__ import annotations

import functools
import itertools
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from ..artifacts.objects import MeasuredColour, ObjectDescription
from ..program.prelude.palette import ROLE_COLOURS, split_role
from ..program.prelude.shape import Shape
from .colours import colour_distance, from_code, lightness, to_code

FIXED = frozenset({
    "glass", "mirror", "metal", "steel", "brass", "rubber", "screen", "soil", "water", "paper", "marker",
})  # fmt: skip
"""Roles that look the same on everything; the picture's reflections in them say little."""
_CELLS = 72
_LARGE = 0.005
"""Share of an object seen from above from which a bent face is looked at closely."""
_SURE = 0.18
"""An object of which less is seen keeps its usual colours."""


def seen_from_above(shapes: Sequence[Shape]) -> dict[str, float]:
    """The share of each material role in what a camera above sees of the shapes; roles without their own colours."""
    (x, y, height), roles = _top_samples(shapes)
    if not len(roles):
        return {}
    column, row = (
        np.clip((v - v.min()) / max(v.max() - v.min(), 1e-6) * _CELLS, 0, _CELLS - 1).astype(int) for v in (x, y)
    )
    order = np.argsort(height, kind="stable")
    tops = np.full(_CELLS * _CELLS, -1)
    tops[(column * _CELLS + row)[order]] = roles[order]  # of the points of a cell the highest one is written last
    tops = tops[tops >= 0]
    names = list(dict.fromkeys(split_role(shape.material)[0] for shape in shapes))
    counts = np.bincount(tops, minlength=len(names))
    return {name: float(count / counts.sum()) for name, count in zip(names, counts, strict=True) if count}


def _top_samples(shapes: Sequence[Shape]) -> tuple[Any, Any]:
    """Points (3, N) spread over all faces that look up, and the number of the role that each belongs to."""
    names = list(dict.fromkeys(split_role(shape.material)[0] for shape in shapes))
    numbers = {name: number for number, name in enumerate(names)}
    meshes = [shape for shape in shapes if shape.faces]
    if not meshes:
        return np.zeros((3, 0)), np.zeros(0, dtype=int)
    extent = np.ptp(np.concatenate([s.vertices[:, :2] for s in shapes if len(s.vertices)]), axis=0)
    cell = max(float(extent[0] * extent[1]), 1e-6) / _CELLS**2
    points = np.concatenate([shape.vertices for shape in meshes])
    offsets = np.cumsum([0, *(len(shape.vertices) for shape in meshes)])
    fans = [_fan(shape) for shape in meshes]
    corners = np.concatenate([fan + start for fan, start in zip(fans, offsets, strict=False)])
    whose = np.repeat([numbers[split_role(shape.material)[0]] for shape in meshes], [len(fan) for fan in fans])
    shape_of = np.repeat(np.arange(len(meshes)), [len(fan) for fan in fans])
    a, b, c = (points[corners[:, k]].T for k in range(3))
    up = 0.5 * ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]))
    face = np.cumsum(np.concatenate([_first_of_face(shape) for shape in meshes])) - 1
    seen = np.flatnonzero(up > 0)
    count = np.clip(np.ceil(2.0 * up[seen] / cell), 1, 4000).astype(int)
    shape_of = np.repeat(shape_of[seen], count)
    # Each shape's points begin the same sequence anew.
    step = np.arange(len(shape_of)) - np.searchsorted(shape_of, np.arange(len(meshes)))[shape_of]
    u, v = _spread(int(step.max(initial=0)).bit_length())[:, step]
    found = [
        np.repeat(p, count) + u * np.repeat(q - p, count) + v * np.repeat(r - p, count)
        for p, q, r in zip(a[:, seen], b[:, seen], c[:, seen], strict=True)
    ]
    places, owners = np.stack(found), np.repeat(whose[seen], count)
    kept = _inside(places[:2], np.repeat(face[seen], count), face, up, (a[:2], b[:2], c[:2]), _LARGE * cell * _CELLS**2)
    return places[:, kept], owners[kept]


def _first_of_face(shape: Shape) -> Any:
    """Which triangles of `_fan` are the first of their face."""
    _, lengths = shape.corners
    count = np.maximum(lengths - 2, 0)
    found = np.zeros(int(count.sum()), dtype=int)
    found[(np.cumsum(count) - count)[count > 0]] = 1
    return found


def _inside(places: Any, own: Any, face: Any, up: Any, corners: Any, large: float) -> Any:
    """Which points (2, N) are in their face itself: triangles round a first corner cover the hole of a ring as well.

    Args:
        own: the face of each point; face, up: the face of each triangle, and its area seen from above, below zero turned over.
        large: the area from which faces are looked at; of small ones nothing is seen.
    """
    kept = np.ones(places.shape[1], dtype=bool)
    area = np.bincount(face, weights=up)
    over = np.bincount(face, weights=np.minimum(up, 0.0))
    for number in np.flatnonzero((area > large) & (over < -1e-9)):
        mine, of = np.flatnonzero(own == number), np.flatnonzero(face == number)
        cover = np.zeros(len(mine))
        for k in of:
            p, q, r = (corner[:, k, None] for corner in corners)
            sides = [_cross(e - s, places[:, mine] - s) for s, e in ((p, q), (q, r), (r, p))]
            way = np.sign(up[k])
            cover += way * (np.min(way * np.array(sides), axis=0) >= 0)
        kept[mine] = cover > 0
    return kept


def _cross(a: Any, b: Any) -> Any:
    return a[0] * b[1] - a[1] * b[0]


@functools.lru_cache(maxsize=4)
def _spread(bits: int) -> Any:
    """Two of three weights (2, N) of points spread evenly over a triangle, for 2 ** bits of them."""
    step = np.arange(2**bits)
    u, v = (step * 0.7548776662) % 1.0, (step * 0.5698402910) % 1.0
    over = u + v > 1
    return np.stack([np.where(over, 1 - u, u), np.where(over, 1 - v, v)])


def _fan(shape: Shape) -> Any:
    """The faces as triangles round their first corners, (N, 3) vertex numbers."""
    corners, lengths = shape.corners
    starts = np.repeat(np.cumsum(lengths) - lengths, np.maximum(lengths - 2, 0))
    within = np.arange(len(starts)) - np.searchsorted(starts, starts)
    return np.stack([corners[starts], corners[starts + within + 1], corners[starts + within + 2]], axis=1)


def tints_for(seen: Mapping[str, float], described: ObjectDescription) -> dict[str, str]:
    """A colour "#RRGGBB" for each role of a piece that the picture tells one for.

    Args:
        seen: the piece's roles with their shares, as `seen_from_above`.
    """
    colours = list(described.measured) if described.seen >= _SURE else []
    if not colours and described.code:
        colours = [MeasuredColour(code=described.code, share=1.0)]
    free = {role: share for role, share in seen.items() if role not in FIXED and share > 0.02}
    if not colours or not free:
        return {}
    roles = sorted(free, key=lambda role: -free[role])[:4]
    total = sum(free[role] for role in roles)
    best = min(_pairings(roles, colours), key=lambda pairs: _cost(pairs, free, total, colours))
    found = {role: f"#{calm(colour.code)}" for role, colour in best if _may(role, colour.code)}
    return found


def _pairings(roles: Sequence[str], colours: Sequence[MeasuredColour]) -> list[list[tuple[str, MeasuredColour]]]:
    """All ways to give the largest role and some others a colour each; colours may be left over."""
    count = min(len(roles), len(colours))
    return [
        list(zip(chosen, given, strict=True))
        for chosen in itertools.combinations(roles, count)
        if roles[0] in chosen
        for given in itertools.permutations(colours, count)
    ]


def _cost(
    pairs: Sequence[tuple[str, MeasuredColour]],
    free: Mapping[str, float],
    total: float,
    colours: Sequence[MeasuredColour],
) -> float:
    cost = 0.0
    for role, colour in pairs:
        usual = ROLE_COLOURS[role][0] if role in ROLE_COLOURS else "A9A39B"
        likeness = 3.0 if role == "shade" else 1.0  # lamps shine: their shades are light whatever else they are
        cost += 1.2 * abs(free[role] / total - colour.share) + likeness * colour_distance(usual, colour.code)
    return cost + sum(c.share for c in colours if c not in [colour for _, colour in pairs]) * 0.8


def _may(role: str, code: str) -> bool:
    """Leaves stay green: what is measured between them is the floor or a shadow."""
    if role != "foliage":
        return True
    red, green, blue = from_code(code)
    return bool(green > red and green > 1.1 * blue)


def calm(code: str) -> str:
    """The colour neither as black nor as white as no material is."""
    light = lightness(code)
    if light < 0.2:
        return to_code(from_code(code) * 0.6 + 0.008)
    return to_code(np.minimum(from_code(code), 0.86)) if light > 0.96 else code
