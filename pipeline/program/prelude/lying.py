# SPDX-License-Identifier: GPL-3.0-or-later
"""Cloth that lies on things: its underside follows the ground below it, and it hangs down where the ground ends.

Everything is in the cloth's own frame: metres, z up. Heights are those at which vertical lines through the cells of a
grid cross the meshes.
"""

from __future__ import annotations

import hashlib
import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from .beside import kept_off
from .heights import Bed, Field, blurred, crossed, spread_out, vertex_normals, widest
from .shape import Floats, Shape

CELL = 0.015
MOST_CELLS = 140
ABOVE = 0.15
"""What rises more than this above the cloth's underside is not what it lies on: headboards, lamps."""
STEP = 0.12
"""Ground this much lower than most of it is not reached: the cloth hangs down there."""
RELIEF = 0.05
LIFT = 0.002
OVER = 0.025
FOLDED = 0.045
BEND = 0.03
"""A cloth reaches `OVER` beyond its ground and bends with this radius; ends that reach less than `FOLDED` beyond it, and
hang already, keep their own shape. Metres."""
LAYER, LAYERS = 0.3, 2.5
"""Of their distance, that hanging layers of a cloth keep, and how many times its thickness counts at most."""
MOST_KNOWN = 24
_NOT_YET = np.zeros((0, 3))
_KNOWN: dict[str, Floats | None] = {}
"""Vertices of cloths that were laid before: a room is evaluated after every edit, and mostly nothing below them moved."""


def laid(shapes: list[Shape], below: Sequence[Shape], beside: Sequence[Shape] = ()) -> list[Shape]:
    """The shapes of a cloth, laid onto others. As they were where nothing carries them, or where that is too much work.

    Args:
        below: what it may lie on, in the cloth's frame. beside: what its ends must not hang into.
    """
    if not shapes or not below or not any(len(shape.vertices) for shape in shapes):
        return shapes
    key = _key(shapes, below, beside)
    new = _KNOWN.get(key, _NOT_YET)
    if new is _NOT_YET:
        new = vertices_laid(shapes, below, beside)
    for oldest in list(_KNOWN)[: max(0, len(_KNOWN) - MOST_KNOWN)]:
        _KNOWN.pop(oldest, None)
    _KNOWN[key] = new
    if new is None:
        return shapes
    starts = np.cumsum([0, *(len(shape.vertices) for shape in shapes)])
    return [replace(s, vertices=new[a : a + len(s.vertices)]) for s, a in zip(shapes, starts, strict=False)]


def _key(*groups: Sequence[Shape]) -> str:
    """A digest of the meshes of a cloth, of what is below it, and of what is beside it."""
    digest = hashlib.sha1(usedforsecurity=False)
    for shapes in groups:
        for shape in shapes:
            for numbers in (shape.vertices, *shape.corners):
                digest.update(np.ascontiguousarray(numbers).tobytes())
            digest.update(b";")
        digest.update(b"|")
    return digest.hexdigest()


def vertices_laid(shapes: Sequence[Shape], below: Sequence[Shape], beside: Sequence[Shape] = ()) -> Floats | None:
    """The vertices of all shapes one after the other, laid onto others; None where they stay as they are."""
    points = np.concatenate([shape.vertices for shape in shapes])
    low, high = points.min(axis=0), points.max(axis=0)
    cell = max(CELL, float((high - low)[:2].max()) / MOST_CELLS)
    count = np.ceil((high - low)[:2] / cell).astype(int) + 8
    field = Field((low + high)[:2] / 2 - count * cell / 2, cell, (int(count[0]), int(count[1])))
    own, ground = crossed(shapes, field), crossed(below, field)
    rest = None if own is None else resting(own, field)
    bed = None if rest is None or ground is None else support(ground, rest, field)
    if rest is None or bed is None:
        return None
    normals = np.concatenate([vertex_normals(shape) for shape in shapes])
    new = placed_on(points, normals, rest, bed, field)
    near = crossed(beside, field) if beside else None
    if near is not None:
        new = kept_off(new, normals, rest.thick, bed, near, field)
    return np.round(new, 6)


# ---- what there is ----


@dataclass(frozen=True)
class Rest:
    """A cloth as it would lie on a table.

    Attributes:
        under: height of its underside, everywhere: beyond its flat part that of the nearest flat place.
        relief: how much of that is folds, which a table does not touch.
        flat: cells of the part that lies. thick: how thick it usually is.
    """

    under: Floats
    relief: Floats
    flat: Any
    thick: float


def resting(own: tuple[Any, Any, Any], field: Field) -> Rest | None:
    """The part of a cloth that lies, told from the ends that hang."""
    cells, heights, steep = own
    top, under = np.full(field.shape, -np.inf), np.full(field.shape, np.inf)
    faces_up = steep > 0.3
    np.maximum.at(top.reshape(-1), cells[faces_up], heights[faces_up])
    np.minimum.at(under.reshape(-1), cells, heights)
    there = np.isfinite(top) & np.isfinite(under)
    if not there.any():
        return None
    flat = there & (top > np.median(top[there]) - 0.06) & (under > np.median(under[there]) - 0.06)
    if not flat.any():
        return None
    filled = spread_out(under, flat, field)[0]
    base = np.minimum(filled, blurred(widest(widest(filled, 8, low=True), 8), 2))
    return Rest(filled, np.clip(filled - base, 0, RELIEF), flat, float(np.median((top - under)[flat])))


def support(ground: tuple[Any, Any, Any], rest: Rest, field: Field) -> Bed | None:
    """The ground below the part of a cloth that lies; None where hardly any of it is carried."""
    cells, heights, steep = ground
    level = float(np.median(rest.under[rest.flat]))
    usable = (steep > 0.2) & (heights < level + ABOVE)
    real = np.full(field.shape, -np.inf)
    np.maximum.at(real.reshape(-1), cells[usable], heights[usable])
    met = rest.flat & np.isfinite(real)
    if met.sum() < 0.1 * rest.flat.sum():
        return None
    carries = np.isfinite(real) & (real > np.percentile(real[met], 80) - STEP)
    if (carries & rest.flat).sum() < 0.1 * rest.flat.sum():
        return None
    filled, edge = spread_out(real, carries, field)
    # Cloth spans narrow gaps and has no sharp bends, and it never sinks in.
    spanned = widest(widest(filled, 2), 2, low=True)
    return Bed(np.maximum(filled, blurred(spanned, 2)), real, edge, carries)


# ---- laying ----


def placed_on(points: Floats, normals: Floats, rest: Rest, bed: Bed, field: Field) -> Floats:
    """Where the vertices of a cloth come to be, (N, 3)."""
    flat = points[:, :2]
    above = points[:, 2] - field.at(rest.under, flat)
    share = np.clip(above / max(rest.thick, 1e-4), 0, 1)
    # The underside follows the ground; folds stay where they are seen.
    new = points.copy()
    height = above + share * share * (3 - 2 * share) * field.at(rest.relief, flat)
    new[:, 2] = field.at(bed.ground, flat) + height + LIFT
    edge = np.column_stack([field.at(bed.edge[:, :, k], flat) for k in (0, 1)])
    beyond = np.linalg.norm(flat - edge, axis=1)
    out = (flat - edge) / np.maximum(beyond, 1e-9)[:, None]
    folds = (beyond > OVER) & folding(beyond, out, above > -0.02)
    bent = hanging(height, normals, rest.thick, beyond, out, edge, field.at(bed.ground, edge))
    new[folds] = bent[folds]
    # Ends that hang down where the ground goes on come to lie on it.
    column, row = field.cells(new[:, :2]).T
    floor = bed.real[column, row] + LIFT + np.where(normals[:, 2] > 0, rest.thick, 0.0)
    sunk = (above < -0.005) & (new[:, 2] < floor) & (floor - new[:, 2] < ABOVE) & bed.carries[column, row]
    new[sunk, 2] = floor[sunk]
    return new


def folding(beyond: Floats, out: Floats, lies: Any) -> Any:
    """Which vertices belong to a side on which the flat part of the cloth reaches well beyond its ground, (N,)."""
    side = sides(out)
    found = np.zeros(len(beyond), dtype=bool)
    for number in range(4):
        mine = side == number
        rim = beyond[mine & lies & (beyond > 0)]
        if len(rim) and float(np.percentile(rim, 90)) > FOLDED:
            found |= mine
    return found


def sides(out: Floats) -> Any:
    """Which of four sides ways out belong to, (N,)."""
    return np.where(np.abs(out[:, 0]) > np.abs(out[:, 1]), np.where(out[:, 0] > 0, 0, 1), np.where(out[:, 1] > 0, 2, 3))


def layered(beyond: Floats, out: Floats, hangs: Any, thick: float) -> Floats:
    """How far outside of its innermost layer the hanging end of a cloth is, (N,): two layers never share a place."""
    side, found = sides(out), np.zeros(len(beyond))
    for number in range(4):
        mine = hangs & (side == number)
        if mine.any():
            found[mine] = np.clip(beyond[mine] - np.median(beyond[mine]) + thick, 0.0, LAYERS * thick)
    return found


def hanging(
    height: Floats, normals: Floats, thick: float, beyond: Floats, out: Floats, edge: Floats, ground: Floats
) -> Floats:
    """Vertices bent down over the edge: as far along the cloth from it as they lay beyond it, (N, 3)."""
    along = np.maximum(0.0, beyond - OVER) + np.maximum(0.0, -height)
    outer = (normals[:, :2] * out).sum(axis=1) > 0
    hangs = height < 0
    skin = np.where(hangs, np.where(outer, thick, 0.0) + LAYER * layered(beyond, out, hangs, thick), height)
    angle = np.minimum(along / BEND, math.pi / 2)
    reach = OVER + BEND * np.sin(angle) + skin * np.sin(angle)
    down = BEND * (1 - np.cos(angle)) + np.maximum(0.0, along - BEND * math.pi / 2)
    return np.column_stack([edge + out * reach[:, None], ground + LIFT - down + skin * np.cos(angle)])
