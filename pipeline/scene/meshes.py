# SPDX-License-Identifier: GPL-3.0-or-later
"""Shapes to Blender meshes, by array writes only (no operators), and how to tell that an artist edited one."""

from __future__ import annotations

import hashlib
from typing import Any

import numpy as np

from ..program.prelude.shape import Shape
from .materials import ensure_material
from .tags import DIGEST, FINGERPRINT


def mesh_fingerprint(mesh: Any) -> str:
    """A short digest of a mesh's vertices and faces as they stand."""
    points = np.empty(3 * len(mesh.vertices), dtype=np.float32)
    corners = np.empty(len(mesh.loops), dtype=np.int32)
    mesh.vertices.foreach_get("co", points)
    mesh.loops.foreach_get("vertex_index", corners)
    digest = hashlib.sha1((points + np.float32(0.0)).tobytes(), usedforsecurity=False)
    digest.update(corners.tobytes())
    return digest.hexdigest()[:20]


def is_hand_made(mesh: Any) -> bool:
    """Whether the mesh is not what we wrote: the artist edited or replaced it."""
    return bool(mesh.get(FINGERPRINT) != mesh_fingerprint(mesh))


def write_shapes(mesh: Any, shapes: list[Shape], family: str, digest: str) -> None:
    """Replace the mesh's geometry and material slots by these shapes; the datablock stays the same."""
    mesh.clear_geometry()
    mesh.materials.clear()
    roles = list(dict.fromkeys(shape.material for shape in shapes if shape.faces))
    for role in roles:
        mesh.materials.append(ensure_material(family, role))
    _write_geometry(mesh, shapes)
    if mesh.polygons:
        slots = [roles.index(s.material) for s in shapes for _ in s.faces]
        mesh.polygons.foreach_set("material_index", np.array(slots, dtype=np.int32))
        mesh.polygons.foreach_set("use_smooth", np.array([s.smooth for s in shapes for _ in s.faces], dtype=bool))
        _write_parts(mesh, shapes)
        _write_uvs(mesh, shapes)
    mesh.update(calc_edges=True)
    mesh.validate()
    mesh[DIGEST] = digest
    mesh[FINGERPRINT] = mesh_fingerprint(mesh)


def _write_geometry(mesh: Any, shapes: list[Shape]) -> None:
    """Vertices, faces and loose edges of all shapes, one after the other."""
    offsets = np.cumsum([0, *(len(s.vertices) for s in shapes)])
    points = np.concatenate([s.vertices for s in shapes]).astype(np.float32) if shapes else np.zeros((0, 3), np.float32)
    faces = [[v + int(start) for v in face] for s, start in zip(shapes, offsets, strict=False) for face in s.faces]
    edges = [
        [v + int(start) for v in edge]
        for s, start in zip(shapes, offsets, strict=False)
        for edge in s.extra.get("edges", ())
    ]
    if edges:
        mesh.from_pydata(points.tolist(), edges, faces)
        return
    mesh.vertices.add(len(points))
    mesh.vertices.foreach_set("co", points.ravel())
    lengths = [len(face) for face in faces]
    mesh.loops.add(sum(lengths))
    mesh.loops.foreach_set("vertex_index", np.array([v for face in faces for v in face], dtype=np.int32))
    mesh.polygons.add(len(faces))
    if faces:
        mesh.polygons.foreach_set("loop_start", np.cumsum([0, *lengths[:-1]]).astype(np.int32))


def _write_parts(mesh: Any, shapes: list[Shape]) -> None:
    """Which named part each face belongs to: a face attribute "part" that counts the names in a custom property."""
    names = list(dict.fromkeys(shape.part for shape in shapes))
    attribute = mesh.attributes.new("part", "INT", "FACE")
    values = [names.index(s.part) for s in shapes for _ in s.faces]
    attribute.data.foreach_set("value", np.array(values, dtype=np.int32))
    mesh["code_as_room_parts"] = names


def _write_uvs(mesh: Any, shapes: list[Shape]) -> None:
    """A UV map in metres when any shape brings one; the others get zeros."""
    if all(shape.uvs is None for shape in shapes):
        return
    rows = []
    for shape in shapes:
        corners = sum(len(face) for face in shape.faces)
        rows.append(np.zeros((corners, 2)) if shape.uvs is None else np.asarray(shape.uvs).reshape(corners, 2))
    layer = mesh.uv_layers.new(name="UVMap", do_init=False)
    layer.uv.foreach_set("vector", np.concatenate(rows).astype(np.float32).ravel())
