# SPDX-License-Identifier: GPL-3.0-or-later
"""The room as one file for other programs: glTF (.glb) and USD (.usdz), with names, materials, lights and cameras.

What a render of the scene shows is what is written, but for what is there for pictures alone (the section of cut walls).
The scene is as it was before when the export ends, however it ends, and the file is whole or not there.
"""

from __future__ import annotations

import contextlib
import functools
import os
import re
import secrets
import shutil
import struct
import zipfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import bpy

from ..errors import OutputError, SceneError
from ..program.prelude.enclosure import CEILING, SECTION
from .compat import quiet
from .plain_materials import plain_materials
from .tags import KIND, find_room_collection

_MENDS = "Choose another folder, or make room."


def lacks_glb() -> str:
    """Why this Blender cannot export glTF, "" when it can. No I/O."""
    return "" if hasattr(bpy.types, "EXPORT_SCENE_OT_gltf") else "Blender's own glTF add-on is switched off"


@functools.cache
def lacks_usd() -> str:
    """As `lacks_glb`, for USD; some Linux distributions build Blender without it."""
    return "" if "usd_export" in dir(bpy.ops.wm) else "This Blender was built without USD"


def export_glb(scene: Any, path: Path) -> Path:
    """Write the room as binary glTF: one file with everything in it, metres, Y up.

    Returns:
        The file, which ends in .glb whatever was asked for.

    Raises:
        SceneError: there is no room, or this Blender cannot export glTF now.
        OutputError: the file cannot be written; one that was there before still is.
    """
    if lacks_glb():
        raise SceneError(f"{lacks_glb()}.", 'Switch on "glTF 2.0 format" under Preferences, Add-ons.')
    with _part_of(path.with_suffix(".glb")) as part, _exported(scene) as collection, plain_materials():
        bpy.ops.export_scene.gltf(
            filepath=str(part), check_existing=False, export_format="GLB", collection=collection.name,
            export_apply=True, export_cameras=True, export_lights=True, export_animations=False,
        )  # fmt: skip
    return path.with_suffix(".glb")


def export_usdz(scene: Any, path: Path) -> Path:
    """Write the room as USD in one package with its images: preview surfaces, metres, Z up.

    Returns, Raises: as `export_glb`; the file ends in .usdz.
    """
    if lacks_usd():
        raise SceneError(f"{lacks_usd()}.", "Export glTF, or use Blender from blender.org.")
    with _part_of(path.with_suffix(".usdz")) as part, _exported(scene) as collection, plain_materials(True):
        bpy.ops.wm.usd_export(
            filepath=str(part), check_existing=False, collection=collection.name, export_custom_properties=False,
            convert_world_material=False, export_animation=False, evaluation_mode="RENDER", merge_parent_xform=True,
        )  # fmt: skip
    return path.with_suffix(".usdz")


@contextlib.contextmanager
def _exported(scene: Any) -> Iterator[Any]:
    """A collection with what is to be exported, which no scene shows; ceilings are seen through from above."""
    if find_room_collection(scene) is None:
        raise SceneError("There is no room in this scene yet.", "Run the stages first.")
    hidden = {c for c in scene.collection.children_recursive if c.hide_render}
    shown = [
        obj
        for obj in scene.objects
        if not obj.hide_render and obj.get(KIND) != SECTION and not hidden.issuperset(obj.users_collection)
    ]
    collection = bpy.data.collections.new("Code-as-Room Export")
    with contextlib.ExitStack() as undo:
        undo.callback(bpy.data.collections.remove, collection)
        for obj in shown:
            collection.objects.link(obj)
            for slot in obj.material_slots if obj.get(KIND) == CEILING else ():
                if slot.material is not None and slot.material.library is None:
                    undo.callback(setattr, slot.material, "use_backface_culling", slot.material.use_backface_culling)
                    slot.material.use_backface_culling = True
        yield collection


@contextlib.contextmanager
def _part_of(path: Path) -> Iterator[Path]:
    """Where to write a file first, in a folder beside its place; it is put there when the block ends well and it is whole.

    It has its own name from the start, since USD names what is inside a package by it.
    """
    folder = path.with_name(f".part-{secrets.token_hex(4)}")
    try:
        if path.is_dir():
            raise IsADirectoryError(0, "a folder of that name is in its place")
        folder.mkdir()  # tells of a missing or read-only folder before anything is worked out
        with quiet():
            yield folder / path.name
        if not _is_whole(folder / path.name):
            raise OSError(0, "Blender could not write all of it")
        os.replace(folder / path.name, path)
    except (OSError, RuntimeError) as problem:
        raise OutputError(f"{path.name} cannot be written: {_reason(problem)}.", _MENDS) from problem
    finally:
        shutil.rmtree(folder, ignore_errors=True)


def _is_whole(part: Path) -> bool:
    """Whether an exporter wrote all of a file: some return as if nothing was wrong when the disk is full."""
    if not part.is_file():
        return False
    if part.suffix == ".glb":
        with part.open("rb") as file:
            head = file.read(12)
        return len(head) == 12 and head[:4] == b"glTF" and struct.unpack("<I", head[8:])[0] == part.stat().st_size
    try:
        with zipfile.ZipFile(part) as package:
            return bool(package.namelist()) and package.testzip() is None
    except (zipfile.BadZipFile, EOFError):
        return False


def _reason(problem: Exception) -> str:
    """Why, in a few words: an exporter's error holds a whole traceback."""
    if isinstance(problem, OSError):
        return problem.strerror or str(problem)
    said = re.search(r"\[Errno \d+\] ([^:\n]+)", str(problem))
    if said is not None:
        return said.group(1)
    lines = [line.strip() for line in str(problem).splitlines() if line.strip() and not line.startswith("Location:")]
    return (lines[-1] if lines else "Blender's exporter failed")[:200].rstrip(".")
