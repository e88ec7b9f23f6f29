# SPDX-License-Identifier: GPL-3.0-or-later
"""Stand-ins for a picture: copies of meshes with shaded colours, so that every face reads and no wall hides the floor.

Workbench's own lights turn some walls black or tint them, and brighten others; what the critic and the artist compare
must have the palette's colours on every upper face. So each face gets its material's viewport colour times a shade
that depends only on where it faces, and Workbench draws it flat, with its cavity and outlines.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import bmesh
import bpy
import numpy as np

from .compat import ensure_node_tree
from .tags import world_matrix

_SHADE = "code_as_room_shade"
_DEFAULT_COLOUR = (0.4, 0.4, 0.4)
_SIDE_LIGHT = np.array((-0.05, -0.06, 0.0))  # vertical faces to the south and west are a little lighter


def painted_copy(obj: Any, made: list[Any], kerb: float | None = None) -> Any:
    """A copy of a mesh object in its place, with shaded vertex colours; cut down to `kerb` metres where given.

    New datablocks are appended to `made`, objects before their meshes, for the caller to remove.
    """
    mesh = obj.data.copy()
    copy = bpy.data.objects.new("Code-as-Room Capture", mesh)
    made.extend([copy, mesh])
    matrix = world_matrix(obj)
    copy.matrix_basis = matrix
    if kerb is not None:
        _cut(mesh, kerb)
    _paint(mesh, np.array(matrix, dtype=float)[:3, :3])
    return copy


def glowing_material(objects: Iterable[Any]) -> Any:
    """Let painted copies shine with their colours, for a renderer that knows no flat light; returns the material."""
    material = bpy.data.materials.new("Code-as-Room Capture")
    tree = ensure_node_tree(material)
    tree.nodes.clear()
    colour, light, output = (tree.nodes.new(f"ShaderNode{n}") for n in ("VertexColor", "Emission", "OutputMaterial"))
    colour.layer_name = _SHADE
    tree.links.new(colour.outputs["Color"], light.inputs["Color"])
    tree.links.new(light.outputs["Emission"], output.inputs["Surface"])
    for obj in objects:
        obj.data.materials.clear()
        obj.data.materials.append(material)
    return material


def _paint(mesh: Any, rotation: Any) -> None:
    """Write the colour of each face to a new active colour attribute."""
    count = len(mesh.polygons)
    if not count:
        return
    slots = np.empty(count, dtype=np.int32)
    mesh.polygons.foreach_get("material_index", slots)
    palette = [m.diffuse_color[:3] if m is not None else _DEFAULT_COLOUR for m in mesh.materials] or [_DEFAULT_COLOUR]
    paint_faces(mesh, np.array(palette)[np.clip(slots, 0, len(palette) - 1)], rotation)


def paint_faces(mesh: Any, colours: Any, rotation: Any) -> None:
    """Give each face its linear colour (faces, 3), shaded by where it faces in the room, as the active colour attribute."""
    count = len(mesh.polygons)
    normals, totals = np.empty(3 * count, dtype=np.float32), np.empty(count, dtype=np.int32)
    mesh.polygons.foreach_get("normal", normals)
    mesh.polygons.foreach_get("loop_total", totals)
    facing = normals.reshape(-1, 3) @ np.linalg.pinv(rotation)  # normals turn by the inverse transpose
    facing /= np.maximum(np.linalg.norm(facing, axis=1, keepdims=True), 1e-9)
    rgba = np.concatenate([colours * _shade(facing)[:, None], np.ones((count, 1))], axis=1).astype(np.float32)
    attribute = mesh.color_attributes.new(_SHADE, "FLOAT_COLOR", "CORNER")
    attribute.data.foreach_set("color", np.repeat(rgba, totals, axis=0).ravel())
    mesh.color_attributes.active_color = attribute


def _shade(facing: Any) -> Any:
    """Factor on linear colour for unit normals: 1 for faces that look up, less for upright ones, least from below."""
    bright = 0.87 + 0.13 * facing[:, 2] + facing @ _SIDE_LIGHT
    return np.clip(bright, 0.5, 1.0) ** 2.2


def _cut(mesh: Any, height: float) -> None:
    """Cut off everything above a height (in the mesh's own frame) and close the cut."""
    work = bmesh.new()
    work.from_mesh(mesh)
    everything = [*work.verts, *work.edges, *work.faces]
    cut = bmesh.ops.bisect_plane(
        work, geom=everything, plane_co=(0.0, 0.0, height), plane_no=(0.0, 0.0, 1.0), clear_outer=True
    )["geom_cut"]
    rim = [item for item in cut if isinstance(item, bmesh.types.BMEdge)]
    for face in bmesh.ops.holes_fill(work, edges=rim)["faces"] if rim else []:
        face.normal_update()
        if face.normal.z < 0:
            face.normal_flip()
    work.to_mesh(mesh)
    work.free()
