# SPDX-License-Identifier: GPL-3.0-or-later
"""Open surfaces by a function, and meshes corner by corner."""

from __future__ import annotations

from typing import Any

import numpy as np

from .arguments import by_kind
from .budget import spend_vertices
from .checks import COORDINATE_LIMIT, fail, flag, is_number, point, positive, whole
from .rings import Faces, placed
from .shape import Shape
from .solids import ORIGIN

MOST_FACES = 500_000


@by_kind
def grid(function: Any, nx: Any, ny: Any, size: Any = (1.0, 1.0), at: Any = ORIGIN, smooth: Any = True) -> Shape:
    """An open sheet of nx times ny cells by function(u, v), u and v in 0..1: a height over `size` (width, depth), or a point
    (x, y, z). Its upper side is where u runs right and v away.
    """
    if not callable(function):
        raise fail("grid", "the first argument must be a function of u and v, such as a lambda")
    columns, rows = whole("grid", "nx", nx, 1, 2000), whole("grid", "ny", ny, 1, 2000)
    width, depth = (positive("grid", "each size", side) for side in point("grid", "size", size, 2))
    spend_vertices((columns + 1) * (rows + 1))
    points = []
    for j in range(rows + 1):
        v = j / rows
        for i in range(columns + 1):
            u = i / columns
            result = function(u, v)
            if is_number(result):
                result = ((u - 0.5) * width, (v - 0.5) * depth, result)
            elif not isinstance(result, (tuple, list)) or len(result) != 3 or not all(map(is_number, result)):
                raise fail("grid", "the function must return a finite height or a point (x, y, z)")
            points.append(result)
    vertices = np.array(points, dtype=np.float64)
    if np.abs(vertices).max() > COORDINATE_LIMIT:
        raise fail("grid", f"all points must lie within {COORDINATE_LIMIT:g} of the origin")
    step = columns + 1
    corners = [j * step + i for j in range(rows) for i in range(columns)]
    faces: Faces = [(a, a + 1, a + step + 1, a + step) for a in corners]
    return placed("grid", vertices, faces, at, flag("grid", "smooth", smooth))


@by_kind
def mesh(vertices: Any, faces: Any, at: Any = ORIGIN, smooth: Any = False) -> Shape:
    """Points (x, y, z); faces are lists of point numbers, counter-clockwise from outside."""
    if not isinstance(vertices, (list, tuple)) or len(vertices) < 3:
        raise fail("mesh", "vertices must be a list of at least three points (x, y, z)")
    spend_vertices(len(vertices))
    points = np.array([point("mesh", "each vertex", v) for v in vertices])
    if not isinstance(faces, (list, tuple)) or not 1 <= len(faces) <= MOST_FACES:
        raise fail("mesh", "faces must be a list of faces, each a list of vertex numbers")
    made = []
    for face in faces:
        if not isinstance(face, (list, tuple)) or len(face) < 3:
            raise fail("mesh", "each face must list at least three vertex numbers")
        made.append(tuple(whole("mesh", "each vertex number", i, 0, len(points) - 1) for i in face))
        if len(set(made[-1])) < len(face):
            raise fail("mesh", "a face must not use the same vertex twice")
    if sum(map(len, made)) > 4 * MOST_FACES:
        raise fail("mesh", "too many face corners")
    return placed("mesh", points, made, at, flag("mesh", "smooth", smooth))
