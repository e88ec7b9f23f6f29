# SPDX-License-Identifier: GPL-3.0-or-later
"""Single cases of the benchmark's figures: what they must say, and what must not disturb them."""

from __future__ import annotations

import json
import math
import random
from pathlib import Path
from typing import Any

import pytest
from code_as_room.pipeline.artifacts.replies import AnalysisReply
from code_as_room.pipeline.geometry.polygon import footprint_iou, intersection_area, rectangle_corners

from benchmark.metrics import (
    Room,
    compare,
    load_truth,
    overlap,
    recall,
    relations,
    room_from_reply,
    room_of,
    score,
    support,
)
from benchmark.metrics.areas import union_area, union_iou
from benchmark.metrics.categories import TABLE, kind_of, similarity

Document = dict[str, Any]


def room(*objects: Document, **more: Any) -> Document:
    floor = [[-2, -1.5], [2, -1.5], [2, 1.5], [-2, 1.5]]
    return {"room": {"floor": floor, "size": [4, 3, 2.6]}, "objects": list(objects), **more}


def item(
    name: str, category: str, at: tuple[float, float], size: tuple[float, ...], yaw: float = 0, **more: Any
) -> Document:
    base = more.pop("base", 0.0)
    placed = {"placement": "floor", "parent": None, **more}
    return {
        "id": name,
        "category": category,
        "centre": [*at, base + size[2] / 2],
        "size": list(size),
        "yaw": yaw,
        **placed,
    }


def bed(**more: Any) -> Document:
    return {**item("bed", "double bed", (-1.0, 0.4), (1.6, 2.0, 0.9)), **more}


def wide_bench(**more: Any) -> Document:
    return {**item("bench", "bench", (1, -0.5), (1.2, 0.4, 0.45)), **more}


def test_empty_rooms() -> None:
    nothing, full = room_of(room()), room_of(room(bed()))
    assert score(nothing, nothing)["object_recall"] == 1 and score(nothing, nothing)["layout_iou"] == 1
    missed = score(full, nothing)
    for name in (
        "object_recall",
        "f1",
        "layout_iou",
        "footprint_iou",
        "functional_accuracy",
        "rotation_all",
        "support",
        "support_all",
    ):
        assert missed[name] == 0, name
    assert score(nothing, full)["layout_iou"] == 0 and score(nothing, full)["precision"] == 0


def test_one_thing_moved_half_its_width() -> None:
    found = score(room_of(room(bed())), room_of(room(bed(centre=[-0.2, 0.4, 0.45]))))
    assert found["object_recall"] == 1
    assert found["footprint_iou"] == pytest.approx(1 / 3)
    assert found["layout_iou"] == pytest.approx(1 / 3)


def test_a_duplicate_costs_precision_not_recall() -> None:
    found = score(room_of(room(bed())), room_of(room(bed(), bed(id="again"))))
    assert found["object_recall"] == 1 and found["precision"] == 0.5 and found["f1"] == pytest.approx(2 / 3)
    assert found["self_overlap"] == pytest.approx(0.5, abs=0.03) and found["colliding"] == 1


def test_a_mirrored_room_is_not_the_room() -> None:
    chair = item("chair", "armchair", (1.3, 0.9), (0.8, 0.8, 0.8), yaw=-60)
    sofa = item("sofa", "sofa", (0.6, -1.0), (1.8, 0.8, 0.8), yaw=180)
    truth = room(bed(), chair, sofa)
    mirrored = json.loads(json.dumps(truth))
    for thing in mirrored["objects"]:
        thing["centre"][0] *= -1
        thing["yaw"] *= -1
    found = score(room_of(truth), room_of(mirrored))
    for name in ("layout_iou", "footprint_iou", "relations_all", "object_recall"):
        assert (found[name] or 0) < 0.8, name


@pytest.mark.parametrize(
    ("thing", "turn", "size", "right"),
    [
        (bed(), 180, None, False),
        (bed(), 14, None, True),
        (bed(), 16, None, False),
        (wide_bench(), 180, None, True),
        (wide_bench(), 90, None, False),
        (wide_bench(), 90, [0.4, 1.2, 0.45], True),
        (wide_bench(size=[1.2, 1.15, 0.45]), 90, None, True),
        (item("plant", "potted plant", (1, 1), (0.5, 0.5, 1.0)), 77, None, True),
        (bed(symmetry=4), 90, None, True),
        (item("art", "picture", (1.5, 1.48), (0.9, 0.03, 0.6), base=1.3, placement="wall"), 180, None, False),
    ],
)
def test_rotation_knows_symmetry(thing: Document, turn: float, size: list[float] | None, right: bool) -> None:
    found = {**thing, "yaw": thing["yaw"] + turn, "size": size or thing["size"]}
    assert score(room_of(room(thing)), room_of(room(found)))["rotation"] == float(right)


@pytest.mark.parametrize(
    ("a", "b", "value"),
    [
        ("sofa", "couch", 1.0),
        ("night_stand", "bedside table", 1.0),
        ("Books", "stack of books", 1.0),
        ("wardrobe with clothes", "closet", 1.0),
        ("bed", "bunk bed", 0.95),
        ("chair", "armchair", 0.95),
        ("decor", "alarm clock", 0.95),
        ("sofa", "armchair", 0.5),
        ("nightstand", "cabinet", 0.5),
        ("table lamp", "coffee table", 0.0),
        ("table lamp", "side table", 0.0),
        ("bed", "plant", 0.0),
        ("terrarium", "glass terrarium", 0.95),
        ("rowing machine", "rowing boat", 0.5),
        ("aquarium", "harp", 0.0),
        ("vase of flowers", "vase", 1.0),
    ],
)
def test_names(a: str, b: str, value: float) -> None:
    assert similarity(a, b) == similarity(b, a) == value


def test_the_table_of_names_has_no_name_twice_and_general_words_exist() -> None:
    rows = [[f.strip() for f in row.split("|")] for row in TABLE.read_text().splitlines() if not row.startswith("#")]
    names = [name.strip() for row in rows for name in [row[0], *row[3].split(",")] if name.strip()]
    assert sorted(names) == sorted(set(names))
    general = {word.strip() for row in rows for word in row[1].split(",") if word.strip()}
    assert general <= {row[0] for row in rows}
    assert all(kind_of(name) is not None for name in names)


def test_other_names_in_the_right_place_do_the_work_but_are_not_recalled() -> None:
    truth = room_of(room(item("seat", "armchair", (0, 0), (0.9, 0.9, 0.8))))
    found = score(truth, room_of(room(item("seat", "sofa", (0, 0), (0.9, 0.9, 0.8)))))
    assert found["object_recall"] == 0 and found["recall_lenient"] == 1
    assert found["functional_accuracy"] == 1 and found["footprint_iou"] == 1
    foreign = score(truth, room_of(room(item("seat", "fridge", (0, 0), (0.9, 0.9, 0.8)))))
    assert foreign["recall_lenient"] == 0 and foreign["functional_accuracy"] == 0


def test_the_right_thing_too_far_away_is_not_found() -> None:
    truth = room_of(room(item("seat", "armchair", (-1.5, 0), (0.8, 0.8, 0.8))))
    found = score(truth, room_of(room(item("seat", "armchair", (1.5, 0), (0.8, 0.8, 0.8)))))
    assert found["object_recall"] == 0 and found["recall_category_only"] == 1


def test_zones_need_their_main_thing_and_half_their_members() -> None:
    zone = {"zones": [{"anchor": "desk", "objects": ["desk", "chair", "lamp", "cup"]}]}
    desk = item("desk", "desk", (0, 1), (1.4, 0.7, 0.75))
    chair = item("chair", "office chair", (0, 0.4), (0.6, 0.6, 1.0))
    lamp = item("lamp", "desk lamp", (0.4, 1.1), (0.2, 0.2, 0.4), base=0.75, placement="surface", parent="desk")
    cup = item("cup", "cup", (0.1, 1.1), (0.1, 0.1, 0.1), base=0.75, placement="surface", parent="desk")
    truth = room_of(room(desk, chair, lamp, cup, **zone))
    assert score(truth, room_of(room(desk, chair)))["functional_accuracy"] == 1
    assert score(truth, room_of(room(desk)))["functional_accuracy"] == 0
    assert score(truth, room_of(room(chair, lamp, cup)))["functional_accuracy"] == 0


def test_overlap_forgives_what_belongs_inside() -> None:
    table = item("table", "dining table", (0, 0), (1.6, 0.9, 0.75))
    tucked = item("stool", "stool", (0, 0.2), (0.4, 0.4, 0.5))
    rug = item("rug", "rug", (0, 0), (2, 1.5, 0.01))
    book = item("book", "book", (-1.5, 0), (0.2, 0.3, 0.05), base=0.5, placement="surface", parent="shelf")
    shelf = item("shelf", "bookcase", (-1.5, 0), (0.9, 0.4, 1.9))
    assert overlap.self_overlap(room_of(room(table, tucked, rug, book, shelf))) == 0
    orphan = room_of(room({**book, "parent": None}, shelf))
    assert overlap.collisions(orphan)[0][:2] in {("book", "shelf"), ("shelf", "book")}
    corner = item("sofa", "corner sofa", (0, 0), (2.4, 2.0, 0.8), shape="l_shape")
    pouf = item("pouf", "pouf", (0.6, -0.5), (0.6, 0.6, 0.4))
    assert overlap.self_overlap(room_of(room(corner, pouf))) == 0
    assert overlap.self_overlap(room_of(room({**corner, "shape": "box"}, pouf))) > 0


def test_support_asks_for_the_parent_and_for_contact() -> None:
    desk = item("desk", "desk", (0, 1), (1.4, 0.7, 0.75))
    lamp = item("lamp", "desk lamp", (0.4, 1.1), (0.2, 0.2, 0.4), base=0.75, placement="surface", parent="desk")
    art = item("art", "picture", (0.5, 1.48), (0.8, 0.03, 0.6), base=1.4, placement="wall")
    truth = room_of(room(desk, lamp, art))

    def value(*things: Document) -> float:
        return support.all_asked(compare(truth, room_of(room(*things))))

    assert value(desk, lamp, art) == 1
    floating = {**lamp, "centre": [0.4, 1.1, 1.2]}
    off_wall = {**art, "centre": [0.5, 1.3, 1.7]}
    tray = item("tray", "harp", (0.4, 1.1), (0.3, 0.3, 0.02), base=0.75, placement="surface", parent="desk")
    on_tray = {**lamp, "parent": "tray", "centre": [0.4, 1.1, 0.97]}
    assert value(desk, floating, art) == pytest.approx(2 / 3)
    assert value(desk, lamp, off_wall) == pytest.approx(2 / 3)
    assert value(desk, {**lamp, "placement": "floor", "parent": None}, art) == pytest.approx(2 / 3)
    assert value(lamp, art) == pytest.approx(1 / 3), "a lamp on a desk that is not there hangs in the air"
    assert value(desk, tray, on_tray, art) == 1, "what the truth does not list may lie between"


def test_relations_are_read_off_the_truth_and_checked_in_the_result() -> None:
    stand = item("stand", "nightstand", (0.1, 1.2), (0.45, 0.45, 0.5))
    chair = item("chair", "armchair", (1.2, -1.0), (0.8, 0.8, 0.8), yaw=-145)  # its back to the corner
    desk = item("desk", "desk", (-0.4, -1.1), (1.0, 0.6, 0.75), yaw=180)
    facing_desk = {**chair, "yaw": -90}
    truth = room_of(room(bed(), stand, facing_desk, desk))
    said = {tuple(r) for r in relations.true_relations(compare(truth, truth))}
    assert {
        ("near", "bed", "stand"),
        ("left_of", "bed", "stand"),
        ("facing", "chair", "desk"),
        ("left_of", "desk", "chair"),
    } <= said
    assert ("against_wall", "stand", "2") in said and ("against_wall", "desk", "0") in said
    away = compare(truth, room_of(room(bed(), stand, {**chair, "yaw": 90}, desk)))
    assert [tuple(r) for r in relations.broken(away)] == [("facing", "chair", "desk")]
    assert relations.consistency(away) == relations.all_asked(away) < 1
    fewer = compare(truth, room_of(room(bed(), stand, facing_desk)))
    assert relations.consistency(fewer) == 1 and relations.all_asked(fewer) < 1


def test_what_the_picture_does_not_show_is_not_asked_for_and_not_held_against_the_result(tmp_path: Path) -> None:
    hidden = {
        **item("box", "box", (1, 1), (0.4, 0.4, 0.3)),
        "image": {"persp": {"visible": 0.1}, "plan": {"visible": 1.0}},
    }
    mirror = item("mirror", "mirror", (0.5, 1.48), (0.8, 0.03, 1.0), base=1.0, placement="wall")
    cameras = {"cameras": {"persp": {"type": "PERSP"}, "plan": {"type": "ORTHO"}}}
    path = tmp_path / "truth.json"
    path.write_text(json.dumps(room(bed(), hidden, mirror, **cameras)))
    assert [t.id for t in load_truth(path, "persp").things if t.shown] == ["bed", "mirror"]
    assert [t.id for t in load_truth(path, "plan").things if t.shown] == ["bed", "box"]
    result = room_of(room(bed(), hidden, mirror))
    for style in ("persp", "plan"):
        found = score(load_truth(path, style), result)
        assert found["object_recall"] == found["precision"] == found["layout_iou"] == 1, style


def test_round_things_are_compared_as_circles_where_both_sides_know() -> None:
    table = item("table", "round table", (0, 0), (1, 1, 0.75), shape="round")
    square = {**table, "yaw": 45}
    assert score(room_of(room(table)), room_of(room(square)))["footprint_iou"] == pytest.approx(1, abs=1e-9)
    unstated = {key: value for key, value in square.items() if key != "shape"}
    assert (score(room_of(room(table)), room_of(room(unstated)))["footprint_iou"] or 0) < 0.9


def test_hand_annotated_boxes_need_no_metres(tmp_path: Path) -> None:
    data = {
        "room_size_m_estimate": [8.0, 4.0, 2.7],
        "floor_aspect": 2.0,
        "floor_polygon": [[0.1, 0.2], [0.9, 0.2], [0.9, 0.8], [0.1, 0.8]],
        "architecture": [{"id": "p", "type": "partition", "footprint": [0.49, 0.2, 0.51, 0.5]}],
        "objects": [
            {"id": "bed", "category": "bed", "facing": "S", "placement": "floor", "parent": None, "salience": "major",
             "room_uv": [0.25, 0.0, 0.5, 0.5]},
            {"id": "seat", "category": "armchair", "facing": 135, "placement": "floor", "parent": "wall_w", "salience": "major",
             "room_uv": [0.7, 0.6, 0.8, 0.8]},
        ],
    }  # fmt: skip
    path = tmp_path / "example.truth.json"
    path.write_text(json.dumps(data))
    truth = load_truth(path)
    assert truth.by_id["bed"].centre == pytest.approx((-1.0, 1.0)) and truth.by_id["bed"].yaw == 0
    assert truth.by_id["seat"].yaw == 45
    assert truth.partitions[0][0] == pytest.approx((0.0, 2.0)) and truth.partitions[0][1] == pytest.approx((0.0, 0.0))
    found = score(truth, truth)
    assert found["footprint_iou"] == 1 and found["layout_iou_metres"] is None and found["size_error"] is None


def reply(**more: Any) -> AnalysisReply:
    box = {"x_min": 0, "y_min": 0, "x_max": 10, "y_max": 10}
    corners = [(100, 900), (900, 902), (898, 500), (500, 498), (502, 100), (100, 100)]
    seat = {
        "id": "a", "category": "sofa", "box": box, "centre_m": {"x_m": -1.0, "y_m": 1.0}, "base_m": 0.1,
        "size_m": {"width": 2, "depth": 1, "height": 0.8}, "yaw_deg": 30,
    }  # fmt: skip
    floor = [{"x": x, "y": y} for x, y in corners]
    return AnalysisReply.model_validate(
        {
            "view": "orthographic",
            "room_width_m": 6,
            "room_depth_m": 4,
            "floor_polygon": floor,
            "objects": [seat],
            **more,
        }
    )


def test_the_direct_answer_is_the_reply_and_its_floor_the_one_it_drew() -> None:
    room = room_from_reply(reply())
    assert room.things[0].centre == pytest.approx((-1.0, 1.0)) and room.things[0].base == pytest.approx(0.1)
    assert room.size == pytest.approx((6, 4))
    assert union_area([room.floor]) == pytest.approx(18, abs=0.15), "an L: three quarters of the rectangle"
    xs = sorted({round(x, 6) for x, _ in room.floor})
    assert len(xs) == 3, "the trembling sides are straight"


@pytest.mark.parametrize("corners", [[(100, 900), (900, 900), (800, 300), (200, 300)], [(0, 0)], []])
def test_a_floor_seen_in_perspective_or_not_drawn_at_all_is_the_stated_rectangle(
    corners: list[tuple[int, int]],
) -> None:
    floor = [{"x": x, "y": y} for x, y in corners]
    room = room_from_reply(reply(view="perspective", floor_polygon=floor))
    assert room.floor == [(-3, -2), (3, -2), (3, 2), (-3, 2)]


def test_areas_of_unions_are_exact() -> None:
    dice = random.Random(3)

    def some() -> list[tuple[float, float]]:
        return [
            (float(x), float(y))
            for x, y in rectangle_corners(
                (dice.uniform(-1, 1), dice.uniform(-1, 1)),
                (dice.uniform(0.1, 1.5), dice.uniform(0.1, 1.5)),
                dice.uniform(0, 360),
            )
        ]

    for _ in range(50):
        a, b = some(), some()
        assert union_iou([a], [b]) == pytest.approx(footprint_iou(a, b), abs=1e-9)
        shared = intersection_area(a, b)
        assert union_area([a, b]) == pytest.approx(union_area([a]) + union_area([b]) - shared, abs=1e-9)
        assert union_iou([a, b], [b, a, a]) == pytest.approx(1)
    square = [(0.0, 0.0), (2.0, 0.0), (2.0, 1.0), (1.0, 1.0), (1.0, 2.0), (0.0, 2.0)]
    assert union_area([square]) == pytest.approx(3) and union_area([square, square]) == pytest.approx(3)
    assert math.isclose(union_iou([square], [[(1.0, 1.0), (2.0, 1.0), (2.0, 2.0), (1.0, 2.0)]]), 0, abs_tol=1e-12)


def test_recall_by_name_counts_each_thing_once() -> None:
    two = room_of(room(item("a", "chair", (0, 0), (0.5, 0.5, 0.9)), item("b", "chair", (1, 0), (0.5, 0.5, 0.9))))
    one: Room = room_of(room(item("c", "dining chair", (-1, 1), (0.5, 0.5, 0.9))))
    assert recall.category_only(compare(two, one)) == 0.5


def test_an_l_may_have_either_hand_unless_it_was_stated() -> None:
    sofa = item("sofa", "corner sofa", (0, 0), (2.4, 2.0, 0.8), shape="l_shape")
    right = [[-1.2, 0.1], [0.12, 0.1], [0.12, -1], [1.2, -1], [1.2, 1], [-1.2, 1]]
    truth = room_of(room({**sofa, "outline": right}))
    found = score(truth, room_of(room(sofa)))
    assert found["footprint_iou"] == pytest.approx(1) and found["layout_iou"] == pytest.approx(1)
    left = [[-x, y] for x, y in right]
    assert (score(truth, room_of(room({**sofa, "outline": left})))["footprint_iou"] or 0) < 0.8
    pouf = item("pouf", "pouf", (-0.6, -0.5), (0.6, 0.6, 0.4))
    assert overlap.self_overlap(room_of(room(sofa, pouf))) == 0
    assert overlap.self_overlap(room_of(room({**sofa, "outline": left}, pouf))) > 0
