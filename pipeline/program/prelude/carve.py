# SPDX-License-Identifier: GPL-3.0-or-later
"""Taking convex bodies away from closed ones: sinks in worktops, holes in panels, niches, handles cut into boards.

Faces are cut along the cutter's planes and put together again; corners that come to lie on a neighbour's edge are
added to that neighbour, so that what was closed stays closed.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np

from .budget import spend_vertices
from .checks import fail
from .operations import Shapes, each
from .polygons import cut_to_convex, joined_faces
from .shape import Floats, Shape, flat_shapes, remeshed
from .unwrap import face_normals

_NEAR = 1e-7  # metres: what is nearer than this is the same place
_STEP = 1e-5  # metres: how far beside a face one looks for what it bounds
_MOST_FACES = 3000
Points = list[tuple[float, ...]]


def carve(shapes: Any, cutters: Any) -> Shapes:
    """Take cutters (box, cylinder, prism, sphere) away from closed shapes: sinks, niches, holes.

    A cutter is any closed shape without hollows: a box, a cylinder, a prism, a sphere. Where it cuts through, let it
    reach beyond the surface.
    """
    knives = flat_shapes("carve", cutters)
    planes = [planes_of(knife) for knife in knives]

    def change(shape: Shape) -> Shape:
        for knife, sides in zip(knives, planes, strict=True):
            shape = without(shape, knife, sides)
        return shape

    return each("carve", shapes, change)


def planes_of(knife: Shape) -> tuple[Floats, Floats]:
    """The different planes of a cutter's faces: unit normals (N, 3) and offsets (N,)."""
    normals = face_normals(knife)
    offsets = np.array(
        [float(knife.vertices[list(f)].mean(axis=0) @ n) for f, n in zip(knife.faces, normals, strict=True)]
    )
    sizes = np.ptp(knife.vertices, axis=0)
    if len(normals) < 4 or (knife.vertices @ normals.T - offsets > 1e-4 * float(sizes.max()) + 1e-9).any():
        raise fail(
            "carve",
            "a cutter must be closed and bulge everywhere, as a box, cylinder, prism or sphere; carve twice instead",
        )
    table = np.column_stack([np.round(normals, 6), np.round(offsets, 7)])
    _, first = np.unique(table, axis=0, return_index=True)
    return normals[np.sort(first)], offsets[np.sort(first)]


def without(shape: Shape, knife: Shape, sides: tuple[Floats, Floats]) -> Shape:
    """One shape without one cutter's room."""
    low, high = knife.vertices.min(axis=0) - _NEAR, knife.vertices.max(axis=0) + _NEAR
    points = shape.vertices
    if (points.max(axis=0) < low).any() or (points.min(axis=0) > high).any():
        return shape
    if len(shape.faces) + len(knife.faces) > _MOST_FACES:
        raise fail("carve", f"shape and cutter have more than {_MOST_FACES} faces together: use fewer segments")
    spend_vertices(8 * (len(shape.faces) + len(knife.faces)))
    normals = face_normals(shape)
    kept: list[tuple[int, Points]] = []
    touched: list[int] = []
    for i, face in enumerate(shape.faces):
        corners = points[list(face)]
        if (corners.max(axis=0) < low).any() or (corners.min(axis=0) > high).any():
            kept.append((i, [tuple(p) for p in corners.tolist()]))
            continue
        outside = outside_of(corners, normals[i], sides)
        if outside is None:
            kept.append((i, [tuple(p) for p in corners.tolist()]))
        else:
            kept += [(i, piece) for piece in outside]
        touched.append(i)
    walls = inner_walls(shape, normals, touched, knife)
    kept += [(len(shape.faces) + k, piece) for k, piece in walls]
    if len(kept) == len(shape.faces) and not walls:
        return shape
    if not kept:
        raise fail("carve", "nothing is left of a shape")
    vertices, faces = joined_faces(kept)
    crease = max(shape.crease, knife.crease) if knife.smooth else shape.crease
    made = remeshed(shape, vertices, faces)
    return replace(made, smooth=shape.smooth or knife.smooth, crease=min(crease, 80.0))


def outside_of(corners: Floats, normal: Floats, sides: tuple[Floats, Floats]) -> list[Points] | None:
    """What of a face lies outside of a cutter, in convex pieces; None when all of it does."""
    found: list[Points] = []
    hit = False
    for piece in cut_to_convex(corners.tolist(), normal.tolist()):
        inside, parts = piece, []
        for plane, offset in zip(sides[0].tolist(), sides[1].tolist(), strict=True):
            inside, front = split(inside, plane, offset)
            if len(front) >= 3:
                parts.append(front)
            if len(inside) < 3:
                break
        if len(inside) >= 3:
            probe = np.mean(inside, axis=0) - _STEP * normal
            if (sides[0] @ probe - sides[1] < 0).all():
                hit = True
                found += parts
                continue
        found.append(piece)
    return found if hit else None


def split(polygon: Points, plane: list[float], offset: float) -> tuple[Points, Points]:
    """A convex polygon's part behind a plane and its part before it; either may be empty."""
    a, b, c = plane
    far = [a * p[0] + b * p[1] + c * p[2] - offset for p in polygon]
    if max(far) <= _NEAR:
        return polygon, []
    if min(far) >= -_NEAR:
        return [], polygon
    behind: Points = []
    before: Points = []
    for i, p in enumerate(polygon):
        d, j = far[i], (i + 1) % len(polygon)
        q, e = polygon[j], far[j]
        if d <= _NEAR:
            behind.append(p)
        if d >= -_NEAR:
            before.append(p)
        if (d > _NEAR and e < -_NEAR) or (d < -_NEAR and e > _NEAR):
            if (p > q) == (d > e):  # the same arithmetic from both sides, so that neighbours meet exactly
                p, q, d, e = q, p, e, d
            t = d / (d - e)
            crossing = tuple(u + (v - u) * t for u, v in zip(p, q, strict=True))
            behind.append(crossing)
            before.append(crossing)
    return behind, before


def inner_walls(shape: Shape, normals: Floats, touched: list[int], knife: Shape) -> list[tuple[int, Points]]:
    """The parts of a cutter's faces that lie inside a shape, turned over, with the number of their face."""
    corners = [shape.vertices[list(shape.faces[i])] for i in touched]
    boxes = [(c.min(axis=0) - _NEAR, c.max(axis=0) + _NEAR) for c in corners]
    triangles = fan(shape)
    found: list[tuple[int, Points]] = []
    for k, (face, normal) in enumerate(zip(knife.faces, face_normals(knife), strict=True)):
        pieces: list[Points] = [[tuple(p) for p in knife.vertices[list(face)].tolist()]]
        for i, own, (low, high) in zip(touched, corners, boxes, strict=True):
            plane, offset = normals[i].tolist(), float(own.mean(axis=0) @ normals[i])
            following: list[Points] = []
            for piece in pieces:
                at = np.array(piece)
                if (at.max(axis=0) < low).any() or (at.min(axis=0) > high).any():
                    following.append(piece)
                    continue
                following += [part for part in split(piece, plane, offset) if len(part) >= 3]
            pieces = following
            if len(pieces) > 2000:
                raise fail("carve", "the shapes cross in too many places: use fewer segments")
        spend_vertices(4 * len(pieces))
        middles = np.array([np.mean(piece, axis=0) for piece in pieces])
        beyond, within = (windings(middles + side * _STEP * normal, triangles) > 0.5 for side in (1, -1))
        for piece, inside in zip(pieces, beyond & within, strict=True):
            if inside:
                found.append((k, piece[::-1]))
    return found


def fan(shape: Shape) -> Floats:
    """Triangles of a shape's faces, (N, 3, 3). Winding numbers of flat faces do not depend on how they are cut."""
    rows = [(f[0], f[i], f[i + 1]) for f in shape.faces for i in range(1, len(f) - 1)]
    return np.asarray(shape.vertices[np.array(rows)])


def windings(points: Floats, triangles: Floats) -> Floats:
    """How often a closed surface goes round each point: 1 inside, 0 outside.

    Source: A. van Oosterom, J. Strackee, "The solid angle of a plane triangle", 1983.
    """
    a, b, c = (triangles[None, :, i] - points[:, None] for i in range(3))
    la, lb, lc = (np.linalg.norm(v, axis=2) for v in (a, b, c))
    top = np.einsum("ijk,ijk->ij", a, np.cross(b, c))
    dots = [np.einsum("ijk,ijk->ij", u, v) for u, v in ((a, b), (b, c), (c, a))]
    bottom = la * lb * lc + dots[0] * lc + dots[1] * la + dots[2] * lb
    return np.asarray(2 * np.arctan2(top, bottom).sum(axis=1) / (4 * math.pi))
