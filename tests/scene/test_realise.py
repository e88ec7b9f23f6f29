# SPDX-License-Identifier: GPL-3.0-or-later
"""Building in Blender: what stands where, what is kept, and that nothing else is touched."""

from __future__ import annotations

import copy
from typing import Any

import bpy
import numpy as np
import pytest
from code_as_room.pipeline.program.prelude.shape import Shape
from code_as_room.pipeline.scene.realise import realise_record
from code_as_room.pipeline.scene.tags import COLOUR, ID, LINE, find_room_collection
from mathutils import Vector


def thing(identifier: str, part: str = "") -> Any:
    """The object with this id."""
    found = [o for o in bpy.data.objects if o.get(ID) == identifier and o.get("code_as_room_part", "") == part]
    assert len(found) == 1, identifier
    return found[0]


def fingerprint(obj: Any) -> tuple[Any, ...]:
    """Everything about an object that a user could see changed."""
    points = [tuple(v.co) for v in obj.data.vertices]
    places = [tuple(row) for row in obj.matrix_world]
    tags = sorted((key, str(list(value) if hasattr(value, "__len__") else value)) for key, value in obj.items())
    return obj.name, obj.data.name, points, places, tags, len(obj.modifiers)


def world_points(obj: Any) -> Any:
    """The vertices in the room, (N, 3)."""
    return np.array([obj.matrix_world @ v.co for v in obj.data.vertices])


def line_of(record: Any, identifier: str) -> dict[str, Any]:
    """A proxy's line."""
    return next(line for line in record.proxies if line["id"] == identifier)


def test_every_proxy_stands_at_its_place_with_its_size(record: Any) -> None:
    realise_record(record)
    for line in record.proxies:
        obj = thing(line["id"])
        turn = np.array(obj.matrix_world.to_3x3())
        local = (world_points(obj) - np.array(line["centre"])) @ turn
        assert np.allclose(local.min(axis=0), -np.array(line["size"]) / 2, atol=1e-5), line["id"]
        assert np.allclose(local.max(axis=0), np.array(line["size"]) / 2, atol=1e-5), line["id"]
        assert np.degrees(np.arctan2(turn[1, 0], turn[0, 0])) == pytest.approx(line["yaw"], abs=1e-3)


def test_a_lamp_follows_its_nightstand(record: Any) -> None:
    realise_record(record)
    before = thing("lamp_1").matrix_world.translation.copy()
    thing("nightstand_1").location.x += 0.5
    bpy.context.view_layer.update()
    moved = thing("lamp_1").matrix_world.translation - before
    assert np.allclose(moved, (0.5, 0, 0), atol=1e-6)


@pytest.mark.parametrize(
    ("origin", "direction", "hits"),
    [
        ((-1.0, -0.3, 1.3), (-1, 0, 0), {"window_1"}),  # through the window: only its glass and frame
        ((-1.0, 0.8, 1.3), (-1, 0, 0), {"wall_w"}),  # beside it
        ((-1.6, -0.3, 0.4), (-1, 0, 0), {"wall_w"}),  # below it
        ((-1.3, -0.5, 1.0), (0, -1, 0), set()),  # through the open door
        ((-0.5, -0.5, 1.0), (0, -1, 0), {"wall_s"}),
        ((1.0, -0.8, 1.0), (1, 0, 0), {"wardrobe_1", "wall_e"}),  # through the partition's opening
        ((1.0, -0.8, 2.3), (1, 0, 0), {"divider"}),  # over it
    ],
)
def test_openings_are_real(record: Any, origin: Any, direction: Any, hits: set[str]) -> None:
    realise_record(record)
    bpy.data.objects["sofa_1"].hide_viewport = True
    bpy.context.view_layer.update()
    graph = bpy.context.evaluated_depsgraph_get()
    hit, _, _, _, obj, _ = bpy.context.scene.ray_cast(graph, Vector(origin), Vector(direction))
    assert (obj.original.get(ID) in hits) if hits else not hit


def test_nothing_else_is_touched(record: Any) -> None:
    mesh = bpy.data.meshes.new("bed_1")
    mesh.from_pydata([(0, 0, 0), (1, 0, 0), (0, 1, 0)], [], [(0, 1, 2)])
    mine = bpy.data.objects.new("bed_1", mesh)
    bpy.context.scene.collection.objects.link(mine)
    mine.location = (1, 2, 3)
    theirs = bpy.data.collections.new("Code-as-Room")
    bpy.context.scene.collection.children.link(theirs)
    material = bpy.data.materials.new("Room bed")
    material.diffuse_color = (1, 0, 0, 1)
    bpy.context.view_layer.update()
    before = fingerprint(mine)
    resolution = bpy.context.scene.render.resolution_x
    realise_record(record)
    realise_record(record)
    assert fingerprint(mine) == before
    assert len(theirs.all_objects) == 0
    assert tuple(material.diffuse_color) == (1, 0, 0, 1) and COLOUR not in material
    assert bpy.context.scene.render.resolution_x == resolution
    assert find_room_collection(bpy.context.scene) != theirs
    assert thing("bed_1") != mine


def test_building_again_keeps_datablocks_and_hand_made_details(record: Any) -> None:
    realise_record(record)
    everything = {o: (o.data, o.get(LINE)) for o in bpy.data.objects}
    counts = len(bpy.data.meshes), len(bpy.data.materials), len(bpy.data.collections)
    thing("wall_n").location.z = 0.3  # walls have no typed edits: what the artist did to them stays
    thing("bed_1").modifiers.new("Bevel", "BEVEL")
    thing("lamp_light").data.energy = 77
    realise_record(record)
    assert {o: (o.data, o.get(LINE)) for o in bpy.data.objects} == everything
    assert (len(bpy.data.meshes), len(bpy.data.materials), len(bpy.data.collections)) == counts
    assert thing("wall_n").location.z == pytest.approx(0.3)
    assert thing("lamp_light").data.energy == 77
    assert len(thing("bed_1").modifiers) == 1


def test_only_what_differs_changes(record: Any) -> None:
    realise_record(record)
    sofa, bed, mesh = thing("sofa_1"), thing("bed_1"), thing("bed_1").data
    untouched = fingerprint(sofa)
    changed = copy.deepcopy(record)
    line_of(changed, "bed_1").update(size=(1.8, 2.1, 0.5), centre=(0.0, 0.0, 0.25), yaw=30.0)
    changed.proxies.remove(line_of(changed, "rug_1"))
    realise_record(changed)
    assert thing("bed_1") == bed and bed.data == mesh
    assert np.allclose(bed.dimensions, (1.8, 2.1, 0.5), atol=1e-5)
    assert fingerprint(sofa) == untouched
    assert not [o for o in bpy.data.objects if o.get(ID) == "rug_1"]
    assert "rug_1" not in bpy.data.meshes


def test_removing_a_parent_leaves_its_child_in_place(record: Any) -> None:
    realise_record(record)
    before = thing("lamp_1").matrix_world.translation.copy()
    changed = copy.deepcopy(record)
    changed.proxies.remove(line_of(changed, "nightstand_1"))
    line_of(changed, "lamp_1")["parent"] = None
    realise_record(changed)
    bpy.context.view_layer.update()
    assert (thing("lamp_1").matrix_world.translation - before).length < 1e-5


def test_a_deep_chain_of_turned_parents_stays_exact(record: Any) -> None:
    for i in range(6):
        line = {**line_of(record, "bed_1"), "id": f"link_{i}", "yaw": 37.0 * i, "centre": (0.3 * i, 1.1 * i, 0.5)}
        record.proxies.insert(0, {**line, "parent": f"link_{i - 1}" if i else None})
    realise_record(record)
    bpy.context.view_layer.update()
    for i in range(6):
        points = world_points(thing(f"link_{i}"))
        assert np.allclose((points.min(axis=0) + points.max(axis=0)) / 2, (0.3 * i, 1.1 * i, 0.5), atol=1e-5)


def test_an_edited_mesh_is_fitted_not_replaced(record: Any) -> None:
    realise_record(record)
    bed = thing("bed_1")
    count = len(bed.data.vertices)
    bed.data.vertices.add(1)
    bed.data.vertices[count].co = (0, 0, 0.9)
    changed = copy.deepcopy(record)
    line_of(changed, "bed_1").update(size=(2.0, 2.2, 1.2), centre=(0.1, 0.1, 0.6))
    realise_record(changed)
    bpy.context.view_layer.update()
    assert len(bed.data.vertices) == count + 1
    points = world_points(bed)
    assert np.allclose(np.ptp(points, axis=0), (2.0, 2.2, 1.2), atol=1e-5)


def test_a_linked_copy_does_not_change_with_its_original(record: Any) -> None:
    realise_record(record)
    twin = bpy.data.objects.new("twin", thing("bed_1").data)
    bpy.context.scene.collection.objects.link(twin)
    changed = copy.deepcopy(record)
    line_of(changed, "bed_1")["size"] = (1.0, 1.0, 1.0)
    realise_record(changed)
    assert np.allclose(twin.dimensions, (1.7, 2.0, 0.6), atol=1e-5)


def test_furnished_proxies_show_their_parts(record: Any) -> None:
    triangle = np.array([(0, 0, 0), (0.5, 0, 0), (0, 0, 0.4)], dtype=float)
    uvs = np.array([(0, 0), (1, 0), (0, 1)], dtype=float)
    record.furnished["bed_1"] = [
        Shape(triangle, ((0, 1, 2),), "leg", "wood", uvs=uvs),
        Shape(triangle + 0.1, ((0, 1, 2),), "pillow", "fabric", smooth=True),
    ]
    realise_record(record)
    mesh = thing("bed_1").data
    assert np.allclose(mesh.vertices[4].co, (0.6, 0.1, 0.1), atol=1e-6)
    assert [slot.name for slot in mesh.materials] == ["Room wood #B58B5E", "Room fabric #B9B4AA"]
    assert [(p.material_index, p.use_smooth) for p in mesh.polygons] == [(0, False), (1, True)]
    assert list(mesh["code_as_room_parts"]) == ["leg", "pillow"]
    assert [tuple(c.vector) for c in mesh.uv_layers[0].uv][:3] == [(0, 0), (1, 0), (0, 1)]


def test_lights_and_camera(record: Any) -> None:
    realise_record(record)
    sun = thing("sun_1")
    aim = sun.matrix_world.to_3x3() @ Vector((0, 0, -1))
    assert np.allclose(aim, Vector((1, 0, -5)).normalized(), atol=1e-5)
    assert thing("lamp_light").data.type == "POINT" and thing("lamp_light").data.energy == 40
    record.lights[0] = {**record.lights[0], "kind": "area", "size": 0.5}
    realise_record(record)
    assert thing("lamp_light").data.type == "AREA" and thing("lamp_light").data.size == pytest.approx(0.5)
    assert np.allclose(np.array(thing("reference").matrix_world).ravel(), record.cameras[0]["matrix"], atol=1e-6)
    assert bpy.context.scene.camera == thing("reference")


def test_materials_show_the_family_in_viewport_and_shader(record: Any) -> None:
    realise_record(record)
    material = thing("sofa_1").data.materials[0]
    shader = next(n for n in material.node_tree.nodes if n.type == "BSDF_PRINCIPLED")
    assert np.allclose(shader.inputs["Base Color"].default_value[:3], material.diffuse_color[:3])
    assert material == thing("armchair_1").data.materials[0] != thing("bed_1").data.materials[0]


def test_two_scenes_have_rooms_of_their_own(record: Any) -> None:
    realise_record(record)
    other = bpy.data.scenes.new("other")
    changed = copy.deepcopy(record)
    line_of(changed, "bed_1")["centre"] = (9, 9, 0.3)
    realise_record(changed, scene=other)
    first = [o for o in find_room_collection(bpy.context.scene).all_objects if o.get(ID) == "bed_1"]
    second = [o for o in find_room_collection(other).all_objects if o.get(ID) == "bed_1"]
    assert first[0].location.x == pytest.approx(-0.6) and second[0].location.x == pytest.approx(9)
