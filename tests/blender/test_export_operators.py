# SPDX-License-Identifier: GPL-3.0-or-later
"""The operators that export the room: the right file, the right name, a plain sentence when it cannot be."""

from __future__ import annotations

import zipfile
from collections.abc import Iterator
from pathlib import Path

import bpy
import code_as_room
import pytest
from code_as_room.pipeline.scene.backend import BlenderScene

ROOM = """
room(size=(3, 3, 2.5), floor=[(-1.5, -1.5), (1.5, -1.5), (1.5, 1.5), (-1.5, 1.5)])
wall("wall_s", (-1.5, -1.5), (1.5, -1.5), height=2.5)
proxy("bed_1", "bed", centre=(0, 0, 0.3), size=(1, 2, 0.6))
build()
"""


@pytest.fixture(autouse=True)
def add_on() -> Iterator[None]:
    bpy.ops.wm.read_factory_settings(use_empty=True)
    code_as_room.register()
    BlenderScene(bpy.context.scene).build(ROOM)
    yield
    code_as_room.unregister()


def test_the_ending_is_put_right_and_the_file_is_whole(tmp_path: Path) -> None:
    bpy.ops.code_as_room.export_glb(filepath=str(tmp_path / "my room"))
    bpy.ops.code_as_room.export_usdz(filepath=str(tmp_path / "my room.v2.usd"))
    assert {p.name for p in tmp_path.iterdir()} == {"my room.glb", "my room.v2.usdz"}
    assert (tmp_path / "my room.glb").read_bytes().startswith(b"glTF")
    with zipfile.ZipFile(tmp_path / "my room.v2.usdz") as package:
        assert any("my room.v2" in name for name in package.namelist())


def test_a_folder_that_is_not_there_is_told_in_words(tmp_path: Path) -> None:
    with pytest.raises(RuntimeError, match=r"room\.glb cannot be written: No such file or directory\. Choose another"):
        bpy.ops.code_as_room.export_glb(filepath=str(tmp_path / "gone" / "room.glb"))
    assert not list(tmp_path.iterdir())


def test_it_needs_object_mode() -> None:
    bpy.context.view_layer.objects.active = bpy.data.objects["bed_1"]
    bpy.ops.object.mode_set(mode="EDIT")
    assert not bpy.ops.code_as_room.export_glb.poll() and not bpy.ops.code_as_room.export_usdz.poll()
    bpy.ops.object.mode_set(mode="OBJECT")
    assert bpy.ops.code_as_room.export_glb.poll()


def test_a_scene_without_a_room_has_nothing_to_export() -> None:
    bpy.context.window.scene = bpy.data.scenes.new("Another")
    assert not bpy.ops.code_as_room.export_glb.poll() and not bpy.ops.code_as_room.export_usdz.poll()
