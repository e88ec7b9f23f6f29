# SPDX-License-Identifier: GPL-3.0-or-later
"""A free place on a surface for a thing: where the picture shows it, else the nearest one. (Paper, stage 7.)"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .find import Surface
from .rasters import Grid

Mask = NDArray[np.bool_]

COVER = 0.85
"""Share of a footprint that must lie on the surface; the rest may hang over its edge."""
SHARED = 0.08
"""Share of a footprint that may reach into a neighbour's: outlines are boxes, things are rounder."""
COVERED = 0.2
"""Share of the smallest neighbour that a larger thing may reach over, for the same reason."""
ROUND = 0.02
CLOSE = 0.12
"""Share of a footprint that may reach into what rises beside the surface (a backrest, a rim): as a rule, for the same
reason, and where there is no other place."""
SHRINK = (1.0, 0.85, 0.7)
"""How far a thing that is too large for its surface is made smaller, in this order."""


@dataclass(frozen=True)
class Seat:
    """A place on a surface, in the local frame of the thing that has the surface.

    Attributes:
        x, y: middle of the footprint; z: height on which it stands.
        scale: what the thing's size is to be multiplied with.
        moved: distance in metres from where it was wanted.
        cells: the cells that it takes.
    """

    x: float
    y: float
    z: float
    scale: float
    moved: float
    cells: Mask


def find_seat(
    surface: Surface,
    wanted: tuple[float, float],
    size: tuple[float, float, float],
    turn: float,
    reach: float = math.inf,
    beyond: float = ROUND,
) -> Seat | None:
    """The nearest place to `wanted` where a thing can stand, or None.

    Args:
        wanted: middle of the footprint in the surface's frame.
        size: width, depth and height of the thing, metres.
        turn: its yaw in the surface's frame, degrees counter-clockwise.
        reach: how far from `wanted` it may stand, metres.
        beyond: share of its footprint that may reach into what rises beside the surface.
    """
    for scale in SHRINK:
        scaled = (size[0] * scale, size[1] * scale, size[2] * scale)
        seat = _seat(surface, wanted, scaled, turn, scale, reach, beyond)
        if seat is not None:
            return seat
    return None


def _seat(
    surface: Surface,
    wanted: tuple[float, float],
    size: tuple[float, float, float],
    turn: float,
    scale: float,
    reach: float,
    beyond: float,
) -> Seat | None:
    grid = surface.grid
    kernel = footprint_kernel(grid.cell, size[0], size[1], turn)
    total = float(kernel.sum())
    high_enough = np.isfinite(surface.heights) & (surface.clearance >= size[2] - 1e-6)
    on = _correlate(high_enough, kernel) / total
    free = _correlate(high_enough & surface.free, kernel) / total
    too_low = np.where(np.isfinite(surface.heights), surface.clearance, surface.beside) < size[2] - 1e-6
    blocked = _correlate(too_low, kernel) / total
    columns, rows = np.meshgrid(np.arange(grid.shape[0]), np.arange(grid.shape[1]), indexing="ij")
    x, y = grid.origin[0] + (columns + 0.5) * grid.cell, grid.origin[1] + (rows + 0.5) * grid.cell
    distance = np.hypot(x - wanted[0], y - wanted[1])
    # The middle must be carried, or the thing tips over.
    shared = min(SHARED, COVERED * surface.smallest / total) if surface.smallest else SHARED
    possible = (on >= COVER) & (on - free <= shared + 1e-9) & high_enough & (distance <= reach + grid.cell)
    possible &= blocked <= beyond + 1e-9
    if not possible.any():
        return None
    column, row = np.unravel_index(int(np.where(possible, distance, np.inf).argmin()), possible.shape)
    spot = grid.centre(float(column), float(row))
    if distance[column, row] <= grid.cell:
        # Within a cell the picture's own place is kept.
        spot = wanted
    cells = _stamp(grid, kernel, int(column), int(row))
    below = surface.heights[cells & np.isfinite(surface.heights)]
    moved = math.hypot(spot[0] - wanted[0], spot[1] - wanted[1])
    return Seat(spot[0], spot[1], float(below.max()), scale, moved, cells)


def footprint_kernel(cell: float, width: float, depth: float, turn: float) -> Mask:
    """The cells that a turned rectangle covers, as a small mask with an odd number of columns and rows."""
    angle = math.radians(turn)
    cos, sin = math.cos(angle), math.sin(angle)
    reach = (abs(width * cos) + abs(depth * sin), abs(width * sin) + abs(depth * cos))
    half = [max(0, math.ceil(r / 2 / cell - 0.5)) for r in reach]
    x, y = np.meshgrid(np.arange(-half[0], half[0] + 1) * cell, np.arange(-half[1], half[1] + 1) * cell, indexing="ij")
    along, across = x * cos + y * sin, -x * sin + y * cos
    inside: Mask = (np.abs(along) <= width / 2 + 1e-9) & (np.abs(across) <= depth / 2 + 1e-9)
    inside[half[0], half[1]] = True
    return inside


def occupied(grid: Grid, x: float, y: float, width: float, depth: float, turn: float) -> Mask:
    """The cells of a grid that a thing at this place takes."""
    return _stamp(grid, footprint_kernel(grid.cell, width, depth, turn), *grid.index(x, y))


def _stamp(grid: Grid, kernel: Mask, column: int, row: int) -> Mask:
    """The kernel laid on the grid with its middle on a cell; what lies outside is cut off."""
    cells = np.zeros(grid.shape, dtype=bool)
    low = (column - kernel.shape[0] // 2, row - kernel.shape[1] // 2)
    a = [max(0, v) for v in low]
    b = [min(grid.shape[i], low[i] + kernel.shape[i]) for i in (0, 1)]
    if a[0] < b[0] and a[1] < b[1]:
        cells[a[0] : b[0], a[1] : b[1]] = kernel[a[0] - low[0] : b[0] - low[0], a[1] - low[1] : b[1] - low[1]]
    return cells


def _correlate(mask: Mask, kernel: Mask) -> NDArray[np.float64]:
    """For each cell, how many cells of the mask lie under the kernel that is centred on it."""
    shape = [mask.shape[i] + kernel.shape[i] - 1 for i in (0, 1)]
    product = np.fft.rfft2(mask.astype(float), shape) * np.fft.rfft2(kernel[::-1, ::-1].astype(float), shape)
    full = np.fft.irfft2(product, shape)
    start = [kernel.shape[i] // 2 for i in (0, 1)]
    return full[start[0] : start[0] + mask.shape[0], start[1] : start[1] + mask.shape[1]]
