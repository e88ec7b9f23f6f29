# SPDX-License-Identifier: GPL-3.0-or-later
"""glTF and USD exports, imported again: names, shapes and looks arrive, and the scene is as it was, also after a failure."""

from __future__ import annotations

import io
import json
import resource
import struct
from collections.abc import Callable
from pathlib import Path
from typing import Any

import bpy
import numpy as np
import pytest
from code_as_room.pipeline.errors import OutputError, SceneError
from code_as_room.pipeline.program.evaluate import evaluate
from code_as_room.pipeline.program.prelude.palette import linear_colour
from code_as_room.pipeline.scene.exports import export_glb, export_usdz
from code_as_room.pipeline.scene.realise import realise_record
from PIL import Image

ROOM = """room(size=(4, 3, 2.6), floor=[(-2, -1.5), (2, -1.5), (2, 1.5), (-2, 1.5)])
wall("wall_s", (-2, -1.5), (2, -1.5), height=2.6)
wall("wall_n", (2, 1.5), (-2, 1.5), height=2.6)
window("window_1", wall="wall_s", start=(-1, -1.5), end=(0.5, -1.5))
proxy("chair_1", "chair", centre=(0, 0.5, 0.45), size=(0.5, 0.5, 0.9))
proxy("chair_2", "chair", centre=(1, 0.5, 0.45), size=(0.5, 0.5, 0.9), yaw=90)
proxy("lamp_1", "lamp", centre=(-1, 0.5, 0.25), size=(0.3, 0.3, 0.5))
proxy("mirror_1", "mirror", centre=(-1.5, 1.45, 1.5), size=(0.6, 0.05, 1.0), placement="wall", parent="wall_n")
proxy("rug_1", "rug", centre=(0, -0.5, 0.01), size=(1.6, 0.8, 0.02))


def chair(size):
    w, d, h = size
    seat = part("seat", box((w, d, 0.05), at=(0, 0, h / 2)), material="wood")
    return [seat, part("back", box((w, 0.05, h), at=(0, d / 2 - 0.025, h / 2)))]


furnish("chair_1", chair)
furnish("chair_2", chair)
furnish("lamp_1", part("bulb", sphere(0.15, at=(0, 0, 0.25))))
furnish("mirror_1", part("glass", box((0.6, 0.05, 1.0), at=(0, 0, 0.5))))
furnish("rug_1", box((1.6, 0.8, 0.02), at=(0, 0, 0.01)))
oak = wood("#6A4A32")
finish("chair_1", {"wood": oak, "back": fabric("#7C8A94")})
finish("chair_2", {"wood": oak, "back": fabric("#7C8A94")})
finish("lamp_1", glow("#FFD9A0"))
finish("mirror_1", mirror_glass())
finish("floor", principled(base=picture("boards", size=(0.8, 0.4), turned=90, space="object"), roughness=0.4))
finish("rug_1", principled(base=picture("woven"), roughness=0.9))
finish("walls", plaster("#D8E0E4"))
light("sun_1", "sun", (0, 0, 5), energy=3, target=(1, 0, 0))
view("view", exposure=0.5, ceiling=2.6, cut=1.2)
build()
"""
OURS = {"floor", "ceiling", "wall_s", "wall_n", "window_1", "chair_1", "chair_2", "lamp_1", "mirror_1", "rug_1"}


@pytest.fixture
def scene() -> Any:
    for name, size in (("boards", (32, 16)), ("woven", (24, 12))):
        pixels = np.zeros((size[1], size[0], 3), dtype=np.uint8)
        pixels[:, : size[0] // 2] = (200, 40, 40)
        buffer = io.BytesIO()
        Image.fromarray(pixels).save(buffer, "PNG")
        image: Any = bpy.data.images.new(name, *size)
        image.pack(data=buffer.getvalue(), data_len=len(buffer.getvalue()))
        image.source = "FILE"
    realise_record(evaluate(ROOM))
    bpy.context.view_layer.update()
    return bpy.context.scene


def everything() -> dict[str, Any]:
    """All of the file that an export could have changed: datablocks, meshes with UVs, slots, nodes and links."""
    found: dict[str, Any] = {}
    for kind in ("objects", "meshes", "materials", "images", "collections", "scenes", "worlds", "node_groups"):
        found[kind] = sorted(getattr(bpy.data, kind).keys())
    for obj in bpy.data.objects:
        found["object " + obj.name] = (obj.data.name if obj.data else "", obj.select_get(), obj.hide_render,
                                       tuple(c.name for c in obj.users_collection), [tuple(r) for r in obj.matrix_world])  # fmt: skip
    for mesh in bpy.data.meshes:
        uvs = np.empty(2 * len(mesh.loops), dtype=np.float32)
        if mesh.uv_layers:
            mesh.uv_layers.active.uv.foreach_get("vector", uvs)
        found["mesh " + mesh.name] = (
            uvs.tobytes(),
            len(mesh.vertices),
            mesh.users,
            [m and m.name for m in mesh.materials],
        )
    for material in bpy.data.materials:
        links = sorted((k.from_node.name, k.from_socket.identifier, k.to_node.name, k.to_socket.identifier)
                       for k in material.node_tree.links)  # fmt: skip
        values = [tuple(i.default_value) if i.type == "RGBA" else i.default_value for n in material.node_tree.nodes
                  if n.type == "BSDF_PRINCIPLED" for i in n.inputs if i.type in ("RGBA", "VALUE")]  # fmt: skip
        found["material " + material.name] = (links, values, material.use_backface_culling)
    return found


def bounds(obj: Any) -> Any:
    """Lowest and highest corner in the room, of an object and of what an importer put below it."""
    pieces = [o for o in (obj, *obj.children) if o.type == "MESH" and o.name.split(".")[0] == obj.name.split(".")[0]]
    corners = np.array([o.matrix_world @ v.co for o in pieces for v in o.data.vertices])
    return np.array((corners.min(axis=0), corners.max(axis=0)))


def shader_of(start: str) -> Any:
    """The shader of the imported material whose name begins so."""
    plain = start.replace(" ", "_").replace("#", "_")
    (material,) = [m for m in bpy.data.materials if m.name.startswith((start, plain))]
    return next(n for n in material.node_tree.nodes if n.type == "BSDF_PRINCIPLED")


def colour(start: str) -> Any:
    return np.array(shader_of(start).inputs["Base Color"].default_value[:3])


def import_glb(path: Path) -> None:
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.import_scene.gltf(filepath=str(path))
    bpy.context.view_layer.update()


def import_usdz(path: Path) -> None:
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.wm.usd_import(filepath=str(path))
    bpy.context.view_layer.update()


WAYS = pytest.mark.parametrize(
    ("export", "load", "ending"), [(export_glb, import_glb, ".glb"), (export_usdz, import_usdz, ".usdz")]
)


@WAYS
def test_names_bounds_and_looks_arrive_and_the_scene_stays(
    scene: Any, tmp_path: Path, export: Callable[..., Path], load: Callable[[Path], None], ending: str
) -> None:
    before = everything()
    places = {name: bounds(bpy.data.objects[name]) for name in OURS}
    path = export(scene, tmp_path / "room")
    assert path == tmp_path / f"room{ending}" and everything() == before
    assert [p.name for p in tmp_path.iterdir()] == [path.name]
    load(path)
    assert {o.name for o in bpy.data.objects} >= OURS
    assert not any(o.name.startswith("section") for o in bpy.data.objects)
    for name, was in places.items():
        assert np.abs(bounds(bpy.data.objects[name]) - was).max() < 1e-4, name
    assert np.abs(colour("Room wood #6A4A32") - linear_colour("6A4A32")[:3]).max() < 1e-3
    assert np.abs(colour("Room fabric #7C8A94") - linear_colour("7C8A94")[:3]).max() < 1e-3
    mirror, bulb = shader_of("Room mirror glass").inputs, shader_of("Room glow").inputs
    assert mirror["Metallic"].default_value == 1 and mirror["Roughness"].default_value < 0.1
    assert bulb["Emission Strength"].default_value > 0 and max(bulb["Emission Color"].default_value[:3]) > 0.5
    assert {o.type for o in bpy.data.objects} >= {"MESH", "LIGHT"}


def test_glass_lets_light_through(scene: Any, tmp_path: Path) -> None:
    import_glb(export_glb(scene, tmp_path / "room.glb"))
    assert shader_of("Room glass").inputs["Transmission Weight"].default_value == 1


def test_usd_tells_glass_by_opacity(scene: Any, tmp_path: Path) -> None:
    import_usdz(export_usdz(scene, tmp_path / "room.usdz"))
    assert 0 < shader_of("Room glass").inputs["Alpha"].default_value < 0.5
    assert shader_of("Room wood").inputs["Alpha"].default_value == 1


@WAYS
def test_pictures_stay_pictures_and_lie_as_in_the_room(
    scene: Any, tmp_path: Path, export: Callable[..., Path], load: Callable[[Path], None], ending: str
) -> None:
    load(export(scene, tmp_path / f"room{ending}"))
    floor = next(o for o in bpy.data.objects if o.type == "MESH" and o.name.startswith("floor"))
    rug = next(o for o in bpy.data.objects if o.type == "MESH" and o.name.startswith("rug_1") and len(o.data.vertices))
    for obj, size in ((floor, (32, 16)), (rug, (24, 12))):
        (image,) = {n.image for m in obj.data.materials for n in m.node_tree.nodes if n.type == "TEX_IMAGE"}
        assert tuple(image.size) == size
    for loop in floor.data.loops:
        place = floor.matrix_world @ floor.data.vertices[loop.vertex_index].co
        # 0.8 m wide and laid a quarter turn counter-clockwise, so its width runs along the room's depth.
        lies = np.array(floor.data.uv_layers.active.uv[loop.index].vector)
        assert np.abs(lies - (place.y / 0.8, -place.x / 0.4)).max() < 1e-3
    flat = np.array([tuple(v.vector) for v in rug.data.uv_layers.active.uv])
    assert np.abs(flat.min(axis=0)).max() < 1e-4 and np.abs(flat.max(axis=0) - 1).max() < 1e-4


def test_what_is_shared_is_written_once_and_ceilings_are_seen_through(scene: Any, tmp_path: Path) -> None:
    data = export_glb(scene, tmp_path / "room.glb").read_bytes()
    document = json.loads(data[20 : 20 + struct.unpack("<I", data[12:16])[0]])
    nodes = {node["name"]: node for node in document["nodes"]}
    assert nodes["chair_1"]["mesh"] == nodes["chair_2"]["mesh"]
    names = [m["name"] for m in document["materials"]]
    assert len(names) == len(set(names))
    (surface,) = document["meshes"][nodes["ceiling"]["mesh"]]["primitives"]
    assert not document["materials"][surface["material"]].get("doubleSided", False)
    assert "KHR_texture_transform" not in document.get("extensionsUsed", [])


@WAYS
def test_what_cannot_be_written_costs_nothing(
    scene: Any, tmp_path: Path, export: Callable[..., Path], load: Callable[[Path], None], ending: str
) -> None:
    before = everything()
    with pytest.raises(OutputError, match="No such file or directory"):
        export(scene, tmp_path / "gone" / "room")
    (tmp_path / f"taken{ending}").mkdir()
    with pytest.raises(OutputError, match="a folder of that name"):
        export(scene, tmp_path / "taken")
    standing = tmp_path / f"full{ending}"
    standing.write_bytes(b"earlier")
    limits = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (4000, limits[1]))  # as a full disk: the file ends after 4 kB
    try:
        with pytest.raises(OutputError, match=r"full\.\w+ cannot be written"):
            export(scene, standing)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, limits)
    assert standing.read_bytes() == b"earlier"
    assert {p.name for p in tmp_path.iterdir()} == {standing.name, f"taken{ending}"}
    assert everything() == before


def test_without_a_room_it_says_so(tmp_path: Path) -> None:
    with pytest.raises(SceneError, match="no room"):
        export_glb(bpy.context.scene, tmp_path / "room.glb")
    assert not list(tmp_path.iterdir())
