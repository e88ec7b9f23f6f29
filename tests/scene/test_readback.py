# SPDX-License-Identifier: GPL-3.0-or-later
"""Hand edits: every kind is read as a typed edit, and applying it leaves nothing to read."""

from __future__ import annotations

import math
from typing import Any

import bpy
import numpy as np
import pytest
from code_as_room.pipeline.program.patch import patch_text
from code_as_room.pipeline.scene.backend import BlenderScene
from code_as_room.pipeline.scene.tags import ID, find_room_collection
from mathutils import Matrix

ROOM = """\
room(size=(5, 4, 2.6), floor=[(-2.5, -2), (2.5, -2), (2.5, 2), (-2.5, 2)])
wall("wall_s", (-2.5, -2), (2.5, -2), height=2.6)
wall("wall_e", (2.5, -2), (2.5, 2), height=2.6)
proxy("bed_1", "double bed", centre=(-0.6, 0.6, 0.3), size=(1.7, 2, 0.6), yaw=0, placement="floor", salience="major")
proxy("nightstand_1", "nightstand", centre=(0.9, 1.2, 0.275), size=(0.5, 0.45, 0.55), yaw=0, placement="floor", \
salience="major")
proxy("lamp_1", "table lamp", centre=(0.9, 1.25, 0.775), size=(0.3, 0.3, 0.45), yaw=0, placement="surface", \
parent="nightstand_1", salience="minor", shape="round")
proxy("chair_1", "chair", centre=(1.7, -1.1, 0.45), size=(0.5, 0.5, 0.9), yaw=350, placement="floor", salience="major")
build()
"""


@pytest.fixture
def scene(empty_blender: None) -> BlenderScene:
    """The room, built."""
    backend = BlenderScene()
    backend.build(ROOM)
    return backend


def thing(identifier: str) -> Any:
    """The one object with this id."""
    [found] = [o for o in bpy.data.objects if o.get(ID) == identifier]
    return found


def edits_of(scene: BlenderScene) -> list[tuple[Any, ...]]:
    """What is read, twice, since reading must not change what is read."""
    bpy.context.view_layer.update()
    first, second = scene.read_back(), scene.read_back()
    assert first == second
    assert all(edit.origin in ("artist", "parent") for edit in first)
    return first


def settle(scene: BlenderScene) -> None:
    """Take the edits over as the driver does; afterwards there must be none, and nothing may have moved."""
    bpy.context.view_layer.update()
    before = {o.name: np.array(o.matrix_world @ Matrix.Diagonal((*o.dimensions, 1))) for o in _proxies()}
    text, findings = patch_text(scene.program_text(), scene.read_back())
    assert all(finding.severity == "note" for finding in findings)
    scene.build(text)
    bpy.context.view_layer.update()
    assert scene.read_back() == []
    after = {o.name: np.array(o.matrix_world @ Matrix.Diagonal((*o.dimensions, 1))) for o in _proxies()}
    assert after.keys() == before.keys()
    for name, place in before.items():
        assert np.allclose(place[:3, 3], after[name][:3, 3], atol=2e-4), name


def _proxies() -> list[Any]:
    return [o for o in find_room_collection(bpy.context.scene).all_objects if o.get("code_as_room_kind") == "proxy"]


def test_an_untouched_scene_reads_as_unchanged(scene: BlenderScene) -> None:
    assert edits_of(scene) == []
    for obj in _proxies():
        obj.location.x += 2e-5  # float noise
        obj.rotation_euler.z += math.radians(0.002)
    assert edits_of(scene) == []


def test_moved(scene: BlenderScene) -> None:
    thing("bed_1").location.x += 0.4
    [edit] = edits_of(scene)
    assert (edit.op, edit.id) == ("move", "bed_1")
    assert edit.centre == pytest.approx((-0.2, 0.6, 0.3))
    settle(scene)


def test_a_moved_parent_takes_its_child_along(scene: BlenderScene) -> None:
    thing("nightstand_1").location.y -= 0.3
    edits = {edit.id: edit for edit in edits_of(scene)}
    assert edits.keys() == {"nightstand_1", "lamp_1"}
    assert edits["lamp_1"].centre == pytest.approx((0.9, 0.95, 0.775))
    assert (edits["nightstand_1"].origin, edits["lamp_1"].origin) == ("artist", "parent")
    assert edits["lamp_1"].reason == "moved along with nightstand_1"
    settle(scene)
    assert thing("lamp_1").parent == thing("nightstand_1")


def test_a_child_that_was_moved_on_its_moved_parent_is_edited_itself(scene: BlenderScene) -> None:
    thing("nightstand_1").location.y -= 0.3
    thing("lamp_1").location.x += 0.05
    assert {(e.id, e.origin) for e in edits_of(scene)} == {("nightstand_1", "artist"), ("lamp_1", "artist")}
    settle(scene)


def test_a_parent_that_moves_away_under_its_child_is_the_only_edit(scene: BlenderScene) -> None:
    stand, lamp = thing("nightstand_1"), thing("lamp_1")
    place = lamp.matrix_world.copy()
    stand.location.x += 0.1
    bpy.context.view_layer.update()
    lamp.matrix_world = place
    assert [e.id for e in edits_of(scene)] == ["nightstand_1"]
    settle(scene)


def test_a_scaled_parent_scales_its_child(scene: BlenderScene) -> None:
    thing("nightstand_1").scale = (1.2, 1.2, 1.2)
    edits = {edit.id: edit for edit in edits_of(scene)}
    assert edits["lamp_1"].size == pytest.approx((0.36, 0.36, 0.54))
    assert edits["lamp_1"].origin == "parent"
    settle(scene)


@pytest.mark.parametrize("mode", ["XYZ", "QUATERNION", "AXIS_ANGLE"])
def test_turned(scene: BlenderScene, mode: str) -> None:
    chair = thing("chair_1")
    chair.rotation_mode = mode
    place = chair.matrix_basis.copy()
    chair.matrix_basis = place @ Matrix.Rotation(math.radians(25), 4, "Z")
    [edit] = edits_of(scene)
    assert (edit.op, edit.id) == ("turn", "chair_1")
    assert edit.yaw == pytest.approx(15, abs=1e-3)
    settle(scene)


def test_scaled_applied_or_edited_all_mean_another_size(scene: BlenderScene) -> None:
    bed = thing("bed_1")
    bed.scale = (1.0, 1.1, 1.0)
    [scaled] = edits_of(scene)
    bed.scale = (1.0, 1.0, 1.0)
    for vertex in bed.data.vertices:
        vertex.co.y *= 1.1
    [applied] = edits_of(scene)
    assert scaled == applied
    assert (applied.op, applied.size) == ("resize", pytest.approx((1.7, 2.2, 0.6)))
    settle(scene)


def test_scaled_up_from_its_base(scene: BlenderScene) -> None:
    thing("chair_1").scale.z = 2.0
    [edit] = edits_of(scene)
    assert edit.op == "resize"
    assert edit.centre == pytest.approx((1.7, -1.1, 0.9))
    settle(scene)
    assert thing("chair_1").scale.z == 2.0, "what the artist did stays as it is"


def test_deleted(scene: BlenderScene) -> None:
    bpy.data.objects.remove(thing("nightstand_1"))
    [edit] = edits_of(scene)
    assert (edit.op, edit.id) == ("remove", "nightstand_1")
    settle(scene)
    assert thing("lamp_1").parent is None


def test_unlinked_from_the_collection_means_removed_but_stays(scene: BlenderScene) -> None:
    chair = thing("chair_1")
    for collection in chair.users_collection:
        collection.objects.unlink(chair)
    bpy.context.scene.collection.objects.link(chair)
    [edit] = edits_of(scene)
    assert (edit.op, edit.id) == ("remove", "chair_1")
    scene.build(patch_text(scene.program_text(), [edit])[0])
    assert chair.name in bpy.data.objects


def test_renamed(scene: BlenderScene) -> None:
    bed = thing("bed_1")
    bed.name = "Grandma's Bed"
    [edit] = edits_of(scene)
    assert (edit.op, edit.id, edit.new_id) == ("rename", "bed_1", "grandma_s_bed")
    settle(scene)
    assert thing("grandma_s_bed") == bed


def test_a_refused_new_name_does_not_cost_the_object(scene: BlenderScene) -> None:
    bed = thing("bed_1")
    bed.name = "Other"
    edits_of(scene)
    scene.build(ROOM)
    assert thing("bed_1") == bed


def test_renamed_and_moved_parent(scene: BlenderScene) -> None:
    stand = thing("nightstand_1")
    stand.name = "Cube"
    stand.location.z += 0.1
    assert [e.op for e in edits_of(scene)] == ["move", "move", "rename"]
    settle(scene)
    assert thing("lamp_1").parent == thing("cube")


@pytest.mark.parametrize("linked", [True, False])
def test_duplicated_with_its_child(scene: BlenderScene, linked: bool) -> None:
    room = find_room_collection(bpy.context.scene)
    for obj in bpy.context.view_layer.objects:
        obj.select_set(obj.get(ID) in ("nightstand_1", "lamp_1"))
    bpy.ops.object.duplicate(linked=linked)
    stand, lamp = sorted(bpy.context.selected_objects, key=lambda o: str(o[ID]), reverse=True)
    assert lamp.parent == stand
    stand.location.x += 0.8
    edits = edits_of(scene)
    assert [(e.op, e.id, e.parent) for e in edits] == [
        ("add", "nightstand_2", None),
        ("add", "lamp_2", "nightstand_2"),
    ]
    assert edits[1].category == "table lamp"
    assert edits[1].centre == pytest.approx((1.7, 1.25, 0.775))
    settle(scene)
    assert thing("lamp_2") == lamp
    assert len([o for o in room.all_objects if o.get("code_as_room_kind") == "proxy"]) == 6


def test_added(scene: BlenderScene) -> None:
    mesh = bpy.data.meshes.new("Vase")
    mesh.from_pydata([(0, 0, 0), (0.1, 0, 0), (0.1, 0.1, 0.2), (0, 0.1, 0.2)], [], [(0, 1, 2, 3)])
    vase = bpy.data.objects.new("Tall Vase.001", mesh)
    vase.location = (-0.6, 0.6, 0.6)
    find_room_collection(bpy.context.scene).objects.link(vase)
    [edit] = edits_of(scene)
    assert (edit.op, edit.id, edit.category, edit.parent) == ("add", "tall_vase", "tall vase", "bed_1")
    assert (edit.placement, edit.salience) == ("surface", "minor")
    assert edit.centre == pytest.approx((-0.55, 0.65, 0.7))
    settle(scene)
    assert thing("tall_vase") == vase and vase.data == mesh


def test_given_another_parent(scene: BlenderScene) -> None:
    lamp, bed = thing("lamp_1"), thing("bed_1")
    place = lamp.matrix_world.copy()
    lamp.parent = bed
    lamp.matrix_parent_inverse = bed.matrix_world.inverted()
    lamp.matrix_basis = place
    [edit] = edits_of(scene)
    assert (edit.op, edit.id, edit.parent) == ("reparent", "lamp_1", "bed_1")
    settle(scene)


def test_edits_in_the_text_and_in_the_scene_are_both_kept(scene: BlenderScene) -> None:
    block = next(t for t in bpy.data.texts if t.name.startswith("room.py"))
    block.from_string(block.as_string().replace('"chair", centre=(1.7,', '"chair", centre=(1.5,'))
    thing("bed_1").location.x += 0.1
    [edit] = edits_of(scene)
    assert edit.id == "bed_1"
    text, _ = patch_text(scene.program_text(), [edit])
    scene.build(text)
    assert thing("chair_1").location.x == pytest.approx(1.5)
    assert thing("bed_1").location.x == pytest.approx(-0.5)


def test_a_copy_survives_a_build_that_does_not_know_it(scene: BlenderScene) -> None:
    twin = thing("bed_1").copy()
    find_room_collection(bpy.context.scene).objects.link(twin)
    scene.build(ROOM.replace('proxy("bed_1"', 'proxy("bed_9"'))
    assert twin.name in bpy.data.objects


def test_editing_mode_is_read_and_left(scene: BlenderScene) -> None:
    bed = thing("bed_1")
    bpy.context.view_layer.objects.active = bed
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.mesh.select_all(action="SELECT")
    bpy.ops.transform.translate(value=(0.2, 0, 0))
    [edit] = edits_of(scene)
    assert edit.centre == pytest.approx((-0.4, 0.6, 0.3), abs=1e-4)
    settle(scene)
