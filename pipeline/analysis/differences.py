# SPDX-License-Identifier: GPL-3.0-or-later
"""Where an analysis contradicts itself: boxes against metres, and both against walls, neighbours and things of one kind.

Everything is in metres on the floor, to the right (x) and up (y) in the picture. A difference is what the metres say less
what the box says. Each has a variance that is a weighted sum of the squares of four usual errors: of centres (metres), of
sizes (relative), of box edges (thousandths of the picture's longer side) and of heights (relative).
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from ..artifacts.analysis import Calibration, DetectedObject, SceneAnalysis
from ..artifacts.common import ImageBox
from ..artifacts.trust import Edges
from ..geometry.camera import GeometryError, image_scale
from ..geometry.polygon import Point, as_points, edges
from ..geometry.shortfall import edges_of, projected_edges, thousandths
from .covered import CLEAR, lowest_of

Floats = npt.NDArray[np.float64]

SQUARE = 8.0
"""Turned by fewer degrees than this against the walls: its sides can stand against them."""
FLAT = 0.06
NEAR_WALL, NEAR_OTHER = 0.5, 0.35
"""Metres within which a wall, or a neighbour, says something of where a thing ends."""
ALIKE = 0.12
"""Stated sizes of one kind that differ by less than this part are meant to be the same."""
MINOR = 0.4
"""How much a small thing counts beside one that defines the layout."""


class Variance(NamedTuple):
    """Weights of the squared errors of centres, sizes, box edges and heights, and a constant, square metres."""

    centre: float = 0.0
    size: float = 0.0
    box: float = 0.0
    height: float = 0.0
    rest: float = 0.0


@dataclass(frozen=True)
class Difference:
    """Metres less box of one object along one axis: of the centre, or of the extent.

    Attributes:
        metres, box: how each common error of the metres (stretch x, y, shift x, y, sizes x, y) and of the boxes (shift x,
            y, stretch x, y, inset) changes it.
    """

    about: str
    value: float
    variance: Variance
    metres: tuple[float, ...]
    box: tuple[float, ...]
    weight: float = 1.0


@dataclass(frozen=True)
class Gap:
    """Room between a side of a thing and a wall or a neighbour, which cannot be less than nothing.

    Attributes:
        by_metres, by_boxes: metres; negative where one reaches into the other.
        metres, box: variances of the two.
        common_metres, common_boxes: how the common errors (as in `Difference`) change each of the two.
        wall: a gap to a wall, and so most likely none at all.
    """

    by_metres: float
    by_boxes: float
    metres: Variance
    box: Variance
    common_metres: tuple[float, ...]
    common_boxes: tuple[float, ...]
    wall: bool


@dataclass(frozen=True)
class Twins:
    """Difference of two extents, by their boxes, of things that are said to be of one size; metres."""

    value: float
    variance: Variance


@dataclass(frozen=True)
class Seen:
    """One object as both measurements have it.

    Attributes:
        edges: metres less box of x_min, y_min, x_max, y_max, metres to the right and down.
        heights: how these change when the height grows by the factor e; short: how far a tight box may lie inside.
        unit: metres for a thousandth of the picture's longer side.
        extent: of the footprint to the right and up.
    """

    item: DetectedObject
    edges: Floats
    heights: Floats
    short: Floats
    unit: float
    extent: tuple[float, float]
    factors: Edges

    @property
    def square(self) -> bool:
        """Whether its sides run along the picture's."""
        return self.item.shape != "round" and abs((self.item.yaw + 45.0) % 90.0 - 45.0) < SQUARE


def seen_twice(analysis: SceneAnalysis, calibration: Calibration, covered: Mapping[str, Edges]) -> list[Seen]:
    """The objects that stand or lie in the room and have a box that the camera can explain."""
    result = []
    for item in analysis.objects:
        if item.box is None or item.placement not in ("floor", "surface"):
            continue
        try:
            result.append(_seen(item, item.box, calibration, covered.get(item.id, CLEAR)))
        except GeometryError:
            continue
    return result


def _seen(item: DetectedObject, box: ImageBox, calibration: Calibration, factors: Edges) -> Seen:
    camera, base, (width, depth, height) = calibration.camera, lowest_of(item), item.size
    centre = (item.centre[0], item.centre[1], base + height / 2)
    unit = max(camera.image_size) / 1000.0 / image_scale(camera, centre)
    projected = projected_edges(camera, centre, item.size, item.yaw, item.shape)
    cos, sin = abs(math.cos(math.radians(item.yaw))), abs(math.sin(math.radians(item.yaw)))
    return Seen(
        item,
        (projected.at - edges_of(box) * thousandths(camera)) * unit,
        projected.heights * unit,
        projected.short * unit,
        unit,
        (width * cos + depth * sin, width * sin + depth * cos),
        factors,
    )


def differences(seen: Sequence[Seen], side: float) -> list[Difference]:
    """Centres and extents along both axes. `side`: the room's longer side, metres."""
    result = []
    for one in seen:
        weight = 1.0 if one.item.salience == "major" else MINOR
        for axis in (0, 1):
            down = -1.0 if axis else 1.0
            low, high = one.edges[axis], one.edges[axis + 2]
            low_h, high_h = one.heights[axis], one.heights[axis + 2]
            noise = (one.factors[axis] * one.unit) ** 2, (one.factors[axis + 2] * one.unit) ** 2
            short = float(one.short[axis] ** 2 + one.short[axis + 2] ** 2)
            at, extent = one.item.centre[axis], one.extent[axis]
            middle = Variance(1.0, 0.0, sum(noise) / 4, float((low_h + high_h) / 2) ** 2, short / 4)
            across = Variance(0.0, extent**2, sum(noise), float(high_h - low_h) ** 2, short)
            result.append(
                Difference(
                    one.item.id,
                    down * float(low + high) / 2,
                    middle,
                    (*_on(axis, at), *_on(axis, side), 0.0, 0.0),
                    (*_on(axis, -down * one.unit), *_on(axis, -at), 0.0),
                    weight,
                )
            )
            result.append(
                Difference(
                    one.item.id,
                    float(high - low),
                    across,
                    (0.0, 0.0, 0.0, 0.0, *_on(axis, extent)),
                    (0.0, 0.0, *_on(axis, -extent), 2.0 * one.unit),
                    weight,
                )
            )
    return result


def _on(axis: int, value: float) -> tuple[float, float]:
    return (value, 0.0) if axis == 0 else (0.0, value)


@dataclass(frozen=True)
class _Side:
    """One side of a thing: where by metres and by box, its variances, and how the common errors move it."""

    by_metres: float
    by_box: float
    metres: Variance
    box: Variance
    common_metres: tuple[float, ...]
    common_boxes: tuple[float, ...]


def _side(one: Seen, axis: int, outward: float, room: float) -> _Side:
    """The side of a thing towards +x or -x (axis 0), +y or -y (axis 1); `room`: the room's longer side."""
    # Up in the room is less in the picture.
    edge = (2 if outward > 0 else 0) if axis == 0 else (1 if outward > 0 else 3)
    down = -1.0 if axis else 1.0
    half, at = one.extent[axis] / 2, one.item.centre[axis]
    place = at + outward * half
    noise = (one.factors[edge] * one.unit) ** 2
    return _Side(
        place,
        place - down * float(one.edges[edge]),
        Variance(1.0, half**2),
        Variance(box=noise, height=float(one.heights[edge]) ** 2, rest=float(one.short[edge]) ** 2),
        (*_on(axis, at), *_on(axis, room), *_on(axis, outward * half)),
        (*_on(axis, down * one.unit), *_on(axis, place), -outward * one.unit),
    )


def wall_gaps(seen: Sequence[Seen], floor: Sequence[Sequence[float]], side: float) -> list[Gap]:
    """Gaps between the square things on the floor and the walls that they may stand against."""
    walls = _square_walls(floor)
    result = []
    for one in seen:
        if one.item.placement != "floor" or one.item.size[2] < FLAT or not one.square:
            continue
        for axis, outward, at, start, end in walls:
            across = one.item.centre[1 - axis]
            half = one.extent[1 - axis] / 2
            if min(end, across + half) - max(start, across - half) < half:
                continue
            mine = _side(one, axis, outward, side)
            by_metres, by_box = (outward * (at - v) for v in (mine.by_metres, mine.by_box))
            if min(abs(by_metres), abs(by_box)) > NEAR_WALL:
                continue
            by_common = [tuple(-outward * c for c in part) for part in (mine.common_metres, mine.common_boxes)]
            result.append(Gap(by_metres, by_box, mine.metres, mine.box, by_common[0], by_common[1], True))
    return result


def _square_walls(floor: Sequence[Sequence[float]]) -> list[tuple[int, float, float, float, float]]:
    """Walls along the picture's axes: which axis they stop, in which direction, where, from, to."""
    found = []
    for (ax, ay), (bx, by) in edges(as_points(floor)):
        outward: Point = (by - ay, ax - bx)
        length = math.hypot(*outward)
        if length < 0.2:
            continue
        axis = 0 if abs(outward[0]) > abs(outward[1]) else 1
        if abs(outward[axis]) < 0.995 * length:
            continue
        at, along = ((ax + bx) / 2, (ay, by)) if axis == 0 else ((ay + by) / 2, (ax, bx))
        found.append((axis, math.copysign(1.0, outward[axis]), at, min(along), max(along)))
    return found


def neighbour_gaps(seen: Sequence[Seen], side: float) -> list[Gap]:
    """Gaps between square things on the floor that stand beside each other."""
    standing = [
        s
        for s in seen
        if s.item.placement == "floor" and s.item.salience == "major" and s.item.size[2] >= FLAT and s.square
    ]
    result = []
    for a, b in combinations(standing, 2):
        apart = [abs(a.item.centre[i] - b.item.centre[i]) - (a.extent[i] + b.extent[i]) / 2 for i in (0, 1)]
        axis = 0 if apart[0] > apart[1] else 1
        shared = -apart[1 - axis]
        if shared < 0.3 * min(a.extent[1 - axis], b.extent[1 - axis]) or abs(apart[axis]) > NEAR_OTHER:
            continue
        low, high = (a, b) if a.item.centre[axis] < b.item.centre[axis] else (b, a)
        first, second = _side(low, axis, 1.0, side), _side(high, axis, -1.0, side)
        result.append(
            Gap(
                second.by_metres - first.by_metres,
                second.by_box - first.by_box,
                _sum(first.metres, second.metres),
                _sum(first.box, second.box),
                tuple(q - p for p, q in zip(first.common_metres, second.common_metres, strict=True)),
                tuple(q - p for p, q in zip(first.common_boxes, second.common_boxes, strict=True)),
                False,
            )
        )
    return result


def _sum(a: Variance, b: Variance) -> Variance:
    return Variance(*(x + y for x, y in zip(a, b, strict=True)))


def twins(seen: Sequence[Seen]) -> list[Twins]:
    """Extents of things of one kind that are said to be of one size and stand the same way."""
    result = []
    kinds: dict[tuple[str, int], list[Seen]] = {}
    for one in seen:
        if one.square:
            kinds.setdefault((one.item.category.lower(), round(one.item.yaw / 90.0) % 2), []).append(one)
    for group in kinds.values():
        for a, b in zip(group, group[1:], strict=False):
            stated = max(abs(math.log(p / q)) for p, q in zip(a.item.size, b.item.size, strict=True))
            if stated > ALIKE:
                continue
            for axis in (0, 1):
                by_box = [s.extent[axis] - float(s.edges[axis + 2] - s.edges[axis]) for s in (a, b)]
                noise = sum((s.factors[k] * s.unit) ** 2 for s in (a, b) for k in (axis, axis + 2))
                rest = (0.03 * (a.extent[axis] + b.extent[axis]) / 2) ** 2
                # Things of one kind are of one form, so they fall short of their cuboids by the same.
                heights = sum(float(s.heights[axis + 2] - s.heights[axis]) ** 2 for s in (a, b))
                result.append(Twins(by_box[0] - by_box[1], Variance(box=noise, height=heights, rest=rest)))
    return result
