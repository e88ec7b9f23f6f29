# SPDX-License-Identifier: GPL-3.0-or-later
"""What a model is shown and told of an object: crops large enough, true directions, what is separate, fair renders."""

from __future__ import annotations

import io
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from code_as_room.pipeline.artifacts.analysis import SceneAnalysis
from code_as_room.pipeline.artifacts.camera import CameraModel
from code_as_room.pipeline.artifacts.common import ImageBox
from code_as_room.pipeline.artifacts.layout import Layout, ProxyLine
from code_as_room.pipeline.geometry.camera import project
from code_as_room.pipeline.geometry.footprint import box_corners
from code_as_room.pipeline.objects.asking import apart_from, facing_words
from code_as_room.pipeline.objects.checks import check
from code_as_room.pipeline.objects.crops import SMALLEST, marked_crop, sheet, side_by_side
from code_as_room.pipeline.objects.examples import nearest_programs
from code_as_room.pipeline.objects.eyes import eyes_on
from code_as_room.pipeline.picture import read_picture
from code_as_room.pipeline.program.evaluate import evaluate_object
from code_as_room.pipeline.prompting import load_template
from PIL import Image

ROOT = Path(__file__).resolve().parents[2]


def thing(**more: Any) -> ProxyLine:
    given = {"id": "a", "category": "armchair", "centre": (1.4, -0.8, 0.4), "size": (0.8, 0.7, 0.8), "yaw": 0.0}
    return ProxyLine.model_validate(given | more)


def picture(colour: str = "#808080", square: tuple[int, int, int, int] | None = None) -> Any:
    image = Image.new("RGB", (1200, 1000), colour)
    if square is not None:
        image.paste((200, 20, 20), square)
    buffer = io.BytesIO()
    image.save(buffer, "PNG")
    return read_picture(buffer.getvalue(), "room.png")


def opened(data: bytes) -> Image.Image:
    return Image.open(io.BytesIO(data)).convert("RGB")


def red(image: Image.Image) -> np.ndarray:
    pixels = np.asarray(image, dtype=int)
    return (pixels[..., 0] > 150) & (pixels[..., 1] < 70) & (pixels[..., 2] < 70)


def test_a_tiny_thing_is_enlarged_with_much_of_what_is_round_it_and_nothing_on_it() -> None:
    box = ImageBox(x_min=500, y_min=500, x_max=520, y_max=524)
    crop = opened(marked_crop(picture(square=(600, 500, 624, 524)), box))
    found = red(crop)
    assert max(crop.size) == SMALLEST and 0.08 < found.mean() < 0.4
    inside = np.argwhere(found)
    low, high = inside.min(axis=0), inside.max(axis=0) + 1
    assert found[low[0] : high[0], low[1] : high[1]].mean() > 0.95, "marks hide the object"


@pytest.mark.parametrize("box", [(0, 0, 12, 9), (985, 990, 1000, 1000), (0, 0, 1000, 1000)])
def test_crops_at_the_pictures_edge_are_crops(box: tuple[float, ...]) -> None:
    shown = ImageBox(x_min=box[0], y_min=box[1], x_max=box[2], y_max=box[3])
    assert max(opened(marked_crop(picture(), shown)).size) >= SMALLEST


@pytest.mark.parametrize(
    ("yaw", "words"),
    [
        (0, "front (-Y) looks to the picture's bottom, its +X to the right"),
        (90, "front (-Y) looks to the picture's right, its +X to the top"),
        (225, "front (-Y) looks to the picture's upper left, its +X to the lower left"),
        (20, "bottom (20 degrees counter-clockwise of it), its +X to the right (20 degrees counter-clockwise of it)"),
    ],
)
def test_directions_are_those_of_the_picture(camera: CameraModel, yaw: float, words: str) -> None:
    assert words in facing_words(thing(yaw=yaw), camera)


def test_what_is_on_it_or_in_it_is_separate_found_or_not_yet_placed(analysis: SceneAnalysis) -> None:
    chair = thing(id="stand")
    pillow = thing(id="pillow", category="lumbar_pillow", size=(0.4, 0.2, 0.3), placement="surface", parent="bed")
    layout = Layout.model_construct(proxies=[chair, pillow], walls=[], doors=[], windows=[], openings=[])
    assert apart_from(chair, layout, analysis) == [("pillow", "lumbar pillow"), ("lamp", "table lamp")]
    assert apart_from(chair, layout, analysis, {"lamp"}) == [("pillow", "lumbar pillow")]


@pytest.mark.parametrize("kind", ["perspective", "orthographic"])
def test_the_render_is_turned_as_the_crop_is_and_shows_all_of_it(camera: CameraModel, kind: str) -> None:
    """Corners of the object lie in the render as in the room's picture, up to moving and scaling."""
    if kind == "orthographic":
        camera = camera.model_copy(update={"kind": kind, "fov_y": 0.0, "ortho_height": 4.5})
    chair = thing(yaw=130.0)
    shapes = evaluate_object("def a():\n    return [box((0.8, 0.7, 0.8), at=(0, 0, 0.4))]\n", "a")
    corners = box_corners(chair.centre, chair.size, chair.yaw)
    own = box_corners((0, 0, 0.4), chair.size, 0)
    room = project(camera, corners) * np.array(camera.image_size)
    for eye in eyes_on(shapes, chair, camera, 200):
        seen = project(eye, own)
        assert seen.min() >= 0 and seen.max() <= 1000
    seen = project(eyes_on(shapes, chair, camera, 200)[0], own)
    both = [(p - p.mean(axis=0)) / np.linalg.norm(p - p.mean(axis=0)) for p in (room, seen)]
    assert np.abs(both[0] - both[1]).max() < 0.06


def test_an_object_higher_than_the_camera_can_still_be_seen(camera: CameraModel) -> None:
    shapes = evaluate_object("def a():\n    return [box((0.8, 0.7, 9.0), at=(0, 0, 4.5))]\n", "a")
    for eye in eyes_on(shapes, thing(centre=(0, 0, 4.5), size=(0.8, 0.7, 9.0)), camera, 200):
        assert np.isfinite(project(eye, shapes[0].vertices)).all()


def test_a_sheet_has_the_pictures_in_their_order() -> None:
    page = Image.new("RGB", (200, 100), "blue")
    page.paste((200, 20, 20), (0, 0, 100, 100))
    buffer = io.BytesIO()
    page.save(buffer, "PNG")
    made = opened(
        sheet([("one", side_by_side(buffer.getvalue(), 2)[1]), ("two", side_by_side(buffer.getvalue(), 2)[0])], 60)
    )
    found = red(made)
    half = made.width // 2
    assert not found[:, :half].any() and found[:, half:].sum() > 3000


def test_examples_of_the_library_do_not_fit_themselves() -> None:
    for category, size in (("bench", (1.2, 0.4, 0.5)), ("nightstand", (0.5, 0.4, 0.5)), ("rug", (2.0, 1.4, 0.01))):
        text = nearest_programs([thing(category=category, size=size)])
        assert "def " in text and not re.search(r"return fill\(", text)


@pytest.mark.parametrize("size", [(1.8, 1.6, 0.35), (1.5, 2.0, 0.3)])
def test_the_duvet_that_the_prompt_describes_is_what_is_checked(size: tuple[float, float, float]) -> None:
    words = " ".join(load_template("06_programs").split())
    height, cloth = re.findall(r"`(z = h [^`]+|drape\([^`]+)`", words)
    program = (
        "def duvet(size):\n    w, d, h = size\n"
        f"    {height}\n    return [part('duvet', {cloth}, material='linen'), part('duvet', {cloth}, material='linen')]\n"
    )
    shapes = evaluate_object(f"{program}\n\ndef made():\n    return duvet({size})\n", "made")
    assert check(shapes, size, "surface").penalty < 0.3, check(shapes, size, "surface").findings
    low = np.concatenate([s.vertices for s in shapes]).min(axis=0)
    assert abs(low[2]) < 0.02
