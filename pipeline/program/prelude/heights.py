# SPDX-License-Identifier: GPL-3.0-or-later
"""Grids of heights: where vertical lines through their cells cross meshes, and what lies between their cells."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from .shape import Floats, Shape
from .unwrap import face_normals

MOST_PAIRS = 12_000_000


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
