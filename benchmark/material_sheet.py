# SPDX-License-Identifier: GPL-3.0-or-later
"""A contact sheet of every family of looks, each on a sphere and on a piece that it is made for, rendered with Cycles.

python -m benchmark.material_sheet [--out out/materials.png] [--only wood leather] [--samples 48] [--engine cycles]
"""

from __future__ import annotations

import argparse
import io
import math
from pathlib import Path
from typing import Any

import bpy
import numpy as np
from code_as_room.pipeline.program.evaluate import call_function, evaluate_object
from code_as_room.pipeline.program.prelude.looks import Look
from code_as_room.pipeline.scene.arrays import mesh_arrays
from code_as_room.pipeline.scene.compat import eevee_id, ensure_node_tree, quiet, set_png
from code_as_room.pipeline.scene.meshes import write_arrays
from code_as_room.pipeline.scene.shading.surfaces import shade_look
from PIL import Image, ImageDraw

PIECES = {
    "block": "[rounded_box((0.3, 0.2, 0.03), 0.004, at=(0, 0, 0.185)), rounded_box((0.04, 0.2, 0.17), 0.004, at=(-0.12, 0, 0.085)),"
             "rounded_box((0.04, 0.2, 0.17), 0.004, at=(0.12, 0, 0.085))]",
    "cloth": "[cushion((0.3, 0.24, 0.1), at=(0, 0, 0.05)), cushion((0.28, 0.22, 0.09), at=(0, 0.02, 0.145))]",
    "slab": "[box((0.34, 0.26, 0.02), at=(0, 0, 0.01)), box((0.34, 0.02, 0.2), at=(0, 0.12, 0.12))]",
    "floor": "[box((1.4, 1.1, 0.02), at=(0, 0, 0.01)), box((0.02, 0.02, 0.1), at=(0.5, 0.5, 0.05))]",
    "vessel": "[lathe([(0, 0), (0.07, 0), (0.1, 0.06), (0.06, 0.17), (0.035, 0.2), (0.045, 0.24), (0.041, 0.24), (0.03, 0.2),"
              "(0.054, 0.17), (0.092, 0.06), (0.06, 0.01), (0, 0.01)], 40)]",
    "lamp": "[lathe([(0.11, 0.1), (0.08, 0.26), (0.078, 0.26), (0.108, 0.1)], 40)]",
    "plant": "[leaves(26, 0.16, 0.05, 0.2, seed=3, at=(0, 0, 0))]",
    "pane": "[box((0.3, 0.008, 0.26), at=(0, 0.05, 0.13))]",
}  # fmt: skip
"""What the samples stand on the sheet as, in the room language."""

SAMPLES: tuple[tuple[str, str], ...] = (
    ('wood("#6A4A32")', "block"), ('wood("#C8A06E")', "block"), ('wood("#A0643C", gloss=0.85)', "block"),
    ('planks("#A9794F")', "floor"), ('planks("#8C7B68", size=(1.2, 0.19), turned=True)', "floor"), ('painted_wood("#DDE3DC")', "block"),
    ('wicker("#C29A5F")', "vessel"), ('fabric("#7C8A94")', "cloth"), ('fabric("#C9BFAE", size=0.005)', "cloth"),
    ('linen("#EFEAE0")', "cloth"), ('velvet("#3F5B56")', "cloth"), ('knit("#D8CFC0")', "cloth"), ('carpet("#B8AD9C")', "floor"),
    ('leather("#7A4A2E")', "cloth"), ('leather("#2B2826", worn=0.1)', "cloth"), ('metal("#B9BCC0")', "block"),
    ('metal("#C2A14D", finish="polished")', "vessel"), ('metal("#3A3A3C", finish="cast")', "block"),
    ('glass()', "vessel"), ('glass("#CFE6E0", frost=0.8)', "vessel"), ('mirror_glass()', "pane"),
    ('marble("#E9E7E3")', "slab"), ('marble("#2E3230", veins="#C9C3B4")', "slab"), ('stone("#A7A39C")', "slab"),
    ('tile("#DDE0DF", size=(0.1, 0.1))', "slab"), ('tile("#9A4F38", size=(0.21, 0.065), gap=0.01, offset=0.5, gloss=0)', "slab"),
    ('concrete("#A9A6A0")', "slab"), ('plaster("#E8E0D2", rough=0.8)', "slab"), ('ceramic("#F6F5F2")', "vessel"),
    ('ceramic("#B9714F", gloss=0)', "vessel"), ('plastic("#D8553F")', "block"), ('rubber("#2E2E2E")', "block"),
    ('paper("#F5F1E6")', "slab"), ('foliage("#5E8B4A")', "plant"), ('soil("#4A3A2C")', "slab"), ('water()', "vessel"),
    ('screen("#1D2127")', "pane"), ('screen("#4A86C8", strength=1.5)', "pane"), ('shade("#F3E5C4")', "lamp"), ('glow()', "lamp"),
)  # fmt: skip
"""Each family, and what it is seen on."""

_APART = 0.48
_COLUMNS = 8
_PIXELS = 230
"""Of one cell."""


def look_of(expression: str) -> Look:
    """A look as the language evaluates it."""
    found = call_function(f"def made():\n    return {expression}\n", "made")
    assert isinstance(found, Look)
    return found


def stand(expression: str, piece: str, at: tuple[float, float]) -> None:
    """Put a sphere and a piece of one look into the scene."""
    material = bpy.data.materials.new(expression)
    shade_look(material, look_of(expression))
    scale = 0.36 if piece == "floor" else 1.0
    for name, text, offset, size in (
        ("sphere", "sphere(0.075, at=(0, 0, 0.075), segments=48, rings=24)", (-0.14, -0.15), 1.0),
        (piece, PIECES[piece], (0.04, 0.06), scale),
    ):
        shapes = evaluate_object(f"def made():\n    return smooth({text})\n", "made")
        mesh = bpy.data.meshes.new(name)
        write_arrays(mesh, mesh_arrays(shapes), "", "")
        mesh.materials.clear()
        mesh.materials.append(material)
        obj = bpy.data.objects.new(f"{name} {expression}", mesh)
        obj.location = (at[0] + offset[0], at[1] + offset[1], 0)
        obj.scale = (size, size, size)
        bpy.context.scene.collection.objects.link(obj)


def stage(columns: int, rows: int) -> None:
    """Table, light, world and camera."""
    scene = bpy.context.scene
    width, depth = columns * _APART, rows * _APART
    mesh = bpy.data.meshes.new("table")
    shapes = evaluate_object(
        f"def made():\n    return box(({width + 8}, {depth + 8}, 0.02), at=(0, 0, -0.01))\n", "made"
    )
    write_arrays(mesh, mesh_arrays(shapes), "", "")
    mesh.materials.clear()
    ground = bpy.data.materials.new("table")
    shade_look(ground, look_of('plastic("#8C8A86", gloss=0)'))
    mesh.materials.append(ground)
    scene.collection.objects.link(bpy.data.objects.new("table", mesh))
    for kind, energy, angle in (("SUN", 2.3, (8, -48, 0)), ("SUN", 0.5, (50, 20, 0))):
        lamp: Any = bpy.data.lights.new("window", kind)
        lamp.energy, lamp.angle = energy, math.radians(25)
        light = bpy.data.objects.new("window", lamp)
        light.rotation_euler = tuple(math.radians(a) for a in angle)
        scene.collection.objects.link(light)
    world = bpy.data.worlds.new("sheet")
    tree = ensure_node_tree(world)
    background = next(n for n in tree.nodes if n.type == "BACKGROUND")
    background.inputs["Color"].default_value = (0.75, 0.82, 0.9, 1.0)
    background.inputs["Strength"].default_value = 0.45
    scene.world = world
    data = bpy.data.cameras.new("sheet")
    data.type, data.ortho_scale = "ORTHO", max(width, depth) * 1.01
    camera = bpy.data.objects.new("sheet", data)
    tilt = math.radians(52)
    camera.rotation_euler = (tilt, 0, 0)
    camera.location = (0, -6 * math.sin(tilt), 6 * math.cos(tilt) + 0.05)
    scene.collection.objects.link(camera)
    scene.camera = camera


def render(width: int, height: int, samples: int, engine: str) -> Image.Image:
    """The scene as an image."""
    scene = bpy.context.scene
    scene.render.engine = "CYCLES" if engine == "cycles" else eevee_id(scene)
    if engine == "cycles":
        scene.cycles.device, scene.cycles.samples, scene.cycles.use_denoising = "CPU", samples, True
    scene.view_settings.view_transform = "Standard"
    scene.render.resolution_x, scene.render.resolution_y, scene.render.resolution_percentage = width, height, 100
    set_png(scene.render.image_settings)
    path = Path(bpy.app.tempdir or "/tmp") / "material_sheet.png"
    scene.render.filepath = str(path)
    with quiet():
        bpy.ops.render.render(write_still=True)
    return Image.open(io.BytesIO(path.read_bytes())).convert("RGB")


def sheet(only: list[str], samples: int, engine: str, pixels: int = _PIXELS) -> Image.Image:
    """The whole page."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    chosen = [s for s in SAMPLES if not only or s[0].split("(")[0] in only]
    columns = min(_COLUMNS, len(chosen))
    rows = math.ceil(len(chosen) / columns)
    tilt = math.cos(math.radians(52))
    places = []
    for number, (expression, piece) in enumerate(chosen):
        at = (
            (number % columns - (columns - 1) / 2) * _APART,
            ((rows - 1) / 2 - number // columns) * _APART,
        )
        stand(expression, piece, at)
        places.append((at, expression))
    stage(columns, rows)
    height = rows * tilt + 0.55
    width = columns
    bpy.context.scene.camera.data.ortho_scale = max(width, height) * _APART
    page = render(int(width * pixels), int(height * pixels), samples, engine)
    pen = ImageDraw.Draw(page)
    for at, expression in places:
        x = page.width / 2 + (at[0] - _APART / 2) / _APART * pixels + 6
        y = page.height / 2 - (at[1] - 0.42 * _APART) * tilt / _APART * pixels - 4
        pen.text((x, y), expression[:44], fill="black")
    return page


def nodes_used() -> dict[str, int]:
    """How many nodes each material of the sheet has."""
    return {m.name: len(m.node_tree.nodes) for m in bpy.data.materials if m.node_tree is not None}


def main() -> None:
    """The command."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--out", type=Path, default=Path("out/materials.png"))
    parser.add_argument("--only", nargs="*", default=[])
    parser.add_argument("--samples", type=int, default=48)
    parser.add_argument("--pixels", type=int, default=_PIXELS, help="width of one sample")
    parser.add_argument("--engine", choices=("cycles", "eevee"), default="cycles")
    options = parser.parse_args()
    options.out.parent.mkdir(parents=True, exist_ok=True)
    page = sheet(options.only, options.samples, options.engine, options.pixels)
    page.save(options.out)
    counts = nodes_used()
    print(options.out, "nodes: most", max(counts.values()), "mean", round(float(np.mean(list(counts.values()))), 1))


if __name__ == "__main__":
    main()
