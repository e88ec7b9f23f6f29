# SPDX-License-Identifier: GPL-3.0-or-later
"""Outlines and lines as lists of points, for `extrude`, `loft`, `sweep`, `tube` and `lathe`."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from .arguments import by_kind
from .budget import spend_vertices
from .checks import flag, number, point, positive, whole
from .shape import Floats

Outline = list[tuple[float, ...]]
FLAT_ORIGIN = (0.0, 0.0)


@by_kind
def rectangle(width: Any, depth: Any, radius: Any = 0.0, at: Any = FLAT_ORIGIN, segments: Any = 4) -> Outline:
    """Points (x, y), corners rounded by radius."""
    w, d = positive("rectangle", "width", width), positive("rectangle", "depth", depth)
    bend = min(number("rectangle", "radius", radius, 0.0), 0.499 * min(w, d))
    x, y = point("rectangle", "at", at, 2)
    steps = whole("rectangle", "segments", segments, 1, 64)
    corners = ((1, -1), (1, 1), (-1, 1), (-1, -1))
    if bend < 1e-6:
        return [(x + a * w / 2, y + b * d / 2) for a, b in corners]
    found: Outline = []
    for quarter, (a, b) in enumerate(corners):
        middle = (x + a * (w / 2 - bend), y + b * (d / 2 - bend))
        turns = [math.pi / 2 * (quarter - 1 + i / steps) for i in range(steps + 1)]
        found += [(middle[0] + bend * math.cos(t), middle[1] + bend * math.sin(t)) for t in turns]
    return found


@by_kind
def ellipse(width: Any, depth: Any, segments: Any = 32, at: Any = FLAT_ORIGIN) -> Outline:
    """Points (x, y)."""
    w, d = positive("ellipse", "width", width), positive("ellipse", "depth", depth)
    count = whole("ellipse", "segments", segments, 3, 512)
    x, y = point("ellipse", "at", at, 2)
    turns = [math.tau * i / count for i in range(count)]
    return [(x + w / 2 * math.cos(t), y + d / 2 * math.sin(t)) for t in turns]


def spline(points: Any, steps: Any = 6, closed: Any = False) -> Outline:
    """A smooth line through points of two or three numbers.

    Source: E. Catmull, R. Rom, "A class of local interpolating splines", 1974.
    """
    fine, loop = whole("spline", "steps", steps, 1, 64), flag("spline", "closed", closed)
    if not isinstance(points, (list, tuple)) or not 2 <= len(points) <= 2000:
        raise ValueError("spline: points must be a list of at least two points")
    size = 2 if isinstance(points[0], (list, tuple)) and len(points[0]) == 2 else 3
    given = np.array([point("spline", "each point", p, size) for p in points])
    spend_vertices(fine * len(given))
    if loop:
        chain = np.concatenate([given[-1:], given, given[:2]])
    else:
        chain = np.concatenate([2 * given[:1] - given[1:2], given, 2 * given[-1:] - given[-2:-1]])
    found: list[Floats] = []
    for i in range(len(chain) - 3):
        a, b, c, d = chain[i : i + 4]
        for k in range(fine):
            t = k / fine
            found.append(
                b + t * (c - a) / 2 + t * t * (a - 2.5 * b + 2 * c - d / 2) + t**3 * (1.5 * (b - c) + (d - a) / 2)
            )
    if not loop:
        found.append(given[-1])
    return [tuple(p) for p in np.array(found).tolist()]
