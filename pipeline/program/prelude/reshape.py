# SPDX-License-Identifier: GPL-3.0-or-later
"""Operations that make new geometry of a shape: rounding it off, bevelling, thickening, roughening, tapering, bending."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np

from .budget import spend_vertices
from .checks import choice, fail, number, positive, whole
from .operations import AXIS_NUMBER, Shapes, each, moved
from .rings import Faces
from .ripples import ripples, seed_of
from .shape import Floats, Shape, remeshed
from .unwrap import face_normals

Edge = tuple[int, int]
COST = 3
"""What each vertex of an operation that works through all faces counts as."""


def edge_faces(shape: Shape) -> dict[Edge, list[int]]:
    """The faces at each edge; an edge is its two vertices in ascending order."""
    found: dict[Edge, list[int]] = {}
    for number_of, face in enumerate(shape.faces):
        for a, b in zip(face, face[1:] + face[:1], strict=True):
            found.setdefault((a, b) if a < b else (b, a), []).append(number_of)
    return found


def vertex_normals(shape: Shape) -> Floats:
    """Unit normals of the vertices, means of their faces', array (vertices, 3)."""
    corners, lengths = shape.corners
    normals = np.repeat(face_normals(shape), lengths, axis=0)
    result = summed(corners, normals, shape.vertex_count)
    return np.asarray(result / np.maximum(np.linalg.norm(result, axis=1, keepdims=True), 1e-15))


def subdivide(shapes: Any, levels: Any = 1) -> Shapes:
    """Rounded off (Catmull-Clark).

    Source: E. Catmull, J. Clark, "Recursively generated B-spline surfaces on arbitrary topological meshes", 1978.
    """
    rounds = whole("subdivide", "levels", levels, 1, 4)

    def change(shape: Shape) -> Shape:
        for _ in range(rounds):
            shape = subdivided(shape)
        return replace(shape, smooth=True, crease=180.0)

    return each("subdivide", shapes, change)


def subdivided(shape: Shape) -> Shape:
    """One level of Catmull-Clark; borders of open sheets follow their own curve."""
    old, lengths = shape.vertices, np.array([len(face) for face in shape.faces])
    corners = np.fromiter((v for face in shape.faces for v in face), dtype=np.int64, count=int(lengths.sum()))
    spend_vertices(COST * (len(old) + len(corners)))
    owner = np.repeat(np.arange(len(lengths)), lengths)
    starts = np.cumsum(lengths) - lengths
    place = np.arange(len(corners)) - starts[owner]
    ahead = corners[starts[owner] + (place + 1) % lengths[owner]]
    behind = starts[owner] + (place - 1) % lengths[owner]
    low, high = np.minimum(corners, ahead), np.maximum(corners, ahead)
    keys, edge = np.unique(low * len(old) + high, return_inverse=True)
    ends = np.stack([keys // len(old), keys % len(old)], axis=1)
    middles = summed(owner, old[corners], len(lengths)) / lengths[:, None]
    halves = old[ends].mean(axis=1)
    sides = np.bincount(edge, minlength=len(keys))
    inner = summed(edge, middles[owner], len(keys)) / np.maximum(sides, 1)[:, None]
    border = sides != 2
    edge_points = np.where(border[:, None], halves, (halves + inner) / 2)
    both, twice = ends.ravel(), np.repeat(halves, 2, axis=0)
    n = np.maximum(np.bincount(both, minlength=len(old)), 1)[:, None]
    faces_at = np.maximum(np.bincount(corners, minlength=len(old)), 1)[:, None]
    points = (
        summed(corners, middles[owner], len(old)) / faces_at + 2 * summed(both, twice, len(old)) / n + (n - 3) * old
    ) / n
    rim, count = ends[border].ravel(), np.bincount(ends[border].ravel(), minlength=len(old))
    on_rim = count > 0
    drawn = summed(rim, np.repeat(halves[border], 2, axis=0), len(old))[on_rim] / count[on_rim][:, None]
    points[on_rim] = (drawn + old[on_rim]) / 2
    first = len(old) + len(keys)
    made = np.stack([corners, len(old) + edge, first + owner, len(old) + edge[behind]], axis=1)
    return remeshed(shape, np.concatenate([points, edge_points, middles]), map(tuple, made.tolist()))


def summed(index: Any, values: Floats, count: int) -> Floats:
    """Sums of the rows of `values` that have the same index, array (count, 3)."""
    return np.stack([np.bincount(index, weights=values[:, i], minlength=count) for i in range(3)], axis=1)


def bevel(shapes: Any, width: Any = 0.01, angle: Any = 30.0) -> Shapes:
    """Sharp edges of closed shapes cut off.

    An edge is sharp where faces meet at more than `angle` degrees.
    Shaded smooth, cut edges look rounded. The width is cut to a third of the shortest edge.
    """
    reach = positive("bevel", "width", width)
    limit = math.cos(math.radians(number("bevel", "angle", angle, 1.0, 170.0)))
    return each("bevel", shapes, lambda shape: bevelled(shape, reach, limit))


def bevelled(shape: Shape, width: float, limit: float) -> Shape:
    """One shape with its sharp edges cut off."""
    edges, normals = edge_faces(shape), face_normals(shape)
    if any(len(faces) != 2 for faces in edges.values()):
        raise fail("bevel", "the shape must be closed; bevel solids, and solidify a sheet first")
    sharp = {e for e, (a, b) in edges.items() if float(normals[a] @ normals[b]) < limit}
    if not sharp:
        return shape
    shortest = min(math.dist(shape.vertices[a], shape.vertices[b]) for a, b in sharp)
    cut = min(width, shortest / 3)
    spend_vertices(12 * COST * sum(len(face) for face in shape.faces))
    corner: dict[tuple[int, int], Floats] = {}
    for i, face in enumerate(shape.faces):
        for k, v in enumerate(face):
            corner[i, v] = corner_point(
                shape.vertices, face[k - 1], v, face[(k + 1) % len(face)], normals[i], sharp, cut
            )
    for (a, b), (one, two) in edges.items():
        if (a, b) not in sharp:
            for v in (a, b):
                corner[one, v] = corner[two, v] = (corner[one, v] + corner[two, v]) / 2
    return stitched(shape, corner, edges, sharp)


def corner_point(
    points: Floats, before: int, v: int, after: int, normal: Floats, sharp: set[Edge], cut: float
) -> Floats:
    """Where a face's corner goes: along its soft edge, or inside between its two sharp ones."""
    back, ahead = points[before] - points[v], points[after] - points[v]
    back, ahead = back / max(float(np.linalg.norm(back)), 1e-12), ahead / max(float(np.linalg.norm(ahead)), 1e-12)
    sine = max(abs(float(np.cross(ahead, back) @ normal)), 0.2)
    first, second = ordered(before, v) in sharp, ordered(v, after) in sharp
    shift = (ahead if first else 0.0) * np.float64(cut / sine) + (back if second else 0.0) * np.float64(cut / sine)
    if float(np.cross(ahead, back) @ normal) < 0 and first and second:
        shift = -shift  # a corner that points inward
    return np.asarray(points[v] + shift)


def ordered(a: int, b: int) -> Edge:
    """The edge between two vertices."""
    return (a, b) if a < b else (b, a)


def stitched(
    shape: Shape, corner: dict[tuple[int, int], Floats], edges: dict[Edge, list[int]], sharp: set[Edge]
) -> Shape:
    """The shrunk faces, a strip along each sharp edge, and a face where strips meet."""
    index: dict[tuple[int, tuple[float, ...]], int] = {}
    points: list[Floats] = []

    def vertex(face: int, v: int) -> int:
        place = corner[face, v]
        key = (v, tuple(np.round(place, 9).tolist()))
        if key not in index:
            index[key] = len(points)
            points.append(place)
        return index[key]

    faces: Faces = [tuple(vertex(i, v) for v in face) for i, face in enumerate(shape.faces)]
    successor: dict[int, dict[int, int]] = {}
    for i, face in enumerate(shape.faces):
        for a, b in zip(face, face[1:] + face[:1], strict=True):
            if ordered(a, b) not in sharp or a > b:
                continue
            one, two = edges[a, b]
            other = two if one == i else one
            faces.append((vertex(i, b), vertex(i, a), vertex(other, a), vertex(other, b)))
            successor.setdefault(a, {})[vertex(other, a)] = vertex(i, a)
            successor.setdefault(b, {})[vertex(i, b)] = vertex(other, b)
    for follow in successor.values():
        ring = [next(iter(follow))]
        while len(ring) <= len(follow) and (following := follow.get(ring[-1])) is not None and following != ring[0]:
            ring.append(following)
        if len(ring) >= 3:
            faces.append(tuple(ring))
    tidy = [tuple(dict.fromkeys(face)) for face in faces]
    return remeshed(shape, np.array(points), (f for f in tidy if len(f) >= 3))


def solidify(shapes: Any, thickness: Any = 0.01) -> Shapes:
    """Open sheets become solid; their upper side stays."""
    depth = positive("solidify", "thickness", thickness)

    def change(shape: Shape) -> Shape:
        spend_vertices(2 * COST * shape.vertex_count)
        below = shape.vertices - vertex_normals(shape) * depth
        count = shape.vertex_count
        faces: Faces = list(shape.faces) + [tuple(v + count for v in face[::-1]) for face in shape.faces]
        edges = edge_faces(shape)
        for face in shape.faces:
            for a, b in zip(face, face[1:] + face[:1], strict=True):
                if len(edges[ordered(a, b)]) == 1:
                    faces.append((b, a, a + count, b + count))
        return remeshed(shape, np.concatenate([shape.vertices, below]), faces)

    return each("solidify", shapes, change)


def displace(shapes: Any, amount: Any = 0.01, size: Any = 0.2, seed: Any = 0) -> Shapes:
    """Bumps `amount` high and `size` wide."""
    reach = number("displace", "amount", amount, -100.0, 100.0)
    wide = positive("displace", "size", size)

    def change(shape: Shape) -> Shape:
        spend_vertices(COST * shape.vertex_count)
        x, y, z = shape.vertices.T
        bumps = ripples(seed_of(seed), x + 0.61 * z, y + 0.79 * z, wide)
        return moved("displace", shape, shape.vertices + vertex_normals(shape) * (reach * bumps)[:, None])

    return each("displace", shapes, change)


def taper(shapes: Any, factor: Any, axis: Any = "z") -> Shapes:
    """Narrower (factor below 1) or wider towards the positive end."""
    share = positive("taper", "factor", factor)
    column = AXIS_NUMBER[choice("taper", "axis", axis, ("x", "y", "z"))]
    others = [i for i in range(3) if i != column]

    def change(shape: Shape) -> Shape:
        spend_vertices(shape.vertex_count)
        points = shape.vertices.copy()
        low, high = points.min(axis=0), points.max(axis=0)
        part_of_way = (points[:, column] - low[column]) / max(float(high[column] - low[column]), 1e-12)
        middle = (low + high) / 2
        points[:, others] = (
            middle[others] + (points[:, others] - middle[others]) * (1 + (share - 1) * part_of_way)[:, None]
        )
        return moved("taper", shape, points)

    return each("taper", shapes, change)


def bend(shapes: Any, angle: Any, axis: Any = "x") -> Shapes:
    """Bent over the height: the top goes to -Y (round "x") or +X (round "y") by up to `angle` degrees.

    Shapes need several rings of vertices over their height, as from `loft` or `tube`.
    """
    total = math.radians(number("bend", "angle", angle, -359.0, 359.0))
    column = {"x": 1, "y": 0}[choice("bend", "axis", axis, ("x", "y"))]
    sign = -1.0 if column == 1 else 1.0

    def change(shape: Shape) -> Shape:
        spend_vertices(shape.vertex_count)
        points = shape.vertices.copy()
        low, tall = float(points[:, 2].min()), max(float(np.ptp(points[:, 2])), 1e-12)
        if abs(total) < 1e-6:
            return shape
        radius = tall / total
        angles = (points[:, 2] - low) / radius
        middle = float(points[:, column].min() + points[:, column].max()) / 2
        out = sign * (points[:, column] - middle)
        points[:, column] = middle + sign * (radius - (radius - out) * np.cos(angles))
        points[:, 2] = low + (radius - out) * np.sin(angles)
        return moved("bend", shape, points)

    return each("bend", shapes, change)
