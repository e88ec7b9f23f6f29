# SPDX-License-Identifier: GPL-3.0-or-later
"""Lengths on the floor, measured between two points of the picture."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence

import numpy as np

from ..artifacts.camera import CameraModel
from .camera import GeometryError, project, to_plane
from .polygon import Point


def floor_distance(camera: CameraModel, start: Sequence[float], end: Sequence[float]) -> float | None:
    """Metres between two picture points (0-1000) that lie on the floor; None where the line of sight misses it."""
    try:
        points = to_plane(camera, [start, end], 0.0)
    except GeometryError:
        return None
    distance = float(np.linalg.norm(points[1] - points[0]))
    return distance if math.isfinite(distance) else None


def along_walls(camera: CameraModel, start: Sequence[float], point: Sequence[float]) -> Point:
    """The picture point (0-1000) nearest to `point` on the floor line through `start` along the room's nearer axis.

    Without a floor under the points they are joined along the picture's own axes.
    """
    try:
        a, b = to_plane(camera, [start, point], 0.0)
    except GeometryError:
        a = b = np.full(3, np.nan)
    step = b - a
    if np.isfinite(step).all():
        step[0 if abs(step[0]) < abs(step[1]) else 1] = 0.0
        seen = project(camera, [a + step])[0]
        if np.isfinite(seen).all():
            return float(seen[0]), float(seen[1])
    dx, dy = point[0] - start[0], point[1] - start[1]
    return (point[0], start[1]) if abs(dx) >= abs(dy) else (start[0], point[1])


GOOD, FAIR = 0.004, 0.012
"""Reprojection error up to which a fit is good, and fair: parts of the picture's longer side."""


def fit_quality(error_px: float, image_size: Sequence[int]) -> str:
    """How well the floor's corners fit the camera: "good", "fair" or "poor".

    People and models point at corners to within about 0.3 percent of the picture's longer side; an error well above
    that means that a corner is elsewhere, or that the floor has another shape.
    """
    part = error_px / max(1, *image_size)
    return "good" if part <= GOOD else "fair" if part <= FAIR else "poor"


_METRES = {
    "": 1.0, "m": 1.0, "cm": 0.01, "mm": 0.001, "ft": 0.3048, "'": 0.3048, "in": 0.0254, '"': 0.0254, "yd": 0.9144,
}  # fmt: skip
_PART = re.compile(r"\s*(\d+(?:[.,]\d*)?|[.,]\d+)\s*(mm|cm|m|ft|in|yd|'|\"|)\s*", re.IGNORECASE)
LENGTH_RANGE = (0.05, 200.0)
"""Metres that a known length may have."""


def parse_length(text: str, feet: bool = False) -> float | None:
    """Metres of a typed length such as 4.2, 4,2, 420cm, 13ft or 6' 3"; None when it is none or out of range.

    Args:
        feet: a number without a unit is in feet, not metres.
    """
    total, place, parts = 0.0, 0, 0
    while place < len(text):
        found = _PART.match(text, place)
        if found is None:
            return None
        unit = found[2].lower() or ("ft" if feet and parts == 0 else "")
        if parts and not found[2]:
            return None  # a second number needs its unit
        total += float(found[1].replace(",", ".")) * _METRES[unit]
        place, parts = found.end(), parts + 1
    return total if parts and LENGTH_RANGE[0] <= total <= LENGTH_RANGE[1] else None
