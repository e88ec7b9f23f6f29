# SPDX-License-Identifier: GPL-3.0-or-later
"""The last millimetres: a thing is let down, or lifted, until its own underside touches what carries it.

A seat's height is that of the highest cell below a footprint. Cushions are round and beds have folds, so the two may
touch somewhere else, or not at all.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from ..program.prelude.shape import Shape
from .rasters import Floats, Samples, sample

FINE = 0.01
"""Side of a raster's cell in metres."""
MOST = 0.04
"""Metres that a thing is let down or lifted at most."""


def drop(
    shapes: Sequence[Shape], scale: float, carrier: Samples, place: tuple[float, float, float], turn: float
) -> float:
    """Metres that a thing has to be let down to touch its carrier; below zero where it has to be lifted.

    Args:
        shapes: parts of the thing in its own frame; scale: what its size is multiplied with.
        carrier: the carrier's raster. place: middle and height of the thing's base in the carrier's frame.
        turn: its yaw there, degrees counter-clockwise.
    """
    own = sample(shapes, FINE)
    if own is None:
        return 0.0
    # The lowest crossing of each cell is the underside: crossings are sorted by height within a cell.
    cells, first = np.unique(own.cells, return_index=True)
    x = own.grid.origin[0] + (cells // own.grid.shape[1] + 0.5) * own.grid.cell
    y = own.grid.origin[1] + (cells % own.grid.shape[1] + 0.5) * own.grid.cell
    cos, sin = math.cos(math.radians(turn)), math.sin(math.radians(turn))
    points = np.stack([place[0] + scale * (x * cos - y * sin), place[1] + scale * (x * sin + y * cos)], axis=1)
    below = _heights(carrier, points, place[2])
    gaps = place[2] + scale * own.heights[first] - below
    gaps = gaps[np.isfinite(gaps)]
    if not len(gaps):
        return 0.0
    gap = float(gaps.min())
    return gap if abs(gap) <= MOST else 0.0


def _heights(carrier: Samples, points: Floats, level: float) -> NDArray[np.float64]:
    """Height of the carrier's highest upward face near a level under each point (N, 2); NaN where there is none."""
    grid = carrier.grid
    near = carrier.up & (np.abs(carrier.heights - level) <= MOST)
    table = np.full(grid.shape[0] * grid.shape[1], np.nan)
    table[carrier.cells[near]] = carrier.heights[near]
    index = np.floor((points - grid.origin) / grid.cell).astype(int)
    inside = ((index >= 0) & (index < grid.shape)).all(axis=1)
    found = np.full(len(points), np.nan)
    found[inside] = table[index[inside, 0] * grid.shape[1] + index[inside, 1]]
    return found
