"""Which way things face: changed only where what is known outweighs a model that is unsure or contradicts itself."""

from __future__ import annotations

from typing import Any

import pytest
from code_as_room.pipeline.analysis.facing import checked_facings, direction_of
from code_as_room.pipeline.artifacts.analysis import Calibration, DetectedObject, SceneAnalysis
from code_as_room.pipeline.artifacts.camera import CameraModel
from code_as_room.pipeline.geometry.footprint import image_box_of

NORTH = 1.95


def thing(camera: CameraModel, category: str, at: tuple[float, float], said: float, **more: Any) -> DetectedObject:
    """A thing as the model says it, with the box that it truly has (`true` is its true yaw and size)."""
    size = more.pop("size", (1.8, 0.8, 0.8))
    true_yaw = more.pop("true", 0.0)
    centre = (at[0], at[1], size[2] / 2)
    box = image_box_of(camera, centre, size, true_yaw)
    return DetectedObject(id="thing", category=category, box=box, centre=centre, size=size, yaw=said, **more)


def checked(analysis: SceneAnalysis, calibration: Calibration, *items: DetectedObject) -> tuple[float, list[str]]:
    alone = analysis.model_copy(update={"objects": list(items), "findings": []})
    result = checked_facings(alone, calibration)
    return result.objects[0].yaw, [f.message for f in result.findings]


@pytest.mark.parametrize(
    ("front", "yaw"),
    [
        ("headboard at the top", 0.0),
        ("backrest left", 90.0),
        ("doors below", 0.0),
        ("screen facing left", 270.0),
        ("Backrest at the right side", 270.0),
        ("", None),
        ("drawers", None),
        ("backrest left, seat right", None),
        ("wooden, on the left", None),
    ],
)
def test_words_of_a_front_tell_a_direction_or_nothing(front: str, yaw: float | None) -> None:
    assert direction_of(front) == yaw


def test_a_sofa_never_faces_the_wall_it_stands_at_when_the_model_was_unsure(
    analysis: SceneAnalysis, calibration: Calibration, camera: CameraModel
) -> None:
    sofa = thing(camera, "sofa", (0.0, NORTH - 0.45), 180.0)
    yaw, said = checked(analysis, calibration, sofa)
    assert yaw == 0.0 and len(said) == 1 and "faces down" in said[0]


def test_a_sure_and_consistent_model_is_asked_not_overruled(
    analysis: SceneAnalysis, calibration: Calibration, camera: CameraModel
) -> None:
    sofa = thing(camera, "sofa", (0.0, NORTH - 0.45), 180.0, front="backrest at the bottom")
    yaw, said = checked(analysis, calibration, sofa)
    assert yaw == 180.0 and "face the wall" in said[0]


def test_a_turned_bed_is_turned_back_by_its_headboard_and_its_sizes(
    analysis: SceneAnalysis, calibration: Calibration, camera: CameraModel
) -> None:
    for said in (90.0, 180.0, 270.0):
        bed = thing(camera, "double bed", (0.0, 0.9), said, size=(1.5, 2.1, 0.6), front="headboard at the top")
        assert checked(analysis, calibration, bed)[0] == 0.0, said


def test_sizes_and_wall_turn_a_wardrobe_by_a_quarter(
    analysis: SceneAnalysis, calibration: Calibration, camera: CameraModel
) -> None:
    wardrobe = thing(camera, "wardrobe", (2.0, -0.5), 0.0, size=(1.6, 0.6, 2.0), true=270.0)
    assert checked(analysis, calibration, wardrobe)[0] == 270.0


@pytest.mark.parametrize(
    ("category", "more"),
    [
        ("coffee table", {}),
        ("plant", {"size": (0.4, 0.4, 1.0)}),
        ("desk lamp", {"size": (0.3, 0.2, 0.4)}),
        ("pouf", {"shape": "round", "size": (0.5, 0.5, 0.4)}),
        ("rug", {"size": (1.8, 0.8, 0.01)}),
    ],
)
def test_what_has_no_back_is_left_alone(
    analysis: SceneAnalysis, calibration: Calibration, camera: CameraModel, category: str, more: dict[str, Any]
) -> None:
    size = more.get("size", (1.8, 0.8, 0.8))
    item = thing(camera, category, (0.0, NORTH - size[1] / 2), 180.0, **more)
    assert checked(analysis, calibration, item) == (180.0, [])


def test_true_directions_stay(analysis: SceneAnalysis, calibration: Calibration) -> None:
    assert checked_facings(analysis, calibration) is analysis


def test_a_turned_armchair_stays_turned(analysis: SceneAnalysis, calibration: Calibration, camera: CameraModel) -> None:
    chair = thing(camera, "armchair", (-1.8, 1.5), 40.0, size=(0.8, 0.8, 0.8), true=40.0)
    assert checked(analysis, calibration, chair) == (40.0, [])


def test_a_seat_faces_its_table_when_nothing_else_is_said(
    analysis: SceneAnalysis, calibration: Calibration, camera: CameraModel
) -> None:
    table = thing(camera, "dining table", (0.0, 0.0), 0.0, size=(1.4, 0.8, 0.75)).model_copy(update={"id": "table"})
    chair = thing(camera, "chair", (0.3, -0.75), 0.0, size=(0.45, 0.45, 0.9))
    yaw, said = checked(analysis, calibration, chair, table)
    assert yaw == 180.0 and "table" in said[0]
    turned = chair.model_copy(update={"front": "backrest at the top", "confidence": 0.9})
    assert checked(analysis, calibration, turned, table) == (0.0, [])


def test_a_picture_on_the_wall_looks_into_the_room(
    analysis: SceneAnalysis, calibration: Calibration, camera: CameraModel
) -> None:
    art = thing(camera, "painting", (0.0, NORTH - 0.02), 180.0, size=(0.9, 0.03, 0.6), placement="wall")
    assert checked(analysis, calibration, art)[0] == 0.0
    east = thing(camera, "mirror", (2.28, 0.2), 0.0, size=(0.9, 0.03, 0.6), placement="wall", true=270.0)
    assert checked(analysis, calibration, east)[0] == 270.0
