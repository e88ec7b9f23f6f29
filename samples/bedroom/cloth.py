"""Cloth simulated in Blender and baked to a plain mesh: the duvet, the throw and the pillows."""

from __future__ import annotations

from collections.abc import Sequence

import bpy
import numpy as np
from shapes import Array, Part


def temporary(part: Part, name: str) -> bpy.types.Object:
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(part.verts.tolist(), [], part.faces)
    obj = bpy.data.objects.new(name, mesh)
    bpy.context.scene.collection.objects.link(obj)
    return obj


def evaluated_verts(obj: bpy.types.Object) -> tuple[Array, list[tuple[int, ...]]]:
    """World vertices and faces of an object with its modifiers."""
    depsgraph = bpy.context.evaluated_depsgraph_get()
    final = obj.evaluated_get(depsgraph)
    mesh = final.to_mesh()
    verts = np.empty(len(mesh.vertices) * 3)
    mesh.vertices.foreach_get("co", verts)
    faces = [tuple(p.vertices) for p in mesh.polygons]
    final.to_mesh_clear()
    matrix = np.array(obj.matrix_world)
    return verts.reshape(-1, 3) @ matrix[:3, :3].T + matrix[:3, 3], faces


def simulate(
    sheet: Part,
    obstacles: Sequence[Part],
    frames: int,
    *,
    pressure: float = 0.0,
    gravity: float = 1.0,
    stiffness: float = 12.0,
    bending: float = 0.6,
    mass: float = 0.3,
    shrink: float = 0.0,
    distance: float = 0.012,
) -> Array:
    """Vertices of the sheet after `frames` frames of falling onto the obstacles (or of being blown up)."""
    scene = bpy.context.scene
    cloth = temporary(sheet, "cloth")
    others = [temporary(p, "obstacle") for p in obstacles]
    for obj in others:
        obj.modifiers.new("Collision", "COLLISION")
        obj.collision.thickness_outer = distance
        obj.collision.cloth_friction = 25.0
    modifier = cloth.modifiers.new("Cloth", "CLOTH")
    modifier.point_cache.frame_end = frames + 1
    settings = modifier.settings
    settings.quality = 7
    settings.mass = mass
    settings.tension_stiffness = settings.compression_stiffness = stiffness
    settings.shear_stiffness = stiffness / 2
    settings.bending_stiffness = bending
    settings.shrink_min = shrink
    settings.effector_weights.gravity = gravity
    settings.use_pressure = pressure > 0
    settings.uniform_pressure_force = pressure
    modifier.collision_settings.distance_min = distance
    modifier.collision_settings.use_collision = bool(others)
    modifier.collision_settings.collision_quality = 3
    for frame in range(1, frames + 1):
        scene.frame_set(frame)
    verts, _ = evaluated_verts(cloth)
    for obj in [cloth, *others]:
        mesh = obj.data
        bpy.data.objects.remove(obj)
        bpy.data.meshes.remove(mesh)
    scene.frame_set(1)
    return verts


def thicken(part: Part, thickness: float, smooth: int = 1) -> Part:
    """The sheet with a thickness (outwards) and smoothed, as a plain mesh. Keeps the texture coordinates."""
    obj = temporary(part, "thick")
    if part.uv is not None:
        layer = obj.data.uv_layers.new(name="UVMap")
        index = np.empty(len(obj.data.loops), int)
        obj.data.loops.foreach_get("vertex_index", index)
        layer.data.foreach_set("uv", part.uv[index].ravel())
    solid = obj.modifiers.new("Solidify", "SOLIDIFY")
    solid.thickness, solid.offset = thickness, 1.0
    if smooth:
        sub = obj.modifiers.new("Subdivision", "SUBSURF")
        sub.levels = sub.render_levels = smooth
    depsgraph = bpy.context.evaluated_depsgraph_get()
    final = obj.evaluated_get(depsgraph)
    mesh = final.to_mesh()
    verts = np.empty(len(mesh.vertices) * 3)
    mesh.vertices.foreach_get("co", verts)
    faces = [tuple(p.vertices) for p in mesh.polygons]
    uv = None
    if part.uv is not None:
        index = np.empty(len(mesh.loops), int)
        mesh.loops.foreach_get("vertex_index", index)
        corner = np.empty(len(mesh.loops) * 2)
        mesh.uv_layers[0].data.foreach_get("uv", corner)
        uv = np.zeros((len(mesh.vertices), 2))
        uv[index] = corner.reshape(-1, 2)
    final.to_mesh_clear()
    data = obj.data
    bpy.data.objects.remove(obj)
    bpy.data.meshes.remove(data)
    return Part(verts.reshape(-1, 3), faces, part.material, uv=uv, name=part.name)
