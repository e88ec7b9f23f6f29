# SPDX-License-Identifier: GPL-3.0-or-later
"""Shapes and boxes as objects of the open Blender scene, with materials and the attribute that textures follow."""

from __future__ import annotations

import math
import zlib
from collections.abc import Mapping, Sequence
from typing import Any

import bpy
import numpy as np
from code_as_room.pipeline.program.prelude.shape import Floats, Shape

from .materials import GRAIN, ROLES, material
from .model import Item

Faces = Sequence[tuple[int, ...]]


def add_mesh(name: str, points: Floats, faces: Faces, texts: Sequence[str], slots: Sequence[int]) -> Any:
    """An object with flat faces; `texts` are its materials, `slots` the material's number of each face."""
    mesh: Any = bpy.data.meshes.new(name)
    mesh.from_pydata(points.tolist(), [], list(faces))
    for text in texts:
        mesh.materials.append(material(text))
    mesh.polygons.foreach_set("material_index", list(slots))
    obj = bpy.data.objects.new(name, mesh)
    bpy.context.scene.collection.objects.link(obj)
    return obj


def add_item(item: Item, shapes: Sequence[Shape], roles: Mapping[str, str]) -> Any:
    """The item at its place; `roles` are the room's materials by role."""
    looks = {**ROLES, **roles}
    if "*" in item.colours:
        looks = dict.fromkeys(looks, item.colours["*"])
    looks |= item.colours
    texts: list[str] = []
    points, grain, faces, slots, smooth, start = [], [], [], [], [], 0
    for number, shape in enumerate(shapes):
        text = looks.get(shape.material, looks[""])
        if text not in texts:
            texts.append(text)
        points.append(shape.vertices)
        grain.append(_grain(shape.vertices, f"{item.id} {number}"))
        faces += [tuple(i + start for i in face) for face in shape.faces]
        slots += [texts.index(text)] * len(shape.faces)
        smooth += [shape.smooth] * len(shape.faces)
        start += shape.vertex_count
    obj = add_mesh(item.id, np.concatenate(points), faces, texts, slots)
    mesh = obj.data
    mesh.polygons.foreach_set("use_smooth", smooth)
    mesh.set_sharp_from_angle(angle=math.radians(35))
    mesh.attributes.new(GRAIN, "FLOAT_VECTOR", "POINT").data.foreach_set("vector", np.concatenate(grain).ravel())
    obj.location = (item.x, item.y, item.base or 0.0)
    obj.rotation_euler = (0, 0, math.radians(item.yaw))
    return obj


def _grain(points: Floats, seed: str) -> Floats:
    """The part's points with its longest side first, moved to a place of its own in the texture."""
    order = np.argsort(-np.round(np.ptp(points, axis=0), 4), kind="stable")
    key = zlib.crc32(seed.encode())
    shift = np.array([key % 997, key // 997 % 991, key // 7 % 983]) / 50
    moved: Floats = points[:, order] + shift
    return moved


def add_box(name: str, low: Sequence[float], high: Sequence[float], text: str, yaw: float = 0.0, at: Any = None) -> Any:
    """A box from corner to corner, turned by `yaw` about its origin and moved to `at`."""
    corners = np.array([[x, y, z] for z in (low[2], high[2]) for x, y in _around(low, high)], dtype=float)
    obj = add_mesh(name, corners, BOX, [text], [0] * 6)
    obj.rotation_euler = (0, 0, math.radians(yaw))
    obj.location = at or (0, 0, 0)
    give_grain(obj)
    return obj


def _around(low: Sequence[float], high: Sequence[float]) -> list[tuple[float, float]]:
    return [(low[0], low[1]), (high[0], low[1]), (high[0], high[1]), (low[0], high[1])]


BOX: Faces = [(3, 2, 1, 0), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7)]


def give_grain(obj: Any) -> None:
    """The texture attribute for an object that was not made of shapes."""
    mesh = obj.data
    points = np.array([v.co[:] for v in mesh.vertices])
    mesh.attributes.new(GRAIN, "FLOAT_VECTOR", "POINT").data.foreach_set("vector", _grain(points, obj.name).ravel())
