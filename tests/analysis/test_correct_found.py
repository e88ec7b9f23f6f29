"""Corrections as plain decisions: exact, repeatable, and without a trace when they are taken back."""

from __future__ import annotations

import functools
import math

import pytest
from code_as_room.pipeline.analysis.calibrate import calibrate
from code_as_room.pipeline.analysis.correct import Known, correct_found
from code_as_room.pipeline.analysis.frames import between
from code_as_room.pipeline.analysis.identity import keep_ids, normal
from code_as_room.pipeline.analysis.rescale import Similarity, rescaled_line, rescaled_text
from code_as_room.pipeline.artifacts.analysis import SceneAnalysis
from code_as_room.pipeline.artifacts.common import ImageBox, ImagePoint
from code_as_room.pipeline.artifacts.corrections import (
    AddedObject,
    Corrections,
    Found,
    KnownLength,
    ObjectCorrection,
)
from code_as_room.pipeline.artifacts.layout import LightLine
from code_as_room.pipeline.geometry.measuring import floor_distance
from code_as_room.pipeline.layout.initial import Evidence, first_layout
from code_as_room.pipeline.layout.score import Expected, measure
from code_as_room.pipeline.program.lines import parse_layout, print_layout
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

POINTS = st.tuples(st.floats(200, 800), st.floats(200, 800)).map(lambda p: ImagePoint(x=p[0], y=p[1]))
FIXTURES = settings(suppress_health_check=[HealthCheck.function_scoped_fixture], max_examples=60)
FITTED = settings(FIXTURES, max_examples=16)
"""Where every example fits a camera."""


@functools.lru_cache(maxsize=4)
def fitted(analysis: str) -> Found:
    aligned, calibration = calibrate(SceneAnalysis.model_validate_json(analysis))
    return Found(analysis=aligned, calibration=calibration)


@pytest.fixture
def found(analysis: SceneAnalysis) -> Found:
    return fitted(analysis.model_dump_json())


def flat(found: Found) -> Found:
    """The same room in a picture without perspective."""
    analysis = found.analysis.model_copy(update={"view": "orthographic", "wall_top_polygon": None})
    return fitted(analysis.model_dump_json())


def measured(found_camera: object, start: ImagePoint, end: ImagePoint) -> float:
    result = floor_distance(found_camera, (start.x, start.y), (end.x, end.y))  # type: ignore[arg-type]
    assert result is not None
    return result


def test_where_nothing_is_said_what_was_found_comes_back(found: Found) -> None:
    nothing = correct_found(found, Corrections(floor_polygon=list(found.analysis.floor_polygon)))
    assert nothing.analysis == found.analysis and nothing.calibration == found.calibration


@FIXTURES
@given(start=POINTS, end=POINTS, metres=st.floats(0.3, 12.0), deep=st.booleans(), high=st.none() | st.floats(2.0, 4.0))
def test_a_known_length_is_exact(
    found: Found, start: ImagePoint, end: ImagePoint, metres: float, deep: bool, high: float | None
) -> None:
    if math.hypot(start.x - end.x, start.y - end.y) < 60:
        return
    found = found if deep else flat(found)
    wanted = Corrections(known_length=KnownLength(start=start, end=end, metres=metres))
    new = correct_found(found, wanted, Known(height=high))
    assert measured(new.calibration.camera, start, end) == pytest.approx(metres, rel=1e-12)
    if high is not None:
        assert new.calibration.height == high == new.analysis.room_size[2]
    again = correct_found(Found(analysis=found.analysis, calibration=found.calibration), wanted, Known(height=high))
    assert again == new
    factor = new.analysis.room_size[0] / found.analysis.room_size[0]
    for before, after in zip(found.analysis.objects, new.analysis.objects, strict=True):
        assert after.size == pytest.approx([v * factor for v in before.size], rel=1e-4)
        assert after.box == before.box and after.yaw == before.yaw


@FIXTURES
@given(factor=st.floats(0.2, 5.0))
def test_a_rescaled_room_fits_the_picture_as_before_and_comes_back(found: Found, factor: float) -> None:
    there = correct_found(found, Corrections(), Known(width=found.analysis.room_size[0] * factor))
    assert there.calibration.scale_spread == 0.0
    change = between(found.calibration, there.calibration)
    assert change.pure and change.metres.factor == pytest.approx(factor) and change.metres.shift == (0.0, 0.0)
    for before, after in zip(found.calibration.residuals, there.calibration.residuals, strict=True):
        assert after.iou == pytest.approx(before.iou, abs=1e-9)
    back = between(there.calibration, found.calibration)
    assert back.pure and back.metres.factor * change.metres.factor == pytest.approx(1.0)


@settings(FIXTURES, max_examples=25)
@given(factor=st.floats(0.3, 4.0), dx=st.floats(-2, 2), dy=st.floats(-2, 2))
def test_a_rescaled_program_scores_the_same(found: Found, factor: float, dx: float, dy: float) -> None:
    layout, _ = first_layout(found.analysis, found.calibration, Evidence({o.id: o for o in found.analysis.objects}))
    lamp = LightLine(id="lamp_light", kind="point", at=(0.0, 0.0, 2.0), energy=100.0)
    text = "# mine\nnote = 1\n" + print_layout(layout.model_copy(update={"lights": [lamp]}))
    change = Similarity(factor, (dx, dy))
    moved = rescaled_text(text, change)
    assert moved.startswith("# mine\nnote = 1\n")
    expected = Expected(tuple(p.id for p in layout.proxies), {}, [], frozenset())
    camera = found.calibration.camera
    (a, _), (b, _) = (measure(parse_layout(t), camera, expected) for t in (text, moved))
    assert b.overlap == pytest.approx(a.overlap, abs=2e-3) and b.bounds == pytest.approx(a.bounds, abs=2e-3)
    light = parse_layout(moved).lights[0]
    # Watts per square metre where it shines are what they were.
    assert light.energy / (light.at[2] ** 2) == pytest.approx(lamp.energy / lamp.at[2] ** 2, rel=2e-3)
    inverse = Similarity(1 / factor, (-dx / factor, -dy / factor))
    back = parse_layout(rescaled_text(moved, inverse))
    for line, was in zip(back.proxies, parse_layout(text).proxies, strict=True):
        assert line.centre == pytest.approx(was.centre, abs=3e-4) and line.size == pytest.approx(was.size, abs=3e-4)


def test_a_sun_shines_on_large_rooms_as_on_small_ones() -> None:
    sun = LightLine(id="sun", kind="sun", at=(0.0, 0.0, 3.0), energy=2.0, size=0.2)
    moved = rescaled_line(sun, Similarity(3.0))
    assert isinstance(moved, LightLine) and (moved.energy, moved.size) == (2.0, 0.2)


@FITTED
@given(
    shifts=st.lists(st.tuples(st.floats(-40, 40), st.floats(-40, 40)), min_size=4, max_size=4),
    deep=st.booleans(),
)
def test_moved_corners_keep_the_size_of_things(found: Found, shifts: list[tuple[float, float]], deep: bool) -> None:
    found = found if deep else flat(found)
    polygon = [
        ImagePoint(x=p.x + dx, y=p.y + dy) for p, (dx, dy) in zip(found.analysis.floor_polygon, shifts, strict=True)
    ]
    new = correct_found(found, Corrections(floor_polygon=polygon))
    assert correct_found(found, Corrections(floor_polygon=polygon)) == new
    low = [min(v) for v in zip(*new.calibration.floor, strict=True)]
    high = [max(v) for v in zip(*new.calibration.floor, strict=True)]
    assert [a + b for a, b in zip(low, high, strict=True)] == pytest.approx([0, 0], abs=1e-6)
    ratios = [
        math.sqrt(b.size[0] * b.size[1] / (a.size[0] * a.size[1]))
        for a, b in zip(found.analysis.objects, new.analysis.objects, strict=True)
    ]
    assert 0.75 < sum(ratios) / len(ratios) < 1.3
    assert [o.box for o in new.analysis.objects] == [o.box for o in found.analysis.objects]


def test_an_added_corner_is_a_wall_more(found: Found) -> None:
    corners = list(found.analysis.floor_polygon)
    a, b = corners[1], corners[2]
    notch = ImagePoint(x=(a.x + b.x) / 2 - 60, y=(a.y + b.y) / 2)
    new = correct_found(found, Corrections(floor_polygon=[*corners[:2], notch, *corners[2:]]))
    assert len(new.calibration.floor) == 5 and new.analysis.wall_top_polygon is None
    assert new.calibration.camera.kind == "perspective"


BOXES = st.tuples(*[st.floats(-100, 1100)] * 4).map(lambda v: ImageBox(x_min=v[0], y_min=v[1], x_max=v[2], y_max=v[3]))
IDS = st.sampled_from(["bed", "chair", "lamp", "art", "ghost", "wall_n", ""])


@FIXTURES
@given(
    objects=st.lists(
        st.builds(
            ObjectCorrection,
            id=IDS,
            include=st.none() | st.booleans(),
            note=st.text(max_size=400),
            box=st.none() | BOXES,
            category=st.text(max_size=80),
        ),
        max_size=5,
    ),
    added=st.lists(
        st.builds(AddedObject, id=st.text(max_size=60), category=st.text(max_size=80), box=BOXES), max_size=4
    ),
)
def test_any_corrections_of_objects_can_be_applied_and_their_form_is_stable(
    found: Found, objects: list[ObjectCorrection], added: list[AddedObject]
) -> None:
    once = normal(Corrections(objects=objects, added=added), found)
    assert normal(once, found) == once
    new = correct_found(found, once)
    ids = [o.id for o in new.analysis.objects]
    assert len(set(ids)) == len(ids) and "wall_n" not in ids
    gone = {c.id for c in once.objects if c.include is False}
    assert not gone & set(ids)
    carriers = {*ids, None, "wall_n", "wall_e", "wall_s", "wall_w"}
    assert all(o.parent in carriers for o in new.analysis.objects)
    assert all(math.isfinite(v) for o in new.analysis.objects for v in (*o.centre, *o.size))


@FIXTURES
@given(order=st.permutations(range(7)), names=st.permutations(["bed", "stand", "chair", "closet", "lamp", "rug", "x"]))
def test_ids_last_whatever_a_second_analysis_calls_things(
    analysis: SceneAnalysis, order: list[int], names: list[str]
) -> None:
    renamed = dict(zip((o.id for o in analysis.objects), names, strict=True))
    shuffled = [
        analysis.objects[i].model_copy(
            update={
                "id": renamed[analysis.objects[i].id],
                "parent": renamed.get(analysis.objects[i].parent or "", analysis.objects[i].parent),
            }
        )
        for i in order
    ]
    kept = keep_ids(analysis, analysis.model_copy(update={"objects": shuffled}))
    assert {o.id: o for o in kept.objects} == {o.id: o for o in analysis.objects}
