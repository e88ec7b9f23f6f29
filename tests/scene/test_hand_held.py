# SPDX-License-Identifier: GPL-3.0-or-later
"""What the artist edited stays bit for bit: matrices and vertices are compared with ==, datablocks by identity."""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import bpy
import pytest
from code_as_room.pipeline.program.lines import parse_layout, print_layout
from code_as_room.pipeline.program.patch import patch_text
from code_as_room.pipeline.scene.backend import BlenderScene
from code_as_room.pipeline.scene.tags import ID, find_room_collection
from mathutils import Matrix

HEAD = """\
room(size=(5, 4, 2.6), floor=[(-2.5, -2), (2.5, -2), (2.5, 2), (-2.5, 2)])
wall("wall_s", (-2.5, -2), (2.5, -2), height=2.6)
proxy("bed_1", "double bed", centre=(-0.6, 0.6, 0.3), size=(1.7, 2, 0.6), yaw=33.3)
proxy("nightstand_1", "nightstand", centre=(0.9, 1.2, 0.275), size=(0.5, 0.45, 0.55), yaw=10)
"""
SMALL = """\
proxy("lamp_1", "table lamp", centre=(0.9, 1.25, 0.775), size=(0.3, 0.3, 0.45), placement="surface", \
parent="nightstand_1", salience="minor", shape="round")
proxy("rug_1", "rug", centre=(0.2, -1, 0.005), size=(1, 0.6, 0.01), salience="minor")
"""
ROOM = HEAD + SMALL + "build()\n"


@pytest.fixture
def scene(empty_blender: None) -> BlenderScene:
    backend = BlenderScene()
    backend.build(ROOM)
    return backend


def thing(identifier: str) -> Any:
    """The object of the room with this id."""
    room = find_room_collection(bpy.context.scene)
    [found] = [o for o in room.all_objects if o.get(ID) == identifier]
    return found


def state(obj: Any) -> tuple[Any, ...]:
    """Everything that must not change by a bit."""
    bpy.context.view_layer.update()
    vertices = tuple(tuple(v.co) for v in obj.data.vertices) if obj.type == "MESH" else ()
    place = tuple(tuple(row) for row in obj.matrix_world)
    own = (tuple(obj.location), tuple(obj.rotation_euler), tuple(obj.scale))
    return place, own, vertices


def take_over(scene: BlenderScene) -> str:
    """As the driver does; there is nothing to read afterwards."""
    text, findings = patch_text(scene.program_text(), scene.read_back())
    assert not [f for f in findings if f.severity == "warning"]
    scene.build(text)
    assert scene.read_back() == []
    return text


def without_small(text: str) -> str:
    """The program as a layout stage builds it before the small things are placed."""
    layout = parse_layout(text)
    return print_layout(layout.model_copy(update={"proxies": [p for p in layout.proxies if p.salience == "major"]}))


def move(obj: Any) -> None:
    obj.location.x += 0.1234567
    obj.rotation_euler.z += 0.1234567


def scale(obj: Any) -> None:
    obj.scale = (1.1234567, 0.912345, 1.2345678)


def tilt(obj: Any) -> None:
    obj.rotation_euler = (0.31, 0.2, 0.7654321)
    obj.location.z += 0.3


def mirror(obj: Any) -> None:
    obj.scale.x = -1.0


def upside_down(obj: Any) -> None:
    obj.matrix_basis = (
        obj.matrix_basis @ Matrix.Translation((0, 0, obj.dimensions.z)) @ Matrix.Rotation(math.pi, 4, "X")
    )


def edit_mesh(obj: Any) -> None:
    for vertex in obj.data.vertices:
        vertex.co.x *= 1.0654321
    obj.data.vertices[4].co.z += 0.0765432


def apply_rotation(obj: Any) -> None:
    obj.data.transform(Matrix.Rotation(obj.rotation_euler.z, 4, "Z"))
    obj.rotation_euler.z = 0.0
    obj.location.x += 0.0511111


@pytest.mark.parametrize("identifier", ["bed_1", "lamp_1"])
@pytest.mark.parametrize("change", [move, scale, tilt, mirror, upside_down, edit_mesh, apply_rotation])
def test_an_edited_object_stays_exact(
    scene: BlenderScene, change: Callable[[Any], None], identifier: str, tmp_path: Path
) -> None:
    obj = thing(identifier)
    change(obj)
    before, data = state(obj), obj.data
    text = take_over(scene)
    assert state(obj) == before
    scene.build(without_small(text))  # a new layout has no small things yet
    scene.build(text)
    assert thing(identifier) == obj and obj.data == data
    assert state(obj) == before
    assert scene.read_back() == []
    moved = text.replace('proxy("rug_1", "rug", centre=(0.2,', 'proxy("rug_1", "rug", centre=(0.3,')
    assert moved != text
    scene.build(moved)
    assert state(obj) == before
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "room.blend"))
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "room.blend"))
    again = BlenderScene()
    assert state(thing(identifier)) == before
    assert again.read_back() == []
    again.build(without_small(moved))
    again.build(moved)
    assert state(thing(identifier)) == before


def test_what_the_artist_added_survives_a_layout_without_it(scene: BlenderScene, tmp_path: Path) -> None:
    mesh = bpy.data.meshes.new("Vase")
    mesh.from_pydata([(0, 0, 0), (0.1, 0, 0), (0.1, 0.1, 0.2), (0, 0.1, 0.2)], [], [(0, 1, 2, 3)])
    vase = bpy.data.objects.new("Vase", mesh)
    vase.location = (-0.6, 0.6, 0.6)
    vase.modifiers.new("Solid", "SOLIDIFY")
    find_room_collection(bpy.context.scene).objects.link(vase)
    before = state(vase)
    text = take_over(scene)
    assert state(vase) == before
    scene.build(HEAD + "build()\n")
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "room.blend"))
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "room.blend"))
    room = find_room_collection(bpy.context.scene)
    assert not [o for o in room.all_objects if o.name == "Vase"]
    again = BlenderScene()
    assert again.read_back() == []
    again.build(text)
    assert state(thing("vase")) == before and len(thing("vase").modifiers) == 1
    assert again.read_back() == []


def test_a_room_that_nobody_edited_leaves_nothing_behind(scene: BlenderScene) -> None:
    scene.build(HEAD + "build()\n")
    assert not [o for o in bpy.data.objects if o.get(ID) in ("lamp_1", "rug_1")]
    assert "lamp_1" not in bpy.data.meshes


def test_own_material_modifier_and_constraint_survive_a_new_layout(scene: BlenderScene) -> None:
    rug, lamp = thing("rug_1"), thing("lamp_1")
    rug.data.materials[0] = bpy.data.materials.new("Persian")
    lamp.modifiers.new("Bevel", "BEVEL")
    scene.build(HEAD + "build()\n")
    scene.build(ROOM)
    assert thing("rug_1") == rug and rug.data.materials[0].name == "Persian"
    assert thing("lamp_1") == lamp and len(lamp.modifiers) == 1 and lamp.parent == thing("nightstand_1")


def test_a_held_object_follows_its_line_when_that_changes(scene: BlenderScene) -> None:
    bed = thing("bed_1")
    tilt(bed)
    text = take_over(scene)
    height = bed.matrix_world.translation.z
    line = next(x for x in text.splitlines() if x.startswith('proxy("bed_1"'))
    x = float(line.split("centre=(")[1].split(",")[0])
    scene.build(text.replace(f"centre=({x:g},", f"centre=({x + 0.5:g},"))
    bpy.context.view_layer.update()
    assert bed.rotation_euler.x == pytest.approx(0.31, abs=1e-5), "it is still tipped over"
    assert bed.matrix_world.translation.z == pytest.approx(height, abs=1e-4)
    assert scene.read_back() == []


def test_a_held_object_gets_the_colour_of_its_new_category(scene: BlenderScene) -> None:
    bed = thing("bed_1")
    scale(bed)
    text = take_over(scene)
    before = state(bed)
    scene.build(text.replace('"double bed"', '"sofa"'))
    assert state(bed) == before
    assert bed.data.materials[0].name == "Room seating"


def test_removed_by_hand_is_removed_for_good(scene: BlenderScene) -> None:
    lamp = thing("lamp_1")
    move(lamp)
    take_over(scene)
    bpy.data.objects.remove(thing("lamp_1"))
    take_over(scene)
    assert not [o for o in bpy.data.objects if o.get(ID) == "lamp_1"]
