# SPDX-License-Identifier: GPL-3.0-or-later
"""What stays free in front of doors and windows: where a leaf swings, where one walks through, where light comes in."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from ..artifacts.common import Metres2
from ..artifacts.layout import DoorLine, Layout, ProxyLine, WallLine
from ..geometry.placement import Rect
from ..geometry.polygon import area, intersection_area
from .doors import opens_in
from .standing import FLAT

PASSAGE = 0.35
"""Depth in metres that stays free before an opening without a leaf, or one whose leaf does not come into the room."""
LIGHT = 0.25
"""Depth in metres before a window in which nothing stands higher than its sill."""
SILL_GRACE = 0.1
LEAF = 0.1
"""Metres of depth that an open leaf keeps free."""
RIGHT_ANGLE = 95.0
"""Degrees up to which an open leaf stands within the square before its door, or nearly so."""


@dataclass(frozen=True)
class Clear:
    """A piece of floor that is kept free of whatever is higher than `above` metres."""

    id: str
    rect: Rect
    above: float


def door_areas(layout: Layout, swings: Mapping[str, str]) -> list[Clear]:
    """Where doors swing and passages lead; `swings` says by id, in the analysis' words, how doors open ("in").

    A leaf that stands open is believed more than words, and keeps its own place free too where that is beside the door.
    """
    walls = {w.id: w for w in layout.walls}
    areas: list[Clear] = []
    for door in layout.doors:
        wall, width = walls.get(door.wall), math.dist(door.start, door.end)
        inward = opens_in(swings.get(door.id, "")) if not door.open else door.open > 0.0
        sides = {1.0: width if inward else PASSAGE, -1.0: PASSAGE}
        if wall is not None and wall.partition and door.open:
            sides[-1.0] = PASSAGE if inward else width
        elif wall is not None and wall.partition:
            sides[-1.0] = sides[1.0]
        areas += _before(door.id, wall, door.start, door.end, sides, FLAT)
        areas += _beside(door, wall)
    for opening in layout.openings:
        if opening.sill < FLAT:
            both = {1.0: PASSAGE, -1.0: PASSAGE}
            areas += _before(opening.id, walls.get(opening.wall), opening.start, opening.end, both, FLAT)
    return areas


def _beside(door: DoorLine, wall: WallLine | None) -> list[Clear]:
    """The place of a leaf that stands open by more than a right angle, and so beside its door."""
    if wall is None or abs(door.open) <= RIGHT_ANGLE or (door.open < 0 and not wall.partition):
        return []
    way = (door.end[0] - door.start[0], door.end[1] - door.start[1])
    width = math.hypot(*way)
    ux, uy = (wall.end[0] - wall.start[0]), (wall.end[1] - wall.start[1])
    runs = 1.0 if way[0] * ux + way[1] * uy >= 0 else -1.0
    yaw = math.degrees(math.atan2(way[1], way[0])) + runs * door.open
    x, y = width / 2 * math.cos(math.radians(yaw)), width / 2 * math.sin(math.radians(yaw))
    return [Clear(door.id, Rect(door.start[0] + x, door.start[1] + y, width, LEAF, yaw % 360.0), FLAT)]


def window_areas(layout: Layout) -> list[Clear]:
    """Where nothing stands in the light."""
    walls = {w.id: w for w in layout.walls}
    areas: list[Clear] = []
    for window in layout.windows:
        above = window.sill + SILL_GRACE
        both = {1.0: LIGHT, -1.0: LIGHT}
        areas += _before(window.id, walls.get(window.wall), window.start, window.end, both, above)
    return areas


def _before(
    name: str, wall: WallLine | None, start: Metres2, end: Metres2, depths: Mapping[float, float], above: float
) -> list[Clear]:
    """The rectangle before a segment of a wall; one on either side of a partition.

    Args:
        depths: metres, by side: 1 is the wall's left (the room), -1 a partition's right.
    """
    width = math.dist(start, end)
    if wall is None or width < 1e-6:
        return []
    ux, uy = (end[0] - start[0]) / width, (end[1] - start[1]) / width
    if (wall.end[0] - wall.start[0]) * ux + (wall.end[1] - wall.start[1]) * uy < 0:
        ux, uy = -ux, -uy
    yaw = math.degrees(math.atan2(uy, ux))
    middle = ((start[0] + end[0]) / 2, (start[1] + end[1]) / 2)
    face = wall.thickness / 2 if wall.partition else 0.0
    result = []
    for side in (1.0, -1.0) if wall.partition else (1.0,):
        depth = depths[side]
        off = side * (face + depth / 2)
        result.append(Clear(name, Rect(middle[0] - uy * off, middle[1] + ux * off, width, depth, yaw), above))
    return result


def stands_in(proxy: ProxyLine, clear: Clear) -> float:
    """Part of what should be clear that a thing on the floor takes, 0..1."""
    if proxy.placement != "floor" or proxy.centre[2] + proxy.size[2] / 2 <= clear.above:
        return 0.0
    rect = Rect(proxy.centre[0], proxy.centre[1], proxy.size[0], proxy.size[1], proxy.yaw)
    whole = area(clear.rect.corners())
    return intersection_area(rect.corners(), clear.rect.corners()) / whole if whole > 0 else 0.0


def blocked(proxies: Iterable[ProxyLine], areas: Iterable[Clear]) -> list[tuple[str, str, float]]:
    """(id of a thing, id of the door or window, part that it takes) for all that stand in the way, in order."""
    things = list(proxies)
    return [(p.id, a.id, share) for a in areas for p in things if (share := stands_in(p, a)) > 0.0]
