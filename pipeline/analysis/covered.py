# SPDX-License-Identifier: GPL-3.0-or-later
"""Which edges of a box were guessed, since something above covers them in the picture."""

from __future__ import annotations

import math
from collections.abc import Sequence

from ..artifacts.analysis import Calibration, DetectedObject, SceneAnalysis
from ..artifacts.common import ImageBox
from ..artifacts.trust import Edges
from ..geometry.camera import GeometryError
from ..geometry.footprint import image_box_of

ABOVE = 0.05
"""Metres by which something has to reach higher to cover another thing."""
MUCH = 0.3
"""A part of an edge that may be covered without making it uncertain."""
GUESSED = 3.0
"""How much larger the error of an edge is that is covered from end to end."""
CLEAR: Edges = (1.0, 1.0, 1.0, 1.0)


def covered_edges(analysis: SceneAnalysis, calibration: Calibration) -> dict[str, Edges]:
    """By how much the errors of each object's box edges (x_min, y_min, x_max, y_max) are larger than usual.

    Only objects with such an edge are listed. What stands or lies on a thing does not hide where the thing ends, unless
    it hangs over the edge; then the edge that was seen is that of both.
    """
    above = [(o.id, o.centre[2] + o.size[2] / 2, o.box) for o in analysis.objects if o.box is not None]
    above += _partitions(analysis, calibration)
    result: dict[str, Edges] = {}
    for item in analysis.objects:
        if item.box is None:
            continue
        top = item.centre[2] + item.size[2] / 2
        over = [box for name, height, box in above if name != item.id and height > top + ABOVE]
        parts = [_covered(edge, over) for edge in _lines(item.box)]
        factors = [1.0 + (GUESSED - 1.0) * max(0.0, part - MUCH) / (1.0 - MUCH) for part in parts]
        if max(factors) > 1.0:
            result[item.id] = (factors[0], factors[1], factors[2], factors[3])
    return result


def _partitions(analysis: SceneAnalysis, calibration: Calibration) -> list[tuple[str, float, ImageBox]]:
    seen = []
    for item in analysis.architecture:
        if item.kind != "partition":
            continue
        height = min(item.height, calibration.height)
        (ax, ay), (bx, by) = item.start, item.end
        centre = ((ax + bx) / 2, (ay + by) / 2, height / 2)
        size = (math.dist(item.start, item.end), item.thickness, height)
        yaw = math.degrees(math.atan2(by - ay, bx - ax))
        try:
            seen.append((item.id, height, image_box_of(calibration.camera, centre, size, yaw)))
        except GeometryError:
            continue
    return seen


def _lines(box: ImageBox) -> list[tuple[bool, float, float, float]]:
    """The four edges: whether it is upright, where, from, to."""
    upright, level = (box.y_min, box.y_max), (box.x_min, box.x_max)
    return [
        (True, box.x_min, *upright),
        (False, box.y_min, *level),
        (True, box.x_max, *upright),
        (False, box.y_max, *level),
    ]


def _covered(edge: tuple[bool, float, float, float], over: Sequence[ImageBox]) -> float:
    """What part of an edge lies well inside of other boxes."""
    upright, at, start, end = edge
    spans = []
    for box in over:
        low, high = (box.x_min, box.x_max) if upright else (box.y_min, box.y_max)
        first, last = (box.y_min, box.y_max) if upright else (box.x_min, box.x_max)
        margin = 0.1 * (high - low)
        if low + margin < at < high - margin and min(end, last) > max(start, first):
            spans.append((max(start, first), min(end, last)))
    covered, reached = 0.0, start
    for first, last in sorted(spans):
        covered += max(0.0, last - max(first, reached))
        reached = max(reached, last)
    return covered / max(1e-9, end - start)


def lowest_of(item: DetectedObject) -> float:
    """Height of an object's underside: the floor for what stands on it, else what was said."""
    return 0.0 if item.placement == "floor" else item.centre[2] - item.size[2] / 2
