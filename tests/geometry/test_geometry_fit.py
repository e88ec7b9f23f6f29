# SPDX-License-Identifier: GPL-3.0-or-later
"""Camera fits against cameras of known parameters."""

import math
from dataclasses import dataclass

import numpy as np
import pytest
from code_as_room.pipeline.artifacts.camera import CameraModel
from code_as_room.pipeline.artifacts.common import ImagePoint
from code_as_room.pipeline.geometry import camera as cam
from code_as_room.pipeline.geometry.fit import CameraFit, fit_camera, fit_from_known_floor, fit_from_known_length
from code_as_room.pipeline.geometry.footprint import image_box_of, lift_box
from code_as_room.pipeline.geometry.polygon import is_convex, signed_area
from hypothesis import HealthCheck, assume, given, settings
from hypothesis import strategies as st

fits = settings(max_examples=25, suppress_health_check=[HealthCheck.filter_too_much, HealthCheck.too_slow])


@dataclass
class Truth:
    """A room, its camera, and its corners in the picture (0-1000, exact)."""

    floor: np.ndarray
    height: float
    camera: CameraModel
    low: np.ndarray
    high: np.ndarray

    @property
    def width(self) -> float:
        return float(np.ptp(self.floor[:, 0]))

    @property
    def diagonal(self) -> float:
        return float(np.linalg.norm(np.ptp(self.floor, axis=0)))

    def shaken(self, pixels: float, seed: int) -> tuple[list[ImagePoint], list[ImagePoint]]:
        """Floor corners and wall tops with normal noise of so many pixels on each coordinate."""
        noise = (
            np.random.default_rng(seed).normal(0, pixels, (2, *self.low.shape))
            * 1000
            / np.array(self.camera.image_size)
        )
        return named(self.low + noise[0]), named(self.high + noise[1])


def named(points: np.ndarray) -> list[ImagePoint]:
    return [ImagePoint(x=float(x), y=float(y)) for x, y in points]


def centred(corners: list) -> np.ndarray:
    points = np.array(corners, dtype=float)
    return points - (points.min(axis=0) + points.max(axis=0)) / 2


@st.composite
def right_angled(draw: st.DrawFn) -> np.ndarray:
    w, d = draw(st.floats(3, 8)), draw(st.floats(2.5, 6))
    a, b, c = draw(st.floats(0.2, 0.4)), draw(st.floats(0.6, 0.8)), draw(st.floats(0.3, 0.7))
    outlines = {
        "rectangle": [(0, 0), (w, 0), (w, d), (0, d)],
        "l": [(0, 0), (w, 0), (w, d * c), (w * b, d * c), (w * b, d), (0, d)],
        "u": [(0, 0), (w, 0), (w, d), (w * b, d), (w * b, d * c), (w * a, d * c), (w * a, d), (0, d)],
        "cut corner": [(0, 0), (w, 0), (w, d * b), (w * b, d), (0, d)],
    }
    return centred(outlines[draw(st.sampled_from(sorted(outlines)))])


@st.composite
def slanted(draw: st.DrawFn) -> np.ndarray:
    """Outlines of 4 to 8 corners without right angles on purpose."""
    count = draw(st.integers(4, 8))
    radii = [draw(st.floats(0.8, 1.0)) for _ in range(count)]
    turns = [2 * math.pi * (i + draw(st.floats(-0.25, 0.25))) / count for i in range(count)]
    w, d = draw(st.floats(1.5, 4)), draw(st.floats(1.5, 3))
    return centred([(w * r * math.cos(t), d * r * math.sin(t)) for r, t in zip(radii, turns, strict=True)])


@st.composite
def truths(
    draw: st.DrawFn,
    floors: st.SearchStrategy[np.ndarray],
    kind: str = "perspective",
    tilt: float = 20.0,
    roll: float = 0.0,
    shifted: bool = False,
) -> Truth:
    """A room that is all in the picture and fills a good part of it."""
    floor, height = draw(floors), draw(st.floats(2.4, 3.0))
    size = (draw(st.integers(600, 1600)), draw(st.integers(600, 1600)))
    towards, angle = draw(st.floats(0, 2 * math.pi)), draw(st.floats(0, tilt))
    rotation = cam.tilt_rotation(angle * math.cos(towards), angle * math.sin(towards), draw(st.floats(-roll, roll)))
    focal = size[1] / 2 / math.tan(math.radians(draw(st.floats(25, 65))) / 2)
    principal = (draw(st.floats(400, 600)), draw(st.floats(400, 600))) if shifted else cam.CENTRE
    for distance in np.geomspace(5, 80, 40):
        position = np.array((0.1, -0.2, 0.0)) + distance * rotation[:, 2]
        scale = focal if kind == "perspective" else min(size) / distance
        camera = cam.camera_from(kind, position, rotation, scale, size, principal)
        if position[2] < height + 1:
            continue
        low, high = (cam.project(camera, np.column_stack([floor, np.full(len(floor), z)])) for z in (0.0, height))
        both = np.concatenate([low, high])
        if np.isfinite(both).all() and both.min() > 10 and both.max() < 990:
            return Truth(floor, height, camera, low, high)
    assume(False)
    raise AssertionError


def worst_footprint(truth: Truth, fit: CameraFit, seed: int) -> float:
    """Largest error of the lifted centre or size of some boxes, as a part of the room's diagonal."""
    rng = np.random.default_rng(seed)
    worst = 0.0
    reach = np.abs(truth.floor).max(axis=0) * 0.85
    for _ in range(5):
        at, size, height = rng.uniform(-reach, reach), rng.uniform(0.3, 2.0, 2), rng.uniform(0.1, 2.0)
        box = image_box_of(truth.camera, (*at, height / 2), (*size, height), 0)
        lifted = lift_box(fit.camera, box, 0, height, 0)
        worst = max(worst, math.dist(lifted.centre[:2], at), *np.abs(np.array(lifted.size[:2]) - size))
    return worst / truth.diagonal


seeds = st.integers(0, 10_000)


@fits
@given(truths(right_angled() | slanted()), seeds)
def test_exact_corners_with_wall_tops_give_the_camera_back(truth: Truth, seed: int) -> None:
    size = truth.camera.image_size
    fit = fit_from_known_length(size, named(truth.low), truth.width, None, named(truth.high), truth.height)
    assert fit.camera.kind == "perspective" and fit.error_px < 0.5
    assert np.array(fit.floor) == pytest.approx(truth.floor, abs=0.01)
    assert worst_footprint(truth, fit, seed) < 0.003


@fits
@given(truths(right_angled(), roll=10, shifted=True))
def test_roll_and_an_off_centre_principal_point(truth: Truth) -> None:
    size = truth.camera.image_size
    fit = fit_camera(
        size, named(truth.low), truth.width, named(truth.high), truth.height, principal=truth.camera.principal
    )
    assert fit.error_px < 0.5
    principal = truth.camera.principal
    assert (fit.camera.principal.x, fit.camera.principal.y) == pytest.approx((principal.x, principal.y))
    assert np.array(fit.floor) == pytest.approx(truth.floor, abs=0.02)


@fits
@given(truths(right_angled() | slanted()), seeds)
def test_noise_of_three_pixels_keeps_footprints_within_three_percent(truth: Truth, seed: int) -> None:
    low, high = truth.shaken(3, seed)
    fit = fit_camera(truth.camera.image_size, low, truth.width, high, truth.height)
    assert worst_footprint(truth, fit, seed) < 0.03


@fits
@given(truths(right_angled() | slanted()), seeds)
def test_noise_with_a_floor_known_in_metres(truth: Truth, seed: int) -> None:
    low, high = truth.shaken(3, seed)
    fit = fit_from_known_floor(truth.camera.image_size, low, truth.floor, high, truth.height)
    assert worst_footprint(truth, fit, seed) < 0.03
    exact = fit_from_known_floor(
        truth.camera.image_size, named(truth.low), truth.floor, named(truth.high), truth.height
    )
    assert exact.error_px < 0.5


@fits
@given(truths(right_angled() | slanted(), kind="orthographic", tilt=0), seeds, st.booleans())
def test_orthographic_views_with_and_without_wall_tops(truth: Truth, seed: int, tops: bool) -> None:
    size = truth.camera.image_size
    for noise in (0, 3):
        low, high = truth.shaken(noise, seed)
        fit = fit_camera(size, low, truth.width, high if tops else None)
        assert fit.camera.kind == "orthographic"
        assert worst_footprint(truth, fit, seed) < (0.03 if noise else 0.01)


@fits
@given(truths(right_angled(), kind="orthographic", tilt=15), seeds)
def test_a_tilted_orthographic_view_shows_in_the_wall_tops(truth: Truth, seed: int) -> None:
    low, high = truth.shaken(3, seed)
    shaken = fit_camera(truth.camera.image_size, low, truth.width, high, truth.height, kind="orthographic")
    assert not any("exchanged" in f.message for f in shaken.findings), "noise does not turn the room inside out"
    assert worst_footprint(truth, shaken, seed) < 0.05
    fit = fit_camera(truth.camera.image_size, named(truth.low), truth.width, named(truth.high), truth.height)
    assert fit.camera.kind == "orthographic" and fit.error_px < 0.5
    assert np.array(fit.floor) == pytest.approx(truth.floor, abs=0.03)


@fits
@given(truths(right_angled(), tilt=0), seeds)
def test_perspective_without_wall_tops_does_not_tilt_wildly(truth: Truth, seed: int) -> None:
    """Right angles are the only cue: corner noise must not be read as tilt."""
    low, _ = truth.shaken(3, seed)
    fit = fit_camera(truth.camera.image_size, low, truth.width, None, truth.height, kind="perspective")
    assert fit.camera.kind == "perspective"
    assert fit.camera.matrix[10] > math.cos(math.radians(8))
    assert np.abs(np.array(fit.floor) - truth.floor).max() < 0.04 * truth.diagonal


@fits
@given(truths(right_angled(), tilt=12))
def test_right_angles_show_a_tilt_without_wall_tops(truth: Truth) -> None:
    assume(len(truth.floor) >= 6)
    fit = fit_camera(truth.camera.image_size, named(truth.low), truth.width, None, truth.height, kind="perspective")
    straight = np.array(fit.floor)
    # The lens is a guess here and pulls a little: not as exact as with wall tops.
    assert fit.error_px < 0.004 * max(truth.camera.image_size)
    assert np.abs(straight - truth.floor).max() < 0.03 * truth.diagonal


@fits
@given(truths(right_angled(), tilt=5), seeds)
def test_walls_end_up_exactly_straight_despite_noise(truth: Truth, seed: int) -> None:
    low, high = truth.shaken(2, seed)
    fit = fit_camera(truth.camera.image_size, low, truth.width, high, truth.height)
    straight = sum(
        abs(bx - ax) < 1e-9 or abs(by - ay) < 1e-9
        for (ax, ay), (bx, by) in zip(fit.floor, [*fit.floor[1:], fit.floor[0]], strict=True)
    )
    assert straight >= len(truth.floor) - 1, "all but a cut corner"
    assert fit.squared


@fits
@given(truths(right_angled() | slanted()), seeds)
def test_the_result_keeps_its_promises(truth: Truth, seed: int) -> None:
    low, high = truth.shaken(5, seed)
    fit = fit_camera(truth.camera.image_size, low, (truth.width, float(np.ptp(truth.floor[:, 1]))), high)
    again = fit_camera(truth.camera.image_size, low, (truth.width, float(np.ptp(truth.floor[:, 1]))), high)
    assert fit == again, "the same corners give the same camera"
    floor = np.array(fit.floor)
    assert signed_area(floor) > 0 and floor.max(axis=0) == pytest.approx(-floor.min(axis=0))
    seen = cam.project(fit.camera, np.column_stack([floor, np.zeros(len(floor))]))
    above = cam.project(fit.camera, np.column_stack([floor, np.full(len(floor), fit.height)]))
    given_ = np.array([(low[i].x, low[i].y) for i in fit.order] + [(high[i].x, high[i].y) for i in fit.order])
    off = (np.concatenate([seen, above]) - given_) * np.array(truth.camera.image_size) / 1000
    assert math.sqrt(np.mean(np.sum(off**2, axis=1))) == pytest.approx(fit.error_px, abs=1e-6)
    assert 2.0 < fit.height < 3.5


def test_an_assumed_height_is_said() -> None:
    camera = cam.camera_straight_down("perspective", 5, 4, (1200, 900), margin=0.2)
    floor = np.array([(-2.5, -2), (2.5, -2), (2.5, 2), (-2.5, 2)])
    low, high = (named(cam.project(camera, np.column_stack([floor, np.full(4, z)]))) for z in (0.0, 2.7))
    fit = fit_camera((1200, 900), low, 5.0, high)
    assert fit.height_source == "assumed" and any(f.about == "height" for f in fit.findings)
    assert fit.height == pytest.approx(2.7, abs=0.05)
    assert is_convex(fit.floor)
