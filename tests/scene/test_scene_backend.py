# SPDX-License-Identifier: GPL-3.0-or-later
"""The backend as the pipeline uses it: build, document, texts, memory, copies."""

from __future__ import annotations

import json
import runpy
from pathlib import Path
from typing import Any

import bpy
import pytest
from code_as_room.pipeline.artifacts.camera import CameraModel
from code_as_room.pipeline.artifacts.layout import Layout
from code_as_room.pipeline.artifacts.scene import SceneDocument
from code_as_room.pipeline.backend import SceneBackend
from code_as_room.pipeline.errors import OutputError, ProgramError, SceneError
from code_as_room.pipeline.program.lines import parse_layout, print_layout
from code_as_room.pipeline.scene.backend import BlenderScene
from code_as_room.pipeline.scene.measure import turn_between
from code_as_room.pipeline.scene.tags import ID, find_room_collection

CAMERA = CameraModel(kind="orthographic", matrix=(1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 9, 0, 0, 0, 1), ortho_height=6,
                     image_size=(64, 48))  # fmt: skip


@pytest.fixture
def layout(record: Any) -> Layout:
    """The bedroom as typed lines."""
    groups = ("walls", "doors", "windows", "openings", "proxies", "lights", "cameras")
    return Layout.model_validate({"room": record.room} | {name: getattr(record, name) for name in groups})


def text_block(name: str) -> Any:
    """The one text whose name starts so."""
    [block] = [t for t in bpy.data.texts if t.name.startswith(name) and "by hand" not in t.name]
    return block


def assert_same(document: SceneDocument, layout: Layout) -> None:
    """The document says what the layout says, within 1e-4 m."""
    near = {"abs": 1e-4}
    assert document.room.size == pytest.approx(layout.room.size, **near)
    assert [tuple(p) for p in document.room.floor] == [pytest.approx(p, **near) for p in layout.room.floor]
    found = {item.id: item for item in document.architecture}
    lines = [*layout.walls, *layout.doors, *layout.windows, *layout.openings]
    assert found.keys() == {line.id for line in lines}
    for line in lines:
        item = found[line.id]
        assert item.start == pytest.approx(line.start, **near), line.id
        assert item.end == pytest.approx(line.end, **near), line.id
        assert item.height == pytest.approx(line.height, **near), line.id
        assert item.sill == pytest.approx(getattr(line, "sill", 0.0), **near), line.id
        assert item.wall == getattr(line, "wall", None), line.id
    objects = {item.id: item for item in document.objects}
    assert objects.keys() == {proxy.id for proxy in layout.proxies}
    for proxy in layout.proxies:
        item = objects[proxy.id]
        assert item.centre == pytest.approx(proxy.centre, **near), proxy.id
        assert item.size == pytest.approx(proxy.size, **near), proxy.id
        assert abs(turn_between(item.yaw, proxy.yaw)) < 1e-2
        for name in ("category", "label", "placement", "parent", "salience"):
            assert getattr(item, name) == getattr(proxy, name), (proxy.id, name)


def test_program_to_scene_to_document_and_back(layout: Layout) -> None:
    scene: SceneBackend = BlenderScene()
    text = print_layout(layout)
    scene.build(text)
    assert_same(scene.scene_document("bedroom.png", CAMERA), layout)
    assert scene.program_text() == text
    assert scene.read_back() == []
    assert parse_layout(scene.program_text()).proxies == parse_layout(text).proxies


def test_room_py_alone_makes_the_same_room(layout: Layout, tmp_path: Path) -> None:
    scene = BlenderScene()
    scene.build(print_layout(layout))
    built = scene.scene_document("bedroom.png", CAMERA)
    meshes = {o.name: [tuple(v.co) for v in o.data.vertices] for o in bpy.data.objects if o.type == "MESH"}
    program = text_block("room.py").as_string()
    bpy.ops.wm.read_factory_settings(use_empty=True)
    (tmp_path / "room.py").write_text(program, encoding="utf-8")
    runpy.run_path(str(tmp_path / "room.py"), run_name="__main__")
    assert BlenderScene().scene_document("bedroom.png", CAMERA) == built
    assert {o.name: [tuple(v.co) for v in o.data.vertices] for o in bpy.data.objects if o.type == "MESH"} == meshes


def test_the_document_shows_the_scene_and_not_the_text(layout: Layout) -> None:
    scene = BlenderScene()
    scene.build(print_layout(layout))
    [bed] = [o for o in bpy.data.objects if o.get(ID) == "bed_1"]
    bed.location.x += 1
    [window] = [o for o in bpy.data.objects if o.get(ID) == "window_2"]
    window.location.y += 0.25
    document = scene.scene_document("bedroom.png", CAMERA)
    assert next(o for o in document.objects if o.id == "bed_1").centre[0] == pytest.approx(0.4)
    assert next(a for a in document.architecture if a.id == "window_2").start[1] == pytest.approx(0.45)


def test_a_refused_program_leaves_the_scene_alone(layout: Layout) -> None:
    scene = BlenderScene()
    scene.build(print_layout(layout))
    names = {o.name for o in bpy.data.objects}
    with pytest.raises(ProgramError):
        scene.build("import os\nbuild()\n")
    assert {o.name for o in bpy.data.objects} == names
    assert scene.program_text() == print_layout(layout)


def test_memory_is_kept_and_a_broken_one_is_set_aside() -> None:
    scene = BlenderScene()
    assert scene.load_memory() == ""
    first = json.dumps({"entries": ["ä" * 50] * 1000}, indent=1, ensure_ascii=False) + "\n"
    scene.save_memory(first)
    assert scene.load_memory() == first
    assert text_block("Code-as-Room Memory").use_fake_user
    text_block("Code-as-Room Memory").write("oops")
    broken = scene.load_memory()
    scene.save_memory("{}\n")
    assert scene.load_memory() == "{}\n"
    assert [t.as_string() for t in bpy.data.texts if "by hand" in t.name] == [broken]
    assert len(scene.notices) == 1


def test_memory_of_two_scenes_is_kept_apart() -> None:
    one, other = BlenderScene(), BlenderScene(bpy.data.scenes.new("other"))
    one.save_memory("1\n")
    other.save_memory("2\n")
    assert (one.load_memory(), other.load_memory()) == ("1\n", "2\n")


def test_a_line_that_would_stop_blender_is_refused() -> None:
    with pytest.raises(SceneError, match="too long"):
        BlenderScene().save_memory("x" * 100_000)


def test_a_saved_copy_holds_room_program_and_memory(layout: Layout, tmp_path: Path) -> None:
    scene = BlenderScene()
    scene.build(print_layout(layout))
    scene.save_memory("{}\n")
    [bed] = [o for o in bpy.data.objects if o.get(ID) == "bed_1"]
    bed.location.x += 0.5
    scene.save_copy(tmp_path / "room.blend")
    assert bpy.data.filepath == ""
    assert [p.name for p in tmp_path.iterdir()] == ["room.blend"]
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "room.blend"))
    again = BlenderScene()
    assert again.load_memory() == "{}\n"
    assert [(e.op, e.id) for e in again.read_back()] == [("move", "bed_1")]
    assert find_room_collection(bpy.context.scene) is not None


def test_a_copy_that_cannot_be_saved_is_told(tmp_path: Path) -> None:
    with pytest.raises(OutputError, match=r"room\.blend"):
        BlenderScene().save_copy(tmp_path / "missing" / "room.blend")
    assert list(tmp_path.iterdir()) == []
