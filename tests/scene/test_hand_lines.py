# SPDX-License-Identifier: GPL-3.0-or-later
"""Walls, doors, windows, openings, lights and cameras changed by hand become their layout lines."""

from __future__ import annotations

import math
from typing import Any

import bpy
import pytest
from code_as_room.pipeline.artifacts.layout import Layout, LayoutEdit
from code_as_room.pipeline.program.lines import parse_layout, parse_line
from code_as_room.pipeline.program.patch import patch_text
from code_as_room.pipeline.scene.backend import BlenderScene
from code_as_room.pipeline.scene.tags import ID, PART, find_room_collection

ROOM = """\
room(size=(5, 4, 2.6), floor=[(-2.5, -2), (2.5, -2), (2.5, 2), (-2.5, 2)])
wall("wall_s", (-2.5, -2), (2.5, -2), height=2.6)
wall("wall_e", (2.5, -2), (2.5, 2), height=2.6)
wall("wall_n", (2.5, 2), (-2.5, 2), height=2.6)
wall("wall_w", (-2.5, 2), (-2.5, -2), height=2.6)
wall("divider", (0.5, -2), (0.5, 0), height=2.4, thickness=0.1, partition=True)
door("door_1", wall="wall_s", start=(-1.9, -2), end=(-1.05, -2), height=2.05, open=30)
door("door_2", wall="wall_n", start=(-1.9, 2), end=(-1.05, 2), height=2.05, open=0)
window("window_1", wall="wall_w", start=(-2.5, 0.6), end=(-2.5, -0.6), sill=0.85, height=1.3)
opening("opening_1", wall="divider", start=(0.5, -1.2), end=(0.5, -0.4), height=2.1)
proxy("art_1", "picture", centre=(2.48, 0, 1.5), size=(0.8, 0.03, 0.6), yaw=270, placement="wall", parent="wall_e")
light("lamp_1", "point", at=(0, 1, 2), energy=40, color=(1, 0.85, 0.7))
light("sun_1", "sun", at=(0, 0, 5), energy=3, target=(1, 0, 0))
light("panel_1", "area", at=(1, 1, 2.5), energy=60, size=0.5)
camera("reference", "perspective", matrix=(1, 0, 0, 0.1, 0, 0.992546, 0.121869, -0.2, 0, -0.121869, 0.992546, 6.5, \
0, 0, 0, 1), fov_y=0.8, image_size=(800, 640), principal=(520, 470))
camera("corner", "perspective", matrix=(1, 0, 0, 2, 0, 1, 0, 2, 0, 0, 1, 3, 0, 0, 0, 1), fov_y=1)
build()
"""


@pytest.fixture
def scene(empty_blender: None) -> BlenderScene:
    backend = BlenderScene()
    backend.build(ROOM)
    return backend


def thing(identifier: str, part: str = "") -> Any:
    [found] = [o for o in bpy.data.objects if o.get(ID) == identifier and o.get(PART, "") == part]
    return found


def edits_of(scene: BlenderScene) -> list[LayoutEdit]:
    """What is read, twice, since reading must not change what is read."""
    bpy.context.view_layer.update()
    first, second = scene.read_back(), scene.read_back()
    assert first == second
    return first


def settle(scene: BlenderScene) -> Layout:
    """Take the edits over; afterwards there are none. Returns the layout that stands then."""
    text, findings = patch_text(scene.program_text(), scene.read_back())
    assert not [f for f in findings if f.severity == "warning"], findings
    scene.build(text)
    assert scene.read_back() == []
    return parse_layout(scene.program_text())


def line(edit: LayoutEdit) -> Any:
    assert edit.line is not None
    return parse_line(edit.line)


def test_an_untouched_room_has_no_edits(scene: BlenderScene) -> None:
    assert edits_of(scene) == []
    scene.build(ROOM)
    assert edits_of(scene) == []


def test_a_moved_wall_takes_its_window_along(scene: BlenderScene) -> None:
    thing("wall_w").location.x -= 0.4
    wall, window = edits_of(scene)
    assert (wall.op, wall.id, wall.origin) == ("line", "wall_w", "artist")
    assert line(wall).start == pytest.approx((-2.9, 2)) and line(wall).end == pytest.approx((-2.9, -2))
    assert (window.op, window.id, window.origin) == ("line", "window_1", "parent")
    assert line(window).start == pytest.approx((-2.9, 0.6))
    layout = settle(scene)
    assert layout.windows[0].wall == "wall_w"
    assert thing("window_1").matrix_world.translation.x == pytest.approx(-2.9, abs=1e-5)


def test_a_wall_scaled_turned_or_edited(scene: BlenderScene) -> None:
    divider = thing("divider")
    divider.scale = (0.5, 2.0, 0.5)
    [scaled, _] = edits_of(scene)
    assert line(scaled).end == pytest.approx((0.5, -1)) and line(scaled).thickness == pytest.approx(0.2)
    assert line(scaled).height == pytest.approx(1.2)
    divider.scale = (1, 1, 1)
    divider.rotation_euler.z += math.radians(-90)
    turned = edits_of(scene)[0]
    assert line(turned).end == pytest.approx((2.5, -2))
    divider.rotation_euler.z += math.radians(90)
    for vertex in divider.data.vertices:
        vertex.co.z *= 0.5
    divider.data.update()
    [lower] = edits_of(scene)
    assert line(lower).height == pytest.approx(1.2) and line(lower).end == pytest.approx((0.5, 0))
    settle(scene)


def test_a_deleted_wall_takes_along_what_was_in_it(scene: BlenderScene) -> None:
    bpy.data.objects.remove(thing("divider"))
    [edit] = edits_of(scene)
    assert (edit.op, edit.id) == ("remove", "divider")
    layout = settle(scene)
    assert "divider" not in [w.id for w in layout.walls] and layout.openings == []
    assert not [o for o in bpy.data.objects if o.get(ID) in ("divider", "opening_1")]


def test_a_door_moved_along_its_wall_stays_in_it(scene: BlenderScene) -> None:
    thing("door_1").location.x += 1.0
    thing("door_1").location.y -= 0.13  # as a hand does
    [edit] = edits_of(scene)
    door = line(edit)
    assert door.wall == "wall_s" and door.open == 30
    assert door.start == pytest.approx((-0.9, -2)) and door.end == pytest.approx((-0.05, -2))
    settle(scene)
    bpy.context.view_layer.update()
    assert thing("door_1").matrix_world.translation[:] == pytest.approx((-0.9, -2, 0), abs=1e-5)
    assert thing("door_1", "leaf").matrix_world.translation.x == pytest.approx(-0.85, abs=1e-4)


def test_a_door_moved_to_another_wall_gets_that_wall(scene: BlenderScene) -> None:
    door = thing("door_1")
    place = door.matrix_world.copy()
    place.translation = (2.4, 0.2, 0)
    door.matrix_world = place
    [edit] = edits_of(scene)
    assert line(edit).wall == "wall_e"
    assert line(edit).start[0] == line(edit).end[0] == 2.5
    assert math.dist(line(edit).start, line(edit).end) == pytest.approx(0.85)
    assert settle(scene).doors[-1].wall in ("wall_e", "wall_n")
    assert thing("door_1").parent == thing("wall_e")


def test_a_door_is_opened_by_turning_its_leaf(scene: BlenderScene) -> None:
    for name, before in (("door_1", 30), ("door_2", 0)):
        leaf = thing(name, "leaf")
        at_rest = leaf.matrix_world.copy()
        # door_1 runs with its wall, door_2 against it: into the room is another way round for each.
        leaf.rotation_euler.z += math.radians(40 if name == "door_1" else -40)
        [edit] = edits_of(scene)
        assert (edit.id, line(edit).open) == (name, pytest.approx(before + 40, abs=1e-3))
        turned = leaf.matrix_world.copy()
        settle(scene)
        bpy.context.view_layer.update()
        assert leaf.matrix_world != at_rest
        assert (leaf.matrix_world.translation - turned.translation).length < 1e-4


def test_a_window_raised_and_stretched(scene: BlenderScene) -> None:
    window = thing("window_1")
    window.location.z += 0.15
    window.scale.x = 1.25
    [edit] = edits_of(scene)
    found = line(edit)
    assert found.sill == pytest.approx(1.0) and found.height == pytest.approx(1.3)
    assert math.dist(found.start, found.end) == pytest.approx(1.5) and found.start == pytest.approx((-2.5, 0.6))
    settle(scene)
    assert tuple(thing("window_1").scale) == pytest.approx((1, 1, 1))


def test_a_duplicated_window_is_another_window(scene: BlenderScene) -> None:
    for obj in bpy.context.view_layer.objects:
        obj.select_set(obj.get(ID) == "window_1")
    bpy.ops.object.duplicate(linked=True)
    [copy] = bpy.context.selected_objects
    copy.location.y -= 1.35
    [edit] = edits_of(scene)
    assert (edit.op, edit.id) == ("add", "window_2")
    assert line(edit).wall == "wall_w" and line(edit).start == pytest.approx((-2.5, -0.75))
    layout = settle(scene)
    assert [w.id for w in layout.windows] == ["window_1", "window_2"]
    assert thing("window_2") == copy
    copy.scale.x = 0.5
    settle(scene)
    assert copy.dimensions.x < 0.8 and thing("window_1").dimensions.x == pytest.approx(1.2)


def test_a_duplicated_door_brings_its_leaf(scene: BlenderScene) -> None:
    for obj in bpy.context.view_layer.objects:
        obj.select_set(obj.get(ID) == "door_1")
    bpy.ops.object.duplicate()
    for obj in list(bpy.context.selected_objects):
        if obj.get(PART) != "leaf":
            obj.location.x += 1.2
    edits = edits_of(scene)
    assert [(e.op, e.id) for e in edits] == [("add", "door_3")]
    settle(scene)
    assert len([o for o in bpy.data.objects if o.get(PART) == "leaf"]) == 3


def test_a_deleted_door_and_light(scene: BlenderScene) -> None:
    bpy.data.objects.remove(thing("door_1"))
    bpy.data.objects.remove(thing("lamp_1"))
    assert {(e.op, e.id) for e in edits_of(scene)} == {("remove", "door_1"), ("remove", "lamp_1")}
    settle(scene)
    assert not [o for o in bpy.data.objects if o.get(ID) == "door_1"], "its leaf is gone too"


def test_lights_moved_turned_and_dimmed(scene: BlenderScene) -> None:
    thing("lamp_1").location.z += 0.25
    thing("lamp_1").data.energy = 77
    thing("sun_1").rotation_euler = (0.3, 0, 0)
    thing("panel_1").data.size = 0.8
    found = {e.id: line(e) for e in edits_of(scene)}
    assert found["lamp_1"].at == pytest.approx((0, 1, 2.25)) and found["lamp_1"].energy == 77
    assert found["sun_1"].at == (0, 0, 5) and found["sun_1"].target[1] > 1
    assert found["panel_1"].size == pytest.approx(0.8) and found["panel_1"].target is None
    before = {name: thing(name).matrix_basis.copy() for name in ("lamp_1", "sun_1", "panel_1")}
    settle(scene)
    assert {name: thing(name).matrix_basis for name in before} == before


def test_a_scaled_area_light_is_larger_once(scene: BlenderScene) -> None:
    thing("panel_1").scale = (2, 2, 2)
    [edit] = edits_of(scene)
    assert line(edit).size == pytest.approx(1.0)
    settle(scene)
    panel = thing("panel_1")
    assert panel.data.size * panel.scale.x == pytest.approx(1.0)


def test_a_light_of_the_artists_joins_the_room(scene: BlenderScene) -> None:
    data = bpy.data.lights.new("Spot", "SPOT")
    data.energy = 250
    lamp = bpy.data.objects.new("Reading Spot", data)
    lamp.location = (1, 1, 2)
    lamp.rotation_euler.x = 0.4
    find_room_collection(bpy.context.scene).objects.link(lamp)
    [edit] = edits_of(scene)
    assert (edit.op, edit.id, line(edit).kind, line(edit).energy) == ("add", "reading_spot", "spot", 250)
    place = lamp.matrix_basis.copy()
    settle(scene)
    assert thing("reading_spot") == lamp and lamp.matrix_basis == place


def test_a_camera_is_moved_but_the_reference_stays_with_the_calibration(scene: BlenderScene) -> None:
    thing("corner").location.x = 1
    thing("corner").data.lens *= 2
    reference = thing("reference")
    before = reference.matrix_basis.copy()
    reference.location.x += 1
    [edit] = edits_of(scene)
    assert edit.id == "corner" and line(edit).matrix[3] == pytest.approx(1)
    assert line(edit).fov_y == pytest.approx(2 * math.atan(math.tan(0.5) / 2))
    assert any("calibration" in notice for notice in scene.notices)
    settle(scene)
    assert (reference.matrix_basis.translation - before.translation).length < 1e-5


def test_the_floor_is_not_edited_by_hand(scene: BlenderScene) -> None:
    thing("floor").location.z = 0.3
    assert edits_of(scene) == []
    assert any("floor" in notice and "calibration" in notice for notice in scene.notices)
    thing("lamp_1").location.z += 0.1
    settle(scene)
    assert thing("floor").location.z == pytest.approx(0)


@pytest.mark.parametrize("scale", [(0, 0, 0), (1, 0, 1), (-1, 1, 1), (1, 1, -1)])
@pytest.mark.parametrize("name", ["divider", "door_1", "window_1", "opening_1", "lamp_1", "panel_1", "corner"])
def test_no_scale_breaks_the_room(scene: BlenderScene, name: str, scale: Any) -> None:
    thing(name).scale = scale
    bpy.context.view_layer.update()
    text, _ = patch_text(scene.program_text(), scene.read_back())
    scene.build(text)
    assert thing(name) is not None
    assert scene.read_back() == []
