# SPDX-License-Identifier: GPL-3.0-or-later
"""Shapes to Blender meshes, by array writes only (no operators), and how to tell that an artist edited one."""

from __future__ import annotations

import hashlib
from typing import Any

import numpy as np

from .arrays import MeshArrays
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


def write_arrays(mesh: Any, arrays: MeshArrays, family: str, digest: str) -> None:
    """Replace the mesh's geometry and material slots by these arrays; the datablock stays the same."""
    mesh.clear_geometry()
    mesh.materials.clear()
    for role in arrays.roles:
        mesh.materials.append(ensure_material(family, role))
    _write_geometry(mesh, arrays)
    if mesh.polygons:
        mesh.polygons.foreach_set("material_index", arrays.slots)
        mesh.polygons.foreach_set("use_smooth", arrays.smooth)
        _write_parts(mesh, arrays)
        if arrays.uvs is not None:
            layer = mesh.uv_layers.new(name="UVMap", do_init=False)
            layer.uv.foreach_set("vector", arrays.uvs.ravel())
    mesh.update(calc_edges=True)
    mesh.validate()
    mesh[DIGEST] = digest
    mesh[FINGERPRINT] = mesh_fingerprint(mesh)


def _write_geometry(mesh: Any, arrays: MeshArrays) -> None:
    """Vertices, faces and loose edges."""
    if len(arrays.edges):
        faces = [face.tolist() for face in np.split(arrays.corners, arrays.starts[1:])] if len(arrays.starts) else []
        mesh.from_pydata(arrays.points.tolist(), arrays.edges.tolist(), faces)
        return
    mesh.vertices.add(len(arrays.points))
    mesh.vertices.foreach_set("co", arrays.points.ravel())
    mesh.loops.add(len(arrays.corners))
    mesh.loops.foreach_set("vertex_index", arrays.corners)
    mesh.polygons.add(len(arrays.starts))
    if len(arrays.starts):
        mesh.polygons.foreach_set("loop_start", arrays.starts)


def _write_parts(mesh: Any, arrays: MeshArrays) -> None:
    """Which named part each face belongs to: a face attribute "part" that counts the names in a custom property."""
    attribute = mesh.attributes.new("part", "INT", "FACE")
    attribute.data.foreach_set("value", arrays.parts)
    mesh["code_as_room_parts"] = list(arrays.part_names)
