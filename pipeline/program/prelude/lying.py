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

from .shape import Floats, Shape
from .unwrap import face_normals

CELL = 0.015
MOST_CELLS = 140
MOST_PAIRS = 12_000_000
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
MOST_KNOWN = 24
_NOT_YET = np.zeros((0, 3))
_KNOWN: dict[str, Floats | None] = {}
"""Vertices of cloths that were laid before: a room is evaluated after every edit, and mostly nothing below them moved."""


@dataclass(frozen=True)
class Field:
    """A grid of heights, (columns along x, rows along y); `origin` is the low corner."""

    origin: Floats
    cell: float
    shape: tuple[int, int]

    def at(self, table: Floats, points: Floats) -> Floats:
        """A table's value at points (N, 2), interpolated between the cells' middles."""
        spot = np.clip((points - self.origin) / self.cell - 0.5, 0, np.array(self.shape) - 1.001)
        low = spot.astype(int)
        u, v = (spot - low).T
        i, j = low.T
        left = table[i, j] * (1 - v) + table[i, j + 1] * v
        return np.asarray(left * (1 - u) + (table[i + 1, j] * (1 - v) + table[i + 1, j + 1] * v) * u)

    def cells(self, points: Floats) -> Any:
        """The cells that hold points, (N, 2) whole numbers."""
        return np.clip(((points - self.origin) / self.cell).astype(int), 0, np.array(self.shape) - 1)

    def middles(self) -> Floats:
        """The cells' middles, (columns, rows, 2)."""
        x, y = np.meshgrid(np.arange(self.shape[0]), np.arange(self.shape[1]), indexing="ij")
        return np.asarray(self.origin + (np.stack([x, y], axis=2) + 0.5) * self.cell)


def laid(shapes: list[Shape], below: Sequence[Shape]) -> list[Shape]:
    """The shapes of a cloth, laid onto others. As they were where nothing carries them, or where that is too much work.

    Args:
        below: what it may lie on, in the cloth's frame.
    """
    if not shapes or not below or not any(len(shape.vertices) for shape in shapes):
        return shapes
    key = _key(shapes, below)
    new = _KNOWN.get(key, _NOT_YET)
    if new is _NOT_YET:
        new = vertices_laid(shapes, below)
    for oldest in list(_KNOWN)[: max(0, len(_KNOWN) - MOST_KNOWN)]:
        _KNOWN.pop(oldest, None)
    _KNOWN[key] = new
    if new is None:
        return shapes
    starts = np.cumsum([0, *(len(shape.vertices) for shape in shapes)])
    return [replace(s, vertices=new[a : a + len(s.vertices)]) for s, a in zip(shapes, starts, strict=False)]


def _key(shapes: Sequence[Shape], below: Sequence[Shape]) -> str:
    """A digest of the meshes of a cloth and of what is below it."""
    digest = hashlib.sha1(usedforsecurity=False)
    for shape in (*shapes, *below):
        for numbers in (shape.vertices, *shape.corners):
            digest.update(np.ascontiguousarray(numbers).tobytes())
        digest.update(b";" if shape is not shapes[-1] else b"|")
    return digest.hexdigest()


def vertices_laid(shapes: Sequence[Shape], below: Sequence[Shape]) -> Floats | None:
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
    return np.round(placed_on(points, normals, rest, bed, field), 6)


# ---- what there is ----


def crossed(shapes: Sequence[Shape], field: Field) -> tuple[Any, Any, Any] | None:
    """Cell, height and steepness (z of the unit normal) of every crossing; None where there are too many."""
    corners = triangles_of(shapes)
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    seen = np.abs(normal[:, 2]) > 1e-12
    corners, normal = corners[seen], normal[seen]
    last = np.array(field.shape) - 1
    first = np.ceil((corners[:, :, :2].min(axis=1) - field.origin) / field.cell - 0.5).astype(np.int64)
    final = np.floor((corners[:, :, :2].max(axis=1) - field.origin) / field.cell - 0.5).astype(np.int64)
    first, final = np.maximum(first, 0), np.minimum(final, last)
    count = np.maximum(0, final - first + 1)
    pairs = count.prod(axis=1)
    if int(pairs.sum()) > MOST_PAIRS:
        return None
    which = np.repeat(np.arange(len(corners)), pairs)
    step = np.arange(len(which)) - np.repeat(np.cumsum(pairs) - pairs, pairs)
    rows = np.maximum(1, count[which, 1])
    column, row = first[which, 0] + step // rows, first[which, 1] + step % rows
    x = field.origin[0] + (column + 0.5) * field.cell
    y = field.origin[1] + (row + 0.5) * field.cell
    a, b, c = (corners[which, k] for k in range(3))
    area = normal[which, 2]
    v = ((x - a[:, 0]) * (c[:, 1] - a[:, 1]) - (y - a[:, 1]) * (c[:, 0] - a[:, 0])) / area
    w = ((b[:, 0] - a[:, 0]) * (y - a[:, 1]) - (b[:, 1] - a[:, 1]) * (x - a[:, 0])) / area
    inside = (v >= -1e-9) & (w >= -1e-9) & (v + w <= 1 + 1e-9)
    heights = a[:, 2] + v * (b[:, 2] - a[:, 2]) + w * (c[:, 2] - a[:, 2])
    steep = area / np.maximum(np.linalg.norm(normal[which], axis=1), 1e-12)
    return (column * field.shape[1] + row)[inside], heights[inside], steep[inside]


def triangles_of(shapes: Sequence[Shape]) -> Floats:
    """All faces as triangles, (T, 3, 3)."""
    found = [np.zeros((0, 3, 3))]
    for shape in shapes:
        corners, lengths = shape.corners
        starts = np.cumsum(lengths) - lengths
        for k in range(1, int(lengths.max(initial=0)) - 1):
            here = starts[lengths > k + 1]
            found.append(shape.vertices[corners[np.stack([here, here + k, here + k + 1], axis=1)]])
    return np.concatenate(found)


def vertex_normals(shape: Shape) -> Floats:
    """The sum of the normals of the faces round each vertex, (N, 3)."""
    corners, lengths = shape.corners
    total = np.zeros((len(shape.vertices), 3))
    np.add.at(total, corners, np.repeat(face_normals(shape), lengths, axis=0))
    return total


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


@dataclass(frozen=True)
class Bed:
    """What a cloth lies on.

    Attributes:
        ground: its height, everywhere: beyond its edge that of the nearest place of it.
        real: the height of whatever is below, -inf where nothing is.
        edge: the nearest place that carries, for every cell, (columns, rows, 2); for carrying cells it is their own.
        carries: which cells carry.
    """

    ground: Floats
    real: Floats
    edge: Floats
    carries: Any


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


def spread_out(table: Floats, known: Any, field: Field) -> tuple[Floats, Floats]:
    """The table with the value of the nearest known cell in all others, and the middle of that cell for every cell."""
    middles = field.middles()
    inner = np.zeros_like(known)
    inner[1:-1, 1:-1] = known[1:-1, 1:-1] & known[:-2, 1:-1] & known[2:, 1:-1] & known[1:-1, :-2] & known[1:-1, 2:]
    rim = np.argwhere(known & ~inner)
    open_cells = np.argwhere(~known)
    result, nearest = table.copy(), middles.copy()
    for start in range(0, len(open_cells), 2048):
        part = open_cells[start : start + 2048]
        apart = ((part[:, None, :] - rim[None, :, :]).astype(np.float32) ** 2).sum(axis=2)
        i, j = rim[apart.argmin(axis=1)].T
        result[part[:, 0], part[:, 1]] = table[i, j]
        nearest[part[:, 0], part[:, 1]] = middles[i, j]
    return result, nearest


def widest(table: Floats, reach: int, low: bool = False) -> Floats:
    """The highest (or lowest) value within so many cells in both directions."""
    pick = np.minimum if low else np.maximum
    for axis in (0, 1):
        padded = np.pad(table, [(reach, reach) if k == axis else (0, 0) for k in (0, 1)], mode="edge")
        slices = [np.take(padded, range(s, s + table.shape[axis]), axis=axis) for s in range(2 * reach + 1)]
        table = pick.reduce(slices)
    return table


def blurred(table: Floats, times: int) -> Floats:
    """The table with every value shared with its neighbours, so many times."""
    for _ in range(times):
        for axis in (0, 1):
            padded = np.pad(table, [(1, 1) if k == axis else (0, 0) for k in (0, 1)], mode="edge")
            before, here, after = (np.take(padded, range(s, s + table.shape[axis]), axis=axis) for s in range(3))
            table = 0.25 * before + 0.5 * here + 0.25 * after
    return table


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
    side = np.where(np.abs(out[:, 0]) > np.abs(out[:, 1]), np.where(out[:, 0] > 0, 0, 1), np.where(out[:, 1] > 0, 2, 3))
    found = np.zeros(len(beyond), dtype=bool)
    for number in range(4):
        mine = side == number
        rim = beyond[mine & lies & (beyond > 0)]
        if len(rim) and float(np.percentile(rim, 90)) > FOLDED:
            found |= mine
    return found


def hanging(
    height: Floats, normals: Floats, thick: float, beyond: Floats, out: Floats, edge: Floats, ground: Floats
) -> Floats:
    """Vertices bent down over the edge: as far along the cloth from it as they lay beyond it, (N, 3)."""
    along = np.maximum(0.0, beyond - OVER) + np.maximum(0.0, -height)
    outer = (normals[:, :2] * out).sum(axis=1) > 0
    skin = np.where(height < 0, np.where(outer, thick, 0.0), height)
    angle = np.minimum(along / BEND, math.pi / 2)
    reach = OVER + BEND * np.sin(angle) + skin * np.sin(angle)
    down = BEND * (1 - np.cos(angle)) + np.maximum(0.0, along - BEND * math.pi / 2)
    return np.column_stack([edge + out * reach[:, None], ground + LIFT - down + skin * np.cos(angle)])
