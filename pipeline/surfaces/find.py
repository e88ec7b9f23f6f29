# SPDX-License-Identifier: GPL-3.0-or-later
"""Support surfaces of built geometry: level upward faces, large enough, with room above them. (Paper, stage 7.)

Worktops, shelves, seats, beds and sills are found by the same rule; nothing here knows what a thing is called.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ..program.prelude.shape import Shape
from .rasters import Floats, Grid, Samples, sample

CELL = 0.02
SMALL_CELL = 0.005
"""Sides of a raster's cell in metres, for furniture and for things under half a metre."""
LEAST_AREA = 0.0036
"""Smallest surface in square metres: a coaster."""
LEAST_CLEARANCE = 0.03
ROUGHNESS = 0.03
"""Heights within this many metres below a surface's level belong to it: folds, tufts and slats."""
BURIED = 0.3
"""A level face with another upward face this near above it, metres, and nothing between them, lies inside a solid."""
STEP = 0.07
"""What lies up to this many metres below a surface, beside it, carries together with it."""
RIM = 0.008
"""What rises less than this many metres above a surface, beside it, is in nobody's way."""
SKIN = 0.004
"""Crossings nearer than this to each other are two faces of one sheet."""


@dataclass(frozen=True)
class Surface:
    """A level place on a thing, in the thing's local frame.

    Attributes:
        level: the surface's highest usual height, metres.
        heights: height of each cell (columns, rows), NaN outside of the surface.
        clearance: free height above each cell, infinite under the open sky, 0 outside.
        free: cells on which nothing stands yet.
        beside: free height above the surface's level in the cells outside of it: 0 where the thing itself rises there (a
            backrest, a rim), infinite where nothing of it is.
        part: name of the part that makes up most of it.
        smallest: cells of the smallest thing that stands on it, 0 for none.
    """

    grid: Grid
    level: float
    heights: Floats
    clearance: Floats
    free: NDArray[np.bool_]
    beside: Floats
    part: str
    smallest: int = 0

    @property
    def area(self) -> float:
        """Its whole area in square metres, occupied or not."""
        return float(np.isfinite(self.heights).sum()) * self.grid.cell**2

    @property
    def open_share(self) -> float:
        """Share of its cells with nothing of the thing itself above them: what a picture from above shows."""
        inside = np.isfinite(self.heights)
        return float(np.isinf(self.clearance[inside]).mean()) if inside.any() else 0.0

    def taken(self, cells: NDArray[np.bool_]) -> Surface:
        """The same surface with more cells occupied."""
        count = int(cells.sum())
        smallest = min(self.smallest, count) if self.smallest else count
        return replace(self, free=self.free & ~cells, smallest=smallest)


def support_surfaces(shapes: Sequence[Shape], least_area: float = LEAST_AREA) -> list[Surface]:
    """The surfaces of a thing, highest first.

    Args:
        shapes: its parts in its local frame.
        least_area: smaller ones are left out, square metres.
    """
    if not shapes:
        return []
    points = np.concatenate([s.vertices for s in shapes])
    extent = float((points[:, :2].max(axis=0) - points[:, :2].min(axis=0)).max()) if len(points) else 0.0
    samples = sample(shapes, SMALL_CELL if extent < 0.5 else CELL)
    if samples is None:
        return []
    usable, above = _usable(samples)
    cells, heights, owner = samples.cells[usable], samples.heights[usable], samples.owner[usable]
    above = above[usable]
    found = []
    while len(cells):
        level = _fullest_level(heights)
        inside = (heights > level - ROUGHNESS) & (heights <= level + SKIN)
        count = len(np.unique(cells[inside]))
        if count * samples.grid.cell**2 < least_area:
            break
        found.append(_surface(samples.grid, cells[inside], heights[inside], above[inside], owner[inside], shapes))
        cells, heights, above, owner = cells[~inside], heights[~inside], above[~inside], owner[~inside]
    found.sort(key=lambda s: -s.level)
    return [_with_rims(_with_steps(surface, found), samples) for surface in found]


def _with_steps(surface: Surface, others: Sequence[Surface]) -> Surface:
    """The surface with what lies a little lower beside it: a thing may lie across a fold, a rim or the edge of a duvet."""
    heights, clearance = surface.heights.copy(), surface.clearance.copy()
    for other in others:
        if surface.level - STEP <= other.level < surface.level:
            filled = np.isnan(heights) & np.isfinite(other.heights)
            heights[filled], clearance[filled] = other.heights[filled], other.clearance[filled]
    return replace(surface, heights=heights, clearance=clearance, free=np.isfinite(heights))


def _with_rims(surface: Surface, samples: Samples) -> Surface:
    """The surface with what rises beside it."""
    higher = samples.heights > surface.level + RIM
    # Crossings are sorted by height within a cell: the first one of each cell counts.
    cells, first = np.unique(samples.cells[higher], return_index=True)
    above = np.where(samples.facing[higher][first], 0.0, samples.heights[higher][first] - surface.level)
    beside = np.full(surface.heights.size, np.inf)
    beside[cells] = above
    return replace(surface, beside=beside.reshape(surface.heights.shape))


def _usable(samples: Samples) -> tuple[NDArray[np.bool_], Floats]:
    """Which crossings are level upward faces with room above, and the free height above each crossing."""
    heights, cells = samples.heights, samples.cells
    above = np.full(len(heights), np.inf)
    same = cells[1:] == cells[:-1]
    gap = heights[1:] - heights[:-1]
    above[:-1][same] = gap[same]
    # Touching parts leave no room; where the next face above faces up as well, the place is inside of something.
    buried = np.zeros(len(heights), dtype=bool)
    buried[:-1] = same & samples.up[1:] & (gap < BURIED)
    above[(above < SKIN) | buried] = 0.0
    return samples.up & (above >= LEAST_CLEARANCE), above


def _fullest_level(heights: Floats) -> float:
    """The height below which, within the roughness, most crossings lie; the top of that layer."""
    ordered = np.sort(heights)
    counts = np.searchsorted(ordered, ordered + SKIN, side="right") - np.searchsorted(ordered, ordered - ROUGHNESS)
    best = int(counts.argmax())
    # Of equally full layers the one whose level has most at its very top: a board's own height.
    ties = np.flatnonzero(counts >= counts[best])
    return float(ordered[ties[-1]])


def _surface(
    grid: Grid,
    cells: NDArray[np.int64],
    heights: Floats,
    above: Floats,
    owner: NDArray[np.int64],
    shapes: Sequence[Shape],
) -> Surface:
    size = grid.shape[0] * grid.shape[1]
    table, room = np.full(size, np.nan), np.zeros(size)
    # Crossings are sorted by height within a cell, so the highest one is written last.
    table[cells], room[cells] = heights, above
    part = shapes[int(np.bincount(owner).argmax())].part
    inside = np.isfinite(table).reshape(grid.shape)
    level = float(np.percentile(heights, 95))
    open_beside = np.full(grid.shape, np.inf)
    return Surface(grid, level, table.reshape(grid.shape), room.reshape(grid.shape), inside, open_beside, part)
