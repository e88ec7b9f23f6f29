# SPDX-License-Identifier: GPL-3.0-or-later
"""Polygons of the floor plane: shape, overlap and distance to walls.

A polygon is any sequence of (x, y) pairs or an (N, 2) array, without the first corner repeated at the end; metres,
but nothing here depends on the unit. Polygons have a handful of corners and these functions run thousands of times in
the layout loop, so the inner loops are plain Python on tuples: at that size it is faster than numpy.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

Floats: TypeAlias = NDArray[np.float64]
Point: TypeAlias = tuple[float, float]
PolygonLike: TypeAlias = Sequence[Sequence[float]] | Floats


class WallHit(NamedTuple):
    """The wall (edge) of a polygon that is nearest to something.

    Attributes:
        edge: edge number; edge i runs from corner i to corner i + 1.
        distance: metres to the segment, 0 when touching.
        along: metres from the edge's start to the nearest point of the edge.
        point: the nearest point on the edge.
    """

    edge: int
    distance: float
    along: float
    point: Point


def as_points(polygon: PolygonLike) -> list[Point]:
    """The polygon as a list of (x, y) tuples of plain floats; further coordinates are left out."""
    return [(float(p[0]), float(p[1])) for p in polygon]


def signed_area(polygon: PolygonLike) -> float:
    """Area, positive when the corners run counter-clockwise (x right, y up)."""
    return _signed_area(as_points(polygon))


def _signed_area(points: list[Point]) -> float:
    if len(points) < 3:
        return 0.0
    x0, y0 = points[0]  # relative to a corner: no loss of digits far from the origin
    total = 0.0
    for (ax, ay), (bx, by) in zip(points[1:], points[2:], strict=False):
        total += (ax - x0) * (by - y0) - (bx - x0) * (ay - y0)
    return total / 2


def area(polygon: PolygonLike) -> float:
    """Area of a simple polygon, never negative."""
    return abs(signed_area(polygon))


def orientation(polygon: PolygonLike) -> int:
    """1 when the corners run counter-clockwise, -1 when clockwise, 0 when there is no area."""
    value = signed_area(polygon)
    return 0 if value == 0 else int(math.copysign(1, value))


def ensure_ccw(polygon: PolygonLike) -> list[Point]:
    """The same outline running counter-clockwise, from the same first corner."""
    points = as_points(polygon)
    return points if _signed_area(points) >= 0 else [points[0], *reversed(points[1:])]


def centroid(polygon: PolygonLike) -> Point:
    """Centre of area; the mean of the corners when there is no area."""
    points = as_points(polygon)
    total = _signed_area(points)
    if abs(total) < 1e-12:
        return sum(p[0] for p in points) / len(points), sum(p[1] for p in points) / len(points)
    x0, y0 = points[0]
    x = y = 0.0
    for (ax, ay), (bx, by) in zip(points[1:], points[2:], strict=False):
        weight = (ax - x0) * (by - y0) - (bx - x0) * (ay - y0)
        x += weight * (ax + bx - 2 * x0)
        y += weight * (ay + by - 2 * y0)
    return x0 + x / (6 * total), y0 + y / (6 * total)


def edges(polygon: PolygonLike) -> list[tuple[Point, Point]]:
    """The closed outline as (start, end) segments; edge i starts at corner i."""
    points = as_points(polygon)
    return [(points[i], points[(i + 1) % len(points)]) for i in range(len(points))]


def bounding_rectangle(polygon: PolygonLike) -> tuple[float, float, float, float]:
    """Axis-aligned (x_min, y_min, x_max, y_max)."""
    points = as_points(polygon)
    xs, ys = [p[0] for p in points], [p[1] for p in points]
    return min(xs), min(ys), max(xs), max(ys)


def rectangle_corners(centre: Sequence[float], size: Sequence[float], yaw: float) -> Floats:
    """Corners (4, 2), counter-clockwise, of a rectangle turned by `yaw` degrees counter-clockwise.

    Before turning, the corners are (-x, -y), (x, -y), (x, y), (-x, y): at yaw 0 the first edge is the front (-Y).
    Further coordinates of `centre` and `size` (z, height) are ignored.
    """
    half_x, half_y = float(size[0]) / 2, float(size[1]) / 2
    cos, sin = _turn(yaw)
    local = ((-half_x, -half_y), (half_x, -half_y), (half_x, half_y), (-half_x, half_y))
    return np.array([(centre[0] + x * cos - y * sin, centre[1] + x * sin + y * cos) for x, y in local], dtype=float)


def _turn(yaw: float) -> tuple[float, float]:
    """Cosine and sine of degrees, exact at multiples of 90."""
    quarter = yaw / 90.0
    if quarter == round(quarter):
        return ((1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0))[int(quarter) % 4]
    return math.cos(math.radians(yaw)), math.sin(math.radians(yaw))


def point_in_polygon(point: Sequence[float], polygon: PolygonLike) -> bool:
    """Whether the point lies inside (even-odd rule); points exactly on the outline may go either way."""
    x, y = float(point[0]), float(point[1])
    inside = False
    for (ax, ay), (bx, by) in edges(polygon):
        if (ay > y) != (by > y) and x < ax + (y - ay) * (bx - ax) / (by - ay):
            inside = not inside
    return inside


def is_convex(polygon: PolygonLike) -> bool:
    """Whether every corner turns the same way and the outline goes round once; corners on a straight edge are fine."""
    points = as_points(polygon)
    sign = 0.0
    turned = 0.0
    for i in range(len(points)):
        (ax, ay), (bx, by), (cx, cy) = points[i - 2], points[i - 1], points[i]
        ux, uy, vx, vy = bx - ax, by - ay, cx - bx, cy - by
        cross = ux * vy - uy * vx
        turned += math.atan2(cross, ux * vx + uy * vy)
        if abs(cross) <= 1e-12 * (math.hypot(ux, uy) * math.hypot(vx, vy) + 1e-300):
            continue
        if sign * cross < 0:
            return False
        sign = cross
    return sign != 0 and abs(turned) < 3 * math.pi


def clip_convex(subject: PolygonLike, window: PolygonLike) -> list[Point]:
    """Part of `subject` (any simple polygon) inside the convex `window` (Sutherland and Hodgman 1974).

    A concave subject may come back as one outline joined by edges that run back over themselves; its area is right.
    """
    return _clip(as_points(subject), ensure_ccw(window))


def _clip(subject: list[Point], window: list[Point]) -> list[Point]:
    result = subject
    for i in range(len(window)):
        if not result:
            break
        (ax, ay), (bx, by) = window[i - 1], window[i]
        ex, ey = bx - ax, by - ay
        clipped: list[Point] = []
        px, py = result[-1]
        before = ex * (py - ay) - ey * (px - ax)
        for qx, qy in result:
            after = ex * (qy - ay) - ey * (qx - ax)
            if (before < 0) != (after < 0):
                t = before / (before - after)
                clipped.append((px + t * (qx - px), py + t * (qy - py)))
            if after >= 0:
                clipped.append((qx, qy))
            px, py, before = qx, qy, after
        result = clipped
    return result


def intersection_area(a: PolygonLike, b: PolygonLike) -> float:
    """Shared area of two simple polygons, convex or not.

    When neither is convex, `b` is taken as the signed sum of the triangles of a fan from its first corner, which is
    exact for any simple polygon.
    """
    first, second = ensure_ccw(a), ensure_ccw(b)
    if len(first) < 3 or len(second) < 3 or not _bounds_meet(first, second):
        return 0.0
    if is_convex(second):
        return abs(_signed_area(_clip(first, second)))
    if is_convex(first):
        return abs(_signed_area(_clip(second, first)))
    total = 0.0
    for p, q in zip(second[1:], second[2:], strict=False):
        triangle = [second[0], p, q]
        turn = _signed_area(triangle)
        if turn != 0:
            window = triangle if turn > 0 else [second[0], q, p]
            total += math.copysign(_signed_area(_clip(first, window)), turn)
    return max(0.0, total)


def _bounds_meet(a: list[Point], b: list[Point]) -> bool:
    a_low_x, a_low_y, a_high_x, a_high_y = bounding_rectangle(a)
    b_low_x, b_low_y, b_high_x, b_high_y = bounding_rectangle(b)
    return a_low_x < b_high_x and b_low_x < a_high_x and a_low_y < b_high_y and b_low_y < a_high_y


def footprint_iou(a: PolygonLike, b: PolygonLike) -> float:
    """Intersection over union of two footprints, 0..1; 0 when both are empty."""
    shared = intersection_area(a, b)
    union = area(a) + area(b) - shared
    return min(1.0, shared / union) if union > 0 else 0.0


def overlap_fraction(a: PolygonLike, b: PolygonLike) -> float:
    """Shared area as a part of the smaller footprint, 0..1."""
    smaller = min(area(a), area(b))
    return min(1.0, intersection_area(a, b) / smaller) if smaller > 0 else 0.0


def outside_fraction(footprint: PolygonLike, floor: PolygonLike) -> float:
    """Part of the footprint's area that lies outside the floor, 0..1."""
    whole = area(footprint)
    return min(1.0, max(0.0, 1.0 - intersection_area(footprint, floor) / whole)) if whole > 0 else 0.0


def nearest_on_segment(point: Sequence[float], start: Sequence[float], end: Sequence[float]) -> tuple[Point, float]:
    """Nearest point of a segment, and how far along the segment it is, 0..1."""
    ex, ey = end[0] - start[0], end[1] - start[1]
    length2 = ex * ex + ey * ey
    t = 0.0 if length2 == 0 else ((point[0] - start[0]) * ex + (point[1] - start[1]) * ey) / length2
    t = min(1.0, max(0.0, t))
    return (start[0] + t * ex, start[1] + t * ey), t


def nearest_wall(point: Sequence[float], floor: PolygonLike) -> WallHit:
    """The floor's edge nearest to a point, inside or outside."""
    best: WallHit | None = None
    for index, (start, end) in enumerate(edges(floor)):
        near, t = nearest_on_segment(point, start, end)
        distance = math.dist((point[0], point[1]), near)
        if best is None or distance < best.distance:
            best = WallHit(index, distance, t * math.dist(start, end), near)
    if best is None:
        raise ValueError("nearest_wall needs a floor with corners")
    return best


def nearest_wall_of_rectangle(corners: PolygonLike, floor: PolygonLike) -> WallHit:
    """The floor's edge nearest to a rectangle (or any polygon); the distance is 0 when they touch or cross."""
    hits = []
    for index, (start, end) in enumerate(edges(floor)):
        distance, near = segment_distance(corners, start, end)
        hits.append(WallHit(index, distance, math.dist(start, near), near))
    middle = centroid(corners)
    walls = edges(floor)

    def rank(hit: WallHit) -> tuple[float, float, int]:
        # A rectangle in a corner touches two walls: the one whose line its centre is nearer to, then the lower number.
        return round(hit.distance, 9), round(abs(line_distance(middle, *walls[hit.edge])), 9), hit.edge

    return min(hits, key=rank)


def segment_distance(polygon: PolygonLike, start: Sequence[float], end: Sequence[float]) -> tuple[float, Point]:
    """Distance from a polygon to a segment, and the nearest point on the segment; 0 when they meet."""
    if point_in_polygon(start, polygon):
        return 0.0, nearest_on_segment(centroid(polygon), start, end)[0]
    best, where = math.inf, (float(start[0]), float(start[1]))
    for a, b in edges(polygon):
        if segments_cross(a, b, start, end):
            return 0.0, nearest_on_segment(centroid(polygon), start, end)[0]
        for p in (a, b):
            near, _ = nearest_on_segment(p, start, end)
            if math.dist(p, near) < best:
                best, where = math.dist(p, near), near
        for q in (start, end):
            near, _ = nearest_on_segment(q, a, b)
            if math.dist((q[0], q[1]), near) < best:
                best, where = math.dist((q[0], q[1]), near), (float(q[0]), float(q[1]))
    return best, where


def line_distance(point: Sequence[float], start: Sequence[float], end: Sequence[float]) -> float:
    """Signed distance from the endless line start-end, positive to its left (inside, for a ccw floor)."""
    ex, ey = end[0] - start[0], end[1] - start[1]
    length = math.hypot(ex, ey)
    if length == 0:
        return math.dist((point[0], point[1]), (start[0], start[1]))
    return (ex * (point[1] - start[1]) - ey * (point[0] - start[0])) / length


def side_distance(corners: PolygonLike, side: int, start: Sequence[float], end: Sequence[float]) -> float:
    """Signed distance from the middle of a rectangle's side to a wall's line, positive inside the room.

    Sides as `rectangle_corners` numbers them: 0 front (-Y at yaw 0), 1 right (+X), 2 back (+Y), 3 left (-X).
    """
    a, b = edges(corners)[side]
    return line_distance(((a[0] + b[0]) / 2, (a[1] + b[1]) / 2), start, end)


def segments_cross(a: Sequence[float], b: Sequence[float], c: Sequence[float], d: Sequence[float]) -> bool:
    """Whether two segments cross at a point inside both (touching at an end does not count)."""

    def side(p: Sequence[float], q: Sequence[float], r: Sequence[float]) -> float:
        return (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0])

    return side(a, b, c) * side(a, b, d) < 0 and side(c, d, a) * side(c, d, b) < 0


def self_crossing(polygon: PolygonLike) -> tuple[int, int] | None:
    """The first pair of edges (i < j) that cross, or None for a simple outline."""
    sides = edges(polygon)
    for i, (a, b) in enumerate(sides):
        for j in range(i + 2, len(sides)):
            if (i, j) != (0, len(sides) - 1) and segments_cross(a, b, *sides[j]):
                return i, j
    return None


def simplify_polygon(polygon: PolygonLike, tolerance: float) -> list[Point]:
    """The outline without repeated corners and corners that stand out less than `tolerance` from the line past them.

    Corners go one at a time, the least important first, so a long flat arc is not lost at once; 3 are always kept.
    """
    points = as_points(polygon)
    while len(points) > 3:
        offsets = [
            math.dist(p, nearest_on_segment(p, points[i - 1], points[(i + 1) % len(points)])[0])
            for i, p in enumerate(points)
        ]
        least = min(range(len(points)), key=offsets.__getitem__)
        if offsets[least] > tolerance:
            break
        del points[least]
    return points
