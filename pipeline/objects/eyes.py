# SPDX-License-Identifier: GPL-3.0-or-later
"""Cameras that look at one object in its own frame: as the room's picture does, and from its front at eye level."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from ..artifacts.camera import CameraModel
from ..artifacts.layout import ProxyLine
from ..program.prelude.shape import Shape

Floats = NDArray[np.float64]
FRONT = (-0.5, -1.0, 0.42)
"""Where an eye before an object is, seen from its middle."""
_FIELD = 0.42  # radians
_AIR = 1.06
_NEAR = 0.05  # metres


def eyes_on(shapes: Sequence[Shape], proxy: ProxyLine, camera: CameraModel, side: int) -> tuple[CameraModel, ...]:
    """Two cameras for square pictures of `side` pixels, in the object's frame: where the room's camera is, and before it."""
    points = np.concatenate([shape.vertices for shape in shapes])
    return (_as_in_picture(points, proxy, camera, side), looking_at(points, FRONT, side))


def _as_in_picture(points: Floats, proxy: ProxyLine, camera: CameraModel, side: int) -> CameraModel:
    """The room's camera seen from the object: at the same place, the picture's top up, aimed at the object."""
    turned = math.radians(-proxy.yaw)
    to_own = np.array(((math.cos(turned), -math.sin(turned), 0), (math.sin(turned), math.cos(turned), 0), (0, 0, 1.0)))
    matrix = np.array(camera.matrix, dtype=float).reshape(4, 4)
    up, back = to_own @ matrix[:3, 1], to_own @ matrix[:3, 2]
    if camera.kind == "orthographic":
        return looking_at(points, back, side, up)
    base = np.array(proxy.centre, dtype=float) - (0, 0, proxy.size[2] / 2)
    place = to_own @ (matrix[:3, 3] - base)
    low, high = points.min(axis=0), points.max(axis=0)
    away = place - (low + high) / 2
    axes = _axes(away, up)
    local = (points - place) @ axes
    if local[:, 2].max() > -_NEAR:
        return looking_at(points, away, side, up)
    tangent = float((np.abs(local[:, :2]) / -local[:, 2:]).max()) * _AIR
    return _camera(axes, place, 2 * math.atan(tangent), side)


def looking_at(points: Floats, direction: Sequence[float], side: int, up: Sequence[float] = (0, 0, 1)) -> CameraModel:
    """A camera that sees all points (N, 3) from a direction, in a square picture; `up` is upwards in it."""
    back = np.array(direction, dtype=float)
    axes = _axes(back, np.array(up, dtype=float))
    middle = (points.min(axis=0) + points.max(axis=0)) / 2
    local = (points - middle) @ axes
    distance = float((np.abs(local[:, :2]).max(axis=1) / np.tan(_FIELD / 2) + local[:, 2]).max()) * _AIR
    return _camera(axes, middle + axes[:, 2] * distance, _FIELD, side)


def _axes(back: Floats, up: Floats) -> Floats:
    """A camera's axes as columns: right, up, back."""
    back = back / np.linalg.norm(back)
    right = np.cross(up, back)
    if np.linalg.norm(right) < 1e-6:
        right = np.cross((0.0, 1.0, 0.0), back)
    right = right / np.linalg.norm(right)
    return np.stack([right, np.cross(back, right), back], axis=1)


def _camera(axes: Floats, place: Floats, field: float, side: int) -> CameraModel:
    matrix = np.eye(4)
    matrix[:3, :3], matrix[:3, 3] = axes, place
    return CameraModel(
        kind="perspective", matrix=tuple(float(v) for v in matrix.ravel()), fov_y=field, image_size=(side, side)
    )
