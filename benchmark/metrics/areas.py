# SPDX-License-Identifier: GPL-3.0-or-later
"""Exact areas of unions of polygons, and the nearest distance of two outlines.

Grids of 2 cm, which the definitions that this library started from use, blur small steps: a score could rise by a pixel
while the room got worse. Here the plane is cut into vertical slabs at every corner and every crossing of two edges;
inside a slab all edges are straight and do not cross, so the covered length changes linearly and its value half-way
times the slab's width is exact.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TypeAlias

from code_as_room.pipeline.geometry.polygon import bounding_rectangle, edges, intersection_area, nearest_on_segment

Polygon: TypeAlias = list[tuple[float, float]]
_Segment: TypeAlias = tuple[float, float, float, float]
_Span: TypeAlias = tuple[float, float]


def union_area(polygons: Sequence[Polygon]) -> float:
    """Area covered by at least one of the simple polygons."""
    return _sweep(polygons, ())[0]


def union_iou(first: Sequence[Polygon], second: Sequence[Polygon]) -> float:
    """Intersection over union of what two sets of polygons cover, 0..1; 1 when both cover nothing."""
    a, b, shared = _sweep(first, second)
    whole = a + b - shared
    return min(1.0, shared / whole) if whole > 1e-12 else 1.0


def _sweep(first: Sequence[Polygon], second: Sequence[Polygon]) -> tuple[float, float, float]:
    """Area of the first union, of the second, and of what they share."""
    sides = [[_segments(polygon) for polygon in group] for group in (first, second)]
    cuts = _cuts([segment for group in sides for polygon in group for segment in polygon])
    areas = [0.0, 0.0, 0.0]
    for left, right in zip(cuts, cuts[1:], strict=False):
        width, x = right - left, (left + right) / 2
        if width < 1e-12:
            continue
        spans = [_joined([span for polygon in group for span in _spans(polygon, x)]) for group in sides]
        areas[0] += width * sum(b - a for a, b in spans[0])
        areas[1] += width * sum(b - a for a, b in spans[1])
        areas[2] += width * _common(spans[0], spans[1])
    return areas[0], areas[1], areas[2]


def _segments(polygon: Polygon) -> list[_Segment]:
    """Edges that are not vertical, from left to right."""
    found = []
    for (ax, ay), (bx, by) in edges(polygon):
        if ax < bx:
            found.append((ax, ay, bx, by))
        elif bx < ax:
            found.append((bx, by, ax, ay))
    return found


def _cuts(segments: list[_Segment]) -> list[float]:
    ordered = sorted(segments)
    cuts = {x for segment in ordered for x in (segment[0], segment[2])}
    for i, (ax, ay, bx, by) in enumerate(ordered):
        for cx, cy, dx, dy in ordered[i + 1 :]:
            if cx >= bx:
                break
            if max(ay, by) < min(cy, dy) or max(cy, dy) < min(ay, by):
                continue
            slope, other = (by - ay) / (bx - ax), (dy - cy) / (dx - cx)
            if slope != other:
                x = (cy - other * cx - ay + slope * ax) / (slope - other)
                if max(ax, cx) < x < min(bx, dx):
                    cuts.add(x)
    return sorted(cuts)


def _spans(polygon: list[_Segment], x: float) -> list[_Span]:
    heights = sorted(ay + (x - ax) * (by - ay) / (bx - ax) for ax, ay, bx, by in polygon if ax < x < bx)
    return list(zip(heights[::2], heights[1::2], strict=False))


def _joined(spans: list[_Span]) -> list[_Span]:
    joined: list[_Span] = []
    for low, high in sorted(spans):
        if joined and low <= joined[-1][1]:
            joined[-1] = (joined[-1][0], max(high, joined[-1][1]))
        else:
            joined.append((low, high))
    return joined


def _common(first: list[_Span], second: list[_Span]) -> float:
    return sum(max(0.0, min(b, d) - max(a, c)) for a, b in first for c, d in second)


def outline_gap(a: Polygon, b: Polygon) -> float:
    """Nearest distance of two outlines, 0 when they overlap or touch."""
    ax0, ay0, ax1, ay1 = bounding_rectangle(a)
    bx0, by0, bx1, by1 = bounding_rectangle(b)
    if ax0 < bx1 and bx0 < ax1 and ay0 < by1 and by0 < ay1 and intersection_area(a, b) > 1e-9:
        return 0.0
    return min(_corner_gap(a, b), _corner_gap(b, a))


def _corner_gap(corners: Polygon, outline: Polygon) -> float:
    return min(math.dist(p, nearest_on_segment(p, start, end)[0]) for p in corners for start, end in edges(outline))


def wall_gap(outline: Polygon, start: Sequence[float], end: Sequence[float]) -> float:
    """Distance of an outline to a wall's segment, 0 when it touches or crosses it."""
    signed = []
    ex, ey = end[0] - start[0], end[1] - start[1]
    length = math.hypot(ex, ey) or 1.0
    for x, y in outline:
        signed.append((ex * (y - start[1]) - ey * (x - start[0])) / length)
    along = [(ex * (x - start[0]) + ey * (y - start[1])) / length for x, y in outline]
    if min(signed) <= 0 <= max(signed) and max(along) > 0 and min(along) < length:
        return 0.0
    ends = [(float(p[0]), float(p[1])) for p in (start, end)]
    corners = min(math.dist(p, nearest_on_segment(p, start, end)[0]) for p in outline)
    return min(corners, _corner_gap(ends, outline))
