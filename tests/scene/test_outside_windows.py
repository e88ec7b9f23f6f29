# SPDX-License-Identifier: GPL-3.0-or-later
"""What is seen through windows: by day a bright sky inside, round the room what the picture has; in the evening the evening."""

from __future__ import annotations

from pathlib import Path

import bpy
import numpy as np
import pytest
from code_as_room.pipeline.scene.backend import BlenderScene
from code_as_room.pipeline.scene.outside import SEEN_NODE
from code_as_room.pipeline.scene.shoot import set_stage, shoot, strike_stage
from PIL import Image

from .test_light_scene import ROOM

# It looks from the north wall along -Y, through the window.
INSIDE = """camera("eye_1", "perspective", matrix=(-1, 0, 0, 0, 0, 0, 1, 1.2, 0, 1, 0, 1.5, 0, 0, 0, 1), fov_y=0.8,
    image_size=(320, 240), stops=-0.5)
build()"""


def build(background: str) -> None:
    text = ROOM.replace("build()", INSIDE).replace("background=(0.8, 0.9, 1)", f"background={background}")
    BlenderScene(bpy.context.scene).build(text)


def sky_of(stage: bpy.types.Scene) -> np.ndarray:
    node = next(n for n in stage.world.node_tree.nodes if n.label == SEEN_NODE)
    return np.array(node.inputs["Color"].default_value[:3])


def test_a_grey_round_the_room_is_a_bright_sky_seen_from_inside(tmp_path: Path) -> None:
    build("(0.35, 0.36, 0.37)")
    world = bpy.context.scene.world
    worlds = len(bpy.data.worlds)
    found = {}
    for camera in ("reference", "eye_1"):
        stage = set_stage(bpy.context.scene, camera, 64, "CYCLES")
        found[camera] = sky_of(stage)
        strike_stage(stage)
    assert found["reference"] == pytest.approx((0.35, 0.36, 0.37), abs=1e-4)
    assert (found["eye_1"] > 2 * found["reference"]).all()
    assert bpy.context.scene.world == world and len(bpy.data.worlds) == worlds
    shoot(bpy.context.scene, "eye_1", tmp_path / "eye.png", 96)
    with Image.open(tmp_path / "eye.png") as image:
        pixels = np.asarray(image.convert("RGB"), dtype=float)
    pane = np.sort(pixels.reshape(-1, 3), axis=0)[-len(pixels) * 4 :].mean(axis=0)
    # Bright and a little blue, but not burnt out.
    assert pane.min() > 195 and pane[2] > pane[0] + 5 and np.ptp(pane) < 45


def test_an_evening_stays_an_evening() -> None:
    build("(0.04, 0.05, 0.08)")
    stage = set_stage(bpy.context.scene, "eye_1", 64, "CYCLES")
    assert sky_of(stage) == pytest.approx((0.04, 0.05, 0.08), abs=1e-4)
    strike_stage(stage)
