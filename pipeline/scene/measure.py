# SPDX-License-Identifier: GPL-3.0-or-later
"""The oriented box of a Blender object as it stands: centre, size and yaw in the room's frame."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

EXACT = 5e-5  # metres; a mesh that fills its line's box this well is not fitted again


@dataclass(frozen=True)
class Box:
    """Centre (x, y, z) and size (width, depth, height) in metres, yaw in degrees counter-clockwise."""

    centre: tuple[float, float, float]
    size: tuple[float, float, float]
    yaw: float


def mesh_points(mesh: Any) -> Any:
    """The vertices of a mesh in its own frame, (N, 3)."""
    points = np.empty(3 * len(mesh.vertices), dtype=np.float32)
    mesh.vertices.foreach_get("co", points)
    return points.reshape(-1, 3).astype(float)


def box_points(size: Any) -> Any:
    """The corners of a proxy's box in its local frame (origin at the centre of its base), (8, 3)."""
    x, y, z = float(size[0]) / 2, float(size[1]) / 2, float(size[2])
    return np.array([(a, b, c) for a in (-x, x) for b in (-y, y) for c in (0.0, z)])


def matrix_yaw(matrix: Any) -> float:
    """Yaw in degrees of an object's matrix, in (-180, 180].

    It is the direction of the local x axis on the floor; of the local y axis where x is mirrored or upright.
    """
    m = np.array(matrix, dtype=float)[:3, :3]
    x, y = m[:2, 0], m[:2, 1]
    upright = np.linalg.norm(x) < 1e-3 * max(float(np.linalg.norm(m[:, 0])), 1e-12)
    if upright or (np.linalg.det(m) < 0 and np.linalg.norm(y) > 1e-9):
        return math.degrees(math.atan2(-y[0], y[1]))
    return math.degrees(math.atan2(x[1], x[0]))


def measure(points: Any, matrix: Any) -> Box:
    """The box around a mesh: upright, turned by the object's yaw, as tight as its vertices allow.

    Applied scale, edited vertices and tilted objects all come out as what an artist sees.
    """
    m = np.array(matrix, dtype=float)
    yaw = matrix_yaw(m)
    c, s = math.cos(math.radians(yaw)), math.sin(math.radians(yaw))
    world = points @ m[:3, :3].T + m[:3, 3]
    turned = world @ np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
    low, high = turned.min(axis=0), turned.max(axis=0)
    middle, size = (low + high) / 2, high - low
    centre = (c * middle[0] - s * middle[1], s * middle[0] + c * middle[1], middle[2])
    return Box(tuple(float(v) for v in centre), tuple(float(v) for v in size), yaw)  # type: ignore[arg-type]


def turn_between(first: float, second: float) -> float:
    """The smallest turn from the first yaw to the second, degrees in (-180, 180]."""
    return -((first - second + 180.0) % 360.0 - 180.0)


def fit_matrix(mesh: Any, matrix: Any, line: dict[str, Any]) -> Any:
    """The matrix with which an artist's own mesh fills the box of a proxy line; unchanged when it does already."""
    box = measure(mesh_points(mesh), matrix)
    now = np.array(matrix, dtype=float)
    wanted_size = np.maximum(np.array(line["size"], dtype=float), 1e-4)
    off = max(np.abs(np.array(box.centre) - line["centre"]).max(), np.abs(np.array(box.size) - wanted_size).max())
    if off < EXACT and abs(turn_between(box.yaw, line["yaw"])) < 5e-3:
        return now
    sizes = np.array(box.size)
    factors = np.where(sizes > 1e-6, wanted_size / np.maximum(sizes, 1e-6), 1.0)
    back = _turned(-box.yaw) @ _moved(tuple(-v for v in box.centre))
    return _moved(line["centre"]) @ _turned(line["yaw"]) @ np.diag((*factors, 1.0)) @ back @ now


def _moved(offset: Any) -> Any:
    matrix = np.eye(4)
    matrix[:3, 3] = offset
    return matrix


def _turned(yaw: float) -> Any:
    c, s = math.cos(math.radians(yaw)), math.sin(math.radians(yaw))
    matrix = np.eye(4)
    matrix[:2, :2] = [[c, -s], [s, c]]
    return matrix
