# SPDX-License-Identifier: GPL-3.0-or-later
"""Edits by hand in a real scene, through stages that run again: locked things stay bit for bit, lines stay edited."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import bpy
import pytest
from code_as_room.pipeline.artifacts.camera import CameraModel
from code_as_room.pipeline.artifacts.corrections import Corrections, ObjectCorrection
from code_as_room.pipeline.artifacts.hand import HandEdits
from code_as_room.pipeline.artifacts.layout import LayoutProgram
from code_as_room.pipeline.memory import EntryMeta, Memory, dump_memory, load_memory
from code_as_room.pipeline.program.lines import parse_layout
from code_as_room.pipeline.run import Run
from code_as_room.pipeline.scene.backend import BlenderScene
from code_as_room.pipeline.scene.tags import ID, PART, find_room_collection
from code_as_room.pipeline.stages import all_stages

FOUR = all_stages()[:4]
ANALYSIS, GRAPH, LAYOUT, AUXILIARY = FOUR


class QuickScene(BlenderScene):
    """Blender, without drawing."""

    def render(self, camera: CameraModel, long_side: int, labels: bool) -> bytes:
        return self.grey

    grey = b""


@pytest.fixture
def room(picture: Any, answers: Any, scene: Any) -> Run:
    """Everything has run, with a critic that wants to move every major object whenever it is asked."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    backend = QuickScene()
    backend.grey = scene.render(None, 256, False)
    run = Run(picture, Memory(), answers, backend)
    run.run_all(FOUR)

    def push(prompt: Any) -> dict[str, Any]:
        objects = answers.by_key["01_analysis"]["objects"]
        edits = []
        for item in objects:
            box = {k: v + (25 if k.startswith("x") else 0) for k, v in item["box"].items()}
            edits.append({"op": "move", "id": item["id"], "box": box})
        return {"score": 40, "edits": edits}

    answers.by_key["03_critique"] = push
    return run


def thing(identifier: str) -> Any:
    collection = find_room_collection(bpy.context.scene)
    [found] = [o for o in collection.all_objects if o.get(ID) == identifier and PART not in o]
    return found


def state(identifier: str) -> tuple[Any, ...]:
    bpy.context.view_layer.update()
    obj = thing(identifier)
    return tuple(map(tuple, obj.matrix_world)), tuple(tuple(v.co) for v in obj.data.vertices), obj.name, obj.data.name


def again(run: Run, *stages: Any) -> None:
    for stage in stages or (LAYOUT, AUXILIARY):
        session = run.begin(stage, fresh=True)
        while not session.finished:
            session.step()


def layout(run: Run) -> Any:
    program = run.memory.latest(LayoutProgram)
    assert program is not None
    return parse_layout(program.text)


def test_edited_objects_stay_bit_for_bit_through_every_later_stage(room: Run, tmp_path: Path) -> None:
    thing("bed").location.x += 0.1234567
    thing("bed").rotation_euler = (0.05, 0.02, 0.4321)
    thing("chair").scale = (1.1, 1.05, 0.9876543)
    thing("lamp").location.y += 0.0123456
    thing("stand").location.x += 0.0234567
    thing("art").data.vertices[0].co.z -= 0.0543219
    names = ("bed", "chair", "lamp", "art", "stand")
    before = {name: state(name) for name in names}
    again(room)
    assert {name: state(name) for name in names} == before
    again(room)
    again(room, LAYOUT)
    again(room, AUXILIARY)
    assert {name: state(name) for name in names} == before
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "room.blend"))
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "room.blend"))
    assert {name: state(name) for name in names} == before
    backend = QuickScene()
    backend.grey = room.backend.grey  # type: ignore[attr-defined]
    later = Run(room.picture, load_memory(dump_memory(room.memory)), room.client, backend)
    again(later)
    assert {name: state(name) for name in names} == before
    assert later.take_over_edits() == []


def test_an_edited_object_stays_where_its_parent_is_moved_away(room: Run) -> None:
    """Blender multiplies matrices in single precision, so only the last bits may change with another parent matrix."""
    thing("lamp").location.y += 0.0123456
    bpy.context.view_layer.update()
    before = thing("lamp").matrix_world.copy()
    again(room)
    bpy.context.view_layer.update()
    after = thing("lamp").matrix_world
    assert max(abs(a - b) for x, y in zip(before, after, strict=True) for a, b in zip(x, y, strict=True)) < 1e-6


def test_what_is_locked_without_an_edit_stays_bit_for_bit(room: Run) -> None:
    names = ("bed", "closet", "stand", "lamp")
    corrections = Corrections(objects=[ObjectCorrection(id=name, locked=True) for name in names])
    room.memory.append("artist", corrections, EntryMeta(time=""))
    before = {name: state(name) for name in names}
    again(room)
    again(room, LAYOUT)
    again(room, AUXILIARY)
    assert {name: state(name) for name in names} == before


def test_what_the_artist_put_on_a_small_thing_comes_back_with_it(room: Run) -> None:
    mesh = bpy.data.meshes.new("Cup")
    mesh.from_pydata([(0, 0, 0), (0.1, 0, 0), (0, 0.1, 0), (0, 0, 0.1)], [], [(0, 1, 2), (0, 1, 3), (1, 2, 3)])
    cup = bpy.data.objects.new("Cup", mesh)
    rug = thing("rug")
    cup.location = rug.matrix_world.translation
    cup.location.z = rug.dimensions.z
    cup.parent = rug
    cup.matrix_parent_inverse = rug.matrix_world.inverted()
    find_room_collection(bpy.context.scene).objects.link(cup)
    room.take_over_edits()
    before = state("cup")
    again(room)
    assert state("cup") == before and thing("cup").parent == thing("rug")


def test_walls_doors_and_lights_edited_by_hand_survive_later_stages(room: Run) -> None:
    thing("door_1").location.x -= 0.8
    thing("wall_w").location.x -= 0.5
    lamp = bpy.data.objects.new("Lamp", bpy.data.lights.new("Lamp", "POINT"))
    lamp.location = (0, 0, 2.3)
    find_room_collection(bpy.context.scene).objects.link(lamp)
    edits = room.take_over_edits()
    assert {(e.op, e.id) for e in edits} == {("line", "door_1"), ("line", "wall_w"), ("add", "lamp_2")}
    edited = layout_lines(parse_layout(room.backend.program_text()))
    again(room)
    assert layout_lines(layout(room)) == edited
    again(room)
    assert layout_lines(layout(room)) == edited
    bpy.data.objects.remove(thing("door_1"))
    again(room)
    assert layout(room).doors == [] and not [o for o in bpy.data.objects if o.get(ID) == "door_1"]


def layout_lines(found: Any) -> Any:
    return found.doors, sorted(found.walls, key=lambda w: w.id), found.lights


def test_what_followed_its_parent_is_not_locked_and_keeps_its_place_on_it(room: Run) -> None:
    stand, lamp = thing("stand"), thing("lamp")
    offset = lamp.matrix_world.translation - stand.matrix_world.translation
    stand.location.y -= 1.0
    edits = room.take_over_edits()
    assert {(e.id, e.origin) for e in edits} == {("stand", "artist"), ("lamp", "parent")}
    assert room.view(LAYOUT).locked == {"stand"}
    again(room)
    bpy.context.view_layer.update()
    stand, lamp = thing("stand"), thing("lamp")
    assert (lamp.matrix_world.translation - stand.matrix_world.translation - offset).length < 1e-3
    assert lamp.parent == stand


def test_findings_of_a_take_over_are_kept_with_it(room: Run) -> None:
    bpy.data.objects.remove(thing("stand"))
    room.take_over_edits()
    entry = room.memory.latest(HandEdits)
    assert entry is not None and any("lamp" in f.message for f in entry.findings)
