# SPDX-License-Identifier: GPL-3.0-or-later
"""The operators of the panel Views: which cameras there are, looking through one, pictures of all of them."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import bpy
import code_as_room
import pytest
from code_as_room.operators import render_ops
from code_as_room.pipeline.scene import shoot
from code_as_room.pipeline.scene.backend import BlenderScene
from PIL import Image

ROOM = """
room(size=(3, 3, 2.5), floor=[(-1.5, -1.5), (1.5, -1.5), (1.5, 1.5), (-1.5, 1.5)])
wall("wall_s", (-1.5, -1.5), (1.5, -1.5), height=2.5)
light("light_1", "area", at=(0, 0, 2.4), energy=60, size=2)
view("view", exposure=0.5, ceiling=2.5)
camera("reference", "perspective", matrix=(1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 6, 0, 0, 0, 1), fov_y=0.7, image_size=(400, 300))
camera("top", "orthographic", matrix=(1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 6, 0, 0, 0, 1), ortho_height=4, image_size=(400, 400))
build()
"""


@pytest.fixture(autouse=True)
def add_on(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """An empty Blender with the add-on, and a room with two cameras in a saved file."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    code_as_room.register()
    monkeypatch.setattr(shoot, "PREVIEW", 48)
    BlenderScene(bpy.context.scene).build(ROOM)
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "home.blend"))
    yield
    code_as_room.unregister()


def test_all_views_are_rendered_beside_the_file(tmp_path: Path) -> None:
    before = {name: len(getattr(bpy.data, name)) for name in ("scenes", "objects", "meshes", "worlds", "cameras")}
    bpy.ops.code_as_room.render_views()
    folder = tmp_path / "home views"
    assert {p.name for p in folder.iterdir()} == {"reference.png", "top.png"}
    assert Image.open(folder / "reference.png").size == (48, 36)
    assert Image.open(folder / "top.png").size == (48, 48)
    assert {name: len(getattr(bpy.data, name)) for name in before} == before
    assert render_ops.folder_of(bpy.context.scene) == folder


def test_one_view_alone_and_one_that_is_not_there(tmp_path: Path) -> None:
    bpy.ops.code_as_room.render_views(camera="top")
    assert {p.name for p in (tmp_path / "home views").iterdir()} == {"top.png"}
    with pytest.raises(RuntimeError, match="no camera nowhere"):
        bpy.ops.code_as_room.render_views(camera="nowhere")


def test_looking_through_a_view_takes_its_camera_and_its_shape() -> None:
    scene: Any = bpy.context.scene
    bpy.ops.code_as_room.show_view(camera="top")
    assert scene.camera.name == "top" and scene.render.resolution_x == scene.render.resolution_y
    bpy.ops.code_as_room.show_view(camera="reference")
    assert scene.camera.name == "reference" and scene.render.resolution_x > scene.render.resolution_y


def test_without_a_room_the_buttons_say_why() -> None:
    bpy.ops.wm.read_factory_settings(use_empty=True)
    with pytest.raises(RuntimeError, match="no cameras yet"):
        bpy.ops.code_as_room.render_views()
    with pytest.raises(RuntimeError, match="no cameras yet"):
        bpy.ops.code_as_room.show_view(camera="top")


def test_a_scene_that_a_broken_off_render_left_is_taken_away() -> None:
    shoot.set_stage(bpy.context.scene, "top", 32, "CYCLES")
    bpy.ops.wm.save_mainfile()
    bpy.ops.wm.open_mainfile(filepath=bpy.data.filepath)
    assert len(bpy.data.scenes) == 1


def test_the_panel_offers_every_view_once_there_is_one() -> None:
    from types import SimpleNamespace

    from code_as_room.panels.views import CODE_AS_ROOM_PT_views

    said: list[tuple[str, str]] = []

    class Row:
        def row(self, align: bool = False) -> Row:
            return self

        column = row

        def operator(self, name: str, **more: Any) -> Any:
            said.append((name, str(more.get("text", ""))))
            return SimpleNamespace()

        def prop(self, owner: Any, name: str, **more: Any) -> None:
            assert name in owner.bl_rna.properties

        def label(self, **more: Any) -> None:
            said.append(("label", str(more.get("text", ""))))

        def separator(self, **more: Any) -> None:
            return

    CODE_AS_ROOM_PT_views.draw_state(SimpleNamespace(), Row(), bpy.context, None)  # type: ignore[arg-type]
    assert ("code_as_room.show_view", "As in the picture") in said and ("code_as_room.show_view", "From above") in said
    assert [name for name, _ in said].count("code_as_room.render_views") == 3
    bpy.ops.wm.read_factory_settings(use_empty=True)
    said.clear()
    CODE_AS_ROOM_PT_views.draw_state(SimpleNamespace(), Row(), bpy.context, None)  # type: ignore[arg-type]
    assert said and {name for name, _ in said} == {"label"}
