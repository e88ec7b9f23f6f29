"""Whatever a model answers, the analysis is usable or refused in words, and every repair is reported."""

from __future__ import annotations

import math
from typing import Any

import pytest
from code_as_room.pipeline.analysis.clean import clean_analysis, facing_yaw
from code_as_room.pipeline.analysis.merge import merge_second_look, to_whole_picture
from code_as_room.pipeline.artifacts.common import ImageBox
from code_as_room.pipeline.artifacts.replies import AnalysisReply, BoxReply, SecondLookReply
from code_as_room.pipeline.errors import PictureError, ReplyError
from hypothesis import given
from hypothesis import strategies as st

SQUARE = [{"x": 200, "y": 800}, {"x": 800, "y": 800}, {"x": 800, "y": 200}, {"x": 200, "y": 200}]


def thing(identifier: str, **changes: Any) -> dict[str, Any]:
    return {
        "id": identifier,
        "category": "chair",
        "box": {"x_min": 300, "y_min": 300, "x_max": 400, "y_max": 400},
        "centre_m": {"x_m": 0.0, "y_m": 0.0},
        "size_m": {"width": 0.5, "depth": 0.5, "height": 0.9},
        **changes,
    }


def reply(*objects: dict[str, Any], **changes: Any) -> AnalysisReply:
    data = {
        "view": "perspective",
        "room_width_m": 4,
        "room_depth_m": 4,
        "floor_polygon": SQUARE,
        "objects": list(objects),
    }
    return AnalysisReply.model_validate({**data, **changes})


def test_an_inside_out_box_is_put_in_order_and_reported() -> None:
    found = clean_analysis(
        reply(thing("a", box={"x_min": 400, "y_min": 400, "x_max": 300, "y_max": 300})), (1000, 1000)
    )
    assert found.objects[0].box == ImageBox(x_min=300, y_min=300, x_max=400, y_max=400)
    assert any("inside out" in f.message for f in found.findings)


def test_a_box_outside_the_picture_leaves_the_metres() -> None:
    found = clean_analysis(reply(thing("a", box={"x_min": 1200, "y_min": 0, "x_max": 1500, "y_max": 10})), (1000, 1000))
    assert found.objects[0].box is None
    assert any("outside the picture" in f.message for f in found.findings)


def test_parents_in_a_circle_are_cut_once() -> None:
    found = clean_analysis(reply(thing("a", parent="b"), thing("b", parent="c"), thing("c", parent="a")), (1000, 1000))
    parents = {o.id: o.parent for o in found.objects}
    for start in parents:
        steps, at = 0, start
        while at is not None and steps < 10:
            at, steps = parents.get(at), steps + 1
        assert steps < 10
    assert sum(p is None for p in parents.values()) == 1


def test_an_unknown_parent_is_cut_and_a_surface_object_finds_its_carrier() -> None:
    table = thing("table", box={"x_min": 250, "y_min": 250, "x_max": 600, "y_max": 600})
    lamp = thing("lamp", placement="surface", parent="ghost")
    found = clean_analysis(reply(table, lamp), (1000, 1000))
    assert found.objects[1].parent == "table"
    assert any("ghost" in f.message for f in found.findings)


def test_equal_ids_are_told_apart() -> None:
    found = clean_analysis(reply(thing("Chair 1"), thing("chair_1"), thing("")), (1000, 1000))
    assert [o.id for o in found.objects] == ["chair_1", "chair_1_2", "chair"]


def test_a_thousand_objects_are_limited_and_reported() -> None:
    found = clean_analysis(reply(*[thing(f"o{i}") for i in range(1000)]), (1000, 1000))
    assert len(found.objects) == 300
    assert any("1000 objects" in f.message for f in found.findings)


def test_no_floor_is_refused_in_words() -> None:
    with pytest.raises(ReplyError, match="no floor"):
        clean_analysis(reply(floor_polygon=SQUARE[:2]), (1000, 1000))


@given(
    st.lists(st.floats(-1e12, 1e12), min_size=9, max_size=9),
    st.sampled_from(["down", "left", "none", "up-right"]),
    st.sampled_from(["floor", "wall", "ceiling", "surface"]),
)
def test_wild_numbers_never_reach_the_artifact(v: list[float], facing: str, placement: str) -> None:
    wild = thing(
        "a",
        box=dict(zip(("x_min", "y_min", "x_max", "y_max"), v[:4], strict=True)),
        centre_m={"x_m": v[4], "y_m": v[5]},
        size_m={"width": v[6], "depth": v[7], "height": v[8]},
        base_m=v[0],
        yaw_deg=v[1],
        facing=facing,
        placement=placement,
    )
    [item] = clean_analysis(reply(wild, room_width_m=v[2], room_depth_m=v[3]), (1000, 1000)).objects
    assert all(math.isfinite(x) and abs(x) <= 200 for x in item.centre)
    assert all(0.001 <= s <= 100 for s in item.size)
    assert 0 <= item.yaw <= 360
    if item.box is not None:
        assert 0 <= item.box.x_min < item.box.x_max <= 1000 and 0 <= item.box.y_min < item.box.y_max <= 1000


def test_a_picture_from_eye_level_is_refused_with_the_models_reason_and_a_next_step() -> None:
    said = reply(view="other", view_problem="The room is seen from eye level.", floor_polygon=[])
    with pytest.raises(PictureError) as caught:
        clean_analysis(said, (1000, 1000))
    assert "seen from eye level" in caught.value.message
    assert "from above" in caught.value.fix


def test_by_what_the_front_was_recognised_is_kept() -> None:
    found = clean_analysis(reply(thing("bed_1", front="headboard at the top")), (1000, 1000))
    assert found.objects[0].front == "headboard at the top"


def test_the_word_wins_where_yaw_contradicts_it() -> None:
    assert facing_yaw("right", 270) == 90
    assert facing_yaw("right", 70) == 70
    assert facing_yaw("none", -90) == 270


def test_second_look_adds_what_was_missed_in_a_crop_and_drops_twins() -> None:
    first = clean_analysis(reply(thing("chair_1")), (1000, 1000))
    crop = ImageBox(x_min=0, y_min=0, x_max=500, y_max=500)
    missed = thing("cup", category="cup", picture=2, box={"x_min": 100, "y_min": 100, "x_max": 120, "y_max": 140})
    twin = thing("seat", category="wooden chair", picture=1)
    merged = merge_second_look(first, SecondLookReply.model_validate({"missed": [missed, twin]}), [None, crop])
    assert [o.id for o in merged.objects] == ["chair_1", "cup"]
    assert merged.objects[1].box == ImageBox(x_min=50, y_min=50, x_max=60, y_max=70)
    assert any("it is chair_1" in f.message for f in merged.findings)


def test_second_look_corrects_and_takes_back() -> None:
    first = clean_analysis(reply(thing("a"), thing("b")), (1000, 1000))
    box = {"x_min": 310, "y_min": 310, "x_max": 390, "y_max": 420}
    fixes = [{"id": "a", "wrong": "too low", "box": box, "facing": "left"}, {"id": "b", "remove": True}, {"id": "zz"}]
    merged = merge_second_look(first, SecondLookReply.model_validate({"corrections": fixes}), [None])
    [item] = merged.objects
    assert item.box == ImageBox(**box) and item.yaw == 270
    assert any(f.about == "zz" for f in merged.findings)


def test_a_box_of_the_whole_picture_stays() -> None:
    box = BoxReply(x_min=1, y_min=2, x_max=3, y_max=4)
    assert to_whole_picture(box, None) is box


def test_second_look_parents_are_found_by_the_names_of_the_answer() -> None:
    first = clean_analysis(reply(thing("chair_1")), (1000, 1000))
    small = {"x_min": 700, "y_min": 700, "x_max": 720, "y_max": 720}
    cup = thing("Cup 1", category="cup", parent="Tea Tray", placement="surface", box=small)
    tray = thing("Tea Tray", category="tray", box=small)
    twin = thing("seat", category="wooden chair")
    pillow = thing("pillow", category="pillow", parent="seat", placement="surface", box=small)
    answer = SecondLookReply.model_validate({"missed": [cup, tray, twin, pillow]})
    merged = merge_second_look(first, answer, [None])
    parents = {o.id: o.parent for o in merged.objects}
    assert parents == {"chair_1": None, "cup_1": "tea_tray", "tea_tray": None, "pillow": "chair_1"}


def test_a_correction_may_be_read_off_an_enlarged_part_and_change_yaw_underside_and_placement() -> None:
    first = clean_analysis(reply(thing("a"), thing("b")), (1000, 1000))
    crop = ImageBox(x_min=500, y_min=0, x_max=1000, y_max=500)
    box = {"x_min": 100, "y_min": 200, "x_max": 300, "y_max": 400}
    fixes = [
        {"id": "a", "picture": 2, "box": box, "yaw_deg": 20, "facing": "right", "base_m": 0.7, "placement": "surface"},
        {"id": "b", "picture": 9, "box": box, "parent": "a"},
    ]
    merged = merge_second_look(first, SecondLookReply.model_validate({"corrections": fixes}), [None, crop])
    a, b = merged.objects
    assert a.box == ImageBox(x_min=550, y_min=100, x_max=650, y_max=200)
    assert (a.yaw, a.placement) == (20, "surface")
    assert a.centre[2] - a.size[2] / 2 == pytest.approx(0.7) and a.size == first.objects[0].size
    assert b.box == first.objects[1].box and b.parent == "a"
    assert any(f.about == "b" and "picture 9" in f.message for f in merged.findings)
