# SPDX-License-Identifier: GPL-3.0-or-later
"""How two things, or a thing and a wall, stand to each other: gaps, sides, fronts and what covers what.

Limits are those of the project's metrics; `slack` widens them where it is asked whether something still holds.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from ..artifacts.common import Metres2, Metres3, Placement
from ..artifacts.layout import WallLine
from ..geometry.placement import Rect, gap_between
from ..geometry.polygon import overlap_fraction, rectangle_corners
from .walls import along

WALL_GAP = 0.18
"""At most this far from a wall's face counts as standing against it, metres."""
NEAR_GAP = 0.4
FRONT_GAP = 1.2
"""At most this far in front of something, metres, is said to be in front of it and looked at by it."""
FACING_ANGLE = 30.0
FLAT = 0.06
"""Things lower than this (rugs, mats) may lie under others, metres."""
COVERED = 0.3
"""Part of the smaller footprint that must be shared for one thing to be under another."""
SLACK = 1.25
"""How much wider every limit is when it is asked whether a relation still holds than when it is found."""


@dataclass(frozen=True)
class Placed:
    """An object's oriented box, as relations need it; metres and degrees, frame of the room.

    `fronted` says that its yaw tells where its front is; where it does not, geometry decides nothing about facing.
    """

    id: str
    centre: Metres3
    size: Metres3
    yaw: float
    placement: Placement
    parent: str | None
    fronted: bool = False

    @property
    def corners(self) -> list[Metres2]:
        """The footprint's corners."""
        return [(float(x), float(y)) for x, y in rectangle_corners(self.centre[:2], self.size[:2], self.yaw)]

    @property
    def rect(self) -> Rect:
        """The footprint."""
        return Rect(self.centre[0], self.centre[1], self.size[0], self.size[1], self.yaw)

    @property
    def span(self) -> tuple[float, float]:
        """Heights of its underside and its top."""
        return self.centre[2] - self.size[2] / 2, self.centre[2] + self.size[2] / 2

    def seen(self, other: Placed) -> Metres2:
        """Another's centre in this one's own frame: x to its width, y to its back."""
        angle = math.radians(-self.yaw)
        dx, dy = other.centre[0] - self.centre[0], other.centre[1] - self.centre[1]
        return dx * math.cos(angle) - dy * math.sin(angle), dx * math.sin(angle) + dy * math.cos(angle)


def wall_gap(item: Placed, wall: WallLine) -> float:
    """Free space between a footprint and a wall's face, metres; infinite beside the wall's ends."""
    length = math.dist(wall.start, wall.end)
    spots = [along(wall, corner) for corner in item.corners]
    low, high = min(t for t, _ in spots), max(t for t, _ in spots)
    if min(high, length) - max(low, 0.0) < 0.3 * max(1e-6, high - low):
        return math.inf
    half = wall.thickness / 2 if wall.partition else 0.0
    distances = [off for _, off in spots]
    if wall.partition and max(distances) < 0:
        return -max(distances) - half
    return min(distances) - half if wall.partition else min(distances)


def against_walls(item: Placed, walls: Sequence[WallLine], gap: float = WALL_GAP) -> list[str]:
    """Ids of the walls that a footprint stands at, nearest first."""
    found = [(abs(g), w.id) for w in walls if (g := wall_gap(item, w)) < gap and g > -gap]
    return [name for _, name in sorted(found)]


def footprint_gap(a: Placed, b: Placed) -> float:
    """Distance between two footprints, 0 when they touch or overlap; metres."""
    return max(0.0, gap_between(a.rect, b.rect))


def corner_walls(item: Placed, walls: Sequence[WallLine], gap: float = WALL_GAP) -> list[str]:
    """The two walls that meet where a footprint stands against both, or nothing."""
    by_id = {w.id: w for w in walls}
    touching = against_walls(item, walls, gap)
    for n, first in enumerate(touching):
        for second in touching[n + 1 :]:
            if _across(by_id[first], by_id[second]):
                return [first, second]
    return []


def _across(a: WallLine, b: WallLine) -> bool:
    """Whether two walls run in clearly different directions."""
    ax, ay, bx, by = a.end[0] - a.start[0], a.end[1] - a.start[1], b.end[0] - b.start[0], b.end[1] - b.start[1]
    return abs(ax * by - ay * bx) > 0.5 * math.hypot(ax, ay) * math.hypot(bx, by)


def directed(name: str, item: Placed, other: Placed, slack: float = 1.0) -> bool:
    """Whether one is left of, or below, the other in the picture by more than a measuring error."""
    axis = 0 if name == "left_of" else 1
    extents = [max(c[axis] for c in p.corners) - min(c[axis] for c in p.corners) for p in (item, other)]
    return other.centre[axis] - item.centre[axis] >= max(0.2, 0.5 * min(extents)) / slack


def is_in_front_of(item: Placed, other: Placed, slack: float = 1.0) -> bool:
    """Whether a thing lies before the other's front, within its width and near."""
    return _before(item, other, -1.0, slack)


def is_behind(item: Placed, other: Placed, slack: float = 1.0) -> bool:
    """Whether a thing lies behind the other's back, within its width and near."""
    return _before(item, other, 1.0, slack)


def _before(item: Placed, other: Placed, side: float, slack: float) -> bool:
    if not other.fronted or other.size[2] < FLAT or item.size[2] < FLAT:
        return False
    x, y = other.seen(item)
    within = abs(x) <= other.size[0] / 2 * slack and side * y >= other.size[1] / 2 / slack
    return within and footprint_gap(item, other) <= FRONT_GAP * slack


def is_beside(item: Placed, other: Placed, slack: float = 1.0) -> bool:
    """Whether two near things stand side by side, seen from the larger one that has a front."""
    fronted = [p for p in (item, other) if p.fronted and p.size[2] >= FLAT]
    if not fronted or min(item.size[2], other.size[2]) < FLAT:
        return False
    anchor = max(fronted, key=lambda p: p.size[0] * p.size[1])
    x, y = anchor.seen(other if anchor is item else item)
    near = footprint_gap(item, other) <= NEAR_GAP * slack
    return near and abs(x) >= anchor.size[0] / 2 / slack and abs(y) <= anchor.size[1] / 2 * slack


def facing_error(item: Placed, other: Placed) -> float:
    """Angle in degrees between a thing's front and the way to another's middle, or to the part of it straight ahead."""
    x, y = item.seen(other)
    ahead = [item.seen(Placed("", (cx, cy, 0.0), (0.0, 0.0, 0.0), 0.0, "floor", None)) for cx, cy in other.corners]
    if max(p[1] for p in ahead) <= 0 and min(p[0] for p in ahead) <= 0 <= max(p[0] for p in ahead):
        return 0.0
    return abs(math.degrees(math.atan2(x, -y)))


def is_under(low: Placed, high: Placed, slack: float = 1.0) -> bool:
    """Whether a thing ends below another one that covers a good part of it; what carries the other does not count."""
    if low.id == high.id or high.parent == low.id or low.parent == high.id or low.placement != "floor":
        return False
    flat = low.size[2] < FLAT <= high.size[2] and high.placement == "floor"
    if not flat and (low.span[1] > high.span[0] + 0.02 or high.placement != "ceiling"):
        return False
    reach = (math.hypot(*low.size[:2]) + math.hypot(*high.size[:2])) / 2
    if math.dist(low.centre[:2], high.centre[:2]) > reach:
        return False
    return overlap_fraction(low.corners, high.corners) >= COVERED / slack
