# SPDX-License-Identifier: GPL-3.0-or-later
"""An L-shaped bedroom as a record, and an empty Blender for every test."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import pytest
from code_as_room.pipeline.program.prelude.recorder import Recorder

FLOOR = [(-2.5, -2.0), (2.5, -2.0), (2.5, 2.0), (0.5, 2.0), (0.5, 1.0), (-2.5, 1.0)]
NAMES = ["wall_s", "wall_e", "wall_n", "wall_nook", "wall_nw", "wall_w"]


def make_room(recorder: Recorder) -> None:
    """Six outer walls (one inner corner), a partition, a door, a window, an opening and eight objects."""
    recorder.room(size=(5.0, 4.0, 2.6), floor=FLOOR)
    for name, start, end in zip(NAMES, FLOOR, FLOOR[1:] + FLOOR[:1], strict=True):
        recorder.wall(name, start, end, height=2.6, thickness=0.15)
    recorder.wall("divider", (1.2, -2.0), (1.2, -0.2), height=2.4, thickness=0.1, partition=True)
    recorder.door("door_1", "wall_s", (-1.9, -2.0), (-1.05, -2.0), height=2.05, open=70)
    recorder.window("window_1", "wall_w", (-2.5, 0.6), (-2.5, -1.2), sill=0.85, height=1.3)
    recorder.window("window_2", "wall_e", (2.5, 0.2), (2.5, 1.4), sill=0.9, height=1.2)
    recorder.opening("opening_1", "divider", (1.2, -1.2), (1.2, -0.4), height=2.1)
    recorder.proxy("bed_1", "double bed", (-0.6, 0.0, 0.3), (1.7, 2.0, 0.6), label="wide bed")
    recorder.proxy("nightstand_1", "nightstand", (-1.75, 0.7, 0.275), (0.5, 0.45, 0.55))
    recorder.proxy(
        "lamp_1", "table lamp", (-1.75, 0.75, 0.775), (0.3, 0.3, 0.45), placement="surface", parent="nightstand_1",
        salience="minor", shape="round",
    )  # fmt: skip
    recorder.proxy("sofa_1", "corner sofa", (1.75, 1.2, 0.4), (1.4, 1.5, 0.8), yaw=-90, shape="l_shape")
    recorder.proxy("rug_1", "rug", (-0.6, -0.7, 0.005), (2.4, 1.6, 0.01), salience="minor")
    recorder.proxy("armchair_1", "armchair", (0.4, -1.4, 0.4), (0.8, 0.75, 0.8), yaw=135)
    recorder.proxy(
        "art_1", "picture", (-1.0, 0.985, 1.6), (0.9, 0.03, 0.6), placement="wall", parent="wall_nw", salience="minor"
    )
    recorder.proxy("wardrobe_1", "wardrobe", (2.2, -1.2, 1.05), (1.4, 0.6, 2.1), yaw=-90)
    recorder.light("lamp_light", "point", (-1.75, 0.75, 0.9), energy=40, color=(1.0, 0.85, 0.7))
    recorder.light("sun_1", "sun", (0, 0, 5), energy=3, target=(1, 0, 0))
    recorder.camera("reference", "perspective", CAMERA_MATRIX, fov_y=0.8, image_size=(800, 640), principal=(520, 470))
    recorder.build()


CAMERA_MATRIX = (1, 0, 0, 0.1, 0, 0.992546, 0.121869, -0.2, 0, -0.121869, 0.992546, 6.5, 0, 0, 0, 1)


@pytest.fixture
def record() -> Any:
    """A fresh record of the bedroom."""
    recorder = Recorder()
    make_room(recorder)
    return recorder.record


@pytest.fixture(autouse=True)
def empty_blender() -> Iterator[None]:
    """Every test starts from an empty file."""
    import bpy

    bpy.ops.wm.read_factory_settings(use_empty=True)
    yield
