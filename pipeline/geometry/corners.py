# SPDX-License-Identifier: GPL-3.0-or-later
"""Room corners as they were pointed out in the picture, checked and put in order before a camera is fitted to them.

People and models point corners out with slips: a corner twice, the outline clockwise or crossing itself, the wall
tops listed from another corner, or floor and wall tops mixed up. What can be mended is mended and reported.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np

from ..artifacts.analysis import Finding
from .camera import GeometryError
from .polygon import Floats, PolygonLike, edges, self_crossing, signed_area

SAME_POINT = 1.0  # of 1000: nearer corners are one corner
MIN_FLOOR_AREA = 1000.0  # of 1,000,000: below 0.1 % of the picture there is no room to measure
MIN_THICKNESS = 0.02  # area / (extent squared): thinner outlines are lines
SWAPPED = 0.95  # wall tops are nearer to the camera than the floor; smaller than noise explains is a mix-up
MISPLACED = 0.12  # wall tops off by more than this part of the floor's diagonal do not belong to it
FIX = "Point the floor's corners out again, one after another around the room."


@dataclass
class Corners:
    """A usable outline.

    Attributes:
        floor: (N, 2) image coordinates 0-1000, anticlockwise as seen in the picture (so ccw in metres).
        tops: (N, 2) upper ends of the same wall corners, nan rows where unknown; None when there are none.
        order: for each corner, its index in the polygon that was given.
        findings: what was mended.
    """

    floor: Floats
    tops: Floats | None
    order: list[int]
    findings: list[Finding] = field(default_factory=list)

    def note(self, about: str, message: str) -> None:
        """Report a repair."""
        self.findings.append(Finding(about=about, message=message, severity="warning"))


def check_corners(floor: Floats, tops: Floats | None) -> Corners:
    """Check and mend corners, both (N, 2) in 0-1000.

    Raises:
        GeometryError: not finite, fewer than three different corners, or an outline without area.
    """
    if not np.isfinite(floor).all():
        raise GeometryError("A corner of the floor is not a number.", FIX)
    corners = Corners(floor, None, list(range(len(floor))))
    _drop_repeated(corners)
    if len(corners.order) < 3:
        raise GeometryError("The floor's outline needs at least three different corners.", FIX)
    _uncross(corners)
    _check_area(corners)
    if signed_area(corners.floor) > 0:  # y points down: positive is clockwise to the eye
        _reorder(corners, [0, *range(len(corners.order) - 1, 0, -1)])
    if tops is not None and len(tops):
        _take_tops(corners, tops, len(floor))
    return corners


def _reorder(corners: Corners, indices: list[int]) -> None:
    corners.floor = corners.floor[indices]
    corners.order = [corners.order[i] for i in indices]


def _drop_repeated(corners: Corners) -> None:
    kept: list[int] = []
    for i, point in enumerate(corners.floor):
        if all(math.dist(point, corners.floor[j]) > SAME_POINT for j in kept):
            kept.append(i)
    if len(kept) < len(corners.floor):
        corners.note("floor", "A corner of the floor was given more than once; it was taken once.")
        _reorder(corners, kept)


def _uncross(corners: Corners) -> None:
    """Turn the part between two crossing edges round until none cross; each turn shortens the outline."""
    crossing = self_crossing(corners.floor)
    if crossing is None:
        return
    for _ in range(200):
        first, second = crossing
        indices = list(range(len(corners.floor)))
        indices[first + 1 : second + 1] = indices[first + 1 : second + 1][::-1]
        _reorder(corners, indices)
        crossing = self_crossing(corners.floor)
        if crossing is None:
            corners.note("floor", "The floor's outline crossed itself; its corners were put into another order.")
            return
    raise GeometryError("The floor's outline crosses itself.", FIX)


def _check_area(corners: Corners) -> None:
    covered = abs(signed_area(corners.floor))
    longest = max(math.dist(a, b) for a in corners.floor for b in corners.floor)
    if covered < MIN_FLOOR_AREA or covered < MIN_THICKNESS * longest**2:
        raise GeometryError("The floor's corners lie on a line or too close together.", FIX)


def _take_tops(corners: Corners, tops: Floats, given: int) -> None:
    tops = np.where(np.isfinite(tops).all(axis=1, keepdims=True), tops, np.nan)
    if len(tops) == given:
        matched = _best_order(corners, tops[corners.order])
    else:
        matched = _match_by_place(corners.floor, tops)
        found = int(np.isfinite(matched[:, 0]).sum())
        corners.note(
            "wall tops", f"{given} floor corners but {len(tops)} wall tops were given; {found} of them were matched."
        )
    if np.isfinite(matched[:, 0]).sum() < min(3, len(matched)):
        corners.note("wall tops", "The wall tops could not be matched with the floor's corners and were left out.")
        return
    scale, _, misfit = similarity(corners.floor, matched)
    diagonal = float(np.linalg.norm(np.ptp(corners.floor, axis=0)))
    if scale <= 0.2 or scale > 10 or misfit > MISPLACED * diagonal:
        corners.note("wall tops", "The wall tops do not belong to this floor outline and were left out.")
        return
    if scale < SWAPPED:
        if not np.isfinite(matched).all():
            corners.note("wall tops", "The wall tops were smaller than the floor and were left out.")
            return
        corners.note("wall tops", "The wall tops were smaller than the floor; the two outlines were exchanged.")
        corners.floor, matched = matched, corners.floor
        if self_crossing(corners.floor) is not None or signed_area(corners.floor) >= 0:
            raise GeometryError("The floor's outline crosses itself.", FIX)
    corners.tops = matched


def similarity(floor: Floats, tops: Floats) -> tuple[float, Floats, float]:
    """Scale and shift with tops = scale * floor + shift, and the root mean square misfit; nan rows do not count."""
    valid = np.isfinite(tops[:, 0])
    a, b = floor[valid], tops[valid]
    a_mean, b_mean = a.mean(axis=0), b.mean(axis=0)
    spread = float(((a - a_mean) ** 2).sum())
    scale = float(((a - a_mean) * (b - b_mean)).sum()) / spread if spread > 0 else 1.0
    shift: Floats = b_mean - scale * a_mean
    misfit = float(np.sqrt(np.mean(np.sum((scale * a + shift - b) ** 2, axis=1))))
    return scale, shift, misfit


def _best_order(corners: Corners, tops: Floats) -> Floats:
    """The tops as given, or turned round the room or reversed when that fits far better."""
    diagonal = float(np.linalg.norm(np.ptp(corners.floor, axis=0)))
    missing = not np.isfinite(tops).all()
    given = _misfit(corners.floor, tops)
    if missing or given < 0.05 * diagonal:
        return tops
    orders = [np.roll(way, -k, axis=0) for way in (tops, tops[::-1]) for k in range(len(tops))]
    best = min(orders, key=lambda order: _misfit(corners.floor, order))
    if _misfit(corners.floor, best) < 0.5 * given:
        corners.note("wall tops", "The wall tops were listed in another order than the floor's corners.")
        return best
    return tops


def _misfit(floor: Floats, tops: Floats) -> float:
    scale, _, misfit = similarity(floor, tops)
    return misfit if scale > 0 else math.inf


def _match_by_place(floor: Floats, tops: Floats) -> Floats:
    """Match outlines of different corner counts by place within their bounding boxes; nan where nothing is near."""
    result = np.full(floor.shape, np.nan)
    usable = tops[np.isfinite(tops[:, 0])]
    if len(usable) < 3:
        return result
    a, b = _in_unit_square(floor), _in_unit_square(usable)
    distance = np.linalg.norm(a[:, None] - b[None], axis=2)
    for i in range(len(floor)):
        j = int(distance[i].argmin())
        if distance[i, j] < 0.1 and int(distance[:, j].argmin()) == i:
            result[i] = usable[j]
    return result


def _in_unit_square(points: Floats) -> Floats:
    low, extent = points.min(axis=0), np.ptp(points, axis=0)
    unit: Floats = (points - low) / np.maximum(extent, 1e-9)
    return unit


def main_direction(polygon: PolygonLike) -> tuple[float, float]:
    """Direction of the walls modulo 90 degrees, -45..45, and how far they agree, 0..1 (1: all at right angles)."""
    total, weight = 0j, 0.0
    for (ax, ay), (bx, by) in edges(polygon):
        step = complex(bx - ax, by - ay)
        if step != 0:
            total += abs(step) * (step / abs(step)) ** 4
            weight += abs(step)
    if weight == 0:
        return 0.0, 0.0
    return math.degrees(math.atan2(total.imag, total.real)) / 4, abs(total) / weight
