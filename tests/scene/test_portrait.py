# SPDX-License-Identifier: GPL-3.0-or-later
"""The picture of one object that a model is shown: in its colours, from both sides, and nothing of it stays behind."""

from __future__ import annotations

import io

import bpy
import numpy as np
from code_as_room.pipeline.objects.eyes import looking_at
from code_as_room.pipeline.program.evaluate import evaluate_object
from code_as_room.pipeline.scene.portrait import portrait
from PIL import Image

POST = """def post():
    foot = part("foot", box((0.4, 0.4, 0.05), at=(0, 0, 0.025)), material="wood #20A040")
    return [foot, part("post", box((0.06, 0.06, 1.0), at=(0, 0, 0.55)), material="fabric #C02020")]
"""


def kinds() -> list[int]:
    data = bpy.data
    return [len(d) for d in (data.meshes, data.objects, data.materials, data.scenes, data.cameras, data.worlds)]


def test_it_shows_front_and_top_in_the_parts_colours_and_leaves_nothing() -> None:
    before = kinds()
    shapes = evaluate_object(POST, "post")
    points = np.concatenate([shape.vertices for shape in shapes])
    cameras = [looking_at(points, way, 120) for way in ((-0.5, -1.0, 0.42), (0.0, -0.28, 1.0))]
    page = Image.open(io.BytesIO(portrait(shapes, "other", cameras))).convert("RGB")
    assert page.size == (240, 120) and kinds() == before
    pixels = np.asarray(page, dtype=int)
    red = (pixels[..., 0] > 120) & (pixels[..., 1] < 90)
    green = (pixels[..., 1] > pixels[..., 0] + 40) & (pixels[..., 1] > pixels[..., 2] + 30)
    front, top = slice(0, 120), slice(120, 240)
    # From the front it is a tall post on a foot, from above the foot hides little of the picture.
    share = [red[:, side].sum() / (red[:, side].sum() + green[:, side].sum()) for side in (front, top)]
    assert share[0] > share[1] + 0.15 and share[1] > 0.02
