"""A small room seen from above by a known camera; and how the property tests run.

Property tests draw the same examples every time, so that a change is judged by what it changes. To look for new ones:
HYPOTHESIS_PROFILE=explore. They have no deadline: how long an example takes says nothing on a busy machine.
"""

from __future__ import annotations

import math
import os

# Before numpy is there: a process that is copied (os.fork, in the fuzz) while a thread of it computes with several threads of
# OpenBLAS waits for ever. Two processes on two cores need no more than one each, either.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import pytest
from code_as_room.pipeline.artifacts.analysis import Calibration, DetectedObject, SceneAnalysis
from code_as_room.pipeline.artifacts.camera import CameraModel
from code_as_room.pipeline.artifacts.common import ImagePoint
from code_as_room.pipeline.geometry.camera import camera_from, project, tilt_rotation
from code_as_room.pipeline.geometry.footprint import image_box_of
from hypothesis import settings

settings.register_profile("steady", deadline=None, derandomize=True)
settings.register_profile("explore", deadline=None, max_examples=1000)
settings.load_profile(os.environ.get("HYPOTHESIS_PROFILE", "steady"))

LONG_FILES = (
    "test_command_bad_input.py", "test_lifetime.py", "test_modelling_stages.py", "test_correcting_scene.py",
    "test_rectified_faces.py", "test_narrowing.py", "test_room_py_scene.py", "test_preferences_extension.py",
    "test_finishing_moves_nothing.py", "test_recorded_prompts.py", "test_eyes_of_rooms.py",
)  # fmt: skip
"""Files whose tests take longest, begun first, so that no process is left alone with one at the end."""

FLOOR = [(-2.3, -1.95), (2.3, -1.95), (2.3, 1.95), (-2.3, 1.95)]
TRUE_OBJECTS = [
    ("bed", "double bed", (0.2, 0.9, 0.45), (1.7, 2.1, 0.9), 0.0, "floor", None),
    ("stand", "nightstand", (-1.0, 1.7, 0.25), (0.45, 0.45, 0.5), 0.0, "floor", None),
    ("chair", "armchair", (-1.6, -1.2, 0.4), (0.8, 0.8, 0.8), 40.0, "floor", None),
    ("closet", "wardrobe", (2.0, -0.6, 1.0), (1.4, 0.6, 2.0), 270.0, "floor", None),
    ("lamp", "table lamp", (-1.0, 1.7, 0.7), (0.25, 0.25, 0.4), 0.0, "surface", "stand"),
    ("rug", "rug", (0.2, 0.2, 0.005), (2.4, 1.8, 0.01), 0.0, "floor", None),
    ("art", "painting", (0.2, 1.93, 1.6), (0.9, 0.03, 0.6), 0.0, "wall", "top"),
]


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """The long files first; all else in its order."""
    place = {name: number for number, name in enumerate(LONG_FILES)}
    items.sort(key=lambda item: place.get(item.path.name, len(place)))


@pytest.fixture
def camera() -> CameraModel:
    height, size = 6.5, (1200, 1020)
    focal = size[1] / 2 / math.tan(math.atan(3.9 * 0.8 / height))
    return camera_from("perspective", (0, 0, height), tilt_rotation(0, 0), focal, size)


@pytest.fixture
def calibration(camera: CameraModel) -> Calibration:
    return Calibration(camera=camera, floor=FLOOR, height=2.6, error_px=0.1, scale_source="model")


@pytest.fixture
def analysis(camera: CameraModel) -> SceneAnalysis:
    """The true room, as an analysis without errors."""
    objects = [
        DetectedObject(
            id=i, category=c, centre=at, size=size, yaw=yaw, placement=placement, parent=parent,
            salience="major" if placement == "floor" and size[2] > 0.1 else "minor",
            box=image_box_of(camera, at, size, yaw),
        )
        for i, c, at, size, yaw, placement, parent in TRUE_OBJECTS
    ]  # fmt: skip
    corners = project(camera, [(x, y, 0.0) for x, y in FLOOR])
    tops = project(camera, [(x, y, 2.6) for x, y in FLOOR])
    return SceneAnalysis(
        image_size=camera.image_size,
        view="perspective",
        room_size=(4.6, 3.9, 2.6),
        floor=FLOOR,
        floor_polygon=[ImagePoint(x=float(x), y=float(y)) for x, y in corners],
        wall_top_polygon=[ImagePoint(x=float(x), y=float(y)) for x, y in tops],
        objects=objects,
    )
