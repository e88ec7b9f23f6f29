# SPDX-License-Identifier: GPL-3.0-or-later
"""Small deterministic solvers that put footprints where they can be: on a wall, inside the floor, off each other.

A footprint is a `Rect`, a plain tuple (x, y, width, depth, yaw): centre and size in metres, yaw in degrees
counter-clockwise. Nothing here knows what the footprints belong to.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Sequence
from itertools import combinations
from typing import NamedTuple

from .polygon import (
    Floats,
    Point,
    PolygonLike,
    edges,
    ensure_ccw,
    line_distance,
    nearest_on_segment,
    outside_fraction,
    point_in_polygon,
    rectangle_corners,
    segments_cross,
)

TOUCH = 1e-6  # metres: footprints closer than this touch, they do not overlap


EFFORT = 300_000
"""Most pairs of rectangles that a separation looks at, in each of its two steps; beyond it, overlaps may stay."""
MIN_ROUNDS = 4
MOST_TRIALS = 200
"""Places that the search for a free one usually tries."""


class Rect(NamedTuple):
    """An oriented rectangle on the floor."""

    x: float
    y: float
    width: float
    depth: float
    yaw: float = 0.0

    def corners(self) -> Floats:
        """Corners (4, 2), as `rectangle_corners`."""
        return rectangle_corners((self.x, self.y), (self.width, self.depth), self.yaw)

    def moved(self, dx: float, dy: float) -> Rect:
        """The same rectangle elsewhere."""
        return self._replace(x=self.x + dx, y=self.y + dy)


class Pushed(NamedTuple):
    """A rectangle brought inside a floor: where it is now, how far it went, and what part is still outside."""

    rect: Rect
    shift: Point
    outside: float


def _axes(rect: Rect) -> tuple[Point, Point]:
    angle = math.radians(rect.yaw)
    cos, sin = math.cos(angle), math.sin(angle)
    return (cos, sin), (-sin, cos)


def support(rect: Rect, direction: Sequence[float]) -> float:
    """How far the rectangle reaches from its centre in a unit direction, metres."""
    along_x, along_y = _axes(rect)
    return rect.width / 2 * abs(along_x[0] * direction[0] + along_x[1] * direction[1]) + rect.depth / 2 * abs(
        along_y[0] * direction[0] + along_y[1] * direction[1]
    )


def snap_to_wall(
    rect: Rect | tuple[float, float, float, float, float],
    wall: Sequence[Sequence[float]],
    max_distance: float,
    max_turn: float = 12.0,
    gap: float = 0.0,
) -> Rect | None:
    """The rectangle moved flush against a wall, or None when it does not belong there.

    It belongs there when its nearest side is within `max_distance` of the wall's inner face, on either side of it,
    and at least half of it lies beside the wall. It is turned parallel to the wall when that takes at most
    `max_turn` degrees, otherwise only its nearest corner touches.

    Args:
        wall: (start, end) of the inner face, the room to its left, metres.
        gap: metres to leave between the two.
    """
    rect = Rect(*rect)
    (ax, ay), (bx, by) = wall[0][:2], wall[1][:2]
    length = math.hypot(bx - ax, by - ay)
    if length < TOUCH:
        return None
    direction = ((bx - ax) / length, (by - ay) / length)
    inward = (-direction[1], direction[0])
    turn = (math.degrees(math.atan2(direction[1], direction[0])) - rect.yaw + 45) % 90 - 45
    distance = line_distance((rect.x, rect.y), (ax, ay), (bx, by)) - support(rect, inward)
    along = (rect.x - ax) * direction[0] + (rect.y - ay) * direction[1]
    reach = support(rect, direction)
    beside = min(length, along + reach) - max(0.0, along - reach)
    if abs(distance) > max_distance or beside < reach:
        return None
    if abs(turn) <= max_turn:
        rect = rect._replace(yaw=_tidy(rect.yaw + turn))
    shift = support(rect, inward) + gap - line_distance((rect.x, rect.y), (ax, ay), (bx, by))
    return rect.moved(shift * inward[0], shift * inward[1])


def _tidy(yaw: float) -> float:
    """Whole degrees where only rounding is in the way, so that right angles stay exact."""
    return float(round(yaw)) if abs(yaw - round(yaw)) < 1e-6 else yaw


def is_inside(rect: Rect, floor: PolygonLike) -> bool:
    """Whether the whole rectangle lies inside the floor; touching a wall is inside."""
    shrunk = rect._replace(width=max(0.0, rect.width - 2 * TOUCH), depth=max(0.0, rect.depth - 2 * TOUCH))
    return _contains(ensure_ccw(floor), shrunk.corners())


def _contains(outline: list[Point], corners: Floats) -> bool:
    quad = [(float(x), float(y)) for x, y in corners]
    if not all(point_in_polygon(corner, outline) for corner in quad):
        return False
    walls = edges(outline)
    return not any(segments_cross(*side, *wall) for side in edges(quad) for wall in walls) and not any(
        point_in_polygon(corner, quad) for corner in outline
    )


def push_inside(rect: Rect | tuple[float, float, float, float, float], floor: PolygonLike) -> Pushed:
    """The smallest move that brings a rectangle inside a floor polygon, convex or not.

    Where the centre may be is bounded by lines: each wall moved in by the rectangle's reach, and each side of the
    rectangle held against each inner (reflex) corner. The nearest allowed point is the foot of a perpendicular to one
    of these lines or a crossing of two, so trying those in order of distance is exact. When the rectangle fits
    nowhere, the candidate that leaves the least outside is taken.
    """
    rect, outline = Rect(*rect), ensure_ccw(floor)
    if is_inside(rect, outline):
        return Pushed(rect, (0.0, 0.0), 0.0)
    candidates = sorted(_candidates(rect, outline), key=lambda c: (round(math.hypot(*c), 9), c))
    for dx, dy in candidates:
        if is_inside(rect.moved(dx, dy), outline):
            return Pushed(rect.moved(dx, dy), (dx, dy), 0.0)
    reachable = [(0.0, 0.0), *candidates[:60]]
    remaining = [round(outside_fraction(rect.moved(dx, dy).corners(), outline), 6) for dx, dy in reachable]
    best = min(range(len(reachable)), key=lambda i: (remaining[i], math.hypot(*reachable[i])))
    return Pushed(rect.moved(*reachable[best]), reachable[best], remaining[best])


def _candidates(rect: Rect, outline: list[Point]) -> list[Point]:
    """Moves of the centre onto one or two of the lines that bound where it may be."""
    lines: list[tuple[Point, float]] = []  # normal n and offset c: the line n . p = c
    count = len(outline)
    for i, (a, b) in enumerate(edges(outline)):
        length = math.dist(a, b)
        if length < TOUCH:
            continue
        normal = (-(b[1] - a[1]) / length, (b[0] - a[0]) / length)
        lines.append((normal, normal[0] * a[0] + normal[1] * a[1] + support(rect, normal)))
        if line_distance(outline[(i + 2) % count], a, b) < -TOUCH:
            for axis, half in zip(_axes(rect), (rect.width / 2, rect.depth / 2), strict=True):
                at = axis[0] * b[0] + axis[1] * b[1]
                lines += [(axis, at + half), (axis, at - half)]
    gaps = [offset - normal[0] * rect.x - normal[1] * rect.y for normal, offset in lines]
    moves = [(normal[0] * gap, normal[1] * gap) for (normal, _), gap in zip(lines, gaps, strict=True)]
    for i, j in combinations(range(len(lines)), 2):
        (px, py), (qx, qy) = lines[i][0], lines[j][0]
        cross = px * qy - py * qx
        if abs(cross) > 1e-6:
            moves.append(((gaps[i] * qy - gaps[j] * py) / cross, (gaps[j] * px - gaps[i] * qx) / cross))
    return moves


def penetration(a: Rect, b: Rect) -> tuple[float, Point] | None:
    """How deep two rectangles overlap, and the unit direction that moves `a` out the shortest way; None when apart.

    Separating axes (Gottschalk et al. 1996) in the plane.
    """
    dx, dy = a.x - b.x, a.y - b.y
    if math.hypot(dx, dy) * 2 > math.hypot(a.width, a.depth) + math.hypot(b.width, b.depth):
        return None
    best: tuple[float, Point] | None = None
    for axis in (*_axes(a), *_axes(b)):
        apart = dx * axis[0] + dy * axis[1]
        depth = support(a, axis) + support(b, axis) - abs(apart)
        if depth <= TOUCH:
            return None
        if best is None or depth < best[0] - 1e-9:
            sign = -1.0 if apart < 0 else 1.0
            best = depth, (sign * axis[0], sign * axis[1])
    return best


def separate(
    rects: Sequence[Rect | tuple[float, float, float, float, float]],
    weights: Sequence[float] | None = None,
    fixed: Collection[int] = (),
    floor: PolygonLike | None = None,
    allowed_pairs: Collection[tuple[int, int]] = (),
    max_move: float = 1.0,
    iterations: int = 60,
) -> list[Point]:
    """Small moves that take overlapping rectangles off each other.

    Pairs are pushed apart the shortest way, each by its share (heavier ones less), and brought back inside the floor,
    again and again. What still overlaps then looks for the nearest free place. Of all rounds the best one counts: no
    move makes the overlaps, or what lies outside, worse than they were.

    Args:
        weights: how strongly each holds its place, above 0; 1 by default.
        fixed: indices that do not move.
        floor: outline that movable rectangles are kept inside; None for no bounds.
        allowed_pairs: pairs of indices that may overlap, in either order (a chair under a table).
        max_move: longest distance from where a rectangle was, metres.

    Returns:
        (dx, dy) for each rectangle; (0, 0) for those that stay.
    """
    start = [Rect(*r) for r in rects]
    state = _Crowd(start, weights, fixed, floor, allowed_pairs, max_move)
    best, best_score = list(start), state.score(start)
    current = list(start)
    rounds = min(iterations, max(MIN_ROUNDS, EFFORT // max(1, len(state.pairs))))
    for _ in range(rounds):
        if best_score <= TOUCH or not state.relax(current):
            break
        score = state.score(current)
        if score < best_score - 1e-9:
            best, best_score = list(current), score
    if best_score > TOUCH:
        best = state.relocate(best)
    return [(now.x - was.x, now.y - was.y) for now, was in zip(best, start, strict=True)]


class _Crowd:
    """The fixed circumstances of one separation."""

    def __init__(
        self,
        start: list[Rect],
        weights: Sequence[float] | None,
        fixed: Collection[int],
        floor: PolygonLike | None,
        allowed: Collection[tuple[int, int]],
        max_move: float,
    ) -> None:
        self.start = start
        self.give = [0.0 if i in fixed else 1.0 / max(1e-6, weights[i] if weights else 1.0) for i in range(len(start))]
        self.floor = None if floor is None else ensure_ccw(floor)
        free = {frozenset(pair) for pair in allowed}
        self.pairs = [pair for pair in combinations(range(len(start)), 2) if frozenset(pair) not in free]
        self.max_move = max_move

    def score(self, rects: list[Rect]) -> float:
        """Depth of all overlaps in metres that a move could mend, and what is outside, by its extent."""
        total = 0.0
        for i, j in self.pairs:
            if self.give[i] or self.give[j]:
                found = penetration(rects[i], rects[j])
                total += found[0] if found else 0.0
        if self.floor is not None:
            for i, rect in enumerate(rects):
                if self.give[i] and not is_inside(rect, self.floor):
                    total += outside_fraction(rect.corners(), self.floor) * max(rect.width, rect.depth)
        return total

    def relax(self, rects: list[Rect]) -> bool:
        """One round of pushes, in place; False when nothing moved."""
        before = list(rects)
        for i, j in self.pairs:
            give = self.give[i] + self.give[j]
            found = penetration(rects[i], rects[j]) if give else None
            if found is None:
                continue
            depth, (nx, ny) = found[0] + 2 * TOUCH, found[1]
            share = depth * self.give[i] / give
            rects[i] = self.bounded(i, rects[i].moved(nx * share, ny * share))
            rest = depth - share
            rects[j] = self.bounded(j, rects[j].moved(-nx * rest, -ny * rest))
        if self.floor is not None:
            for i, rect in enumerate(rects):
                if self.give[i]:
                    rects[i] = self.bounded(i, push_inside(rect, self.floor).rect)
        return any(math.dist(a[:2], b[:2]) > TOUCH / 10 for a, b in zip(before, rects, strict=True))

    def bounded(self, index: int, rect: Rect) -> Rect:
        """The rectangle no further than `max_move` from where it was at first."""
        home = self.start[index]
        distance = math.dist(rect[:2], home[:2])
        if distance <= self.max_move:
            return rect
        factor = self.max_move / distance
        return rect._replace(x=home.x + (rect.x - home.x) * factor, y=home.y + (rect.y - home.y) * factor)

    def relocate(self, rects: list[Rect]) -> list[Rect]:
        """Give each that still overlaps, lightest first, the nearest free place, if there is one."""
        result = list(rects)
        around: list[list[int]] = [[] for _ in rects]
        for a, b in self.pairs:
            around[a].append(b)
            around[b].append(a)
        effort = EFFORT
        for i in sorted(range(len(rects)), key=lambda i: (-self.give[i], i)):
            if self.give[i] == 0 or effort <= 0:
                continue
            others = [result[j] for j in around[i]]
            if any(penetration(result[i], other) for other in others):
                effort -= MOST_TRIALS * len(others)
                free = nearest_free(self.start[i], others, self.floor, self.max_move)
                result[i] = free or result[i]
        return result if self.score(result) <= self.score(rects) else rects


def nearest_free(
    rect: Rect, obstacles: Sequence[Rect], floor: PolygonLike | None, max_move: float, step: float = 0.05
) -> Rect | None:
    """The nearest place, on rings `step` metres apart, where a rectangle is inside and overlaps nothing, or None."""
    for ring in range(int(max_move / step + 1e-9) + 1):
        directions = 1 if ring == 0 else min(48, 8 * ring)
        for k in range(directions):
            angle = 2 * math.pi * k / directions
            trial = rect.moved(ring * step * math.cos(angle), ring * step * math.sin(angle))
            if not any(penetration(trial, other) for other in obstacles) and (floor is None or is_inside(trial, floor)):
                return trial
    return None


def gap_between(a: Rect, b: Rect) -> float:
    """Distance between two rectangles, metres; minus the depth of their overlap when they overlap."""
    found = penetration(a, b)
    if found is not None:
        return -found[0]
    first, second = a.corners(), b.corners()
    return min(
        math.dist(p, nearest_on_segment(p, *side)[0])
        for here, there in ((first, second), (second, first))
        for p in [(float(x), float(y)) for x, y in here]
        for side in edges(there)
    )
