# SPDX-License-Identifier: GPL-3.0-or-later
"""A mesh as upright columns of solid, so that what two things share of space is a sum. Metres, the room's frame."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ..program.prelude.shape import Shape
from ..surfaces.rasters import Grid, sample

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

COARSEST, FINEST = 0.02, 0.005
"""Sides of a column in metres, for furniture and for the smallest things."""
_PER_SIDE = 30  # columns along the longer side of a small thing


@dataclass(frozen=True)
class Columns:
    """Solid stretches of upright lines through the cells' middles, by cell and then by height.

    Attributes:
        cells: flat index (column * rows + row) of each stretch; low, high: its ends.
        tops, tops_cells: heights of nearly level faces that look up, and their cells, in the same order.
    """

    grid: Grid
    cells: Ints
    low: Floats
    high: Floats
    tops: Floats
    tops_cells: Ints

    @property
    def volume(self) -> float:
        """Cubic metres of solid."""
        return float((self.high - self.low).sum()) * self.grid.cell**2

    def moved(self, dx: float, dy: float, dz: float = 0.0) -> Columns:
        """The same columns elsewhere."""
        x, y = self.grid.origin
        grid = replace(self.grid, origin=(x + dx, y + dy))
        return replace(self, grid=grid, low=self.low + dz, high=self.high + dz, tops=self.tops + dz)

    def places(self, cells: Ints) -> Floats:
        """The middles (N, 2) of cells."""
        rows = self.grid.shape[1]
        at = np.stack([cells // rows, cells % rows], axis=1)
        result: Floats = np.asarray(self.grid.origin) + (at + 0.5) * self.grid.cell
        return result

    def at(self, places: Floats) -> Ints:
        """The flat index of the cell that holds each place (N, 2), -1 outside."""
        index = np.floor((places - self.grid.origin) / self.grid.cell + 1e-9).astype(np.int64)
        inside = ((index >= 0) & (index < self.grid.shape)).all(axis=1)
        flat: Ints = np.where(inside, index[:, 0] * self.grid.shape[1] + index[:, 1], -1)
        return flat


def columns_of(shapes: Sequence[Shape]) -> Columns | None:
    """The columns of shapes in the room's frame; None for what has no extent seen from above."""
    if not shapes:
        return None
    points = np.concatenate([s.vertices for s in shapes])
    side = float(np.ptp(points[:, :2], axis=0).max()) if len(points) else 0.0
    cell = min(COARSEST, max(FINEST, side / _PER_SIDE))
    found = sample(shapes, cell)
    if found is None or not len(found.cells):
        return None
    cells, heights = found.cells, found.heights
    # Each face that looks down begins a solid, each that looks up ends one; parts may lie in each other.
    steps = np.where(found.facing, -1, 1)
    total = np.cumsum(steps)
    starts = np.flatnonzero(np.concatenate([[True], cells[1:] != cells[:-1]]))
    before = np.where(starts > 0, total[starts - 1], 0)
    deep = total - np.repeat(before, np.diff([*starts, len(cells)]))
    solid = (deep[:-1] > 0) & (cells[1:] == cells[:-1]) & (heights[1:] > heights[:-1])
    low, high = heights[:-1][solid], heights[1:][solid]
    return Columns(found.grid, cells[:-1][solid], low, high, heights[found.up], cells[found.up])


def shared_volume(a: Columns, b: Columns) -> float:
    """Cubic metres that two meshes share, as far as their columns tell."""
    if a.grid.cell > b.grid.cell:
        a, b = b, a
    into = b.at(a.places(a.cells))
    inside = into >= 0
    if not inside.any() or not len(b.cells):
        return 0.0
    into, low, high = into[inside], a.low[inside], a.high[inside]
    first = np.searchsorted(b.cells, into, side="left")
    last = np.searchsorted(b.cells, into, side="right")
    total = 0.0
    for k in range(int((last - first).max(initial=0))):
        here = first + k < last
        other = first[here] + k
        both = np.minimum(high[here], b.high[other]) - np.maximum(low[here], b.low[other])
        total += float(np.maximum(both, 0.0).sum())
    return total * a.grid.cell**2


BAND = 0.04
"""Metres that a face may lie above an underside and still be what carries it; beyond, it is sunken all over or not."""
_MOSTLY = 0.5
_LEAST_CELLS = 3


def clearance(thing: Columns, carriers: Sequence[Columns]) -> float | None:
    """Metres from a thing's underside down to what carries it, at the place where they are nearest.

    Below zero where it sinks in; None where nothing is below it.
    """
    cells, first = np.unique(thing.cells, return_index=True)
    if not len(cells):
        return None
    last = np.concatenate([first[1:], [len(thing.cells)]]) - 1
    under, over = thing.low[first], thing.high[last]
    places = thing.places(cells)
    near, through = np.full(len(cells), np.nan), np.full(len(cells), np.nan)
    for carrier in carriers:
        if carrier.grid.cell > 0:
            near = np.fmax(near, _highest(carrier, places, under + BAND))
            through = np.fmax(through, _highest(carrier, places, over))
    sunken = np.isfinite(through) & (through > under + BAND)
    if sunken.sum() > max(_LEAST_CELLS, _MOSTLY * np.isfinite(through).sum()):
        return -float(np.median((through - under)[sunken]))
    gaps = (under - near)[np.isfinite(near)]
    return float(gaps.min()) if len(gaps) >= min(_LEAST_CELLS, len(cells)) else None


def _highest(carrier: Columns, places: Floats, most: Floats) -> Floats:
    """Height of the carrier's highest face that looks up, not above `most`, under each place; NaN for none."""
    into, tops = carrier.at(places), carrier.tops
    first, last = np.searchsorted(carrier.tops_cells, into, "left"), np.searchsorted(carrier.tops_cells, into, "right")
    found = np.full(len(places), np.nan)
    for k in range(int((last - first).max(initial=0))):
        here = np.flatnonzero((first + k < last) & (into >= 0))
        height = tops[first[here] + k]
        fits = height <= most[here] + 1e-9
        found[here[fits]] = height[fits]
    return found


def turned(vertices: Floats, yaw: float, base: tuple[float, float, float]) -> Floats:
    """Vertices (N, 3) of a thing's own frame in the room's frame."""
    angle = math.radians(yaw)
    cos, sin = math.cos(angle), math.sin(angle)
    matrix = np.array(((cos, -sin, 0.0), (sin, cos, 0.0), (0.0, 0.0, 1.0)))
    result: Floats = vertices @ matrix.T + np.asarray(base)
    return result
