# SPDX-License-Identifier: GPL-3.0-or-later
"""Meshes seen from above as samples: for every cell of a grid, the heights at which a mesh crosses it.

Frame: that of the shapes (a proxy's local frame), metres, z up.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..program.prelude.shape import Shape

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

_MOST_PAIRS = 4_000_000
"""Triangle and cell pairs that are looked at in one go; larger meshes are rasterised in pieces."""
_ASIDE = (1.3e-7, 2.1e-7)
"""Metres that lines are beside the cells' middles: none goes through the edge of two triangles and counts for both."""


@dataclass(frozen=True)
class Grid:
    """Square cells over a rectangle: `origin` is the low corner, `shape` is (columns along x, rows along y)."""

    origin: tuple[float, float]
    cell: float
    shape: tuple[int, int]

    def index(self, x: float, y: float) -> tuple[int, int]:
        """The cell that holds a point; may lie outside the grid."""
        return int(np.floor((x - self.origin[0]) / self.cell)), int(np.floor((y - self.origin[1]) / self.cell))

    def centre(self, column: float, row: float) -> tuple[float, float]:
        """The middle of a cell."""
        return self.origin[0] + (column + 0.5) * self.cell, self.origin[1] + (row + 0.5) * self.cell


@dataclass(frozen=True)
class Samples:
    """Crossings of vertical lines through the cells' middles with a mesh, sorted by cell and then by height.

    Attributes:
        cells: flat index (column * rows + row) of each crossing; heights in metres.
        up: whether the surface there is nearly level and faces upward; facing: whether it faces upward at all.
        owner: index of the shape that was crossed.
    """

    grid: Grid
    cells: Ints
    heights: Floats
    up: NDArray[np.bool_]
    facing: NDArray[np.bool_]
    owner: Ints


def triangles(shapes: Sequence[Shape]) -> tuple[Floats, Ints, Ints]:
    """All faces as triangles (T, 3, 3), the index of the shape that each belongs to (T,), and of its concave face, -1 for others.

    Triangles are fans: those of a concave face cover what is outside of it as well, but always an even number of times.
    """
    corners: list[Floats] = []
    counts: list[int] = []
    bent: list[Ints] = []
    concave = 0
    for shape in shapes:
        flat, lengths = shape.corners
        starts = np.cumsum(lengths) - lengths
        kinds, first = np.unique(lengths, return_index=True)
        found = 0
        for length in kinds[np.argsort(first)].tolist():
            table = flat[starts[lengths == length] + np.arange(length)[:, None]]
            if length > 2:
                fans = np.stack(
                    [np.broadcast_to(table[0], (length - 2, table.shape[1])), table[1:-1], table[2:]], axis=2
                )
                corners.append(shape.vertices[fans.reshape(-1, 3)])
                found += len(corners[-1])
                turned = (
                    _is_concave(corners[-1].reshape(length - 2, -1, 3, 3)) if length > 3 else np.zeros(1, dtype=bool)
                )
                names = np.where(turned, concave + np.cumsum(turned) - 1, -1)
                bent.append(np.broadcast_to(names, (length - 2, table.shape[1])).ravel())
                concave += int(turned.sum())
        counts.append(found)
    if not corners:
        return np.zeros((0, 3, 3)), np.zeros(0, dtype=np.int64), np.zeros(0, dtype=np.int64)
    return np.concatenate(corners), np.repeat(np.arange(len(counts)), counts), np.concatenate(bent)


def _is_concave(fans: Floats) -> NDArray[np.bool_]:
    """Of faces in fans (triangles of each, faces, 3, 3): whether some triangle of a face is turned over against the whole."""
    cross = np.cross(fans[:, :, 1] - fans[:, :, 0], fans[:, :, 2] - fans[:, :, 0])
    whole = cross.sum(axis=0)
    found: NDArray[np.bool_] = ((cross * whole).sum(axis=2) < -1e-9 * (whole * whole).sum(axis=1)).any(axis=0)
    return found


def grid_over(points: Floats, cell: float) -> Grid:
    """The grid that covers all points (N, 2 or more)."""
    low, high = points[:, :2].min(axis=0), points[:, :2].max(axis=0)
    count = np.maximum(1, np.ceil((high - low) / cell - 1e-9).astype(int))
    # Centred, so that a thing narrower than whole cells is not cut on one side only.
    start = (low + high) / 2 - count * cell / 2
    return Grid((float(start[0]), float(start[1])), cell, (int(count[0]), int(count[1])))


def sample(shapes: Sequence[Shape], cell: float, level: float = 0.9) -> Samples | None:
    """Rasterise shapes from above; None where there is nothing.

    Args:
        cell: side of a cell in metres.
        level: the least z of a unit normal that counts as level and facing upward.
    """
    corners, owner, bent = triangles(shapes)
    if not len(corners):
        return None
    grid = grid_over(corners.reshape(-1, 3), cell)
    a, b, c = corners[:, 0], corners[:, 1], corners[:, 2]
    cross = np.cross(b - a, c - a)
    seen = np.flatnonzero(np.abs(cross[:, 2]) > 1e-12)
    if (bent >= 0).any():  # a concave face looks where all of its triangles together do
        whole = np.zeros((int(bent.max()) + 1, 3))
        np.add.at(whole, bent[bent >= 0], cross[bent >= 0])
        cross[bent >= 0] = whole[bent[bent >= 0]]
    length = np.sqrt(cross[:, 0] ** 2 + cross[:, 1] ** 2 + cross[:, 2] ** 2)
    # Upright triangles have no extent from above; they do not take room beyond their edges' neighbours.
    corners, owner, upward, length, bent = corners[seen], owner[seen], cross[seen, 2], length[seen], bent[seen]
    up, facing = upward > level * length, upward > 0
    a, b, c = corners[:, 0, :2], corners[:, 1, :2], corners[:, 2, :2]
    low = np.floor((np.minimum(np.minimum(a, b), c) - grid.origin) / cell - 0.5).astype(np.int64)
    high = np.ceil((np.maximum(np.maximum(a, b), c) - grid.origin) / cell - 0.5).astype(np.int64)
    low, high = np.maximum(low, 0), np.minimum(high, np.array(grid.shape) - 1)
    count = np.maximum(0, high - low + 1)
    found = [_crossings(corners, low, count, grid, part) for part in _parts(count[:, 0] * count[:, 1])]
    triangle = np.concatenate([f[0] for f in found])
    cells = np.concatenate([f[1] for f in found])
    heights = np.concatenate([f[2] for f in found])
    kept = _inside(bent[triangle], cells)
    triangle, cells, heights = triangle[kept], cells[kept], heights[kept]
    order = np.lexsort((heights, cells))
    triangle = triangle[order]
    return Samples(grid, cells[order], heights[order], up[triangle], facing[triangle], owner[triangle])


def _inside(bent: Ints, cells: Ints) -> Ints:
    """Which crossings are with a face itself: of a concave one, one of an odd number in a cell, and none of an even number."""
    odd = bent >= 0
    if not odd.any():
        return np.arange(len(cells))
    at = np.flatnonzero(odd)
    key = bent[at] * (int(cells.max()) + 1) + cells[at]
    _, first, count = np.unique(key, return_index=True, return_counts=True)
    found: Ints = np.sort(np.concatenate([np.flatnonzero(~odd), at[first[count % 2 == 1]]]))
    return found


def _parts(pairs: Ints) -> list[slice]:
    """Slices of the triangles, each with about `_MOST_PAIRS` pairs."""
    ends = np.cumsum(pairs)
    cuts: Ints | list[int] = (
        np.searchsorted(ends, np.arange(_MOST_PAIRS, int(ends[-1]) + _MOST_PAIRS, _MOST_PAIRS)) if len(ends) else []
    )
    edges = [0, *(int(c) + 1 for c in cuts)]
    return [slice(a, min(b, len(pairs))) for a, b in zip(edges[:-1], edges[1:], strict=True) if a < len(pairs)]


def _crossings(corners: Floats, low: Ints, count: Ints, grid: Grid, part: slice) -> tuple[Ints, Ints, Floats]:
    """Triangle index, cell and height of every crossing of some triangles with the cells' middles."""
    number = np.arange(len(corners))[part]
    wide, deep = count[part, 0], count[part, 1]
    wide = np.where(deep > 0, wide, 0)
    (ax, ay, az), (bx, by, bz), (cx, cy, cz) = (corners[part, k].T for k in range(3))
    # What all cells of a triangle's column share is worked out once a column.
    whose = np.repeat(np.arange(len(number)), wide)
    column, deep = low[part, 0][whose] + _counted(wide), deep[whose]
    x = grid.origin[0] + _ASIDE[0] + (column + 0.5) * grid.cell - ax[whose]
    row = np.repeat(low[part, 1][whose], deep) + _counted(deep)
    y = grid.origin[1] + _ASIDE[1] + (row + 0.5) * grid.cell - np.repeat(ay[whose], deep)
    area = np.repeat(((bx - ax) * (cy - ay) - (by - ay) * (cx - ax))[whose], deep)
    v = (np.repeat(x * (cy - ay)[whose], deep) - y * np.repeat((cx - ax)[whose], deep)) / area
    w = (np.repeat((bx - ax)[whose], deep) * y - np.repeat((by - ay)[whose] * x, deep)) / area
    inside = np.flatnonzero((v >= -1e-9) & (w >= -1e-9) & (v + w <= 1 + 1e-9))
    own = np.repeat(whose, deep)[inside]
    heights = az[own] + v[inside] * (bz - az)[own] + w[inside] * (cz - az)[own]
    cells = np.repeat(column * grid.shape[1], deep)[inside] + row[inside]
    return number[own], cells, heights


def _counted(lengths: Ints) -> Ints:
    """0, 1, 2, ... up to each of these lengths, one after the other."""
    ends = np.cumsum(lengths)
    found: Ints = np.arange(int(ends[-1]) if len(ends) else 0) - np.repeat(ends - lengths, lengths)
    return found
