# SPDX-License-Identifier: GPL-3.0-or-later
"""Handles on a picture: what lies under the pointer, and what dragging it does.

Positions are (x, y) pairs with x to the right and y downwards or upwards alike: nothing here depends on it, except that
"top" is the side with the smaller y. Reaches and positions of one call share one unit: pixels where something is looked
for, 0-1000 of the picture where something is dragged.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

from ..artifacts.common import ImageBox
from .polygon import Point, nearest_on_segment, self_crossing, signed_area

PICTURE = (0.0, 0.0, 1000.0, 1000.0)
"""The whole picture as x_min, y_min, x_max, y_max."""
LEAST_SIDE = 4.0
"""A box of the picture never gets narrower than this, 0-1000: a fleck that nobody could grab again."""
LEAST_CORNERS = 4
"""A floor never gets fewer corners by hand."""
LEAST_AREA = 2000.0
"""A floor covers at least this much of the picture, in squared 0-1000 units: 0.2 percent of it."""

Rectangle = tuple[float, float, float, float]


class Grip(NamedTuple):
    """Which sides of a box are held; all four move it as a whole."""

    left: bool = False
    top: bool = False
    right: bool = False
    bottom: bool = False

    @property
    def whole(self) -> bool:
        """Whether the box moves without changing its size."""
        return all(self)


WHOLE = Grip(True, True, True, True)


class EdgeHit(NamedTuple):
    """An edge of an outline near the pointer: its number (edge i starts at corner i), the nearest point, the distance."""

    edge: int
    point: Point
    distance: float


def nearest_point(points: Sequence[Sequence[float]], at: Sequence[float], reach: float) -> int | None:
    """Number of the point nearest to `at`, None when none is within reach; points that are nan are passed over."""
    distances = [math.dist(point[:2], at) for point in points]
    near = min((i for i, d in enumerate(distances) if d <= reach), key=distances.__getitem__, default=None)
    return near


def nearest_edge(outline: Sequence[Sequence[float]], at: Sequence[float], reach: float) -> EdgeHit | None:
    """The edge of a closed outline that is nearest to `at`, None when none is within reach."""
    best: EdgeHit | None = None
    for index, start in enumerate(outline):
        point, _ = nearest_on_segment(at, start, outline[(index + 1) % len(outline)])
        distance = math.dist(point, at)
        if distance <= reach and (best is None or distance < best.distance):
            best = EdgeHit(index, point, distance)
    return best


def grip_at(box: Sequence[float], at: Sequence[float], reach: float) -> Grip | None:
    """Which sides of a box (x_min, y_min, x_max, y_max) are under the pointer: one, or two at a corner.

    Of two opposite sides within reach the nearer one is held, so that a small box can still be made larger.
    """
    left, top, right, bottom = box
    x, y = at[0], at[1]
    if not (left - reach <= x <= right + reach and top - reach <= y <= bottom + reach):
        return None
    near_left, near_right = abs(x - left), abs(x - right)
    near_top, near_bottom = abs(y - top), abs(y - bottom)
    grip = Grip(
        left=near_left <= reach and near_left <= near_right,
        top=near_top <= reach and near_top <= near_bottom,
        right=near_right <= reach and near_right < near_left,
        bottom=near_bottom <= reach and near_bottom < near_top,
    )
    return grip if any(grip) else None


def inside(rectangle: Sequence[float], at: Sequence[float]) -> bool:
    """Whether a position lies in x_min, y_min, x_max, y_max."""
    return rectangle[0] <= at[0] <= rectangle[2] and rectangle[1] <= at[1] <= rectangle[3]


def drag_box(
    box: ImageBox, grip: Grip, shift: Sequence[float], least: float = LEAST_SIDE, within: Rectangle = PICTURE
) -> ImageBox:
    """The box after its held sides were dragged by `shift`, 0-1000.

    It stays within the picture, never turns inside out and never gets narrower than `least`. A box that already was
    outside or narrower is not made worse by dragging another side of it.
    """
    if grip.whole:
        dx = _slide(box.x_min, box.x_max, shift[0], within[0], within[2])
        dy = _slide(box.y_min, box.y_max, shift[1], within[1], within[3])
        return ImageBox(x_min=box.x_min + dx, y_min=box.y_min + dy, x_max=box.x_max + dx, y_max=box.y_max + dy)
    x_min, x_max = _stretch(box.x_min, box.x_max, (grip.left, grip.right), shift[0], least, (within[0], within[2]))
    y_min, y_max = _stretch(box.y_min, box.y_max, (grip.top, grip.bottom), shift[1], least, (within[1], within[3]))
    return ImageBox(x_min=x_min, y_min=y_min, x_max=x_max, y_max=y_max)


def _slide(low: float, high: float, shift: float, least: float, most: float) -> float:
    """How far an interval may be moved of what is wished for."""
    return min(max(shift, min(0.0, least - low)), max(0.0, most - high))


def _stretch(
    low: float, high: float, held: tuple[bool, bool], shift: float, least: float, within: tuple[float, float]
) -> tuple[float, float]:
    if held[0]:
        return min(max(low + shift, min(within[0], low)), max(low, high - least)), high
    if held[1]:
        return low, max(min(high + shift, max(within[1], high)), min(high, low + least))
    return low, high


def box_between(start: Sequence[float], end: Sequence[float], within: Rectangle = PICTURE) -> ImageBox:
    """The box that two opposite corners span, cut at the picture's border."""
    xs = sorted(min(max(p[0], within[0]), within[2]) for p in (start, end))
    ys = sorted(min(max(p[1], within[1]), within[3]) for p in (start, end))
    return ImageBox(x_min=xs[0], y_min=ys[0], x_max=xs[1], y_max=ys[1])


def is_large_enough(box: ImageBox, least: float = LEAST_SIDE) -> bool:
    """Whether both sides of a box are at least this long."""
    return box.x_max - box.x_min >= least and box.y_max - box.y_min >= least


def moved_corner(outline: Sequence[Point], corner: int, to: Point) -> list[Point]:
    """The outline with one corner elsewhere."""
    return [to if index == corner else point for index, point in enumerate(outline)]


def with_corner(outline: Sequence[Point], edge: int, point: Point) -> list[Point]:
    """The outline with a new corner on an edge; it becomes corner `edge + 1`."""
    return [*outline[: edge + 1], point, *outline[edge + 1 :]]


def without_corner(outline: Sequence[Point], corner: int) -> list[Point]:
    """The outline without one of its corners."""
    return [point for index, point in enumerate(outline) if index != corner]


def outline_fault(outline: Sequence[Point]) -> str:
    """Why no floor can have this outline in the picture (0-1000), as a sentence; "" when one can."""
    if len(outline) < LEAST_CORNERS:
        return f"A floor needs at least {LEAST_CORNERS} corners."
    if self_crossing(outline) is not None:
        return "The floor's outline would cross itself."
    if abs(signed_area(outline)) < LEAST_AREA:
        return "The floor would be too small."
    return ""


def spread_labels(boxes: Sequence[Rectangle], sizes: Sequence[Sequence[float]]) -> list[Rectangle | None]:
    """Where labels of these sizes (width, height) go: in their box's upper left corner, or None where one is taken.

    Positions are pixels with y upwards, as Blender draws: a box's upper edge is its y_max. Earlier boxes have the
    right of way, so the caller sorts by importance.
    """
    placed: list[Rectangle] = []
    result: list[Rectangle | None] = []
    for box, (width, height) in zip(boxes, sizes, strict=True):
        spots = (
            (box[0], box[3] - height, box[0] + width, box[3]),
            (box[0], box[3], box[0] + width, box[3] + height),
            (box[0], box[1], box[0] + width, box[1] + height),
        )
        spot = next((s for s in spots if not any(_overlap(s, other) for other in placed)), None)
        result.append(spot)
        if spot is not None:
            placed.append(spot)
    return result


def _overlap(a: Rectangle, b: Rectangle) -> bool:
    return a[0] < b[2] and b[0] < a[2] and a[1] < b[3] and b[1] < a[3]
