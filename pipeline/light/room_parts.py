# SPDX-License-Identifier: GPL-3.0-or-later
"""The parts of a room that light hardly leaves: what long partitions part, and the arms of an L."""

from __future__ import annotations

import numpy as np

from ..geometry.polygon import Floats
from .bulk import Bools, Ints
from .space import Space, Wall, inside


def part_of(space: Space, points: Floats) -> Ints:
    """In which part of the room places (N, 3) are, the nearest where they are in none; all 0 in a room of one part."""
    walls = _long_partitions(space)
    result = np.zeros(len(points), dtype=np.int64)
    if not walls:
        return result
    for axis in (0, 1):
        middles = sorted((low + high) / 2 for across, low, high in walls if across == axis)
        result = result * (len(middles) + 1) + np.searchsorted(middles, points[:, axis])
    return result


def rectangles(space: Space) -> list[tuple[float, float, float, float]]:
    """The floor as a few large rectangles (x from, to, y from, to) that neither leave it nor cross a partition."""
    xs, ys = _cuts(space, 0), _cuts(space, 1)
    cells = np.zeros((len(xs) - 1, len(ys) - 1), dtype=bool)
    for i in range(len(xs) - 1):
        for j in range(len(ys) - 1):
            middle = ((xs[i] + xs[i + 1]) / 2, (ys[j] + ys[j + 1]) / 2)
            within = any(low < middle[axis] < high for axis, low, high in _long_partitions(space))
            cells[i, j] = not within and bool(inside(space.floor, np.array([middle]))[0])
    found: list[tuple[float, float, float, float]] = []
    while cells.any() and len(found) < 6:
        area, best = max((_largest(cells, xs, ys, i, j) for i, j in np.argwhere(cells)), key=lambda item: item[0])
        i0, i1, j0, j1 = best
        cells[i0:i1, j0:j1] = False
        if area > 1.0 or not found:
            found.append((xs[i0], xs[i1], ys[j0], ys[j1]))
    return found


def _cuts(space: Space, axis: int) -> list[float]:
    """Where the room is cut along an axis: its corners, and its long partitions."""
    low, high = float(space.floor[:, axis].min()), float(space.floor[:, axis].max())
    marks = [float(v) for v in space.floor[:, axis]]
    marks += [face for across, *faces in _long_partitions(space) if across == axis for face in faces]
    kept: list[float] = []
    for mark in sorted({low, high, *marks}):
        if not kept or mark - kept[-1] > 0.02:
            kept.append(mark)
    return kept if len(kept) > 1 else [low, high]


def _long_partitions(space: Space) -> list[tuple[int, float, float]]:
    """Partitions that part the room: the axis across each, and where its two faces are on it."""
    faces: dict[str, list[Wall]] = {}
    for wall in space.walls:
        faces.setdefault(wall.id, []).append(wall)
    found = []
    for pair in faces.values():
        for axis in (0, 1):
            span = float(np.ptp(space.floor[:, 1 - axis]))
            if len(pair) == 2 and abs(pair[0].normal[axis]) > 0.95 and pair[0].length > 0.6 * span:
                low, high = sorted(wall.start[axis] for wall in pair)
                found.append((axis, low, high))
    return found


def _largest(cells: Bools, xs: list[float], ys: list[float], i: int, j: int) -> tuple[float, tuple[int, int, int, int]]:
    """The largest rectangle of cells whose lower left one is (i, j)."""
    best, found = 0.0, (i, i + 1, j, j + 1)
    reach = cells.shape[1]
    for i1 in range(i + 1, cells.shape[0] + 1):
        column = cells[i1 - 1, j:reach]
        reach = j + (int(np.argmin(column)) if not column.all() else len(column))
        if reach <= j:
            break
        area = (xs[i1] - xs[i]) * (ys[reach] - ys[j])
        if area > best:
            best, found = area, (i, i1, j, reach)
    return best, found
