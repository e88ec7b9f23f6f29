# SPDX-License-Identifier: GPL-3.0-or-later
"""The shapes that stand in for objects: a box, a cylinder or an L, each with a mark that shows its front.

A proxy's local frame: origin at the centre of its base, +X its width, -Y its front, +Z up. Every shape fills its box
exactly (its bounds are the box), so that a proxy's size can be read from its mesh.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from .shape import Shape

_ROUND_SEGMENTS = 48  # a multiple of four, so that the cylinder touches all four sides of its box
_L_RATIO = 0.45  # share of the depth (of the width) that the two arms of an L take
_SMALLEST = 1e-4  # metres; a flat proxy still needs a mesh with bounds


def proxy_shapes(line: dict[str, Any]) -> list[Shape]:
    """Shapes of one proxy line in its local frame, in metres.

    `shape="box"` is a box with a recessed panel in its front; `"round"` an elliptic cylinder; `"l_shape"` an L whose
    long arm runs along the back and whose short arm comes forward on its -X side. A dark triangle on top points to
    the front (part "arrow", material "marker").
    """
    width, depth, height = (max(abs(float(value)), _SMALLEST) for value in line["size"])
    kind = line.get("shape", "box")
    if kind == "round":
        return _round_proxy(width, depth, height)
    if kind == "l_shape":
        return _l_proxy(width, depth, height)
    return _box_proxy(width, depth, height)


def _arrow_points(width: float, front: float, back: float) -> list[tuple[float, float]]:
    """Tip, right and left corner of the arrow on a top face `width` wide that runs from y = front to y = back."""
    depth = back - front
    long = min(0.26 * depth, 0.20, 0.5 * width)
    half = min(0.7 * long, 0.30 * width)
    tip = front + 0.10 * depth
    return [(0.0, tip), (half, tip + long), (-half, tip + long)]


def _arrow_shape(points: list[tuple[float, float]], z: float) -> Shape:
    """The arrow itself: one triangle in the plane of the top."""
    return Shape(np.array([(x, y, z) for x, y in points], dtype=float), ((0, 1, 2),), "arrow", "marker")


def _box_proxy(width: float, depth: float, height: float) -> list[Shape]:
    """A box whose front face has a shallow recess and whose top has the arrow let in."""
    x, y = width / 2, depth / 2
    edge = min(0.06, 0.12 * width, 0.12 * height)
    sunk = -y + min(0.015, 0.1 * depth)
    arrow = _arrow_points(width, -y, y)
    base = [(-x, -y, 0), (x, -y, 0), (x, y, 0), (-x, y, 0)]
    top = [(a, b, height) for a, b, _ in base]
    rim = [(-x + edge, -y, edge), (x - edge, -y, edge), (x - edge, -y, height - edge), (-x + edge, -y, height - edge)]
    floor = [(a, sunk, c) for a, _, c in rim]
    vertices = base + top + rim + floor + [(a, b, height) for a, b in arrow]
    tip, right, left = 16, 17, 18
    faces = [
        (3, 2, 1, 0), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7),  # base and sides
        (0, 1, 9, 8), (1, 5, 10, 9), (5, 4, 11, 10), (4, 0, 8, 11),  # border of the front
        (8, 9, 13, 12), (9, 10, 14, 13), (10, 11, 15, 14), (11, 8, 12, 15),  # recess
        (4, 5, tip), (5, 6, right, tip), (6, 7, left, right), (7, 4, tip, left),  # top around the arrow
    ]  # fmt: skip
    body = Shape(np.array(vertices, dtype=float), tuple(faces), "body")
    panel = Shape(np.array(floor, dtype=float), ((0, 1, 2, 3),), "front", "front")
    return [body, panel, _arrow_shape(arrow, height)]


def _round_proxy(width: float, depth: float, height: float) -> list[Shape]:
    """An elliptic cylinder with the arrow let into its top."""
    count = _ROUND_SEGMENTS
    angles = [2 * math.pi * i / count - math.pi / 2 for i in range(count)]
    ring = [(math.cos(a) * width / 2, math.sin(a) * depth / 2) for a in angles]
    arrow = _arrow_points(0.8 * width, -depth / 2, depth / 2)
    vertices = [(a, b, 0.0) for a, b in ring] + [(a, b, height) for a, b in ring + arrow]
    tip, right, left = 2 * count, 2 * count + 1, 2 * count + 2
    sides = [(i, (i + 1) % count, count + (i + 1) % count, count + i) for i in range(count)]
    first, second = 3 * count // 8, 5 * count // 8
    caps = [
        tuple(range(count - 1, -1, -1)),
        (*range(count, count + first + 1), right, tip),
        (*range(count + first, count + second + 1), left, right),
        (*range(count + second, 2 * count), count, tip, left),
    ]
    body = Shape(np.array(vertices, dtype=float), tuple(sides + caps), "body")
    return [body, _arrow_shape(arrow, height)]


def _l_proxy(width: float, depth: float, height: float) -> list[Shape]:
    """An L: full width along the back, one arm forward at -X."""
    x, y = width / 2, depth / 2
    arm, inner = -x + _L_RATIO * width, y - _L_RATIO * depth
    outline = [(-x, -y), (arm, -y), (arm, inner), (x, inner), (x, y), (-x, y)]
    arrow = _arrow_points(0.9 * width, inner, y)
    vertices = [(a, b, 0.0) for a, b in outline] + [(a, b, height) for a, b in outline + arrow]
    sides = [(i, (i + 1) % 6, 6 + (i + 1) % 6, 6 + i) for i in range(6)]
    tip, right, left = 12, 13, 14
    caps = [(5, 4, 3, 2, 1, 0), (6, 7, 8, tip, left, 11), (8, 9, right, tip), (9, 10, 11, left, right)]
    body = Shape(np.array(vertices, dtype=float), tuple(sides + caps), "body")
    return [body, _arrow_shape(arrow, height)]
