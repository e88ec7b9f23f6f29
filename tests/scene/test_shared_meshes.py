# SPDX-License-Identifier: GPL-3.0-or-later
"""Identical objects share one mesh, and whatever an artist does to one of them stays exact."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import bpy
import pytest
from code_as_room.pipeline.program.patch import patch_text
from code_as_room.pipeline.scene.backend import BlenderScene
from code_as_room.pipeline.scene.plan import plan_build
from code_as_room.pipeline.scene.realise import lacking, new_mesh
from code_as_room.pipeline.scene.tags import ID, find_room_collection

HEAD = """\
room(size=(6, 5, 2.6), floor=[(-3, -2.5), (3, -2.5), (3, 2.5), (-3, 2.5)])
proxy("table_1", "table", centre=(0, 0, 0.37), size=(1.8, 0.9, 0.74))
"""
CHAIRS = "".join(
    f'proxy("chair_{n}", "dining chair", centre=({x}, {y}, 0.45), size=(0.45, 0.5, 0.9), yaw={yaw})\n'
    for n, (x, y, yaw) in enumerate([(x, y, yaw) for y, yaw in ((-0.7, 180), (0.7, 0)) for x in (-2, -1, 1, 2)], 1)
)
CODE = """
def chair(size):
    w, d, h = size
    legs = [cylinder(0.02, h / 2, at=(x * w / 2.3, y * d / 2.3, h / 4)) for x in (-1, 1) for y in (-1, 1)]
    return [part("seat", rounded_box((w, d, 0.04), at=(0, 0, h / 2)), material="wood"),
            part("back", rounded_box((w, 0.03, h / 2), at=(0, d / 2 - 0.02, 0.75 * h)), material="fabric"),
            part("leg", legs, material="wood")]

"""
FURNISH = "".join(f'furnish("chair_{n}", chair)\n' for n in range(1, 9))
ROOM = HEAD + CHAIRS + CODE + FURNISH + "build()\n"


@pytest.fixture
def scene(empty_blender: None) -> BlenderScene:
    backend = BlenderScene()
    backend.build(ROOM)
    return backend


def chair(number: int) -> Any:
    room = find_room_collection(bpy.context.scene)
    [found] = [o for o in room.all_objects if o.get(ID) == f"chair_{number}"]
    return found


def meshes() -> set[Any]:
    return {chair(n).data for n in range(1, 9)}


def points(obj: Any) -> list[tuple[float, ...]]:
    bpy.context.view_layer.update()
    return [tuple(v.co) for v in obj.data.vertices]


def take_over(scene: BlenderScene) -> str:
    text, _ = patch_text(scene.program_text(), scene.read_back())
    scene.build(text)
    assert not scene.read_back()
    return text


def test_eight_chairs_are_one_mesh_and_stay_one(scene: BlenderScene, tmp_path: Path) -> None:
    [mesh] = meshes()
    assert mesh.users == 8
    boxes = {chair(n).data for n in range(1, 9)} | {o.data for o in bpy.data.objects if o.get(ID) == "table_1"}
    assert len(boxes) == 2
    scene.build(ROOM)
    assert meshes() == {mesh} and not scene.read_back()
    scene.build(ROOM.replace("h / 4", "h / 4.0001"))
    assert len(meshes()) == 1 and meshes().pop().users == 8
    path = tmp_path / "room.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(path))
    bpy.ops.wm.open_mainfile(filepath=str(path))
    assert meshes().pop().users == 8
    assert not BlenderScene().read_back()


def test_meshes_made_beforehand_are_made_once(empty_blender: None) -> None:
    backend = BlenderScene()
    plan = plan_build(ROOM)
    missing = lacking(plan.room, None)
    assert [t.key[0] for t in missing if t.key[0].startswith("chair")] == ["chair_1"]
    made = {t.key: new_mesh(t, plan.room) for t in missing}
    backend.commit(plan, made)
    assert meshes().pop().users == 8 and not made
    assert not [m for m in bpy.data.meshes if m.users == 0]


def test_another_size_gets_a_mesh_of_its_own_and_the_others_keep_theirs(scene: BlenderScene) -> None:
    [mesh] = meshes()
    before = points(chair(2))
    scene.build(ROOM.replace("size=(0.45, 0.5, 0.9), yaw=180)", "size=(0.6, 0.5, 0.9), yaw=180)", 1))
    assert chair(1).data != mesh and chair(1).data.users == 1 and mesh.users == 7
    assert points(chair(2)) == before
    scene.build(ROOM)
    assert meshes() == {mesh} and mesh.users == 8


def test_an_edit_of_the_mesh_shows_on_all_and_is_kept_for_all(scene: BlenderScene) -> None:
    [mesh] = meshes()
    for vertex in mesh.vertices:
        vertex.co.x *= 1.5
    mesh.update()
    edited = points(chair(1))
    edits = scene.read_back()
    assert {e.id for e in edits if e.op == "resize"} == {f"chair_{n}" for n in range(1, 9)}
    text = take_over(scene)
    assert text.count("size=(0.675, 0.5, 0.9)") == 8
    assert meshes() == {mesh} and points(chair(5)) == edited


def test_one_made_single_user_is_edited_alone(scene: BlenderScene) -> None:
    [mesh] = meshes()
    before = points(chair(2))
    chair(1).data = mesh.copy()
    scene.build(ROOM)
    assert chair(1).data != mesh and mesh.users == 7
    for vertex in chair(1).data.vertices:
        vertex.co.z *= 1.2
    edited = points(chair(1))
    assert {e.id for e in scene.read_back()} == {"chair_1"}
    text = take_over(scene)
    scene.build(text.replace("h / 4)", "h / 4.0001)"))
    assert points(chair(1)) == edited
    assert points(chair(2)) != before and chair(2).data.users == 7


def test_a_moved_chair_and_a_linked_copy_share_on(scene: BlenderScene) -> None:
    [mesh] = meshes()
    chair(3).location.x += 0.2
    copy = chair(4).copy()
    copy.location.y += 1.0
    chair(4).users_collection[0].objects.link(copy)
    bpy.context.view_layer.update()
    edits = scene.read_back()
    assert {(e.op, e.id) for e in edits} >= {("move", "chair_3"), ("add", "chair_9")}
    take_over(scene)
    assert meshes() == {mesh}
    assert chair(9).data != mesh


def test_another_category_of_one_leaves_the_colours_of_the_others(scene: BlenderScene) -> None:
    plain = CODE.replace(', material="wood"', "").replace(', material="fabric"', "")
    scene.build(HEAD + CHAIRS + plain + FURNISH + "build()\n")
    [mesh] = meshes()
    slots = list(mesh.materials)
    chair(1).location.x += 0.1
    bpy.context.view_layer.update()
    text = take_over(scene)
    scene.build(text.replace('"chair_1", "dining chair"', '"chair_1", "floor lamp"'))
    assert list(chair(2).data.materials) == slots
    assert list(chair(1).data.materials) != slots


def test_the_artists_material_stays_on_what_shared_it(scene: BlenderScene) -> None:
    red = bpy.data.materials.new("My Red")
    [mesh] = meshes()
    mesh.materials[0] = red
    scene.build(ROOM.replace("h / 4", "h / 4.0001"))
    assert {list(m.materials)[0] for m in meshes()} == {red}
    assert len(meshes()) == 1
