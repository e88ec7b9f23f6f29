# SPDX-License-Identifier: GPL-3.0-or-later
"""What nobody did is not read, and two rooms in one file stay two."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import bpy
import pytest
from code_as_room.pipeline.artifacts.layout import LayoutEdit
from code_as_room.pipeline.program.evaluate import evaluate
from code_as_room.pipeline.program.lines import parse_layout
from code_as_room.pipeline.program.patch import patch_text
from code_as_room.pipeline.scene.backend import BlenderScene
from code_as_room.pipeline.scene.tags import ID, find_room_collection

ROOM = """\
room(size=(5, 4, 2.6), floor=[(-2.5, -2), (2.5, -2), (2.5, 2), (-2.5, 2)])
wall("wall_s", (-2.5, -2), (2.5, -2), height=2.6)
wall("wall_e", (2.5, -2), (2.5, 2), height=2.6)
window("window_1", wall="wall_e", start=(2.5, -0.5), end=(2.5, 0.5))
proxy("bed_1", "double bed", centre=(-0.6, 0.6, 0.3), size=(1.7, 2, 0.6), yaw=30)
proxy("nightstand_1", "nightstand", centre=(0.9, 1.2, 0.275), size=(0.5, 0.45, 0.55))
proxy("lamp_1", "table lamp", centre=(0.9, 1.25, 0.775), size=(0.3, 0.3, 0.45), placement="surface", \
parent="nightstand_1", salience="minor", shape="round")
proxy("chair_1", "chair", centre=(1.7, -1.1, 0.45), size=(0.5, 0.5, 0.9), yaw=350)

def chair():
    return [part("leg", box((0.1, 0.1, 0.4), at=(x, 0, 0.2)), material="wood") for x in (-0.1, 0.1)]

furnish("chair_1", chair())
light("sun_1", "sun", at=(0, 0, 5), energy=3)
camera("reference", "perspective", matrix=(1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 6, 0, 0, 0, 1), fov_y=1)
build()
"""


@pytest.fixture
def scene(empty_blender: None) -> BlenderScene:
    backend = BlenderScene()
    backend.build(ROOM)
    bpy.context.view_layer.update()
    return backend


def room() -> Any:
    return find_room_collection(bpy.context.scene)


def thing(identifier: str) -> Any:
    [found] = [o for o in room().all_objects if o.get(ID) == identifier and "code_as_room_part" not in o]
    return found


def edits_of(scene: BlenderScene) -> list[LayoutEdit]:
    bpy.context.view_layer.update()
    first, second = scene.read_back(), scene.read_back()
    assert first == second
    return first


def settle(scene: BlenderScene) -> Any:
    """Take the edits over; afterwards there are none. Returns the layout that stands then."""
    text, findings = patch_text(scene.program_text(), scene.read_back())
    assert not [f for f in findings if f.severity == "warning"], findings
    evaluate(text)
    scene.build(text)
    bpy.context.view_layer.update()
    assert scene.read_back() == []
    return parse_layout(scene.program_text())


def test_save_load_and_scene_copies_are_no_edits(scene: BlenderScene, tmp_path: Path) -> None:
    path = str(tmp_path / "room.blend")
    thing("bed_1").scale = (1.1, 1, 1)
    thing("nightstand_1").location.x += 0.3
    settle(scene)
    bpy.ops.wm.save_as_mainfile(filepath=path)
    bpy.ops.wm.open_mainfile(filepath=path)
    again = BlenderScene()
    assert again.read_back() == []
    again.build(again.program_text())
    assert again.read_back() == []
    bpy.ops.scene.new(type="FULL_COPY")
    copied = BlenderScene()
    assert copied.scene != again.scene and copied.read_back() == []
    bpy.ops.wm.read_factory_settings(use_empty=True)
    with bpy.data.libraries.load(path) as (source, into):
        into.collections = [name for name in source.collections if name.startswith("Code-as-Room")]
    bpy.context.scene.collection.children.link(into.collections[0])
    assert BlenderScene().read_back() == []


def test_units_frames_and_view_layers_are_no_edits(scene: BlenderScene) -> None:
    units = bpy.context.scene.unit_settings
    units.system, units.scale_length = "IMPERIAL", 0.01
    bpy.context.scene.frame_set(40)
    bpy.context.scene.view_layers.new("Other")
    thing("bed_1").select_set(True)
    thing("bed_1").color = (1, 0, 0, 1)
    thing("bed_1").display_type = "WIRE"
    assert edits_of(scene) == []


def test_undo_and_redo_are_no_edits(scene: BlenderScene) -> None:
    bpy.ops.ed.undo_push(message="built")
    thing("bed_1").location.x += 0.5
    bpy.ops.ed.undo_push(message="moved")
    settle(BlenderScene())
    bpy.ops.ed.undo_push(message="taken over")
    bpy.ops.ed.undo()
    again = BlenderScene()
    assert [(e.op, e.id) for e in again.read_back()] == [("move", "bed_1")], (
        "the take-over was undone, the move was not"
    )
    bpy.ops.ed.undo()
    assert BlenderScene().read_back() == []
    bpy.ops.ed.redo()
    bpy.ops.ed.redo()
    assert BlenderScene().read_back() == []


def test_two_scenes_keep_two_rooms_apart(scene: BlenderScene) -> None:
    first = bpy.context.scene
    other = BlenderScene(bpy.data.scenes.new("Other"))
    other.build(ROOM)
    theirs = find_room_collection(other.scene)
    bed = next(o for o in theirs.all_objects if o.get(ID) == "bed_1")
    before = {o.name: (tuple(map(tuple, o.matrix_basis)), o.data) for o in find_room_collection(first).all_objects}
    bed.location.x += 0.5
    bed.data.vertices[0].co.z -= 0.1
    text, _ = patch_text(other.program_text(), other.read_back())
    other.build(text)
    other.build(text.replace('proxy("bed_1"', 'proxy("bed_9"'))
    other.build(text)
    assert scene.read_back() == [] and scene.program_text() == ROOM and other.program_text() == text
    now = {o.name: (tuple(map(tuple, o.matrix_basis)), o.data) for o in find_room_collection(first).all_objects}
    assert now == before
    assert bed.name in theirs.all_objects


def test_a_linked_copy_of_the_scene_reads_its_own_room_once(scene: BlenderScene) -> None:
    """Objects in two collections of the room are one object each."""
    extra = bpy.data.collections.new("Favourites")
    room().children.link(extra)
    extra.objects.link(thing("bed_1"))
    assert edits_of(scene) == []
    thing("bed_1").location.x += 0.2
    assert len(edits_of(scene)) == 1
