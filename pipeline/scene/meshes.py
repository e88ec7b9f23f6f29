# SPDX-License-Identifier: GPL-3.0-or-later
"""Shapes to Blender meshes, by array writes only (no operators), and how to tell that an artist edited one."""

from __future__ import annotations

import hashlib
from typing import Any

import numpy as np

from ..program.prelude.looks import Look
from .arrays import MeshArrays
from .slots import artists_slots, put_artists_slots, write_slots
from .tags import DIGEST, FINGERPRINT


def mesh_fingerprint(mesh: Any) -> str:
    """A short digest of a mesh's vertices and faces as they stand."""
    points = np.empty(3 * len(mesh.vertices), dtype=np.float32)
    corners = np.empty(len(mesh.loops), dtype=np.int32)
    if mesh.is_editmode:  # its attributes are then with the edit mesh
        mesh.vertices.foreach_get("co", points)
        mesh.loops.foreach_get("vertex_index", corners)
    else:
        _read(mesh, "position", "vector", points)
        _read(mesh, ".corner_vert", "value", corners)
    digest = hashlib.sha1((points + np.float32(0.0)).tobytes(), usedforsecurity=False)
    digest.update(corners.tobytes())
    return digest.hexdigest()[:20]


def is_hand_made(mesh: Any) -> bool:
    """Whether the mesh is not what we wrote: the artist edited or replaced it."""
    return bool(mesh.get(FINGERPRINT) != mesh_fingerprint(mesh))


def write_arrays(mesh: Any, arrays: MeshArrays, family: str, digest: str, looks: dict[str, Look] | None = None) -> None:
    """Replace the mesh's geometry and material slots by these arrays; the datablock stays the same.

    A material that the artist put into a slot stays with the role that the slot was for. `looks`: those of finishes, by key.
    """
    own = artists_slots(mesh)
    mesh.clear_geometry()
    write_slots(mesh, arrays.roles, family, looks or {})
    put_artists_slots(mesh, own)
    _write_geometry(mesh, arrays)
    if mesh.polygons:
        _write(mesh, "material_index", "INT", "FACE", arrays.slots)
        _write(mesh, "sharp_face", "BOOLEAN", "FACE", ~arrays.smooth)
        _write_parts(mesh, arrays)
        layer = mesh.uv_layers.new(name="UVMap", do_init=False)
        layer.uv.foreach_set("vector", arrays.uvs.ravel())
    mesh.update(calc_edges=True)
    mesh.validate()
    _write_sharp(mesh, arrays.sharp)
    mesh[DIGEST] = digest
    mesh[FINGERPRINT] = mesh_fingerprint(mesh)


def _write_geometry(mesh: Any, arrays: MeshArrays) -> None:
    """Vertices, faces and loose edges."""
    if len(arrays.edges):
        faces = [face.tolist() for face in np.split(arrays.corners, arrays.starts[1:])] if len(arrays.starts) else []
        mesh.from_pydata(arrays.points.tolist(), arrays.edges.tolist(), faces)
        return
    mesh.vertices.add(len(arrays.points))
    if len(arrays.points):
        mesh.attributes["position"].data.foreach_set("vector", arrays.points.ravel())
    mesh.loops.add(len(arrays.corners))
    if len(arrays.corners):
        mesh.attributes[".corner_vert"].data.foreach_set("value", arrays.corners)
    mesh.polygons.add(len(arrays.starts))
    if len(arrays.starts):
        mesh.polygons.foreach_set("loop_start", arrays.starts)


def _write_sharp(mesh: Any, sharp: Any) -> None:
    """Mark the edges that stay sharp: Blender numbers the edges itself, so they are found by their vertices."""
    if not len(sharp):
        return
    ends = np.empty(2 * len(mesh.edges), dtype=np.int32)
    _read(mesh, ".edge_verts", "value", ends)
    pairs = np.sort(ends.reshape(-1, 2), axis=1).astype(np.int64)
    count = len(mesh.vertices)
    wanted = sharp[:, 0].astype(np.int64) * count + sharp[:, 1]
    _write(mesh, "sharp_edge", "BOOLEAN", "EDGE", np.isin(pairs[:, 0] * count + pairs[:, 1], wanted))


def _read(mesh: Any, name: str, field: str, values: Any) -> None:
    """Fill an array from a mesh's attribute, which is hundreds of times faster than from its vertices and loops."""
    if len(values):
        mesh.attributes[name].data.foreach_get(field, values)


def _write(mesh: Any, name: str, kind: str, domain: str, values: Any) -> None:
    """Write an attribute of one value each, made where it is missing."""
    attribute = mesh.attributes.get(name) or mesh.attributes.new(name, kind, domain)
    attribute.data.foreach_set("value", values)


def _write_parts(mesh: Any, arrays: MeshArrays) -> None:
    """Which named part each face belongs to: a face attribute "part" that counts the names in a custom property."""
    _write(mesh, "part", "INT", "FACE", arrays.parts)
    mesh["code_as_room_parts"] = list(arrays.part_names)
