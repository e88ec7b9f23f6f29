# SPDX-License-Identifier: GPL-3.0-or-later
"""room.py by itself in plain Python with bpy makes the same objects as the add-on's own interpreter and builder."""

from __future__ import annotations

import inspect
import json
import subprocess
import sys
from pathlib import Path
from typing import Any

import bpy
import pytest
from code_as_room.pipeline.program.assemble import assemble, room_part
from code_as_room.pipeline.program.evaluate import evaluate
from code_as_room.pipeline.program.prelude import registry
from code_as_room.pipeline.scene.realise import realise_record

ROOM = '''
room(size=(4.6, 3.9, 2.6), floor=[(-2.3, -1.95), (2.3, -1.95), (2.3, 1.95), (-2.3, 1.95)])
wall("wall_s", (-2.3, -1.95), (2.3, -1.95), height=2.6)
wall("wall_e", (2.3, -1.95), (2.3, 1.95), height=2.6)
wall("wall_n", (2.3, 1.95), (-2.3, 1.95), height=2.6)
wall("wall_w", (-2.3, 1.95), (-2.3, -1.95), height=2.6)
wall("wall_p", (0.4, -1.95), (0.4, -0.5), height=2.6, thickness=0.08, partition=True)
door("door_1", wall="wall_s", start=(1.2, -1.95), end=(2.05, -1.95), height=2.05, open=80)
window("window_1", wall="wall_w", start=(-2.3, 0.6), end=(-2.3, -0.7))
opening("opening_1", wall="wall_p", start=(0.4, -1.5), end=(0.4, -0.8), height=2.1)
proxy("bed \\\\"1\\\\" é", "double bed", centre=(0.2, 0.7, 0.5), size=(1.7, 2.1, 1.0), yaw=5)
proxy("round_1", "pouf", centre=(-1.5, -1.2, 0.2), size=(0.5, 0.5, 0.4), shape="round")
proxy("desk_1", "desk", centre=(1.7, -1.0, 0.4), size=(1.0, 1.2, 0.8), yaw=90, shape="l_shape")
proxy("lamp_1", "lamp", centre=(1.7, -1.0, 1.0), size=(0.3, 0.3, 0.4), parent="desk_1", placement="surface", salience="minor")
proxy("vase_1", "vase", centre=(-1.9, 1.6, 0.3), size=(0.4, 0.4, 0.6), salience="minor")
proxy("stool_1", "stool", centre=(-0.6, -1.4, 0.25), size=(0.4, 0.4, 0.5), salience="minor")
proxy("stool_2", "stool", centre=(-0.1, -1.4, 0.25), size=(0.4, 0.4, 0.5), yaw=30, salience="minor")
proxy("cloth_1", "runner", centre=(1.7, -1.0, 0.85), size=(0.9, 0.5, 0.02), yaw=80, parent="desk_1", placement="surface")
light("sun_1", "sun", at=(0, 0, 5), energy=3, target=(0.5, 0, 0))
camera("reference", "perspective", matrix=(1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 6, 0, 0, 0, 1), fov_y=0.9, image_size=(640, 480))

# names a room may use for its own things, although the prelude uses them inside
np, bpy, math, record, fail, number, Shape, text = 1, 2, 3, 4, 5, 6, 7, 8


def leg(x, y, height=0.3):
    """One leg."""
    return move(cylinder(0.03, height, segments=8), (x, y, height / 2))


def bed_1():
    legs = [leg(x, y) for x in (-0.8, 0.8) for y in (-1, 1)]
    frame = part("frame", rounded_box((1.7, 2.1, 0.3), 0.03, at=(0, 0, 0.35)), material="wood")
    cover = grid(lambda u, v: lerp(0.0, 0.1, smoothstep(0, 1, sin(u * pi)) * noise(u * 5, v * 5, seed=3)), 12, 10, size=(1.6, 2.0))
    pillows = array(sphere((0.3, 0.2, 0.1), segments=8, rings=6), 2, (0.7, 0, 0))
    soft = [cushion((0.5, 0.5, 0.1), at=(0, 0, 0.6)), pillow((0.4, 0.3, 0.1), at=(0, 0.5, 0.7), seed="p")]
    soft += [tufted((1.6, 0.1, 0.5), 2, 1, at=(0, 1, 0.9)), drape((1.6, 1.0), hang=0.2, at=(0, 0, 0.5), fringe=0.03)]
    soft += [curtain((0.8, 0.1, 1.0), 3, at=(0, 0, 1.5)), rug((1, 1, 0.01), "hide"), leaves(5, 0.2, 0.1, at=(0, 0, 1))]
    block = displace(subdivide(bevel(box((0.3, 0.3, 0.3)), 0.05)), 0.01, 0.1, seed=2)
    sheet = solidify(bend(taper(grid(lambda u, v: (u, v, v), 2, 5), 0.5), 20), 0.02)
    column = loft([[(0, 0), (1, 0), (1, 1)], [(0, 0), (0.5, 0), (0.5, 0.5)]], [0, 1])
    posts = [turn(capsule(0.05, 0.6, segments=8), 10 * i, "x") for i in range(3)]
    top = carve(panelled((0.5, 0.03, 0.6), rows=2), cylinder(0.05, 1, axis="y", edge=0.001))
    board = extrude(rectangle(0.5, 0.3, 0.05), 0.02, holes=[ellipse(0.1, 0.2)])
    seat = [tint(pouf((0.5, 0.5, 0.4)), {"": "#336699"}), wedge((0.2, 0.2, 0.1)), tube(spline([(0, 0, 0), (1, 0, 1), (2, 0, 0)]), 0.02)]
    plants = [leaves(3, 0.2, 0.1, kind=kind) for kind in ("fern", "grass", "succulent")]
    more = [posts, soft, block, sheet, column, top, board, seat, plants]
    return [frame, part("leg", legs, material="metal"), move(cover, (0, 0, 0.7)), part("pillow", pillows), more]


def vase():
    profile = [(0, 0)]
    for i in range(9):
        append(profile, (0.1 + 0.05 * sin(i) + rand(("vase", i), 0, 0.02), i * 0.05))
    body = lathe(profile + [(0, 0.41)], segments=12)
    stems = [tube([(0, 0, 0.4), (0.02 * i, 0.03, 0.5), (0.05 * i, 0.1, 0.6)], [0.01, 0.008, 0.004], 6) for i in range(-1, 2)]
    rim = torus(0.12, 0.01, at=(0, 0, 0.4), segments=12, rings=6)
    foot = extrude([(0, 0), (0.2, 0), (0.2, 0.1), (0.1, 0.1), (0.1, 0.2), (0, 0.2)], 0.02)
    half = scale(cone(0.1, 0.2, 0.05, segments=6), (1, 2, 1))
    other = mirror(move(half, (0.2, 0, 0)), "x")
    edge = sweep([(0, 0), (0.02, 0), (0, 0.02)], [(0, 0, 0), (0.1, 0, 0), (0.1, 0.1, 0)], closed=True)
    flag = mesh([(0, 0, 0), (0.1, 0, 0), (0.1, 0, 0.1)], [(0, 1, 2)])
    low, high = bounds([body, stems])
    lid = box((0.1, 0.1, 0.1), at=(0, 0, high[2])) if size_of(body)[2] > 0.3 else prism(5, 0.1, 0.1)
    sizes = {"a": clamp(3, 0, 1), "b": floor(2.5) + sqrt(2)}
    tags = [prism(5, 0.01 * value, 0.02 + 0.01 * len(name), at=(0, 0.1, 0)) for name, value in items(sizes)]
    return [material("glass", body), smooth(join(stems), False), rim, foot, half, other, edge, flag, lid] + tags


def cloth(size):
    wall = 0.004
    camera = lambda u, v, tall=wall: tall * sin(30 * u)
    return part("cloth", solidify(grid(camera, 20, 12, (size[0], size[1])), 0.01), material="linen")


def stool(size, room=0.05):
    box = cylinder(size[0] / 2, room, at=(0, 0, size[2] - room / 2))
    return part("seat", box, material="wood")


furnish("cloth_1", cloth, lying=True)
furnish("stool_1", stool)
furnish("stool_2", stool)
furnish("bed \\\\"1\\\\" é", bed_1())
furnish("vase_1", vase())
build()
'''.replace("\\\\", "\\")


def dump() -> dict[str, Any]:
    """Everything in the room's collection, as plain values."""
    import bpy

    found = {}
    for obj in bpy.data.collections["Code-as-Room"].all_objects:
        entry = {"type": obj.type, "place": [round(v, 6) for row in obj.matrix_world for v in row]}
        if obj.type == "MESH":
            mesh = obj.data
            entry["vertices"] = [list(v.co) for v in mesh.vertices]
            entry["faces"] = [list(p.vertices) for p in mesh.polygons]
            entry["materials"] = [m.name for m in mesh.materials]
            entry["of_face"] = [p.material_index for p in mesh.polygons]
            entry["smooth"] = [p.use_smooth for p in mesh.polygons]
            entry["sharp"] = sorted(sorted(e.vertices) for e in mesh.edges if e.use_edge_sharp)
            entry["uvs"] = [list(c.vector) for c in mesh.uv_layers[0].uv] if mesh.polygons else []
        found[obj.name] = entry
    return found


def run_plainly(text: str, folder: Path, before: str = "") -> dict[str, Any]:
    """What plain Python makes of a room.py, in a process of its own that never sees the package."""
    (folder / "room.py").write_text(text, encoding="utf-8")
    code = (
        f"import json, runpy, sys, bpy\nbpy.ops.wm.read_factory_settings(use_empty=True)\n{before}\n"
        f"runpy.run_path('room.py', run_name='__main__')\nbpy.context.view_layer.update()\n"
        f"assert 'code_as_room' not in sys.modules\n"
        f"from typing import Any\n{inspect.getsource(dump)}\n"
        "json.dump(dump(), open('dump.json', 'w'))\n"
    )
    done = subprocess.run([sys.executable, "-c", code], cwd=folder, capture_output=True, text=True, timeout=120)
    assert done.returncode == 0, done.stderr
    result: dict[str, Any] = json.loads((folder / "dump.json").read_text())
    return result


@pytest.fixture
def empty_blender() -> None:
    bpy.ops.wm.read_factory_settings(use_empty=True)


def test_the_text_means_the_same_in_plain_python_and_in_the_add_on(tmp_path, empty_blender) -> None:
    full = assemble(ROOM)
    plain = run_plainly(full, tmp_path)
    realise_record(evaluate(room_part(full)))
    bpy.context.view_layer.update()
    ours = json.loads(json.dumps(dump()))
    assert plain.keys() == ours.keys()
    assert bpy.data.objects["stool_1"].data == bpy.data.objects["stool_2"].data
    assert ours["cloth_1"]["vertices"] != [list(v) for s in evaluate(ROOM).plain["cloth_1"] for v in s.vertices]
    for name, entry in ours.items():
        assert plain[name] == entry, name
    assert {'bed "1" é', "round_1", "desk_1", "lamp_1", "vase_1", "sun_1", "reference", "wall_s", "floor"} <= set(plain)
    assert len(plain['bed "1" é']["faces"]) > 400 and "LIGHT" in {entry["type"] for entry in plain.values()}


def test_the_room_of_the_test_uses_every_constructor() -> None:
    unused = [name for name in registry.CONSTRUCTORS if f"{name}(" not in ROOM]
    assert set(unused) <= {"keys", "values"}


def test_room_py_leaves_the_rest_of_the_file_alone_and_can_run_twice(tmp_path) -> None:
    mine = "mesh = bpy.data.meshes.new('mine'); obj = bpy.data.objects.new('bed_1', mesh)\n"
    mine += "bpy.context.scene.collection.objects.link(obj)"
    once = run_plainly(assemble(ROOM), tmp_path, mine)
    (tmp_path / "first.py").write_text(assemble(ROOM), encoding="utf-8")
    twice = run_plainly(assemble(ROOM), tmp_path, mine + "\nrunpy.run_path('first.py')")
    assert once == twice


def test_a_wrong_room_makes_nothing(tmp_path) -> None:
    wrong = assemble(ROOM.replace('wall="wall_s"', 'wall="wall_x"'))
    with pytest.raises(AssertionError, match="'door_1' lies in 'wall_x', which is not a wall of this room"):
        run_plainly(wrong, tmp_path)
