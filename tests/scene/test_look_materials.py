# SPDX-License-Identifier: GPL-3.0-or-later
"""Looks as Blender materials: one for each look, geometry untouched, what the artist did is kept, room.py makes the same."""

from __future__ import annotations

import inspect
import json
import subprocess
import sys
from typing import Any

import bpy
import numpy as np
import pytest
from code_as_room.pipeline.program.assemble import assemble
from code_as_room.pipeline.program.evaluate import evaluate
from code_as_room.pipeline.program.prelude import registry
from code_as_room.pipeline.scene.plain_materials import plain_materials
from code_as_room.pipeline.scene.realise import realise_record
from code_as_room.pipeline.scene.tags import COLOUR

HEAD = """room(size=(4, 4, 2.6), floor=[(-2, -2), (2, -2), (2, 2), (-2, 2)])
wall("wall_s", (-2, -2), (2, -2), height=2.6)
window("window_1", wall="wall_s", start=(-1, -2), end=(0.5, -2))
proxy("desk_1", "desk", centre=(0, 0, 0.4), size=(1.2, 0.6, 0.8))
proxy("desk_2", "desk", centre=(0, 1.5, 0.4), size=(1.2, 0.6, 0.8))
proxy("box_1", "bed", centre=(1, -1, 0.2), size=(0.4, 0.4, 0.4))


def desk(size):
    w, d, h = size
    top = part("top", rounded_box((w, d, 0.03), at=(0, 0, h - 0.015)), material="wood")
    legs = [part("leg", cylinder(0.03, h - 0.03, at=(x, 0, (h - 0.03) / 2), segments=8), material="wood") for x in (-0.5, 0.5)]
    return [top, legs, part("mat", box((0.4, 0.3, 0.01), at=(0, 0, h + 0.005)), material="fabric #7C8A94")]


furnish("desk_1", desk)
furnish("desk_2", desk)
"""
LOOKS = """oak = wood("#6A4A32", along="x")
finish("desk_1", {"leg": metal("#3A3A3C", finish="cast"), "wood": oak})
finish("desk_2", oak)
finish("walls", plaster("#D8E0E4"))
finish("floor", planks("#A9794F"))
finish("window_1", {"frame": oak})
"""
EVERY = "\n".join(
    [
        *(f'proxy("p_{n}", "thing", centre=(0, 0, 0.1), size=(0.2, 0.2, 0.2))' for n in registry.LOOKS),
        *(
            f'furnish("p_{n}", box((0.2, 0.2, 0.2)))\nfinish("p_{n}", {n}())'
            for n in registry.LOOKS
            if not n.endswith("_map") and n not in ("picture", "ramp", "mix", "bump")
        ),
        'finish("p_mix", principled(base=mix(ramp(wave_map(0.1), [(0, "#112233"), (0.5, "#445566"), (1, "#778899")]),'
        ' picture("floor", size=(2.4, 1.2), turned=30), brick_map((0.3, 0.1), turned=True), mode="multiply"), alpha=0.8,'
        ' roughness=ramp(voronoi_map(0.1, "edge"), [(0, 0.2), (1, 0.9)]), emission="#FFFFFF", strength=1, coat=0.5, sheen=0.2,'
        " specular=0.3, transmission=0.2, ior=1.3, metallic=0.1, bump=bump(noise_map(0.02, stretch=(1, 4)), 0.002)))",
        'furnish("p_mix", box((0.2, 0.2, 0.2)))',
    ]
)


def build(text: str) -> list[str]:
    """Make a room in the open file."""
    return realise_record(evaluate(text + "\nbuild()\n"))


def geometry() -> dict[str, Any]:
    """Every mesh and transform."""
    found = {}
    for obj in bpy.data.objects:
        if obj.type == "MESH":
            places = np.empty(3 * len(obj.data.vertices), dtype=np.float32)
            obj.data.vertices.foreach_get("co", places)
            corners = [tuple(p.vertices) for p in obj.data.polygons]
            found[obj.name] = (places.tobytes(), corners, [tuple(row) for row in obj.matrix_world])
    return found


def slots(name: str) -> list[str]:
    """The keys of an object's materials."""
    return [str(m.get(COLOUR)) for m in bpy.data.objects[name].data.materials]


@pytest.fixture(autouse=True)
def empty_blender() -> None:
    bpy.ops.wm.read_factory_settings(use_empty=True)


def test_finishing_changes_materials_and_nothing_else() -> None:
    build(HEAD)
    before = geometry()
    assert slots("desk_1") == slots("desk_2") == ['wood("#B58B5E")', 'fabric("#7C8A94")']
    assert slots("box_1")[0] == "bed/"  # a stand-in keeps its flat colour
    assert build(HEAD + LOOKS) == []
    assert geometry() == before
    assert slots("desk_1") == ['wood("#6A4A32", along="x")', 'metal("#3A3A3C", finish="cast")', 'fabric("#7C8A94")']
    assert slots("floor") == ['planks("#A9794F")'] and slots("wall_s") == ['plaster("#D8E0E4")']
    assert slots("window_1") == ['wood("#6A4A32", along="x")', 'glass("#BFDDEA")']
    build(HEAD)
    assert geometry() == before and slots("desk_1") == ['wood("#B58B5E")', 'fabric("#7C8A94")']


def test_equal_looks_are_one_material_and_building_again_makes_none() -> None:
    build(HEAD + LOOKS)
    keys = [m[COLOUR] for m in bpy.data.materials if COLOUR in m]
    assert len(keys) == len(set(keys))
    users = {bpy.data.objects[name].data.materials[0].name for name in ("desk_1", "desk_2", "window_1")}
    assert len(users) == 1
    build(HEAD + LOOKS)
    assert [m[COLOUR] for m in bpy.data.materials if COLOUR in m] == keys


def test_a_finish_of_what_is_not_there_is_noted() -> None:
    (note,) = build(HEAD + 'finish("desk_1", {"shelf": stone(), "leg": stone()})')
    assert "'desk_1'" in note and "'shelf'" in note and "leg, mat, top" in note


def test_the_artists_change_of_a_material_stays() -> None:
    build(HEAD)
    material = bpy.data.objects["desk_1"].data.materials[0]
    shader = next(n for n in material.node_tree.nodes if n.type == "BSDF_PRINCIPLED")
    shader.inputs["Metallic"].default_value = 0.77
    build(HEAD.replace("0.015))", "0.02))"))
    material = bpy.data.objects["desk_1"].data.materials[0]
    shader = next(n for n in material.node_tree.nodes if n.type == "BSDF_PRINCIPLED")
    assert shader.inputs["Metallic"].default_value == pytest.approx(0.77)


def test_a_material_that_the_artist_put_into_a_slot_stays_through_finishing() -> None:
    build(HEAD)
    bpy.data.objects["desk_1"].data.materials[1] = bpy.data.materials.new("mine")
    build(HEAD + LOOKS)
    names = [m.name for m in bpy.data.objects["desk_1"].data.materials]
    assert names[2] == "mine" and slots("desk_1")[0] == 'wood("#6A4A32", along="x")'


def test_a_mesh_that_the_artist_edited_gets_its_finish_and_stays_as_it_is() -> None:
    build(HEAD)
    mesh = bpy.data.objects["desk_1"].data
    mesh.vertices[0].co.x -= 0.02
    count, place = len(mesh.vertices), tuple(mesh.vertices[0].co)
    build(HEAD + LOOKS)
    mesh = bpy.data.objects["desk_1"].data
    assert (len(mesh.vertices), tuple(mesh.vertices[0].co)) == (count, place)
    assert slots("desk_1") == ['wood("#6A4A32", along="x")', 'fabric("#7C8A94")']


def test_solid_view_and_the_critics_pictures_keep_the_palette() -> None:
    build(HEAD)
    wood, fabric = (tuple(m.diffuse_color) for m in bpy.data.objects["desk_1"].data.materials)
    assert wood == pytest.approx((0.462, 0.258, 0.112, 1), abs=0.002)
    assert fabric == pytest.approx((0.202, 0.254, 0.296, 1), abs=0.002)
    pane = bpy.data.objects["window_1"].data.materials[1]
    assert pane.diffuse_color[3] == pytest.approx(0.35)


def test_every_look_is_small_ends_in_a_surface_and_uses_only_sockets_that_are_there() -> None:
    build(HEAD + EVERY)
    looks = [m for m in bpy.data.materials if COLOUR in m and "(" in m[COLOUR]]
    assert len(looks) >= 29
    for material in looks:
        tree = material.node_tree
        assert len(tree.nodes) <= 24, material.name
        end = next(n for n in tree.nodes if n.type == "OUTPUT_MATERIAL")
        assert end.inputs["Surface"].is_linked and all(link.is_valid for link in tree.links)
        assert sum(n.type == "BSDF_PRINCIPLED" for n in tree.nodes) == 1
        for node in tree.nodes:  # nothing hangs loose: every node's work is used
            assert node == end or any(o.is_linked for o in node.outputs), (material.name, node.name)
    glass = next(m for m in looks if m[COLOUR].startswith("glass"))
    assert glass.surface_render_method == "BLENDED"
    shader = next(n for n in glass.node_tree.nodes if n.type == "BSDF_PRINCIPLED")
    assert shader.inputs["Transmission Weight"].default_value == 1


def test_a_picture_without_a_size_fills_its_part_once_upright() -> None:
    art = (
        'proxy("art_1", "painting", centre=(0, -1.9, 1.5), size=(1.2, 0.04, 0.8), yaw=180, placement="wall")\n'
        'frame = part("frame", box((1.2, 0.03, 0.8), at=(0, 0.005, 0.4)))\n'
        'furnish("art_1", [frame, part("canvas", box((1, 0.01, 0.6), at=(0, -0.015, 0.4)))])\n'
    )
    build(HEAD + art)
    before = geometry()
    build(HEAD + art + 'finish("art_1", {"canvas": principled(base=picture("sun"))})')
    assert geometry() == before
    mesh = bpy.data.objects["art_1"].data
    places = {}
    for polygon in mesh.polygons:
        if mesh.materials[polygon.material_index][COLOUR].startswith("principled"):
            for corner in polygon.loop_indices:
                places[tuple(mesh.vertices[mesh.loops[corner].vertex_index].co)] = tuple(
                    mesh.uv_layers[0].uv[corner].vector
                )
    for (x, _, z), (u, v) in places.items():
        assert (u, v) == pytest.approx((x + 0.5, (z - 0.1) / 0.6), abs=1e-5)


def test_exports_get_the_mean_colour_while_they_run() -> None:
    build(HEAD + LOOKS)
    material = bpy.data.objects["floor"].data.materials[0]
    shader = next(n for n in material.node_tree.nodes if n.type == "BSDF_PRINCIPLED")
    with plain_materials():
        assert not shader.inputs["Base Color"].is_linked and not shader.inputs["Roughness"].is_linked
        assert tuple(shader.inputs["Base Color"].default_value)[:3] == pytest.approx((0.397, 0.191, 0.078), abs=0.002)
    assert shader.inputs["Base Color"].is_linked and shader.inputs["Roughness"].is_linked


def dump() -> dict[str, Any]:
    """Every material of ours, node by node, and which meshes use it."""
    import bpy

    def plain(value: Any) -> Any:
        if isinstance(value, (bool, int, str)) or value is None:
            return value
        return round(value, 5) if isinstance(value, float) else [round(float(v), 5) for v in value]

    found: dict[str, Any] = {}
    for material in bpy.data.materials:
        if "code_as_room_colour" not in material:
            continue
        nodes = {}
        for node in material.node_tree.nodes:
            inputs = [
                [s.identifier, plain(s.default_value)]
                for s in node.inputs
                if hasattr(s, "default_value") and s.type != "SHADER"
            ]
            ramp = (
                [[e.position, plain(e.color)] for e in node.color_ramp.elements] if hasattr(node, "color_ramp") else []
            )
            nodes[node.name] = [node.bl_idname, plain(node.location), inputs, ramp]
        links = [
            [x.from_node.name, x.from_socket.identifier, x.to_node.name, x.to_socket.identifier]
            for x in material.node_tree.links
        ]
        looks = [plain(material.diffuse_color), plain(material.roughness), material.surface_render_method]
        found[material["code_as_room_colour"]] = [material.name, nodes, sorted(links), looks]
    for obj in bpy.data.objects:
        if obj.type == "MESH":
            found["object " + obj.name] = [m.name for m in obj.data.materials]
    return found


def test_room_py_makes_the_same_materials_in_plain_blender(tmp_path) -> None:
    text = HEAD + LOOKS + EVERY + "\nbuild()\n"
    (tmp_path / "room.py").write_text(assemble(text), encoding="utf-8")
    code = (
        "import json, runpy, bpy\nfrom typing import Any\nbpy.ops.wm.read_factory_settings(use_empty=True)\n"
        f"runpy.run_path('room.py')\n{inspect.getsource(dump)}\njson.dump(dump(), open('dump.json', 'w'))\n"
    )
    done = subprocess.run([sys.executable, "-c", code], cwd=tmp_path, capture_output=True, text=True, timeout=180)
    assert done.returncode == 0, done.stderr
    build(HEAD + LOOKS + EVERY)
    assert json.loads((tmp_path / "dump.json").read_text()) == json.loads(json.dumps(dump()))
