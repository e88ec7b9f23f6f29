"""The picture's own edges say by how much a turned thing is turned; where they are not clear, nothing changes."""

from __future__ import annotations

import numpy as np
import pytest
from code_as_room.pipeline.analysis.edges import refined_yaws, seen_yaw
from code_as_room.pipeline.artifacts.analysis import Calibration, DetectedObject, SceneAnalysis
from code_as_room.pipeline.artifacts.camera import CameraModel
from code_as_room.pipeline.geometry.camera import camera_looking_at, project
from code_as_room.pipeline.geometry.footprint import image_box_of
from code_as_room.pipeline.geometry.polygon import rectangle_corners
from PIL import Image, ImageDraw


def drawn(camera: CameraModel, item: DetectedObject, boards: bool = True) -> np.ndarray:
    """The thing's top on a floor of boards, with smooth edges and the grain of a photograph."""
    width, height = camera.image_size
    image = Image.new("RGB", (3 * width, 3 * height), (170, 140, 110))
    pen = ImageDraw.Draw(image)
    if boards:
        for x in np.arange(-2.3, 2.3, 0.15):
            pen.line([tuple(p) for p in pixels(camera, [(x, -1.9, 0.0), (x, 1.9, 0.0)])], fill=(150, 120, 90), width=6)
    top = [(float(x), float(y), item.size[2]) for x, y in rectangle_corners(item.centre, item.size, item.yaw)]
    pen.polygon([tuple(p) for p in pixels(camera, top)], fill=(70, 90, 130), outline=(30, 40, 60))
    image = image.resize((width, height), Image.Resampling.BOX)
    grain = np.random.default_rng(3).integers(-8, 9, (height, width, 3))
    return np.clip(np.asarray(image).astype(int) + grain, 0, 255).astype(np.uint8)


def pixels(camera: CameraModel, points: list[tuple[float, float, float]]) -> list[tuple[float, float]]:
    """In a picture of three times the size."""
    width, height = camera.image_size
    return [(x * 3 * width / 1000, y * 3 * height / 1000) for x, y in project(camera, points).tolist()]


def chair(camera: CameraModel, yaw: float) -> DetectedObject:
    centre, size = (-1.2, -0.8, 0.4), (0.9, 0.75, 0.8)
    box = image_box_of(camera, centre, size, yaw)
    return DetectedObject(id="chair", category="armchair", centre=centre, size=size, yaw=yaw, box=box)


@pytest.mark.parametrize(("true", "said"), [(32.0, 45.0), (60.0, 45.0), (318.0, 330.0), (128.0, 135.0)])
def test_a_turned_thing_is_turned_as_the_picture_shows(camera: CameraModel, true: float, said: float) -> None:
    picture = drawn(camera, chair(camera, true))
    found = seen_yaw(chair(camera, true).model_copy(update={"yaw": said}), camera, picture)
    assert found is not None and found == pytest.approx(true, abs=3.0)


def test_through_a_camera_at_an_angle() -> None:
    camera = camera_looking_at("perspective", (0.0, -4.0, 7.0), (0.0, 0.0, 0.0), 45.0, (1200, 1000))
    picture = drawn(camera, chair(camera, 35.0))
    found = seen_yaw(chair(camera, 35.0).model_copy(update={"yaw": 48.0}), camera, picture)
    assert found is not None and found == pytest.approx(35.0, abs=3.0)


def test_nothing_changes_without_clear_edges(camera: CameraModel, calibration: Calibration) -> None:
    item = chair(camera, 45.0)
    noise = np.random.default_rng(1).integers(0, 255, (1020, 1200, 3)).astype(np.uint8)
    flat = np.full((1020, 1200, 3), 128, dtype=np.uint8)
    assert seen_yaw(item, camera, noise) is None and seen_yaw(item, camera, flat) is None


def test_straight_and_round_things_are_left(
    camera: CameraModel, calibration: Calibration, analysis: SceneAnalysis
) -> None:
    picture = drawn(camera, chair(camera, 30.0))
    straight = chair(camera, 0.0).model_copy(update={"id": "straight"})
    round_one = chair(camera, 45.0).model_copy(update={"id": "round", "shape": "round"})
    turned = chair(camera, 45.0)
    before = analysis.model_copy(update={"objects": [straight, round_one, turned]})
    after = refined_yaws(before, calibration, picture)
    assert [o.yaw for o in after.objects[:2]] == [0.0, 45.0]
    assert after.objects[2].yaw == pytest.approx(30.0, abs=3.0)
    assert [f.about for f in after.findings] == ["chair"]
