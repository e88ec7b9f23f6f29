"""The analysis in the fitted frame: one yardstick for everything, and rooms that are askew in the picture."""

from __future__ import annotations

import math

import numpy as np
import pytest
from code_as_room.pipeline.analysis.calibrate import calibrate
from code_as_room.pipeline.artifacts.analysis import SceneAnalysis
from code_as_room.pipeline.artifacts.camera import CameraModel
from code_as_room.pipeline.artifacts.common import ImagePoint, Metres2
from code_as_room.pipeline.geometry.camera import project
from code_as_room.pipeline.geometry.footprint import image_box_of


def test_a_known_width_scales_the_walls_with_everything_else(analysis: SceneAnalysis) -> None:
    part = 0.8
    small = analysis.model_copy(
        update={
            "room_size": tuple(v * part for v in analysis.room_size),
            "objects": [
                o.model_copy(update={k: tuple(v * part for v in getattr(o, k)) for k in ("centre", "size")})
                for o in analysis.objects
            ],
        }
    )
    aligned, calibration = calibrate(small, known_width=4.6)
    assert calibration.height == pytest.approx(2.6, abs=0.01)
    assert min(r.iou for r in calibration.residuals) > 0.98
    for true, found in zip(analysis.objects, aligned.objects, strict=True):
        np.testing.assert_allclose(found.size, true.size, rtol=0.01)
    assert calibrate(small, known_width=4.6, wall_height=2.5)[1].height == 2.5


def spun(point: tuple[float, ...], degrees: float) -> Metres2:
    cos, sin = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
    return point[0] * cos - point[1] * sin, point[0] * sin + point[1] * cos


@pytest.mark.parametrize("turn", [-9.0, 4.0, 12.0])
@pytest.mark.parametrize("along", ["picture", "walls"])
def test_a_room_that_is_askew_is_squared_with_its_objects(
    analysis: SceneAnalysis, camera: CameraModel, turn: float, along: str
) -> None:
    floor = [spun(p, turn) for p in analysis.floor]
    seen = []
    for item in analysis.objects:
        there = item.model_copy(
            update={"centre": (*spun(item.centre, turn), item.centre[2]), "yaw": (item.yaw + turn) % 360}
        )
        box = image_box_of(camera, there.centre, there.size, there.yaw)
        seen.append((there if along == "picture" else item).model_copy(update={"box": box}))
    askew = analysis.model_copy(
        update={
            "floor_polygon": [ImagePoint(x=x, y=y) for x, y in project(camera, [(*p, 0.0) for p in floor]).tolist()],
            "wall_top_polygon": [ImagePoint(x=x, y=y) for x, y in project(camera, [(*p, 2.6) for p in floor]).tolist()],
            "objects": seen,
        }
    )
    aligned, calibration = calibrate(askew)
    np.testing.assert_allclose(sorted(calibration.floor), sorted(analysis.floor), atol=0.01)
    for true, found in zip(analysis.objects, aligned.objects, strict=True):
        np.testing.assert_allclose(found.centre, true.centre, atol=0.01)
        assert abs((found.yaw - true.yaw + 180) % 360 - 180) < 0.2
