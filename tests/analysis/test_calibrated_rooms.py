"""Cameras and frames found for rooms made of numbers, from answers of known exactness."""

from __future__ import annotations

import math

import numpy as np
import pytest
from code_as_room.benchmark.calibration import errors
from code_as_room.benchmark.synthetic import EXACT, STRONG, WAYS, Exactness, TrueRoom, Way, make_room, told
from code_as_room.pipeline.analysis.calibrate import calibrate, uncalibrated
from code_as_room.pipeline.analysis.recorner import recornered
from code_as_room.pipeline.artifacts.analysis import SceneAnalysis
from code_as_room.pipeline.artifacts.common import ImagePoint
from code_as_room.pipeline.artifacts.corrections import Found
from code_as_room.pipeline.errors import PictureError
from hypothesis import given, settings
from hypothesis import strategies as st

seeds = st.integers(0, 10_000)


def noisy(units: float) -> Exactness:
    """Corners and boxes off by so many units; metres as a strong model gives them, the word for the view often wrong."""
    return Exactness(units, units, 0.01, 0.04, 0.06, 0.015, 0.0, 0.3) if units else EXACT


def answer(way: Way, seed: int, exactness: Exactness, tops: bool = True) -> tuple[TrueRoom, SceneAnalysis]:
    rng = np.random.default_rng(seed)
    room = make_room(rng, way)
    return room, told(room, rng, exactness, tops)


def swapped_view(analysis: SceneAnalysis) -> SceneAnalysis:
    return analysis.model_copy(update={"view": "orthographic" if analysis.view == "perspective" else "perspective"})


@settings(max_examples=14)
@given(st.sampled_from(WAYS), seeds, st.sampled_from([0.0, 3.0, 8.0]))
def test_camera_and_proportions_where_wall_tops_show(way: Way, seed: int, units: float) -> None:
    room, analysis = answer(way, seed, noisy(units))
    found = errors(room, calibrate(analysis)[1])
    assert found.tilt < 4.0 + units and found.aspect < 0.01 + 0.006 * units
    assert found.feet < 0.002 + 0.002 * units


@settings(max_examples=10)
@given(st.sampled_from(WAYS), seeds, st.sampled_from([0.0, 3.0]))
def test_camera_from_floor_corners_and_objects_alone(way: Way, seed: int, units: float) -> None:
    """How tall things lean tells what the floor's corners leave open, a strong tilt too."""
    room, analysis = answer(way, seed, noisy(units), tops=False)
    found = errors(room, calibrate(analysis)[1])
    assert found.tilt < 2.0 + 1.5 * units and found.aspect < 0.02 + 0.012 * units
    assert found.feet < 0.003 + 0.004 * units


@settings(max_examples=8)
@given(st.sampled_from(WAYS), seeds, st.booleans())
def test_a_wrong_word_for_the_view_changes_nothing_that_the_picture_shows(way: Way, seed: int, tops: bool) -> None:
    room, analysis = answer(way, seed, noisy(0.0), tops)
    right, wrong = calibrate(analysis)[1], calibrate(swapped_view(analysis))[1]
    assert right.tried[0].name == wrong.tried[0].name
    assert right.camera.kind == wrong.camera.kind == room.camera.kind
    assert any("said to be taken" in f.message for f in wrong.findings)


def test_without_tall_things_and_wall_tops_the_word_decides() -> None:
    room, analysis = answer("orthographic", 3, EXACT)
    flat = [
        o.model_copy(update={"size": (*o.size[:2], 0.01), "centre": (*o.centre[:2], 0.005)}) for o in analysis.objects
    ]
    for view, kind in (("orthographic", "orthographic"), ("perspective", "perspective")):
        said = analysis.model_copy(update={"objects": flat, "view": view})
        assert calibrate(said)[1].camera.kind == kind


@pytest.mark.parametrize("tops", [True, False])
def test_a_view_from_the_side_is_refused_and_a_steep_one_is_not(tops: bool) -> None:
    for seed in range(2):
        for down, refused in ((20.0, True), (33.0, True), (50.0, False), (60.0, False)):
            rng = np.random.default_rng(seed)
            room = make_room(rng, "steep", "rectangle", 90.0 - down)
            analysis = told(room, rng, STRONG, tops)
            if refused:
                with pytest.raises(PictureError, match="degrees down") as caught:
                    calibrate(analysis)
                assert "from above" in caught.value.fix
            else:
                assert errors(room, calibrate(analysis)[1]).tilt < 5.0


def test_a_floor_stretched_beyond_any_room_is_refused(analysis: SceneAnalysis) -> None:
    thin = [ImagePoint(x=x, y=y) for x, y in ((20, 520), (980, 520), (980, 480), (20, 480))]
    lying = analysis.model_copy(update={"floor_polygon": thin, "wall_top_polygon": None, "objects": []})
    with pytest.raises(PictureError, match="not seen from above"):
        calibrate(lying)


@pytest.mark.parametrize("way", ["downward", "bottom left", "top left"])
def test_metres_measured_from_elsewhere_are_brought_to_the_middle(way: str) -> None:
    room, analysis = answer("straight", 5, STRONG)
    width, depth = analysis.room_size[:2]
    shift = (0.0, 0.0) if way == "downward" else (width / 2, depth / 2)
    sign = 1.0 if way == "bottom left" else -1.0

    def elsewhere(centre: tuple[float, float, float]) -> tuple[float, float, float]:
        return centre[0] + shift[0], sign * centre[1] + shift[1], centre[2]

    odd = analysis.model_copy(
        update={"objects": [o.model_copy(update={"centre": elsewhere(o.centre)}) for o in analysis.objects]}
    )
    found, calibration = calibrate(odd)
    usual = calibrate(analysis)[0]
    for mended, as_usual in zip(found.objects, usual.objects, strict=True):
        assert math.dist(mended.centre, as_usual.centre) < 0.02
    assert any("measured" in f.message for f in found.findings)
    assert errors(room, calibration).feet < 0.02


def test_a_camera_found_by_its_objects_survives_a_corner_moved_a_little() -> None:
    """The corners alone would say that it looks straight down."""
    room, analysis = answer("steep", 4, EXACT, tops=False)
    found, calibration = calibrate(analysis)
    assert errors(room, calibration).tilt < 1.0
    moved = [p.model_copy(update={"x": p.x + 3}) if n == 0 else p for n, p in enumerate(found.floor_polygon)]
    after = recornered(Found(analysis=found, calibration=calibration), moved)[1]
    assert errors(room, after).tilt < 6.0 and errors(room, after).feet < 0.03


def test_an_off_centre_camera_stays_so_when_a_corner_is_moved() -> None:
    _, analysis = answer("shifted", 6, EXACT)
    found, calibration = calibrate(analysis)
    before = calibration.camera.principal
    assert max(abs(before.x - 500), abs(before.y - 500)) > 40
    moved = [p.model_copy(update={"x": p.x + 2}) if n == 0 else p for n, p in enumerate(found.floor_polygon)]
    after = recornered(Found(analysis=found, calibration=calibration), moved)[1].camera.principal
    assert (after.x, after.y) == pytest.approx((before.x, before.y))


def test_without_calibration_the_stated_rectangle_lies_over_the_floor() -> None:
    room, analysis = answer("tilted", 7, EXACT)
    found, calibration = uncalibrated(analysis)
    assert found.room_size == analysis.room_size and calibration.camera.kind == "orthographic"
    assert [o.centre for o in found.objects] == [o.centre for o in analysis.objects]
    xs = [p.x for p in found.floor_polygon]
    seen = [p.x for p in analysis.floor_polygon]
    assert abs(sum(xs) / 4 - (min(seen) + max(seen)) / 2) < 1.0
    assert len(room.floor) >= 4
