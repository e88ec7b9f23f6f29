# SPDX-License-Identifier: GPL-3.0-or-later
"""Convex hulls and oriented boxes of pixel areas."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .grid import Bools

Points = NDArray[np.float64]


@dataclass(frozen=True)
class OrientedBox:
    """A rectangle in the picture.

    Attributes:
        centre: (x, y) in pixels.
        length, breadth: sides along its own axis and across it, length >= breadth unless it is upright.
        angle: degrees of the `length` side from the picture's x axis, counter-clockwise as seen, -45 < angle <= 45 for
            upright boxes 0, where `length` is then the horizontal side.
    """

    centre: tuple[float, float]
    length: float
    breadth: float
    angle: float

    @property
    def area(self) -> float:
        """Area in square pixels."""
        return self.length * self.breadth

    def corners(self) -> Points:
        """The four corners, (4, 2) x, y in pixels."""
        turn = np.radians(-self.angle)  # the picture's y axis points down
        along = np.array([np.cos(turn), np.sin(turn)]) * self.length / 2
        across = np.array([-np.sin(turn), np.cos(turn)]) * self.breadth / 2
        middle = np.array(self.centre)
        return np.array(
            [middle - along - across, middle + along - across, middle + along + across, middle - along + across]
        )

    def bounds(self) -> tuple[float, float, float, float]:
        """Axis-aligned bounds x_min, y_min, x_max, y_max in pixels."""
        corners = self.corners()
        low, high = corners.min(0), corners.max(0)
        return float(low[0]), float(low[1]), float(high[0]), float(high[1])

    def contains(self, points: Points, slack: float = 0.0) -> NDArray[np.bool_]:
        """Which of (n, 2) points lie inside, with the box grown by `slack` pixels on each side."""
        turn = np.radians(-self.angle)
        offset = points - np.array(self.centre)
        along = offset @ np.array([np.cos(turn), np.sin(turn)])
        across = offset @ np.array([-np.sin(turn), np.cos(turn)])
        inside: NDArray[np.bool_] = (np.abs(along) <= self.length / 2 + slack) & (
            np.abs(across) <= self.breadth / 2 + slack
        )
        return inside


def convex_hull(points: Points) -> Points:
    """Convex hull of (n, 2) points by Andrew's monotone chain, in order around it."""
    ordered = sorted(set(map(tuple, points.tolist())))
    if len(ordered) < 3:
        return np.array(ordered, dtype=np.float64).reshape(-1, 2)
    hull: list[tuple[float, float]] = []
    for sweep in (ordered, ordered[::-1]):
        chain: list[tuple[float, float]] = []
        for x, y in sweep:
            while len(chain) > 1:
                (x0, y0), (x1, y1) = chain[-2], chain[-1]
                if (x1 - x0) * (y - y0) - (y1 - y0) * (x - x0) > 0:
                    break
                chain.pop()
            chain.append((x, y))
        hull += chain[:-1]
    return np.array(hull, dtype=np.float64)


def polygon_area(points: Points) -> float:
    """Area of a simple polygon, never negative."""
    x, y = points[:, 0], points[:, 1]
    return abs(float(np.dot(x, np.roll(y, -1)) - np.dot(y, np.roll(x, -1)))) / 2


def outline_points(mask: Bools, offset: tuple[int, int] = (0, 0)) -> Points:
    """Corners of the first and last pixel of each row of a mask: enough for its convex hull. Offset is (x, y)."""
    rows = np.flatnonzero(mask.any(1))
    first = np.argmax(mask[rows], axis=1)
    last = mask.shape[1] - np.argmax(mask[rows][:, ::-1], axis=1)
    x = np.concatenate([first, first, last, last]).astype(np.float64) + offset[0]
    y = np.concatenate([rows, rows + 1, rows, rows + 1]).astype(np.float64) + offset[1]
    return np.stack([x, y], 1)


def _box_at(hull: Points, angle: float) -> OrientedBox:
    turn = np.radians(-angle)
    u, v = np.array([np.cos(turn), np.sin(turn)]), np.array([-np.sin(turn), np.cos(turn)])
    along, across = hull @ u, hull @ v
    middle = u * (along.max() + along.min()) / 2 + v * (across.max() + across.min()) / 2
    return OrientedBox((float(middle[0]), float(middle[1])), float(np.ptp(along)), float(np.ptp(across)), float(angle))


def oriented_box(hull: Points, upright_bonus: float = 1.09) -> OrientedBox:
    """Smallest rectangle around a convex hull; the axis-aligned one unless another is clearly smaller.

    Args:
        upright_bonus: how many times larger the axis-aligned rectangle may be and still win.
    """
    upright = _box_at(hull, 0.0)
    if len(hull) < 3:
        return upright
    edges = np.roll(hull, -1, axis=0) - hull
    angles = np.degrees(np.arctan2(-edges[:, 1], edges[:, 0]))
    folded = np.unique(np.round((angles + 45.0) % 90.0 - 45.0))  # whole degrees: pixels do not tell more
    turns = np.radians(-folded)
    along = hull @ np.stack([np.cos(turns), np.sin(turns)])
    across = hull @ np.stack([-np.sin(turns), np.cos(turns)])
    best = _box_at(hull, float(folded[int(np.argmin(np.ptp(along, axis=0) * np.ptp(across, axis=0)))]))
    return upright if upright.area <= best.area * upright_bonus or abs(best.angle) < 4 else best
