# SPDX-License-Identifier: GPL-3.0-or-later
"""room.py edited in the Text Editor and applied: the scene follows, a mistake is shown at its line, nothing is lost."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import bpy
import code_as_room
import pytest
from code_as_room.operators import driver, room_memory
from code_as_room.pipeline.artifacts.hand import HandEdits
from code_as_room.pipeline.program.assemble import room_part
from code_as_room.pipeline.scene.backend import BlenderScene
from code_as_room.pipeline.scene.tags import ID, find_room_collection
from PIL import Image

ROOM = """\
room(size=(5, 4, 2.6), floor=[(-2.5, -2), (2.5, -2), (2.5, 2), (-2.5, 2)])
wall("wall_s", (-2.5, -2), (2.5, -2), height=2.6)
window("window_1", wall="wall_s", start=(-1, -2), end=(0, -2), sill=0.9, height=1.2)
proxy("bed_1", "double bed", centre=(-0.6, 0.6, 0.3), size=(1.7, 2, 0.6))
proxy("chair_1", "chair", centre=(1.7, -1.1, 0.45), size=(0.5, 0.5, 0.9))
build()
"""


@pytest.fixture
def scene(tmp_path: Path) -> Iterator[Any]:
    """A scene with a picture and a room."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    code_as_room.register()
    path = tmp_path / "room.png"
    Image.new("RGB", (120, 100), "tan").save(path)
    bpy.ops.code_as_room.load_picture(filepath=str(path))
    BlenderScene().build(ROOM)
    yield bpy.context.scene
    code_as_room.unregister()


def block() -> Any:
    [found] = [t for t in bpy.data.texts if t.name.startswith("room.py") and "by hand" not in t.name]
    return found


def edit(before: str, after: str) -> None:
    above, marker, room = block().as_string().partition("# ==== room ====\n")
    assert room.count(before) == 1
    block().from_string(above + marker + room.replace(before, after))


def thing(identifier: str) -> Any:
    room = find_room_collection(bpy.context.scene)
    return next((o for o in room.all_objects if o.get(ID) == identifier and "code_as_room_part" not in o), None)


def taken(scene: Any) -> HandEdits:
    found = room_memory.run_of(scene).memory.latest(HandEdits)
    assert found is not None
    return found


def locked(scene: Any) -> frozenset[str]:
    return room_memory.run_of(scene)._locked()


def apply() -> None:
    bpy.ops.code_as_room.apply_program()


def test_only_an_edited_text_can_be_applied(scene: Any) -> None:
    poll: Any = bpy.ops.code_as_room.apply_program.poll
    assert not poll()
    edit("centre=(-0.6,", "centre=(-0.4,")
    assert poll()
    apply()
    assert not poll()


def test_numbers_lines_and_functions_of_the_text_take_effect_and_are_locked(scene: Any) -> None:
    edit("centre=(-0.6,", "centre=(-0.4,")
    edit("sill=0.9", "sill=1.0")
    edit("build()\n", 'proxy("rug_1", "rug", centre=(0, 0, 0.01), size=(2, 1, 0.02))\n\n\ndef seat():  # my chair\n'
         '    return [part("seat", box((0.5, 0.5, 0.1), at=(0, 0, 0.4)), material="wood")]\n\n\n'
         'furnish("chair_1", seat())\nbuild()\n')  # fmt: skip
    text = block().as_string()
    apply()
    assert room_part(block().as_string()) == room_part(text), "not a byte of the artist's text changes"
    assert "\ndef box(" not in text and "\ndef box(" in block().as_string(), "what it uses now is above it"
    assert thing("bed_1").location.x == pytest.approx(-0.4)
    assert thing("rug_1") is not None and len(thing("chair_1").data.vertices) == 8
    assert {(e.op, e.id) for e in taken(scene).edits} == {("line", "window_1"), ("move", "bed_1"), ("add", "rug_1")}
    assert {"window_1", "bed_1", "rug_1"} <= locked(scene)
    assert "3 edits taken over" in driver.outcome_of(scene).text
    assert BlenderScene().read_back() == []


@pytest.mark.parametrize(
    ("before", "after", "words"),
    [
        ("size=(1.7, 2, 0.6)", "size=(1.7, -2, 0.6)", "positive"),
        ("size=(1.7, 2, 0.6))", "size=(1.7, 2, 0.6)", "never closed"),
        ('proxy("bed_1"', 'import os\nproxy("bed_1"', "import"),
        ('proxy("bed_1"', 'furnish("nobody", box((1, 1, 1)))\nproxy("bed_1"', "nobody"),
        ('wall="wall_s"', 'wall="wall_x"', "wall_x"),
    ],
)
def test_a_mistake_is_shown_at_its_line_and_changes_nothing(scene: Any, before: str, after: str, words: str) -> None:
    places = {o.name: o.matrix_world.copy() for o in bpy.data.objects}
    edit(before, after)
    text = block().as_string()
    with pytest.raises(RuntimeError, match=words) as problem:
        apply()
    assert {o.name: o.matrix_world for o in bpy.data.objects} == places
    assert block().as_string() == text and driver.outcome_of(scene).problem is not None
    lines = text.splitlines()
    marker = lines.index("# ==== room ====")
    if "Line" in str(problem.value):
        told = int(str(problem.value).split("Line ")[1].split(" ")[0])
        assert block().current_line_index == told - 1 > marker
    edit(after, before)
    with pytest.raises(RuntimeError):
        apply()  # nothing is left to apply


def test_the_line_that_is_told_is_the_line_of_the_whole_text(scene: Any) -> None:
    edit("size=(1.7, 2, 0.6)", "size=(1.7, -2, 0.6)")
    number = next(n for n, line in enumerate(block().as_string().splitlines(), 1) if "-2, 0.6)" in line)
    with pytest.raises(RuntimeError, match=f"Line {number} of room.py"):
        apply()
    assert block().current_line_index == number - 1


def test_edits_of_text_and_scene_are_both_kept_and_the_text_wins_a_conflict(scene: Any) -> None:
    thing("bed_1").location.x = 1.0
    thing("chair_1").location.y = -0.5
    edit("centre=(-0.6,", "centre=(-0.4,")
    apply()
    assert thing("bed_1").location.x == pytest.approx(-0.4)
    assert thing("chair_1").location.y == pytest.approx(-0.5)
    assert "centre=(1.7, -0.5, 0.45)" in block().as_string()
    assert [f.about for f in taken(scene).findings] == ["bed_1"]
    assert BlenderScene().read_back() == [] and not bpy.ops.code_as_room.apply_program.poll()
    assert not [t for t in bpy.data.texts if "by hand" in t.name]


def test_a_new_id_in_the_text_keeps_the_object(scene: Any) -> None:
    bed = thing("bed_1")
    bed.modifiers.new("Bevel", "BEVEL")
    edit('"bed_1"', '"grand_bed"')
    apply()
    assert [(e.op, e.new_id) for e in taken(scene).edits] == [("rename", "grand_bed")]
    assert thing("grand_bed") == bed and len(bed.modifiers) == 1


def test_a_stage_that_writes_the_program_anew_keeps_the_former_one(scene: Any) -> None:
    edit("build()\n", "def extra():\n    return []\n\n\nbuild()\n")
    apply()
    backend = BlenderScene()
    backend.build(ROOM)
    [kept] = [t for t in bpy.data.texts if "by hand" in t.name]
    assert "def extra" in kept.as_string() and any(kept.name in notice for notice in backend.notices)


def test_edits_above_the_room_are_set_aside(scene: Any) -> None:
    block().from_string("# mine\n" + block().as_string().replace("centre=(-0.6,", "centre=(-0.4,"))
    apply()
    assert thing("bed_1").location.x == pytest.approx(-0.4)
    assert not block().as_string().startswith("# mine")
    [kept] = [t for t in bpy.data.texts if "by hand" in t.name]
    assert kept.as_string().startswith("# mine")


def test_objects_of_the_artists_are_added_to_the_room(scene: Any) -> None:
    poll: Any = bpy.ops.code_as_room.add_to_room.poll
    mesh = bpy.data.meshes.new("Crate")
    mesh.from_pydata([(0, 0, 0), (0.4, 0, 0), (0, 0.4, 0), (0, 0, 0.4)], [], [(0, 1, 2), (0, 1, 3), (1, 2, 3)])
    crate, lid = bpy.data.objects.new("Crate", mesh), bpy.data.objects.new("Lid", mesh)
    lid.parent = crate
    for obj in (crate, lid):
        scene.collection.objects.link(obj)
    for obj in scene.objects:
        obj.select_set(False)
    assert not poll() and BlenderScene().read_back() == []
    crate.select_set(True)
    bpy.ops.code_as_room.add_to_room()
    assert [(e.op, e.id) for e in BlenderScene().read_back()] == [("add", "crate")]
    assert not poll() and lid.users_collection == crate.users_collection
