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


def seen(stage: bpy.types.Scene) -> bpy.types.NodeSocket:
    return next(n for n in stage.world.node_tree.nodes if n.label == SEEN_NODE).inputs["Color"]


def test_a_grey_round_the_room_is_a_bright_sky_seen_from_inside(tmp_path: Path) -> None:
    build("(0.35, 0.36, 0.37)")
    world = bpy.context.scene.world
    worlds = len(bpy.data.worlds)
    stage = set_stage(bpy.context.scene, "reference", 64, "CYCLES")
    assert not seen(stage).is_linked and tuple(seen(stage).default_value)[:3] == pytest.approx((0.35, 0.36, 0.37))
    strike_stage(stage)
    assert bpy.context.scene.world == world and len(bpy.data.worlds) == worlds
    shoot(bpy.context.scene, "eye_1", tmp_path / "eye.png", 96)
    assert bpy.context.scene.world == world and len(bpy.data.worlds) == worlds
    with Image.open(tmp_path / "eye.png") as image:
        pixels = np.asarray(image.convert("RGB"), dtype=float)
    tall, wide = pixels.shape[:2]
    pane = pixels[:, int(0.24 * wide) : int(0.34 * wide)].mean(axis=1)
    high, middle, low = (pane[int(share * tall)] for share in (0.28, 0.45, 0.66))
    # Bright but not burnt out, blue above, brightest at the horizon, darker towards the ground: a pane is not a lamp.
    assert pixels[0, 0].min() > 100 and 190 < high.max() < 245 and middle.mean() > max(high.mean(), low.mean()) + 4
    assert high[2] - high[0] > low[2] - low[0] + 4 and high[2] > high[0] + 6


def test_an_evening_stays_an_evening() -> None:
    build("(0.04, 0.05, 0.08)")
    stage = set_stage(bpy.context.scene, "eye_1", 64, "CYCLES")
    assert not seen(stage).is_linked and tuple(seen(stage).default_value)[:3] == pytest.approx((0.04, 0.05, 0.08))
    strike_stage(stage)
