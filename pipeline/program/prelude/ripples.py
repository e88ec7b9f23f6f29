# SPDX-License-Identifier: GPL-3.0-or-later
"""Smooth irregularity for soft things: a few seeded waves, over whole arrays at once; and closed sheets from grids."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from .budget import spend_vertices
from .numbers import rand
from .rings import Faces
from .shape import Floats

WAVES = 6


def ripples(seed: Any, x: Floats, y: Floats, size: float) -> Floats:
    """Smooth noise of about -1..1 whose features are about `size` metres wide."""
    total = np.zeros(np.broadcast(x, y).shape)
    for i in range(WAVES):
        name = f"{seed_of(seed)}/{i}"
        angle = rand(name + "turn", 0.0, math.tau)
        pitch = math.tau / (size * rand(name + "pitch", 1.4, 3.2))
        total += np.sin(pitch * (x * math.cos(angle) + y * math.sin(angle)) + rand(name + "phase", 0.0, math.tau))
    return total * (1.6 / WAVES)


def seed_of(seed: Any) -> str:
    """The seed, a number, a text or a tuple of them, as one text."""
    return "/".join(map(seed_of, seed)) if isinstance(seed, (tuple, list)) else str(seed)


def cells(rows: int, columns: int, start: int = 0) -> Faces:
    """Faces of a grid of vertices in rows, upper side up where columns run along x and rows along y."""
    corners = [start + j * columns + i for j in range(rows - 1) for i in range(columns - 1)]
    return [(a, a + 1, a + columns + 1, a + columns) for a in corners]


def normals_of(points: Floats) -> Floats:
    """Unit normals of a grid of points (rows, columns, 3), on its upper side."""
    across, up = np.gradient(points, axis=1), np.gradient(points, axis=0)
    normals = np.cross(across, up)
    length = np.linalg.norm(normals, axis=2, keepdims=True)
    return np.asarray(normals / np.maximum(length, 1e-12))


def thick_sheet(points: Floats, thickness: float | Floats, cloth: Floats) -> tuple[Floats, Faces, Floats]:
    """A closed sheet: the grid (rows, columns, 3) as its upper side, the lower side `thickness` behind it.

    Args:
        thickness: one, or one for each point (rows, columns, 1).
        cloth: where each point lies on the flat cloth, metres, (rows, columns, 2).

    Returns:
        Vertices, faces, and for each face corner its place on the cloth.
    """
    rows, columns = points.shape[:2]
    count = rows * columns
    spend_vertices(2 * count)
    below = points - normals_of(points) * thickness
    vertices = np.concatenate([points.reshape(-1, 3), below.reshape(-1, 3)])
    top = cells(rows, columns)
    faces = top + [tuple(i + count for i in face[::-1]) for face in top]
    rim = [*range(columns), *range(2 * columns - 1, count, columns)]
    rim += [*range(count - 2, count - columns - 1, -1), *range(count - 2 * columns, 0, -columns)]
    faces += [(b, a, a + count, b + count) for a, b in zip(rim, rim[1:] + rim[:1], strict=True)]
    flat = np.concatenate([cloth.reshape(-1, 2)] * 2)
    return vertices, faces, flat[[i for face in faces for i in face]]


def fitted(vertices: Floats, size: tuple[float, float, float]) -> Floats:
    """The vertices stretched so that their bounding box is `size` round the origin."""
    low, high = vertices.min(axis=0), vertices.max(axis=0)
    extent = np.maximum(high - low, 1e-12)
    return np.asarray((vertices - (low + high) / 2) / extent * np.array(size))
