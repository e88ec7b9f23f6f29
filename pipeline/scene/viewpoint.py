# SPDX-License-Identifier: GPL-3.0-or-later
"""A good place to look into the room from: raised, from the corner that tall furniture hides least."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from ..artifacts.camera import CameraModel
from .measure import mesh_points
from .tags import KIND, world_matrix

_IMAGE_SIZE = (1280, 800)
_FOV_Y = math.radians(32.0)
_PITCH = math.radians(46.0)
_MARGIN = 1.06
_DIRECTIONS = (-122.0, -58.0, 58.0, 122.0)  # degrees of the eye from the middle, a little off the diagonals


def corner_camera(objects: list[Any]) -> CameraModel:
    """A perspective camera that sees the whole room from the best of four corners."""
    points = np.concatenate([_world_points(obj) for obj in objects])
    tall = [_world_points(obj) for obj in objects if obj.get(KIND) in ("proxy", "partition")]
    middle = (points.min(axis=0) + points.max(axis=0)) / 2
    best = min(_DIRECTIONS, key=lambda degrees: _hidden(tall, middle, math.radians(degrees)))
    return _camera_towards(points, middle, math.radians(best))


def _world_points(obj: Any) -> Any:
    """An object's vertices in the room, (N, 3)."""
    matrix = np.array(world_matrix(obj), dtype=float)
    return mesh_points(obj.data) @ matrix[:3, :3].T + matrix[:3, 3]


def _hidden(tall: list[Any], middle: Any, angle: float) -> float:
    """How much high furniture stands on the viewer's side, in cubic metres of a sort; lower is better.

    The two southern corners are preferred, since from there the picture's up stays up.
    """
    eye = np.array([math.cos(angle), math.sin(angle)])
    total = 1.5 if eye[1] > 0 else 0.0
    for points in tall:
        low, high = points.min(axis=0), points.max(axis=0)
        nearness = ((low + high)[:2] / 2 - middle[:2]) @ eye
        spread = abs(high[0] - low[0]) + abs(high[1] - low[1])
        total += nearness * max(0.0, float(high[2]) - 0.6) * spread
    return float(total)


def _camera_towards(points: Any, middle: Any, angle: float) -> CameraModel:
    """A camera at this azimuth and the fixed pitch, as near as all points fit into the picture."""
    back = np.array([math.cos(_PITCH) * math.cos(angle), math.cos(_PITCH) * math.sin(angle), math.sin(_PITCH)])
    right = np.cross((0.0, 0.0, 1.0), back)
    right /= np.linalg.norm(right)
    up = np.cross(back, right)
    half_v = math.tan(_FOV_Y / 2) / _MARGIN
    half_h = half_v * _IMAGE_SIZE[0] / _IMAGE_SIZE[1]
    local = (points - middle) @ np.stack([right, up, back], axis=1)
    # Distance d and shifts (sx, sy) of the eye so that |x - sx| <= half_h (d - z) for all points, likewise y.
    needs = []
    shifts = []
    for axis, half in ((0, half_h), (1, half_v)):
        plus = float((local[:, axis] / half + local[:, 2]).max())
        minus = float((-local[:, axis] / half + local[:, 2]).max())
        needs.append((plus + minus) / 2)
        shifts.append((plus - minus) / 2 * half)
    eye = middle + back * max(needs) + right * shifts[0] + up * shifts[1]
    matrix = np.eye(4)
    matrix[:3, 0], matrix[:3, 1], matrix[:3, 2], matrix[:3, 3] = right, up, back, eye
    return CameraModel(
        kind="perspective", matrix=tuple(float(v) for v in matrix.ravel()), fov_y=_FOV_Y, image_size=_IMAGE_SIZE
    )
