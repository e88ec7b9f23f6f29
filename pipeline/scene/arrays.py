# SPDX-License-Identifier: GPL-3.0-or-later
"""Shapes as the arrays that a Blender mesh is written from: everything about a mesh that needs no Blender."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..program.prelude.shape import Shape
from ..program.prelude.unwrap import corner_uvs, face_normals


@dataclass(frozen=True)
class MeshArrays:
    """One mesh made of several shapes, one after the other.

    Attributes:
        points: (N, 3) float32, metres in the object's frame.
        corners: the vertex of each face corner; starts: the first corner of each face.
        edges: loose edges, (E, 2).
        slots, smooth, parts: material slot, shading and index into `part_names` of each face.
        roles: the material roles, slot by slot.
        uvs: (corners, 2) in metres.
        sharp: edges that stay sharp between faces that are shaded smooth, (E, 2), the lower vertex first.
    """

    points: Any
    corners: Any
    starts: Any
    edges: Any
    slots: Any
    smooth: Any
    parts: Any
    roles: tuple[str, ...]
    part_names: tuple[str, ...]
    uvs: Any
    sharp: Any


def mesh_arrays(shapes: list[Shape], unwrap: bool = True, furniture: bool = False) -> MeshArrays:
    """The arrays of these shapes; any thread. Without `unwrap` the UVs, which take longest, are all 0.

    The shapes of `furniture` are drawn `apart`.
    """
    offsets = np.cumsum([0, *(len(s.vertices) for s in shapes)])
    last = len(shapes) - 1
    points = [
        apart(s.vertices, last - n) if furniture and len(s.vertices) else s.vertices for n, s in enumerate(shapes)
    ]
    roles = tuple(dict.fromkeys(shape.material for shape in shapes if shape.faces))
    names = tuple(dict.fromkeys(shape.part for shape in shapes))
    flat = [s.corners for s in shapes]
    counts = [len(lengths) for _, lengths in flat]
    lengths = np.concatenate([np.zeros(0, dtype=np.int64), *(lengths for _, lengths in flat)])
    corners = [found + start for (found, _), start in zip(flat, offsets, strict=False)]
    edges = [
        (a + int(start), b + int(start))
        for s, start in zip(shapes, offsets, strict=False)
        for a, b in s.extra.get("edges", ())
    ]
    sharp = [sharp_edges(s) + start for s, start in zip(shapes, offsets, strict=False)]
    slots = [roles.index(s.material) if s.faces else 0 for s in shapes]
    return MeshArrays(
        points=np.concatenate([np.zeros((0, 3)), *points]).astype(np.float32),
        corners=np.concatenate([np.zeros(0, dtype=np.int64), *corners]).astype(np.int32),
        starts=(np.cumsum(lengths) - lengths).astype(np.int32),
        edges=np.array(edges, dtype=np.int32).reshape(-1, 2),
        slots=np.repeat(slots, counts).astype(np.int32),
        smooth=np.repeat([bool(s.smooth) for s in shapes], counts).astype(bool),
        parts=np.repeat([names.index(s.part) for s in shapes], counts).astype(np.int32),
        roles=roles,
        part_names=names,
        uvs=np.concatenate(
            [
                np.zeros((0, 2)),
                *(corner_uvs(s) if unwrap else np.zeros((len(c), 2)) for s, (c, _) in zip(shapes, flat, strict=True)),
            ]
        ).astype(np.float32),
        sharp=np.concatenate([np.zeros((0, 2), dtype=np.int64), *sharp]).astype(np.int32),
    )


def apart(points: Any, number: int) -> Any:
    """Points (N, 3) drawn in by up to 0.75 mm: boards that lie in one plane, and layers in one place, render black there.

    Args:
        number: of the shape, counted from the mesh's last; what comes later lies over what comes before.
    """
    away = (points.max(0) + points.min(0)) / 2 - points
    return points + away * np.minimum(number % 16 * 1e-4 / (np.ptp(points, 0) + 1e-9), 0.05)


def sharp_edges(shape: Shape) -> Any:
    """The edges of a shape shaded smooth whose faces meet at more than its crease angle, (E, 2)."""
    corners, lengths = shape.corners
    if not shape.smooth or shape.crease >= 179.9 or not len(corners):
        return np.zeros((0, 2), dtype=np.int64)
    starts = np.cumsum(lengths) - lengths
    ahead = np.arange(1, len(corners) + 1)
    ahead[starts + lengths - 1] = starts
    low, high = np.minimum(corners, corners[ahead]), np.maximum(corners, corners[ahead])
    keys = low * len(shape.vertices) + high
    order = np.argsort(keys, kind="stable")
    same = keys[order[:-1]] == keys[order[1:]]
    face = np.repeat(np.arange(len(lengths)), lengths)
    normals = face_normals(shape)
    one, other = order[:-1][same], order[1:][same]
    turned = np.einsum("ij,ij->i", normals[face[one]], normals[face[other]])
    found = one[turned < math.cos(math.radians(shape.crease))]
    return np.stack([low[found], high[found]], axis=1)
