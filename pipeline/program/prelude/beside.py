# SPDX-License-Identifier: GPL-3.0-or-later
"""Ends of cloths that hang down beside what the cloth lies on, kept out of what stands there."""

from __future__ import annotations

from typing import Any

import numpy as np

from .heights import Bed, Field, widest
from .shape import Floats

REACH = 0.15
"""Metres below the underside of something within which an end lies on it rather than passing below."""
GAP = 0.002
PRESSED, NARROW = 16, 0.012
"""Steps in which a way out is looked for, and the least room in metres that a hanging end is pressed into."""
OVERHANG = 3
"""Cells by which an end that lies on something reaches over its edge."""


def kept_off(
    points: Floats, normals: Floats, thick: float, bed: Bed, near: tuple[Any, Any, Any], field: Field
) -> Floats:  # fmt: skip
    """The vertices of a cloth that was laid, with its ends off what stands beside its ground, (N, 3).

    They are pressed back to where there is room before it, and come to lie on what is lower than the cloth where there is
    none.
    """
    top, low = spans(near, field)
    high, flat = widest(top, OVERHANG), points[:, :2]
    edge = np.column_stack([field.at(bed.edge[:, :, k], flat) for k in (0, 1)])
    away = flat - edge
    column, row = field.cells(flat).T
    ends = ~bed.carries[column, row]
    free, share = ends.copy(), np.zeros(len(points))
    for step in range(1, PRESSED + 1):
        i, j = field.cells(edge + away * (step / PRESSED)).T
        free &= (points[:, 2] <= low[i, j]) | (points[:, 2] >= top[i, j])
        share = np.where(free, step / PRESSED, share)
    new, wide = points.copy(), np.linalg.norm(away, axis=1)
    level = field.at(bed.ground, edge)
    below = ends & (high[column, row] <= level + GAP) & (points[:, 2] < high[column, row])
    # Where there is hardly room beside what is lower, all that hangs there lies on it, its neighbours too.
    narrow = ends & (share < 1) & (share * wide < NARROW)
    lifted = below & (points[:, 2] > low[column, row] - REACH) & near_to(narrow, field, column, row)
    pressed = ends & (share < 1) & ~lifted
    inner = np.where((normals[:, :2] * away).sum(axis=1) > 0, 0.0, 0.25)
    new[pressed, :2] = (edge + away * (share * (1 - inner))[:, None])[pressed]
    over = np.where(normals[:, 2] > 0, thick, 0.0)
    new[lifted, 2] = (high[column, row] + over)[lifted]
    return new


def spans(crossings: tuple[Any, Any, Any], field: Field) -> tuple[Floats, Floats]:
    """Highest and lowest of what crosses each cell or one next to it, a little more to both sides."""
    cells, heights, _ = crossings
    top, low = np.full(field.shape, -np.inf), np.full(field.shape, np.inf)
    np.maximum.at(top.reshape(-1), cells, heights)
    np.minimum.at(low.reshape(-1), cells, heights)
    return widest(top, 1) + GAP, widest(low, 1, low=True) - GAP


def near_to(found: Any, field: Field, column: Any, row: Any) -> Any:
    """Which points lie in or near a cell that holds one of those found, (N,)."""
    table = np.zeros(field.shape)
    table[column[found], row[found]] = 1.0
    return widest(table, OVERHANG + 1)[column, row] > 0
