# SPDX-License-Identifier: GPL-3.0-or-later
"""A room.py as it is handed out makes the add-on's scene, property by property, and is as short and clean as promised."""

from __future__ import annotations

import inspect
import json
import subprocess
import sys
from pathlib import Path
from typing import Any

import bpy
import pytest
from code_as_room.pipeline.program import assemble
from code_as_room.pipeline.program.assemble import MOST_BYTES, assemble_file, room_part
from code_as_room.pipeline.program.evaluate import evaluate
from code_as_room.pipeline.program.finishes import read_materials
from code_as_room.pipeline.program.limits import FINISHED_ROOM_LIMITS
from code_as_room.pipeline.program.lines import parse_layout
from code_as_room.pipeline.scene.realise import realise_record
from test_room_py import ROOM

ROOT = Path(__file__).resolve().parents[2]
LIMITS = {12: MOST_BYTES, 24: MOST_BYTES, 50: 380_000}
"""Bytes of a room of 100 objects, by the number of its kinds of furniture."""


def sizes() -> Any:
    """The generator of the benchmark, which is no part of the package."""
    sys.path.insert(0, str(ROOT))
    try:
        import benchmark.room_size as module
    finally:
        sys.path.remove(str(ROOT))
    return module


def bedroom() -> str:
    """The sample's bedroom with materials, light, and cameras, as all stages leave it."""
    text = (Path(__file__).parent / "bedroom.room").read_text(encoding="utf-8")
    made = sizes()
    lights = made.LIGHTS[: made.LIGHTS.index("# Cameras")] + made.LIGHTS[made.LIGHTS.index('camera("top"') :]
    looks = ['oak = wood("#8A5F3C")', 'print_1 = principled(base=picture("print", color="#806040"))']
    finishes = ['finish("floor", planks("#A9825A"))', 'finish("walls", plaster("#E6E0D4"))', 'finish("desk_1", oak)',
                'finish("picture_1", {"print": print_1, "": metal("#8A8A8C")})', 'finish("duvet_1", linen("#D9C7A8"))']  # fmt: skip
    return text.replace("build()", "\n".join([*looks, *finishes, lights, "build()"]))


def dump() -> dict[str, Any]:
    """Everything that a room made in this file, as plain values."""
    import bpy

    def plain(value: Any) -> Any:
        if isinstance(value, float):
            return round(value, 5)
        if value is None or isinstance(value, (bool, int, str)):
            return value
        if isinstance(value, bpy.types.ID):
            return value.name
        if hasattr(value, "items"):
            return {k: plain(v) for k, v in value.items()}
        return [plain(v) for v in value]

    def own(thing: Any) -> Any:
        return {key: plain(thing[key]) for key in sorted(thing.keys()) if key != "cycles"}

    def nodes(tree: Any) -> Any:
        found = {}
        for node in tree.nodes:
            inputs = [(s.identifier, plain(s.default_value)) for s in node.inputs if hasattr(s, "default_value")]
            image = getattr(node, "image", None)
            found[node.name] = [node.bl_idname, plain(node.location), inputs, image.name if image else None]
        ends = [
            [x.from_node.name, x.from_socket.identifier, x.to_node.name, x.to_socket.identifier] for x in tree.links
        ]
        return [found, sorted(ends)]

    found: dict[str, Any] = {}
    for obj in bpy.data.objects:
        entry = [obj.type, plain(obj.matrix_world), obj.parent.name if obj.parent else None, own(obj),
                 sorted(c.name for c in obj.users_collection), obj.display_type, obj.hide_render, obj.visible_camera]  # fmt: skip
        data = obj.data
        entry.append(data.name if obj.type != "CAMERA" else None)
        if obj.type == "MESH":
            entry += [[list(v.co) for v in data.vertices], [list(p.vertices) for p in data.polygons], own(data)]
            entry += [[m.name for m in data.materials], [p.material_index for p in data.polygons]]
            entry += [
                [p.use_smooth for p in data.polygons],
                [list(c.vector) for layer in data.uv_layers for c in layer.uv],
            ]
        else:
            names = ("energy", "color", "angle", "size", "size_y", "shape", "shadow_soft_size", "lens", "ortho_scale",
                     "shift_x", "shift_y", "clip_start", "clip_end", "sensor_fit", "type")  # fmt: skip
            entry.append({n: plain(getattr(data, n)) for n in names if hasattr(data, n)})
        found["object " + obj.name] = entry
    for material in bpy.data.materials:
        found["material " + material.name] = [own(material), plain(material.diffuse_color), nodes(material.node_tree)]
    for collection in bpy.data.collections:
        found["collection " + collection.name] = own(collection)
    scene = bpy.context.scene
    found["world"] = [nodes(scene.world.node_tree), own(scene.world)] if scene.world else None
    view = scene.view_settings
    found["view"] = [plain(view.exposure), view.view_transform, view.look, scene.camera.name if scene.camera else None]
    found["images"] = sorted((i.name, tuple(i.size)) for i in bpy.data.images)
    return found


def made_plainly(file: str, folder: Path) -> dict[str, Any]:
    """What plain Python with bpy and numpy alone makes of a file."""
    (folder / "room.py").write_text(file, encoding="utf-8")
    code = (
        "import json, runpy, sys, bpy\nfrom typing import Any\n"
        "for name in ('pydantic', 'PIL', 'requests', 'code_as_room'):\n    sys.modules[name] = None\n"
        "bpy.ops.wm.read_factory_settings(use_empty=True)\nrunpy.run_path('room.py', run_name='__main__')\n"
        f"bpy.context.view_layer.update()\n{inspect.getsource(dump)}\njson.dump(dump(), open('dump.json', 'w'))\n"
    )
    done = subprocess.run([sys.executable, "-c", code], cwd=folder, capture_output=True, text=True, timeout=400)
    assert done.returncode == 0, done.stderr
    result: dict[str, Any] = json.loads((folder / "dump.json").read_text())
    return result


@pytest.mark.parametrize("name", ["bedroom", "hundred"])
def test_the_file_makes_the_add_ons_scene(name: str, tmp_path: Path) -> None:
    text = bedroom() if name == "bedroom" else sizes().make_room(50)
    file = assemble_file(text)
    plain = made_plainly(file, tmp_path)
    bpy.ops.wm.read_factory_settings(use_empty=True)
    realise_record(evaluate(text, FINISHED_ROOM_LIMITS))
    bpy.context.view_layer.update()
    ours = json.loads(json.dumps(dump()))
    assert plain.keys() == ours.keys()
    for key, entry in ours.items():
        assert plain[key] == entry, key
    assert sum(key.startswith("object ") for key in ours) > (100 if name == "hundred" else 24)


@pytest.mark.parametrize("name", ["bedroom", "every constructor"])
def test_without_its_checks_the_file_makes_the_same_scene(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    text = bedroom() if name == "bedroom" else ROOM
    checked = assemble_file(text)
    monkeypatch.setattr(assemble, "MOST_BYTES", 0)  # every file is too long now
    file = assemble_file(text)
    assert "raise _fail(" in checked and len(file) < 0.93 * len(checked)
    (tmp_path / "one").mkdir(), (tmp_path / "two").mkdir()
    one, two = made_plainly(checked, tmp_path / "one"), made_plainly(file, tmp_path / "two")
    assert one == two and sum(key.startswith("object ") for key in one) > 4


@pytest.mark.parametrize("name", ["bedroom", "hundred"])
def test_the_file_holds_the_same_typed_room(name: str) -> None:
    text = bedroom() if name == "bedroom" else sizes().make_room(24)
    back = room_part(assemble_file(text))
    assert parse_layout(back) == parse_layout(text)
    assert read_materials(back) == read_materials(text)


@pytest.mark.parametrize("kinds", LIMITS)
def test_a_room_of_a_hundred_objects_is_no_longer_than_promised(kinds: int) -> None:
    assert len(assemble_file(sizes().make_room(kinds)).encode()) <= LIMITS[kinds]


def test_the_bedroom_is_no_longer_than_promised() -> None:
    assert len(assemble_file(bedroom()).encode()) <= MOST_BYTES


@pytest.mark.parametrize("rules", [["--isolated"], ["--config", str(ROOT / "pyproject.toml")]], ids=["usual", "ours"])
@pytest.mark.parametrize("name", ["bedroom", "hundred"])
def test_the_file_is_clean(name: str, rules: list[str], tmp_path: Path) -> None:
    pytest.importorskip("ruff", reason="the linter is where the development tools are")
    text = bedroom() if name == "bedroom" else sizes().make_room(50)
    (tmp_path / "room.py").write_text(assemble_file(text), encoding="utf-8")
    command = [sys.executable, "-m", "ruff", "check", "--no-cache", *rules, str(tmp_path / "room.py")]
    done = subprocess.run(command, capture_output=True, text=True, timeout=60)
    assert done.returncode == 0, done.stdout


def test_a_second_run_keeps_what_was_done_by_hand_and_follows_the_text(tmp_path: Path) -> None:
    text = bedroom()
    (tmp_path / "room.py").write_text(assemble_file(text), encoding="utf-8")
    moved = text.replace("centre=(1.9481, -0.2124, 0.3844)", "centre=(1.5, -0.2124, 0.3844)")
    assert moved != text
    (tmp_path / "moved.py").write_text(assemble_file(moved), encoding="utf-8")
    code = (
        "import runpy, bpy\nbpy.ops.wm.read_factory_settings(use_empty=True)\nrunpy.run_path('room.py')\n"
        "chair = bpy.data.objects['chair_1']\nchair.location.x += 0.25\nplace = tuple(chair.location)\n"
        "bpy.data.objects['bed_1'].data.vertices[0].co.x += 0.5\nbed = bpy.data.objects['bed_1'].data.vertices[0].co.x\n"
        "count = len(bpy.data.objects), len(bpy.data.meshes), len(bpy.data.materials)\n"
        "runpy.run_path('moved.py')\n"
        "assert tuple(bpy.data.objects['chair_1'].location) == place\n"
        "assert bpy.data.objects['bed_1'].data.vertices[0].co.x == bed\n"
        "assert abs(bpy.data.objects['desk_1'].location.x - 1.5) < 1e-5\n"
        "assert count == (len(bpy.data.objects), len(bpy.data.meshes), len(bpy.data.materials)), count\n"
    )
    done = subprocess.run([sys.executable, "-c", code], cwd=tmp_path, capture_output=True, text=True, timeout=200)
    assert done.returncode == 0, done.stderr
