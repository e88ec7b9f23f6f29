# SPDX-License-Identifier: GPL-3.0-or-later
"""Whatever an artist does to a room with Blender's ordinary tools is read sensibly and never breaks it."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import bpy
import pytest
from code_as_room.pipeline.artifacts.layout import LayoutEdit
from code_as_room.pipeline.program.evaluate import evaluate
from code_as_room.pipeline.program.lines import parse_layout
from code_as_room.pipeline.program.patch import patch_text
from code_as_room.pipeline.scene.backend import BlenderScene
from code_as_room.pipeline.scene.tags import ID, find_room_collection
from mathutils import Matrix

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


def cube(name: str, at: tuple[float, float, float], size: float = 0.2) -> Any:
    mesh = bpy.data.meshes.new(name)
    half = size / 2
    corners = [(x, y, z) for x in (-half, half) for y in (-half, half) for z in (-half, half)]
    mesh.from_pydata(corners, [], [(0, 1, 3, 2), (4, 6, 7, 5)])
    obj = bpy.data.objects.new(name, mesh)
    obj.location = at
    return obj


def select(*objects: Any) -> None:
    for obj in bpy.context.view_layer.objects:
        obj.select_set(obj in objects)
    bpy.context.view_layer.objects.active = objects[0]


# ---- what is added ----


def test_an_appended_asset_of_several_meshes_is_one_object(scene: BlenderScene) -> None:
    root = bpy.data.objects.new("Plant Pot", None)
    root.location = (1.5, 1.0, 0.0)
    root.rotation_euler.z = math.radians(45)
    parts = [cube("Pot", (0, 0, 0.1)), cube("Leaves", (0, 0, 0.6), 0.4)]
    for obj in (root, *parts):
        room().objects.link(obj)
    parts[0].parent = root
    parts[1].parent = parts[0]
    [edit] = edits_of(scene)
    assert (edit.op, edit.id, edit.category) == ("add", "plant_pot", "plant pot")
    assert edit.centre == pytest.approx((1.5, 1.0, 0.45)) and edit.size == pytest.approx((0.4, 0.4, 0.9))
    assert edit.yaw == pytest.approx(45)
    places = [o.matrix_world.copy() for o in (root, *parts)]
    settle(scene)
    assert [o.matrix_world for o in (root, *parts)] == places
    root.location.x -= 0.5
    [moved] = edits_of(scene)
    assert (moved.op, moved.id) == ("move", "plant_pot")
    settle(scene)
    parts[1].location.z += 0.2
    [taller] = edits_of(scene)
    assert (taller.op, taller.size[2]) == ("resize", pytest.approx(1.1))
    settle(scene)
    scene.build("\n".join(x for x in scene.program_text().splitlines() if "plant_pot" not in x) + "\n")
    assert not [o for o in room().all_objects if o.name in ("Plant Pot", "Pot", "Leaves")]
    assert len([o for o in bpy.data.objects if o.name in ("Plant Pot", "Pot", "Leaves")]) == 3


def test_a_copied_asset_is_another_one(scene: BlenderScene) -> None:
    root = bpy.data.objects.new("Pot", None)
    part = cube("Body", (0, 0, 0.1))
    for obj in (root, part):
        room().objects.link(obj)
    part.parent = root
    settle(scene)
    select(root, part)
    bpy.ops.object.duplicate()
    twin = next(o for o in bpy.context.selected_objects if o.type == "EMPTY")
    twin.location.x += 1
    [edit] = edits_of(scene)
    assert (edit.op, edit.id) == ("add", "pot_2") and edit.centre == pytest.approx((1, 0, 0.1))
    settle(scene)


def test_a_collection_instance_is_one_object(scene: BlenderScene) -> None:
    asset = bpy.data.collections.new("Asset")
    asset.objects.link(cube("Inner", (0, 0, 0.3), 0.6))
    empty = bpy.data.objects.new("Sofa Asset", None)
    empty.instance_type, empty.instance_collection = "COLLECTION", asset
    empty.location = (1, -1, 0)
    room().objects.link(empty)
    [edit] = edits_of(scene)
    assert (edit.id, edit.placement) == ("sofa_asset", "floor") and edit.size == pytest.approx((0.6, 0.6, 0.6))
    settle(scene)
    empty.scale = (2, 2, 2)
    [larger] = edits_of(scene)
    assert larger.size == pytest.approx((1.2, 1.2, 1.2))
    settle(scene)


@pytest.mark.parametrize("kind", ["CURVE", "FONT"])
def test_curves_and_texts_have_a_box(scene: BlenderScene, kind: str) -> None:
    data: Any = bpy.data.curves.new("Cable", kind)
    if kind == "CURVE":
        data.dimensions, data.bevel_depth = "3D", 0.05
        spline = data.splines.new("POLY")
        spline.points.add(1)
        spline.points[1].co = (0.5, 0, 0.3, 1)
    obj = bpy.data.objects.new("Cable", data)
    obj.location = (0, -1, 0)
    room().objects.link(obj)
    [edit] = edits_of(scene)
    assert edit.id == "cable" and max(edit.size) > 0.4
    settle(scene)


def test_empties_speakers_and_armatures_alone_are_no_objects(scene: BlenderScene) -> None:
    for name, data in (("Empty", None), ("Rig", bpy.data.armatures.new("Rig"))):
        room().objects.link(bpy.data.objects.new(name, data))
    assert edits_of(scene) == []


def test_a_cube_parented_to_furniture_belongs_to_it(scene: BlenderScene) -> None:
    box = cube("Book", (0, 0, 0.65))
    box.parent = thing("nightstand_1")
    room().objects.link(box)
    [edit] = edits_of(scene)
    assert (edit.id, edit.parent, edit.placement) == ("book", "nightstand_1", "surface")
    settle(scene)
    assert box.parent == thing("nightstand_1")


# ---- what is taken away, joined or hidden ----


def test_joined_objects_are_one(scene: BlenderScene) -> None:
    bed, stand = thing("bed_1"), thing("nightstand_1")
    select(bed, stand)
    bpy.ops.object.join()
    edits = {(e.op, e.id) for e in edits_of(scene)}
    assert edits == {("resize", "bed_1"), ("remove", "nightstand_1")}
    vertices = len(bed.data.vertices)
    settle(scene)
    assert len(thing("bed_1").data.vertices) == vertices


def test_moved_out_of_the_collection_and_back(scene: BlenderScene) -> None:
    bed = thing("bed_1")
    former = bed.users_collection[0]
    former.objects.unlink(bed)
    bpy.context.scene.collection.objects.link(bed)
    assert [(e.op, e.id) for e in edits_of(scene)] == [("remove", "bed_1")]
    settle(scene)
    assert bed.name in bpy.context.scene.objects, "it is the artist's now"
    former.objects.link(bed)
    [edit] = edits_of(scene)
    assert (edit.op, edit.id, edit.category) == ("add", "bed_1", "double bed")
    settle(scene)
    assert thing("bed_1") == bed


def test_moved_into_another_collection_of_the_room(scene: BlenderScene) -> None:
    bed = thing("bed_1")
    bed.users_collection[0].objects.unlink(bed)
    mine = bpy.data.collections.new("Big things")
    room().children.link(mine)
    mine.objects.link(bed)
    assert edits_of(scene) == []
    scene.build(ROOM)
    assert bed.users_collection == (mine,)


def test_hidden_objects_are_still_there(scene: BlenderScene) -> None:
    thing("bed_1").hide_set(True)
    thing("chair_1").hide_viewport = True
    thing("lamp_1").hide_render = True
    bpy.context.view_layer.layer_collection.children[0].exclude = True
    assert edits_of(scene) == []
    thing("bed_1").location.x += 0.5
    assert [(e.op, e.id) for e in edits_of(scene)] == [("move", "bed_1")]
    settle(scene)


def test_a_mesh_without_anything_left_is_removed(scene: BlenderScene) -> None:
    thing("bed_1").data.clear_geometry()
    assert [(e.op, e.id) for e in edits_of(scene)] == [("remove", "bed_1")]
    settle(scene)


# ---- constraints, modifiers, drivers, strange matrices ----


def test_a_constraint_counts_as_what_it_does(scene: BlenderScene) -> None:
    target = bpy.data.objects.new("Target", None)
    target.location = (1, 1, 0)
    bpy.context.scene.collection.objects.link(target)
    constraint: Any = thing("bed_1").constraints.new("COPY_LOCATION")
    constraint.target = target
    [edit] = edits_of(scene)
    assert (edit.op, edit.centre) == ("move", pytest.approx((1, 1, 0.3)))
    settle(scene)
    assert len(thing("bed_1").constraints) == 1


def test_modifiers_and_drivers_are_left_alone(scene: BlenderScene) -> None:
    bed = thing("bed_1")
    modifier: Any = bed.modifiers.new("Array", "ARRAY")
    modifier.count = 3
    assert edits_of(scene) == []
    driver: Any = bed.driver_add("location", 0).driver
    driver.expression = "0.25"
    bpy.context.view_layer.update()
    [edit] = edits_of(scene)
    assert edit.op == "move" and edit.centre[0] == pytest.approx(0.25)
    settle(scene)


@pytest.mark.parametrize("furnished", [False, True])
@pytest.mark.parametrize(
    ("matrix", "size"),
    [
        (Matrix.Diagonal((-1, 1, 1, 1)), (1, 1, 1)),
        (Matrix.Diagonal((1, 1, -1, 1)), (1, 1, 1)),
        (Matrix.Diagonal((0, 0, 0, 1)), None),
        (Matrix.Diagonal((1, 0, 1, 1)), None),
        (Matrix.Diagonal((1e-7, 1e-7, 1e-7, 1)), None),
        (Matrix.Shear("XY", 4, (0.5, 0.2)), None),
        (Matrix.Rotation(math.pi / 2, 4, "X"), None),
        (Matrix.Rotation(math.pi, 4, "Y"), (1, 1, 1)),
        (Matrix.Diagonal((200, 1, 1, 1)), (200, 1, 1)),
    ],
)
def test_strange_matrices(scene: BlenderScene, matrix: Matrix, size: Any, furnished: bool) -> None:
    name = "chair_1" if furnished else "bed_1"
    obj = thing(name)
    built = parse_layout(ROOM).proxy(name)
    assert built is not None
    obj.matrix_basis = obj.matrix_basis @ matrix
    bpy.context.view_layer.update()
    before = obj.matrix_world.copy()
    edits = edits_of(scene)
    assert edits and {e.id for e in edits} == {name}, "it is locked"
    layout = settle(scene)
    assert obj.matrix_world == before
    found = layout.proxy(name)
    assert found is not None and all(v >= 1e-4 for v in found.size)
    if size is not None:
        assert found.size == pytest.approx([a * b for a, b in zip(built.size, size, strict=True)], abs=1e-3)


def apply(**what: bool) -> Callable[[Any], None]:
    def change(obj: Any) -> None:
        select(obj)
        bpy.ops.object.transform_apply(**{"location": False, "rotation": False, "scale": False, **what})

    return change


@pytest.mark.parametrize("name", ["bed_1", "chair_1"])
@pytest.mark.parametrize(
    "change", [apply(scale=True), apply(rotation=True), apply(location=True, rotation=True, scale=True)]
)
def test_applied_transforms_change_nothing(scene: BlenderScene, change: Callable[[Any], None], name: str) -> None:
    obj = thing(name)
    change(obj)
    assert edits_of(scene) == []
    obj.location.x += 0.1
    assert [(e.op, e.id) for e in edits_of(scene)] == [("move", name)]
    settle(scene)
    obj.rotation_euler.z += math.radians(15)
    ops = {e.op: e for e in edits_of(scene)}
    yaw = parse_layout(ROOM).proxy(name).yaw  # type: ignore[union-attr]
    assert (ops["turn"].yaw or 0) % 360 == pytest.approx((yaw + 15) % 360, abs=0.01) and "resize" not in ops
    settle(scene)


def test_all_vertices_turned_in_edit_mode_is_a_turn(scene: BlenderScene) -> None:
    bed = thing("bed_1")
    bed.data.transform(Matrix.Rotation(math.radians(20), 4, "Z"))
    [edit] = edits_of(scene)
    assert (edit.op, edit.yaw) == ("turn", pytest.approx(50, abs=0.01))
    settle(scene)
