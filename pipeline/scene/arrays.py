# SPDX-License-Identifier: GPL-3.0-or-later
"""Shapes as the arrays that a Blender mesh is written from: everything about a mesh that needs no Blender."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from ..program.prelude.shape import Shape


@dataclass(frozen=True)
class MeshArrays:
    """One mesh made of several shapes, one after the other.

    Attributes:
        points: (N, 3) float32, metres in the object's frame.
        corners: the vertex of each face corner; starts: the first corner of each face.
        edges: loose edges, (E, 2).
        slots, smooth, parts: material slot, shading and index into `part_names` of each face.
        roles: the material roles, slot by slot.
        uvs: (corners, 2) in metres, None when no shape brings any.
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


def mesh_arrays(shapes: list[Shape]) -> MeshArrays:
    """The arrays of these shapes; any thread."""
    offsets = np.cumsum([0, *(len(s.vertices) for s in shapes)])
    points = np.concatenate([s.vertices for s in shapes]) if shapes else np.zeros((0, 3))
    roles = tuple(dict.fromkeys(shape.material for shape in shapes if shape.faces))
    names = tuple(dict.fromkeys(shape.part for shape in shapes))
    counts = [len(s.faces) for s in shapes]
    lengths = [len(face) for s in shapes for face in s.faces]
    corners = [v + int(start) for s, start in zip(shapes, offsets, strict=False) for face in s.faces for v in face]
    edges = [
        (a + int(start), b + int(start))
        for s, start in zip(shapes, offsets, strict=False)
        for a, b in s.extra.get("edges", ())
    ]
    slots = [roles.index(s.material) if s.faces else 0 for s in shapes]
    return MeshArrays(
        points=points.astype(np.float32),
        corners=np.array(corners, dtype=np.int32),
        starts=np.cumsum([0, *lengths])[:-1].astype(np.int32),
        edges=np.array(edges, dtype=np.int32).reshape(-1, 2),
        slots=np.repeat(slots, counts).astype(np.int32),
        smooth=np.repeat([bool(s.smooth) for s in shapes], counts).astype(bool),
        parts=np.repeat([names.index(s.part) for s in shapes], counts).astype(np.int32),
        roles=roles,
        part_names=names,
        uvs=_uvs(shapes),
    )


def _uvs(shapes: list[Shape]) -> Any:
    """UV coordinates of all corners when any shape brings them; the others get zeros."""
    if all(shape.uvs is None for shape in shapes):
        return None
    rows = []
    for shape in shapes:
        corners = sum(len(face) for face in shape.faces)
        rows.append(np.zeros((corners, 2)) if shape.uvs is None else np.asarray(shape.uvs).reshape(corners, 2))
    return np.concatenate(rows).astype(np.float32)
