# SPDX-License-Identifier: GPL-3.0-or-later
"""The estimate of a room's brightness, against Cycles."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import bpy
import numpy as np
import pytest
from code_as_room.pipeline.artifacts.layout import Layout, LightLine, RoomLine, WallLine
from code_as_room.pipeline.light.estimate import irradiance
from code_as_room.pipeline.light.space import space_of
from code_as_room.pipeline.program.evaluate import evaluate
from code_as_room.pipeline.program.lines import print_layout
from code_as_room.pipeline.scene.nodes import ensure_node_tree
from code_as_room.pipeline.scene.realise import realise_record

FLOOR = [(-2.0, -1.5), (2.0, -1.5), (2.0, 1.5), (-2.0, 1.5)]
ALBEDO = 0.5
CASES = {
    "under the ceiling": LightLine(id="l", kind="area", at=(0, 0, 2.4), energy=60, size=3.4, size_y=2.4),
    "in a window": LightLine(
        id="l", kind="area", at=(0, -1.45, 1.5), energy=40, size=1.6, size_y=1.2, target=(0, 1, 1.5)
    ),
    "a lamp": LightLine(id="l", kind="point", at=(0.8, 0.5, 1.4), energy=30, size=0.05),
}


def layout(light: LightLine) -> Layout:
    walls = [
        WallLine(id=f"wall_{i}", start=a, end=b, height=2.5)
        for i, (a, b) in enumerate(zip(FLOOR, FLOOR[1:] + FLOOR[:1], strict=True))
    ]
    return Layout(room=RoomLine(size=(4, 3, 2.5), floor=FLOOR), walls=walls, lights=[light])


def rendered_floor(tmp_path: Path) -> float:
    """Mean radiance of the floor's middle, seen from under the ceiling."""
    scene: Any = bpy.context.scene
    material = bpy.data.materials.new("grey")
    tree = ensure_node_tree(material)
    tree.nodes.clear()
    grey, output = tree.nodes.new("ShaderNodeBsdfDiffuse"), tree.nodes.new("ShaderNodeOutputMaterial")
    grey.inputs["Color"].default_value = (ALBEDO, ALBEDO, ALBEDO, 1)
    tree.links.new(grey.outputs[0], output.inputs[0])
    bpy.ops.mesh.primitive_plane_add(size=20, location=(0, 0, 2.5))
    for obj in bpy.data.objects:
        if obj.type == "MESH":
            obj.data.materials.clear()
            obj.data.materials.append(material)
    camera = bpy.data.objects.new("eye", bpy.data.cameras.new("eye"))
    camera.data.type, camera.data.ortho_scale = "ORTHO", 2.0
    camera.location = (0, 0, 2.3)
    scene.collection.objects.link(camera)
    scene.camera, scene.render.engine = camera, "CYCLES"
    scene.cycles.samples, scene.cycles.use_denoising, scene.cycles.max_bounces = 32, False, 12
    scene.cycles.diffuse_bounces = 12
    scene.render.resolution_x = scene.render.resolution_y = 16
    scene.render.filepath = str(tmp_path / "floor.exr")
    settings = scene.render.image_settings
    if hasattr(settings, "media_type"):
        settings.media_type = "IMAGE"
    settings.file_format = "OPEN_EXR"
    bpy.ops.render.render(write_still=True)
    image = bpy.data.images.load(scene.render.filepath)
    pixels = np.empty(16 * 16 * 4, np.float32)
    image.pixels.foreach_get(pixels)
    return float(pixels.reshape(-1, 4)[:, :3].mean())


@pytest.mark.parametrize("case", CASES)
def test_the_floor_is_as_bright_as_cycles_makes_it(case: str, tmp_path: Path) -> None:
    room = layout(CASES[case])
    realise_record(evaluate(print_layout(room)))
    truth = rendered_floor(tmp_path)
    space = space_of(room, {"floor": ALBEDO, "walls": ALBEDO, "ceiling": ALBEDO})
    grid = np.array([(x, y, 0.0) for x in np.linspace(-0.9, 0.9, 8) for y in np.linspace(-0.9, 0.9, 8)])
    up = np.tile((0.0, 0.0, 1.0), (len(grid), 1))
    found = irradiance(space, room.lights, 0.0, grid, up).lights.sum(axis=0).mean() * ALBEDO / math.pi
    assert abs(math.log2(found / truth)) < 0.3  # of a stop


def test_a_panel_that_nearly_touches_the_walls_makes_no_single_place_count_for_all() -> None:
    """Rays that end a hair from a light found a thousand times what can arrive, and the whole room was taken for brighter."""
    wide = LightLine(id="l", kind="area", at=(0, 0, 2.485), energy=60, size=3.96, size_y=2.96)
    space = space_of(layout(wide), {"floor": ALBEDO, "walls": ALBEDO, "ceiling": ALBEDO})
    x, y = np.meshgrid(np.linspace(-1.6, 1.6, 21), np.linspace(-1.1, 1.1, 21))
    places = np.stack([x.ravel(), y.ravel(), np.zeros(x.size)], axis=1)
    arriving = irradiance(space, [wide], 0.0, places, np.tile((0.0, 0.0, 1.0), (len(places), 1)))
    radiance = 60 / (math.pi * 3.96 * 2.96)
    assert arriving.lights.max() < 2.5 * radiance
