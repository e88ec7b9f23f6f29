# SPDX-License-Identifier: GPL-3.0-or-later
"""The oriented box of a Blender object as it stands: centre, size and yaw in the room's frame."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

EXACT = 6e-5  # metres; what stands as near to its line as this stays, since a printed line is as coarse (0.1 mm)


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

    It is the direction of the local x axis on the floor; of the local y axis where x is mirrored, upright or nothing.
    """
    (a, b, c), (d, e, f), (g, h, i) = (tuple(float(v) for v in row[:3]) for row in list(matrix)[:3])
    mirrored = a * (e * i - f * h) - b * (d * i - f * g) + c * (d * h - e * g) < 0
    upright = math.hypot(a, d) < 1e-3 * max(math.hypot(a, d, g), 1e-9)
    if upright or (mirrored and math.hypot(b, e) > 1e-9):
        return math.degrees(math.atan2(-b, e))
    return math.degrees(math.atan2(d, a))


def measure(points: Any, matrix: Any, yaw: float | None = None) -> Box:
    """The box around a mesh: upright, turned by `yaw` (the object's own unless given), as tight as its vertices allow.

    Applied scale, edited vertices and tilted objects all come out as what an artist sees.
    """
    m = np.array(matrix, dtype=float)
    if yaw is None:
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
    return fit_box(measure(mesh_points(mesh), matrix), matrix, line)


def fit_box(box: Box, matrix: Any, line: dict[str, Any]) -> Any:
    """The matrix that brings what fills `box` under `matrix` into the box of a proxy line; unchanged when it is there."""
    now = np.array(matrix, dtype=float)
    wanted_size = np.maximum(np.array(line["size"], dtype=float), 1e-4)
    sizes = np.array(box.size)
    off = max(np.abs(np.array(box.centre) - line["centre"]).max(), np.abs(np.maximum(sizes, 1e-4) - wanted_size).max())
    if off < EXACT and abs(turn_between(box.yaw, line["yaw"])) < 5e-3:
        return now
    factors = np.where(sizes > 1e-6, wanted_size / np.maximum(sizes, 1e-6), 1.0)
    back = _turned(-box.yaw) @ _moved(tuple(-v for v in box.centre))
    return _moved(line["centre"]) @ _turned(line["yaw"]) @ np.diag((*factors, 1.0)) @ back @ now


def affine_between(before: Any, after: Any) -> Any | None:
    """The 4 x 4 matrix that takes points (N, 3) to others, None when no such matrix takes all of them there."""
    rows = np.hstack([before, np.ones((len(before), 1))])
    found, _, rank, _ = np.linalg.lstsq(rows, after, rcond=1e-9)
    scale = max(float(np.ptp(after, axis=0).max()), 1e-6)
    if rank < 4 or np.abs(rows @ found - after).max() > 1e-4 * scale:
        return None
    matrix = np.eye(4)
    matrix[:3, :] = found.T
    return matrix


def _moved(offset: Any) -> Any:
    matrix = np.eye(4)
    matrix[:3, 3] = offset
    return matrix


def _turned(yaw: float) -> Any:
    c, s = math.cos(math.radians(yaw)), math.sin(math.radians(yaw))
    matrix = np.eye(4)
    matrix[:2, :2] = [[c, -s], [s, c]]
    return matrix
