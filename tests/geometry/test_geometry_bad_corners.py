# SPDX-License-Identifier: GPL-3.0-or-later
"""Corners with slips: mended and reported, or refused in a plain sentence; never a traceback."""

import math

import numpy as np
import pytest
from code_as_room.pipeline.artifacts.common import ImagePoint
from code_as_room.pipeline.errors import RoomError
from code_as_room.pipeline.geometry import camera as cam
from code_as_room.pipeline.geometry.fit import CameraFit, fit_camera, fit_from_known_floor
from hypothesis import given, settings
from hypothesis import strategies as st

SIZE = (1200, 900)
FLOOR = np.array([(-3, -2), (3, -2), (3, 0.5), (1, 0.5), (1, 2), (-3, 2)], dtype=float)
CAMERA = cam.camera_straight_down("perspective", 6, 4, SIZE, margin=0.2)
LOW, HIGH = (cam.project(CAMERA, np.column_stack([FLOOR, np.full(6, z)])) for z in (0.0, 2.7))


def named(points: object) -> list[ImagePoint]:
    return [ImagePoint.model_construct(x=float(x), y=float(y)) for x, y in np.asarray(points, dtype=float)]


def fit(low: object, high: object = None, size: object = 6.0) -> CameraFit:
    return fit_camera(SIZE, named(low), size, None if high is None else named(high), 2.7)


def same_room(result: CameraFit) -> bool:
    area = {tuple(np.round(c, 2)) for c in result.floor}
    return area == {tuple(np.round(c, 2)) for c in FLOOR}


def test_clockwise_corners_are_turned_round() -> None:
    result = fit(LOW[::-1], HIGH[::-1])
    assert same_room(result) and result.error_px < 0.1
    assert [tuple(np.round(FLOOR[::-1][i], 2)) for i in result.order] == [tuple(np.round(c, 2)) for c in result.floor]


def test_a_repeated_corner_counts_once() -> None:
    twice = [0, 1, 2, 2, 3, 4, 5, 0]
    result = fit(LOW[twice], HIGH[twice])
    assert same_room(result) and len(result.floor) == 6
    assert any("more than once" in f.message for f in result.findings)


def test_an_outline_that_crosses_itself_is_untangled() -> None:
    order = [0, 2, 1, 3, 4, 5]
    result = fit(LOW[order], HIGH[order])
    assert same_room(result) and any("crossed itself" in f.message for f in result.findings)


def test_exchanged_outlines_are_exchanged_back() -> None:
    result = fit(HIGH, LOW)
    assert same_room(result) and any("exchanged" in f.message for f in result.findings)


@pytest.mark.parametrize("turn", [1, 3, 5])
def test_wall_tops_listed_from_another_corner(turn: int) -> None:
    result = fit(LOW, np.roll(HIGH, turn, axis=0))
    assert same_room(result) and any("another order" in f.message for f in result.findings)


def test_missing_wall_tops_leave_the_others_in_use() -> None:
    result = fit(LOW, HIGH[[0, 1, 2, 4, 5]])
    assert result.camera.kind == "perspective" and same_room(result)
    assert any("matched" in f.message for f in result.findings)


def test_wall_tops_of_another_room_are_left_out() -> None:
    result = fit(LOW, [(0, 0), (1000, 0), (0, 30), (990, 50), (10, 5), (100, 900)])
    assert result.camera.kind == "orthographic"
    assert any("do not belong" in f.message or "left out" in f.message for f in result.findings)


def test_a_floor_in_metres_from_another_corner_or_of_another_shape() -> None:
    turned = fit_from_known_floor(SIZE, named(LOW), np.roll(FLOOR, 2, axis=0), named(HIGH), 2.7)
    assert turned.error_px < 0.1 and any("another order" in f.message for f in turned.findings)
    stretched = fit(LOW, HIGH, FLOOR * (1, 1.5))
    assert any("shape was taken from the picture" in f.message for f in stretched.findings)
    fewer = fit(LOW, HIGH, FLOOR[:4])
    assert any("different numbers" in f.message for f in fewer.findings)


def test_a_kind_that_contradicts_the_wall_tops() -> None:
    result = fit_camera(SIZE, named(LOW), 6.0, named(HIGH), 2.7, kind="orthographic")
    assert result.camera.kind == "perspective" and result.findings[0].severity == "warning"
    flat = fit_camera(SIZE, named(LOW), 6.0, named(LOW), 2.7, kind="perspective")
    assert flat.camera.kind == "orthographic"


@pytest.mark.parametrize(
    "corners",
    [
        [],
        [(100, 100), (900, 100)],
        [(100, 100)] * 5,
        [(100, 100), (500, 500), (900, 900)],
        [(100, 100), (500, 500.2), (900, 900), (300, 300)],
        [(100, 100), (900, 100), (900, math.nan), (100, 900)],
        [(100, 100), (math.inf, 100), (900, 900), (100, 900)],
    ],
)
def test_corners_that_no_room_can_have_are_refused_in_words(corners: list) -> None:
    with pytest.raises(RoomError) as caught:
        fit(corners)
    assert caught.value.message.endswith(".") and caught.value.fix


@pytest.mark.parametrize("size", [0.0, -3.0, math.nan, math.inf, (5.0, math.nan), [[1.0, 2.0, 3.0]] * 3])
def test_sizes_that_no_room_can_have_are_refused(size: object) -> None:
    with pytest.raises(RoomError):
        fit(LOW, HIGH, size)


def test_a_height_that_cannot_be_is_not_believed() -> None:
    result = fit_camera(SIZE, named(LOW), 6.0, named(HIGH), 0.05)
    assert result.height == pytest.approx(2.7, abs=0.3) and any(f.about == "height" for f in result.findings)


anywhere = st.tuples(st.floats(-200, 1200), st.floats(-200, 1200))


@settings(
    max_examples=40,
)
@given(st.lists(anywhere, max_size=7), st.none() | st.lists(anywhere, max_size=7), st.floats(0.5, 50))
def test_any_corners_give_a_finite_camera_or_a_plain_error(low: list, high: list | None, width: float) -> None:
    try:
        result = fit_camera(
            SIZE, named(low or np.zeros((0, 2))), width, None if high is None else named(np.reshape(high, (-1, 2)))
        )
    except RoomError as error:
        assert error.message
        return
    assert np.isfinite(result.camera.matrix).all() and math.isfinite(result.error_px)
    assert np.ptp(np.array(result.floor)[:, 0]) == pytest.approx(width, rel=1e-6)
