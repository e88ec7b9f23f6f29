# SPDX-License-Identifier: GPL-3.0-or-later
"""Rays against meshes, to the millimetre that rasters do not have. (Möller and Trumbore, 1997.)

Few rays and every triangle: what is asked here is asked once for a thing. Metres, in the frame of the shapes.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..program.prelude.shape import Shape
from .rasters import Floats, triangles

_EDGE = 1e-9


def faces_of(shapes: Sequence[Shape]) -> Floats:
    """The faces of shapes as triangles (T, 3, 3), for `hits`; concave faces are the fans that they are cut into."""
    return triangles(shapes)[0]


def hits(corners: Floats, origin: Floats, way: Floats) -> Floats:
    """Distances in rising order at which a ray (3,), (3,) goes through triangles (T, 3, 3); `way` is a unit vector."""
    if not len(corners):
        return np.zeros(0)
    a, edge, other = corners[:, 0], corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    across = np.cross(way, other)
    scale = (edge * across).sum(axis=1)
    with np.errstate(divide="ignore", invalid="ignore"):
        away = origin - a
        u = (away * across).sum(axis=1) / scale
        turned = np.cross(away, edge)
        v = turned @ way / scale
        distance = (other * turned).sum(axis=1) / scale
        met = (np.abs(scale) > 1e-14) & (u >= -_EDGE) & (v >= -_EDGE) & (u + v <= 1 + _EDGE) & (distance > 0)
    found: Floats = np.sort(distance[met])
    return found


def room_beside(
    shapes: Sequence[Shape],
    middle: Floats,
    size: Floats,
    turn: float,
    axis: int,
    levels: Sequence[float] = (-0.3, 0.0, 0.3),
) -> tuple[float, float]:
    """How far it is from the middle of a box to what stands beside it, against an axis of the box and along it.

    Args:
        middle: of the box; size: width, depth and height of it; turn: its yaw, radians. axis: 0 its width, 1 its depth.
        levels: heights at which it is asked, from the middle, in shares of the height.
    """
    axes = np.array(((np.cos(turn), np.sin(turn), 0.0), (-np.sin(turn), np.cos(turn), 0.0), (0.0, 0.0, 1.0)))
    corners = faces_of(shapes)
    found = []
    for side in (-1.0, 1.0):
        nearest = np.inf
        for other in (-0.3, 0.3):
            for up in levels:
                origin = middle + other * size[1 - axis] * axes[1 - axis] + up * size[2] * axes[2]
                met = hits(corners, origin, side * axes[axis])
                nearest = min(nearest, float(met[0])) if len(met) else nearest
        found.append(nearest)
    return found[0], found[1]
