"""Objects wear assets: in their own box and pose, whatever is done with the room afterwards, and nothing else comes in."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import bpy
import numpy as np
import pytest
from asset_files import coloured, mark, thing, write_library
from code_as_room.pipeline.artifacts.assets import AssetRef, ChosenAsset
from code_as_room.pipeline.errors import SceneError
from code_as_room.pipeline.scene.asset_file import load_asset
from code_as_room.pipeline.scene.assets import asset_of
from code_as_room.pipeline.scene.backend import BlenderScene
from code_as_room.pipeline.scene.boxes import object_box
from code_as_room.pipeline.scene.tags import world_matrix

STAND = 'proxy("stand_1", "nightstand", (-1.75, 0.7, 0.275), (0.5, 0.45, 0.55), yaw=20)'
LAMP = (
    'proxy("lamp_1", "table lamp", ({x}, 0.75, {z}), (0.3, 0.3, {height}), placement="surface", parent="stand_1", '
    'salience="minor", shape="round", yaw=30)'
)
ROOM = "room(size=(5.0, 4.0, 2.6), floor=[(-2.5, -2.0), (2.5, -2.0), (2.5, 2.0), (-2.5, 2.0)])"


def text(height: float = 0.4, x: float = -1.75, lamp: bool = True) -> str:
    lines = [ROOM, STAND, *([LAMP.format(x=x, z=0.55 + height / 2, height=height)] if lamp else []), "build()"]
    return "\n".join(lines) + "\n"


def choice(name: str, obj: str = "lamp_1", kind: Any = "object", turn: int = 0, file: str = "things.blend") -> Any:
    return ChosenAsset(id=obj, asset=AssetRef(library="Mine", file=file, kind=kind, name=name), turn=turn)


def built() -> BlenderScene:
    scene = BlenderScene(bpy.context.scene)
    scene.build(text())
    return scene


@pytest.fixture
def backend() -> BlenderScene:
    return built()


def wear(backend: BlenderScene, folder: Path, *choices: Any) -> dict[str, str]:
    return backend.dress(choices, {c.asset.key: folder / c.asset.file for c in choices})


def points(name: str = "lamp_1") -> Any:
    """The mesh's points in the proxy's own frame."""
    obj = bpy.data.objects[name]
    box = object_box(obj)
    assert box is not None
    angle = np.radians(box.yaw)
    turn = np.array([[np.cos(angle), -np.sin(angle), 0], [np.sin(angle), np.cos(angle), 0], [0, 0, 1]])
    matrix = np.array(world_matrix(obj))
    world = np.array([v.co for v in obj.data.vertices]) @ matrix[:3, :3].T + matrix[:3, 3]
    base = np.array(box.centre) - [0, 0, box.size[2] / 2]
    return (world - base) @ turn


def spans(name: str = "lamp_1") -> Any:
    found = points(name)
    return found.min(axis=0), found.max(axis=0)


def counts() -> dict[str, int]:
    kinds = ("objects", "meshes", "materials", "images", "collections", "scenes", "libraries", "texts", "node_groups")
    return {kind: len(getattr(bpy.data, kind)) for kind in kinds}


def test_it_fills_the_objects_box_and_the_object_stays_where_it_was(backend: BlenderScene, library: Path) -> None:
    before, pose = counts(), np.array(world_matrix(bpy.data.objects["lamp_1"]))
    assert wear(backend, library, choice("Table Lamp Brass")) == {}
    obj = bpy.data.objects["lamp_1"]
    assert asset_of(obj) and np.array_equal(np.array(world_matrix(obj)), pose)
    low, high = spans()
    # The asset is 0.2 x 0.2 x 0.4, the box 0.3 x 0.3 x 0.4, and the asset's origin is metres away from it.
    assert low == pytest.approx([-0.15, -0.15, 0.0], abs=1e-4) and high == pytest.approx([0.15, 0.15, 0.4], abs=1e-4)
    assert [m.name for m in obj.data.materials] == ["Table Lamp Brass paint"]
    assert backend.read_back() == []
    after = counts()
    assert after.pop("materials") - before.pop("materials") <= 1 and after == before
    assert not any(item.asset_data for item in (*bpy.data.objects, *bpy.data.materials, *bpy.data.meshes))


def test_the_parts_of_a_collection_become_one_mesh_whose_uvs_have_one_name(
    backend: BlenderScene, library: Path
) -> None:
    assert wear(backend, library, choice("Clay Vases", kind="collection")) == {}
    mesh = bpy.data.objects["lamp_1"].data
    assert len(mesh.polygons) == 12 and [m.name for m in mesh.materials] == ["Clay 0", "Clay 1"]
    slots = sorted(face.material_index for face in mesh.polygons)
    assert slots == [0] * 6 + [1] * 6
    assert "UVMap" in mesh.uv_layers


def test_it_follows_every_new_layout_and_survives_one_without_it(backend: BlenderScene, library: Path) -> None:
    wear(backend, library, choice("Table Lamp Brass"))
    backend.build(text(height=0.5, x=-1.6))
    assert asset_of(bpy.data.objects["lamp_1"])
    assert spans()[1] == pytest.approx([0.15, 0.15, 0.5], abs=1e-4)
    assert bpy.data.objects["lamp_1"].scale[:] == pytest.approx((1, 1, 1)) and backend.read_back() == []
    backend.build(text(lamp=False))
    (library / "things.blend").unlink()
    backend.build(text(height=0.45))
    assert asset_of(bpy.data.objects["lamp_1"]) and spans()[1][2] == pytest.approx(0.45, abs=1e-4)


def test_it_is_in_the_file_without_its_library(backend: BlenderScene, library: Path, tmp_path: Path) -> None:
    wear(backend, library, choice("Table Lamp Brass"))
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "room.blend"))
    (library / "things.blend").unlink()
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "room.blend"))
    again = BlenderScene(bpy.context.scene)
    assert asset_of(bpy.data.objects["lamp_1"]) and not len(bpy.data.libraries)
    again.build(text(height=0.6))
    assert spans()[1][2] == pytest.approx(0.6, abs=1e-4)
    # Another object may have the same asset, from the mesh that is in the file.
    assert again.dress([choice("Table Lamp Brass", "stand_1")], {}) == {}
    assert spans("stand_1")[1][2] == pytest.approx(0.55, abs=1e-4)


def test_what_was_moved_and_scaled_by_hand_keeps_its_matrix_bit_for_bit(backend: BlenderScene, library: Path) -> None:
    obj = bpy.data.objects["lamp_1"]
    obj.scale, obj.location.x = (1.0, 1.0, 2.0), obj.location.x + 0.05
    bpy.context.view_layer.update()
    backend.read_back()
    backend.hold(frozenset({"lamp_1"}))
    now = np.array(world_matrix(obj))
    wear(backend, library, choice("Table Lamp Brass"))
    assert np.array_equal(np.array(world_matrix(obj)), now)
    low, high = spans()
    assert high - low == pytest.approx([0.3, 0.3, 0.8], abs=1e-3)
    x, y, z = (column / np.linalg.norm(column) for column in np.array(world_matrix(obj))[:3, :3].T)
    assert abs(x @ y) + abs(y @ z) < 1e-6


def test_without_it_the_program_is_shown_again(backend: BlenderScene, library: Path) -> None:
    shape = points().copy()
    materials = len(bpy.data.materials)
    wear(backend, library, choice("Table Lamp Brass"))
    assert backend.undress(["lamp_1", "stand_1"]) == ["lamp_1"]
    backend.build(text())
    assert np.allclose(points(), shape, atol=1e-6) and backend.read_back() == []
    assert len(bpy.data.materials) == materials and not asset_of(bpy.data.objects["lamp_1"])


def test_a_quarter_turn_turns_it_in_its_box(backend: BlenderScene, library: Path) -> None:
    wear(backend, library, choice("Étagère 書架", "stand_1"))
    wide = np.ptp(points("stand_1"), axis=0)
    wear(backend, library, choice("Étagère 書架", "stand_1", turn=1))
    turned = np.ptp(points("stand_1"), axis=0)
    assert wide[0] > wide[1] and turned[1] > turned[0]


@pytest.mark.parametrize(
    ("name", "kind", "says"),
    [
        ("Reading Nook Empty", "object", "has no mesh"),
        ("Empty Stool", "collection", "has no mesh"),
        ("No Such Thing", "object", "is no asset of things.blend any more"),
    ],
)
def test_what_is_no_furniture_changes_nothing_and_stops_no_other(
    backend: BlenderScene, library: Path, name: str, kind: str, says: str
) -> None:
    mesh, before = bpy.data.objects["lamp_1"].data, counts()
    failed = wear(backend, library, choice(name, kind=kind), choice("Huge Vase", "stand_1"))
    assert set(failed) == {"lamp_1"} and says in failed["lamp_1"]
    assert bpy.data.objects["lamp_1"].data == mesh and asset_of(bpy.data.objects["stand_1"])
    after = counts()
    assert {k: after[k] for k in after if k != "materials"} == {k: before[k] for k in before if k != "materials"}
    assert spans("stand_1")[1][2] == pytest.approx(0.55, abs=1e-3)  # from 1 km


def test_broken_and_missing_files_are_a_sentence(backend: BlenderScene, tmp_path: Path) -> None:
    before = counts()
    (tmp_path / "broken.blend").write_bytes(b"BLENDER-v405REND" + b"\xff" * 4000)
    assert "cannot be read" in wear(backend, tmp_path, choice("Lamp", file="broken.blend"))["lamp_1"]
    assert "cannot be read" in wear(backend, tmp_path, choice("Lamp", file="gone.blend"))["lamp_1"]
    failed = backend.dress([choice("Lamp")], {})
    assert '"Mine" does not have things.blend' in failed["lamp_1"] and "Preferences" in failed["lamp_1"]
    assert counts() == before


def test_modifiers_and_instances_come_and_cutters_do_not(tmp_path: Path) -> None:
    def make() -> None:
        inner = bpy.data.collections.new("leg")
        leg = thing("leg", (0.1, 0.1, 0.5), into=inner)
        whole = bpy.data.collections.new("Stool")
        bpy.context.scene.collection.children.link(whole)
        for number in range(3):
            empty = bpy.data.objects.new(f"place {number}", None)
            empty.instance_type, empty.instance_collection = "COLLECTION", inner
            empty.location, empty.scale = (0.3 * number, 0.0, 0.0), (-1.0, 1.0, 1.0)
            whole.objects.link(empty)
        seat = thing("seat", (0.7, 0.4, 0.1), origin=(0.3, 0.0, 0.3), into=whole)
        seat.modifiers.new("more", "SUBSURF").levels = 1
        cutter = thing("cutter", (9.0, 9.0, 9.0), into=whole)
        cutter.display_type = "WIRE"
        assert leg.users
        mark(whole, ("stool",))

    write_library(tmp_path / "stool.blend", make)
    mesh, notes = load_asset(tmp_path / "stool.blend", choice("Stool", kind="collection").asset)
    assert not notes and len(mesh.polygons) == 3 * 6 + 24
    size = np.ptp(np.array([v.co for v in mesh.vertices]), axis=0)
    assert (size < 1.0).all()
    # Mirrored legs still show their outsides.
    centre = np.mean([v.co for v in mesh.vertices], axis=0)
    top = max(mesh.polygons, key=lambda face: face.center.z)
    assert top.normal.z > 0.9 and np.isfinite(centre).all()


def test_pictures_are_packed_and_a_missing_one_is_told(tmp_path: Path, picture_of_colour: Any) -> None:
    wood, lost = picture_of_colour("wood"), picture_of_colour("lost")

    def make() -> None:
        for name, path in (("Mug", wood), ("Cup", lost)):
            obj = thing(name, (0.1, 0.1, 0.1))
            material = obj.data.materials[0]
            if not material.node_tree:
                material.use_nodes = True
            node = material.node_tree.nodes.new("ShaderNodeTexImage")
            node.image = bpy.data.images.load(str(path))
            material["code_as_room_colour"] = "table/"  # as if the library were a room of ours

    write_library(tmp_path / "mugs.blend", make)
    lost.unlink()
    backend = built()
    wear(backend, tmp_path, choice("Mug", file="mugs.blend"))
    assert [image.name for image in bpy.data.images if image.packed_file] == ["wood.png"]
    assert not any("code_as_room_colour" in m for m in bpy.data.objects["lamp_1"].data.materials)
    backend.prepare_asset(choice("Cup", file="mugs.blend").asset, tmp_path / "mugs.blend")
    assert any("lost.png" in notice for notice in backend.notices)


def test_too_many_faces_are_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, library: Path) -> None:
    monkeypatch.setattr("code_as_room.pipeline.scene.asset_file.MOST_FACES", 5)
    before = counts()
    with pytest.raises(SceneError, match="faces"):
        load_asset(library / "things.blend", choice("Table Lamp Brass").asset)
    assert counts() == before


def test_what_the_artist_has_under_the_same_names_is_left_alone(backend: BlenderScene, library: Path) -> None:
    own = coloured("Table Lamp Brass paint")
    own.use_fake_user = True
    mine = bpy.data.objects.new("Table Lamp Brass", None)
    bpy.context.scene.collection.objects.link(mine)
    wear(backend, library, choice("Table Lamp Brass"))
    assert bpy.data.objects["Table Lamp Brass"] == mine and mine.data is None
    assert bpy.data.materials["Table Lamp Brass paint"] == own
    assert bpy.data.objects["lamp_1"].data.materials[0] != own


def test_a_copy_made_by_hand_wears_it_too(backend: BlenderScene, library: Path) -> None:
    wear(backend, library, choice("Table Lamp Brass"))
    obj = bpy.data.objects["lamp_1"]
    copy = obj.copy()
    copy.data = obj.data.copy()
    copy.location.x += 0.6
    obj.users_collection[0].objects.link(copy)
    edits = backend.read_back()
    assert [(edit.op, edit.id) for edit in edits] == [("add", "lamp_2")]
    assert edits[0].size == pytest.approx((0.3, 0.3, 0.4), abs=1e-3) and asset_of(copy)


def test_instances_that_geometry_nodes_make_of_no_object_come_too(tmp_path: Path) -> None:
    def make() -> None:
        group: Any = bpy.data.node_groups.new("scatter", "GeometryNodeTree")
        group.interface.new_socket("Geometry", in_out="OUTPUT", socket_type="NodeSocketGeometry")
        points, cube, scatter, out = (
            group.nodes.new(kind)
            for kind in (
                "GeometryNodeMeshLine",
                "GeometryNodeMeshCube",
                "GeometryNodeInstanceOnPoints",
                "NodeGroupOutput",
            )
        )
        points.inputs["Count"].default_value = 4
        group.links.new(points.outputs[0], scatter.inputs["Points"])
        group.links.new(cube.outputs[0], scatter.inputs["Instance"])
        group.links.new(scatter.outputs[0], out.inputs[0])
        obj = thing("Book Row", (0.1, 0.1, 0.1))
        modifier: Any = obj.modifiers.new("scatter", "NODES")
        modifier.node_group = group

    write_library(tmp_path / "row.blend", make)
    mesh, _ = load_asset(tmp_path / "row.blend", choice("Book Row").asset)
    assert len(mesh.polygons) == 4 * 6
    assert not bpy.data.node_groups
