"""Writes asset libraries with Blender itself; each call leaves an empty file open."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import bmesh
import bpy

CATALOGUE = "b5c1f0a2-3d4e-4f60-9a1b-2c3d4e5f6071"


def write_library(path: Path, make: Callable[[], None] | None = None, compress: bool = False) -> Path:
    """Save a file of assets; by default with one of everything that the tests need."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    (make or all_things)()
    bpy.context.view_layer.update()
    bpy.ops.wm.save_as_mainfile(filepath=str(path), compress=compress)
    bpy.ops.wm.read_factory_settings(use_empty=True)
    return path


def all_things() -> None:
    """A lamp off its origin, a vase of two parts, an empty, an empty collection, a bed's lamp, a thing 1 km large."""
    thing("Table Lamp Brass", (0.2, 0.2, 0.4), ("lamp", "light"), "A brass lamp, schön", origin=(5.0, -3.0, 2.0))
    thing("Étagère 書架", (1.0, 0.3, 1.8), ("bookcase",))
    thing("Huge Vase", (400.0, 400.0, 1000.0), ("vase",))
    vase = bpy.data.collections.new("Clay Vases")
    bpy.context.scene.collection.children.link(vase)
    for number, name in enumerate(("UVMap", "uv_of_import")):
        part = thing(f"part {number}", (0.1, 0.16, 0.3), (), origin=(0.1 * number, 0.0, 0.0), uv=name, into=vase)
        part.data.materials.clear()
        part.data.materials.append(coloured(f"Clay {number}"))
    mark(vase, ("vase", "pot"))
    empty = bpy.data.objects.new("Reading Nook Empty", None)
    bpy.context.scene.collection.objects.link(empty)
    mark(empty, ("armchair",))
    nothing = bpy.data.collections.new("Empty Stool")
    bpy.context.scene.collection.children.link(nothing)
    mark(nothing, ("stool",))


def thing(
    name: str,
    size: tuple[float, float, float],
    tags: tuple[str, ...] | None = (),
    description: str = "",
    origin: tuple[float, float, float] = (0.0, 0.0, 0.0),
    uv: str = "UVMap",
    into: Any = None,
) -> Any:
    """A box with its middle away from its origin; marked unless it belongs to a collection."""
    mesh = bpy.data.meshes.new(name)
    work = bmesh.new()
    bmesh.ops.create_cube(work, size=1.0)
    bmesh.ops.scale(work, vec=size, verts=work.verts)
    bmesh.ops.translate(work, vec=origin, verts=work.verts)
    work.to_mesh(mesh)
    work.free()
    mesh.uv_layers.new(name=uv)
    mesh.materials.append(coloured(f"{name} paint"))
    obj = bpy.data.objects.new(name, mesh)
    (into or bpy.context.scene.collection).objects.link(obj)
    if into is None:
        mark(obj, tags or (), description)
    return obj


def coloured(name: str) -> Any:
    return bpy.data.materials.new(name)


def mark(datablock: Any, tags: tuple[str, ...], description: str = "") -> None:
    datablock.asset_mark()
    for tag in tags:
        datablock.asset_data.tags.new(tag)
    datablock.asset_data.description = description
