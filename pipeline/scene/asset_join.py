# SPDX-License-Identifier: GPL-3.0-or-later
"""Many meshes as one, with their materials, UVs and sharp edges; no operators."""

from __future__ import annotations

from typing import Any

import bmesh
import bpy
import numpy as np

UV = "UVMap"


def joined(meshes: list[Any], name: str) -> Any:
    """One mesh of all of these, in one frame already. They are used up: the first may be the result itself.

    Each material has one slot. The UV layers that are drawn get one name, so that textures find them on every part.
    """
    for mesh in meshes:
        _one_name_for_uvs(mesh)
    if len(meshes) == 1:
        meshes[0].name = name
        return meshes[0]
    materials: list[Any] = []
    work = bmesh.new()
    try:
        for mesh in meshes:
            _renumber(mesh, materials)
            work.from_mesh(mesh)
        result = bpy.data.meshes.new(name)
        work.to_mesh(result)
    finally:
        work.free()
    for material in materials:
        result.materials.append(material)
    bpy.data.batch_remove(meshes)
    return result


def _renumber(mesh: Any, materials: list[Any]) -> None:
    """Let a mesh's faces count the slots of the whole."""
    own = list(mesh.materials) or [None]
    for material in own:
        if material not in materials:
            materials.append(material)
    count = len(mesh.polygons)
    if not count:
        return
    slots = np.zeros(count, dtype=np.int32)
    mesh.polygons.foreach_get("material_index", slots)
    table = np.array([materials.index(material) for material in own], dtype=np.int32)
    mesh.polygons.foreach_set("material_index", table[np.clip(slots, 0, len(own) - 1)])


def _one_name_for_uvs(mesh: Any) -> None:
    drawn = next((layer for layer in mesh.uv_layers if layer.active_render), None)
    if drawn is None or drawn.name == UV:
        return
    name, other = drawn.name, mesh.uv_layers.get(UV)
    if other is not None:
        other.name = f"{UV} 2"
    mesh.uv_layers[name].name = UV
