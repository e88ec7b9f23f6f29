"""The room's scale from things of known size, and which detections disagree."""

from __future__ import annotations

import math

import numpy as np
import pytest
from code_as_room.benchmark.calibration import errors
from code_as_room.benchmark.synthetic import STRONG, make_room, told
from code_as_room.pipeline.analysis.anchors import Anchor, find_anchors, usual_size
from code_as_room.pipeline.analysis.calibrate import calibrate
from code_as_room.pipeline.analysis.rescale import Similarity, rescaled_analysis
from code_as_room.pipeline.analysis.residuals import outliers
from code_as_room.pipeline.analysis.scale import estimated_scale, robust_mean, scale_sentence
from code_as_room.pipeline.artifacts.analysis import DetectedObject, ObjectResidual, SceneAnalysis
from code_as_room.pipeline.artifacts.camera import CameraModel
from hypothesis import given, settings
from hypothesis import strategies as st


def anchors(*factors: float, spread: float = 0.08) -> list[Anchor]:
    return [Anchor(f"thing {n}", math.log(f), spread, 1) for n, f in enumerate(factors)]


@pytest.mark.parametrize(
    ("category", "like"),
    [
        ("Double Bed", "double bed"),
        ("modern_double-bed with drawers", "double bed"),
        ("dining chairs", "chair"),
        ("bedside table", "nightstand"),
        ("chest of drawers", "dresser"),
    ],
)
def test_a_category_is_known_by_its_last_words(category: str, like: str) -> None:
    assert usual_size(category) is not None and usual_size(category) == usual_size(like)


@pytest.mark.parametrize("category", ["dog bed", "bed bench", "doll bed", "bed linen", "lamp", "grand piano", "", "42"])
def test_what_only_sounds_like_an_anchor_is_none(category: str) -> None:
    assert usual_size(category) is None


def test_many_that_agree_on_another_size_win() -> None:
    found = estimated_scale(anchors(1.27, 1.22, 1.25, 1.3, 1.24))
    assert 1.18 < found.factor < 1.28
    assert any("larger" in f.message for f in found.findings)


def test_a_small_or_uncertain_disagreement_hardly_moves_the_stated_size() -> None:
    assert abs(estimated_scale(anchors(1.05, 1.02, 1.07)).factor - 1) < 0.03
    assert abs(estimated_scale(anchors(1.3, 0.8, 1.1, 0.9, 1.2, spread=0.15)).factor - 1) < 0.03
    assert abs(estimated_scale(anchors(1.25)).factor - 1) < 0.06, "one thing may just be large"


def test_an_anchor_that_contradicts_all_others_is_named_and_not_averaged() -> None:
    found = estimated_scale(anchors(1.0, 1.01, 0.99, 1.02, 1.9))
    assert abs(found.factor - 1) < 0.03
    assert [f.about for f in found.findings] == ["thing 4"] and "smaller than usual" in found.findings[0].message


@given(st.lists(st.floats(0.85, 1.15), min_size=3, max_size=9), st.floats(2.0, 4.0))
def test_one_gross_mistake_moves_the_mean_less_than_the_others_differ(good: list[float], bad: float) -> None:
    values = [math.log(v) for v in good]
    mean, _ = robust_mean([*values, math.log(bad)], [0.08] * (len(values) + 1))
    assert min(values) - 0.02 <= mean <= max(values) + 0.12


@settings(max_examples=8)
@given(st.integers(0, 10_000), st.sampled_from([0.75, 1.0, 1.33]))
def test_a_room_stated_far_too_large_or_small_is_found_out(seed: int, factor: float) -> None:
    rng = np.random.default_rng(seed)
    room = make_room(rng, "straight")
    said = rescaled_analysis(told(room, rng, STRONG), Similarity(factor))
    _, calibration = calibrate(said)
    off = errors(room, calibration).scale
    assert off < (0.08 if factor == 1.0 else 0.5 * abs(math.log(factor)) + 0.06)
    assert calibration.scale_spread > 0.02


def test_a_known_width_overrides_all_anchors(analysis: SceneAnalysis) -> None:
    found, calibration = calibrate(rescaled_analysis(analysis, Similarity(1.4)), known_width=5.5)
    assert found.room_size[0] == pytest.approx(5.5) and calibration.scale_spread == 0.0
    assert scale_sentence(calibration) == "Scale from the known width"


def test_a_chair_under_its_table_and_a_turned_one_are_no_yardsticks(
    analysis: SceneAnalysis, camera: CameraModel
) -> None:
    table = DetectedObject(
        id="table", category="dining table", box=analysis.objects[0].box, centre=(0.2, 0.9, 0.37), size=(1.7, 2.1, 0.75)
    )
    tucked = analysis.objects[1].model_copy(
        update={"id": "tucked", "category": "dining chair", "centre": (0.9, 0.9, 0.4), "size": (0.45, 0.5, 0.85)}
    )
    seen = analysis.model_copy(update={"objects": [table, tucked, *analysis.objects[2:]]})
    by_name = {a.name: a for a in find_anchors(seen, camera)}
    alone = {a.name for a in find_anchors(analysis, camera)}
    assert "wardrobe" in alone and "armchair" not in alone
    # What is left of the tucked one is its stated height, a far less certain thing.
    assert by_name["dining chair"].spread > 0.15


def test_the_panel_says_where_the_scale_comes_from(analysis: SceneAnalysis) -> None:
    words = scale_sentence(calibrate(analysis)[1])
    assert words.startswith("Scale from the model and 3 anchors, about ") and words.endswith(" % uncertain")
    bare = analysis.model_copy(update={"objects": []})
    assert scale_sentence(calibrate(bare)[1]) == "Scale from the model, about 6 % uncertain"


def off_by(*values: tuple[float, float, float]) -> list[ObjectResidual]:
    return [ObjectResidual(id=f"o{n}", iou=iou, shift=(x, y)) for n, (x, y, iou) in enumerate(values)]


def test_detections_that_disagree_are_told_from_those_that_are_all_off_alike() -> None:
    usual = [(2.0, -1.0, 0.9), (-3.0, 2.0, 0.88), (1.0, 3.0, 0.93), (0.0, -2.0, 0.9), (-2.0, 1.0, 0.86)]
    assert outliers(off_by(*usual)) == []
    assert outliers(off_by(*usual, (60.0, 5.0, 0.3), (20.0, 18.0, 0.6))) == ["o5", "o6"]
    assert outliers(off_by(*((x + 40, y, iou * 0.6) for x, y, iou in usual))) == []
    assert outliers([]) == [] and outliers(off_by((90.0, 0.0, 0.0))) == ["o0"]
