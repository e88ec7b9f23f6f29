# SPDX-License-Identifier: GPL-3.0-or-later
"""From rings of points to a closed mesh, and the turning of a mesh so that its faces look outward."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from .budget import spend_vertices
from .checks import choice, point
from .shape import Floats, Shape

Faces = list[tuple[int, ...]]
AXES = ("x", "y", "z")


def skin(rings: list[Floats], loop: bool = False) -> tuple[Floats, Faces]:
    """Vertices and faces of a tube through rings of the same number of points; a ring of one point is a pole.

    Rings follow each other upward and each runs counter-clockwise seen from above, so the faces look outward. The
    first and the last ring are closed by a face unless they are poles; with `loop` the last joins the first instead.
    """
    starts = np.cumsum([0] + [len(ring) for ring in rings]).tolist()
    faces: Faces = []
    pairs = [(i, i + 1) for i in range(len(rings) - 1)] + ([(len(rings) - 1, 0)] if loop else [])
    for low, high in pairs:
        faces.extend(band(starts[low], len(rings[low]), starts[high], len(rings[high])))
    if not loop and len(rings[0]) > 1:
        faces.append(tuple(range(len(rings[0]) - 1, -1, -1)))
    if not loop and len(rings[-1]) > 1:
        faces.append(tuple(range(starts[-2], starts[-2] + len(rings[-1]))))
    return np.concatenate(rings), faces


def band(a: int, a_count: int, b: int, b_count: int) -> Faces:
    """Faces between the ring that starts at vertex a and the ring above it that starts at b."""
    count = max(a_count, b_count)
    following = [*range(1, count), 0]
    if a_count == 1:
        return [(a, b + j, b + i) for i, j in enumerate(following)]
    if b_count == 1:
        return [(a + i, a + j, b) for i, j in enumerate(following)]
    return [(a + i, a + j, b + j, b + i) for i, j in enumerate(following)]


def circle(segments: int) -> Floats:
    """Unit circle in the XY plane, counter-clockwise from +X, array (segments, 3)."""
    angles = [math.tau * i / segments for i in range(segments)]
    return np.array([(math.cos(angle), math.sin(angle), 0.0) for angle in angles])


def ring_sizes(profile: list[tuple[float, float]], segments: int) -> tuple[int, ...]:
    """How many points each ring has that `revolve` makes of the profile."""
    return tuple(segments if radius > 0 else 1 for radius, _ in profile)


def revolve(profile: list[tuple[float, float]], segments: int, loop: bool = False) -> tuple[Floats, Faces]:
    """Turn points (radius, z) round the Z axis; a radius of 0 makes a pole. Counts the vertices first."""
    spend_vertices(sum(segments if radius > 0 else 1 for radius, _ in profile))
    unit = circle(segments)
    up = np.array((0.0, 0.0, 1.0))
    rings = [unit * radius + up * z if radius > 0 else (up * z)[None, :] for radius, z in profile]
    return skin(rings, loop)


def signed_volume(vertices: Floats, faces: Faces) -> float:
    """Volume inside a closed mesh, negative when its faces look inward."""
    total = 0.0
    by_length: dict[int, list[tuple[int, ...]]] = {}
    for face in faces:
        by_length.setdefault(len(face), []).append(face)
    points = vertices - vertices[0]
    for length, same in by_length.items():
        corners = points[np.array(same)]
        fan = np.cross(corners[:, 1:-1], corners[:, 2:]) if length > 3 else np.cross(corners[:, 1], corners[:, 2])
        fan = fan.sum(axis=1) if length > 3 else fan
        total += float(np.einsum("ij,ij->", corners[:, 0], fan))
    return total / 6


def outward(vertices: Floats, faces: Faces) -> Faces:
    """The faces of a closed mesh, all turned over if they look inward."""
    return faces if signed_volume(vertices, faces) >= 0 else [face[::-1] for face in faces]


def ringed(
    where: str, vertices: Floats, faces: Faces, at: Any, rings: tuple[int, ...], loop: bool = False,
    smooth: bool = True, crease: float = 35.0,
) -> Shape:  # fmt: skip
    """A closed shape that `skin` made of rings of these sizes, turned outward and moved by `at`."""
    inward = signed_volume(vertices, faces) < 0
    moved = vertices + np.array(point(where, "at", at))
    made = tuple(face[::-1] for face in faces) if inward else tuple(faces)
    return Shape(moved, made, smooth=smooth, crease=crease, rings=rings, loop=loop, flipped=inward)


def crease_of(segments: int) -> float:
    """The angle in degrees above which an edge of a round thing of so many segments is meant to be sharp."""
    return min(max(35.0, 1.1 * 360.0 / segments), 80.0)


def along(where: str, vertices: Floats, axis: Any) -> Floats:
    """Turn a mesh that was made along Z so that it lies along the axis "x", "y" or "z"."""
    shift = {"x": 1, "y": 2, "z": 0}[choice(where, "axis", axis, AXES)]
    return np.roll(vertices, shift, axis=1) if shift else vertices


def placed(
    where: str, vertices: Floats, faces: Faces, at: Any, smooth: bool = False, crease: float = 35.0
) -> Shape:  # fmt: skip
    """A shape of these vertices moved by `at`."""
    moved = vertices + np.array(point(where, "at", at))
    return Shape(vertices=moved, faces=tuple(faces), smooth=smooth, crease=crease)
