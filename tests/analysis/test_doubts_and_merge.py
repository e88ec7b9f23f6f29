"""What contradicts itself is asked about in plain words; the answers are taken over; one thing seen twice is one thing."""

from __future__ import annotations

from typing import Any

import pytest
from code_as_room.pipeline.analysis.doubts import MOST, asked, doubts
from code_as_room.pipeline.analysis.look import dense_surfaces
from code_as_room.pipeline.analysis.merge import merge_second_look
from code_as_room.pipeline.artifacts.analysis import Calibration, DetectedObject, SceneAnalysis
from code_as_room.pipeline.artifacts.common import ImageBox
from code_as_room.pipeline.artifacts.replies import SecondLookReply


def changed(analysis: SceneAnalysis, identifier: str, **update: Any) -> SceneAnalysis:
    objects = [o.model_copy(update=update) if o.id == identifier else o for o in analysis.objects]
    return analysis.model_copy(update={"objects": objects})


def test_a_room_that_agrees_with_itself_asks_nothing(analysis: SceneAnalysis, calibration: Calibration) -> None:
    assert doubts(analysis, analysis, calibration) == []


def test_another_width_and_another_place_are_asked_about(analysis: SceneAnalysis, calibration: Calibration) -> None:
    wrong = changed(analysis, "bed", size=(1.0, 2.1, 0.9))
    wrong = changed(wrong, "closet", centre=(1.2, -0.6, 1.0))
    found = doubts(wrong, wrong, calibration)
    assert {d.about for d in found} == {"bed", "closet"}
    text = asked(found)
    assert "by its box it is 1.7" in text and "by its metres 1.00 m" in text
    assert "further right than its metres" in text


def test_questions_speak_in_the_metres_of_the_model(analysis: SceneAnalysis, calibration: Calibration) -> None:
    wrong = changed(analysis, "bed", size=(1.0, 2.1, 0.9))
    stated = wrong.model_copy(update={"room_size": tuple(2 * v for v in wrong.room_size)})
    assert "by its metres 2.00 m" in asked(doubts(stated, wrong, calibration))


def test_questions_are_few(analysis: SceneAnalysis, calibration: Calibration) -> None:
    bed = analysis.objects[0]
    many = [bed.model_copy(update={"id": f"bed_{n}", "size": (0.8, 1.0, 0.9)}) for n in range(40)]
    assert len(doubts(analysis, analysis.model_copy(update={"objects": many}), calibration)) == MOST


def merged(analysis: SceneAnalysis, crops: list[ImageBox | None] | None = None, **reply: Any) -> SceneAnalysis:
    return merge_second_look(analysis, SecondLookReply.model_validate(reply), crops or [None])


def test_an_answer_gives_new_metres(analysis: SceneAnalysis) -> None:
    fix = {"id": "bed", "centre_m": {"x_m": 0.3, "y_m": 0.8}, "size_m": {"width": 1.6, "depth": 2.0, "height": 0.5}}
    bed = merged(analysis, corrections=[fix]).objects[0]
    assert bed.centre == pytest.approx((0.3, 0.8, 0.25)) and bed.size == (1.6, 2.0, 0.5)
    # A lamp stays on its nightstand when only its size changes.
    lamp = merged(
        analysis, corrections=[{"id": "lamp", "size_m": {"width": 0.3, "depth": 0.3, "height": 0.6}}]
    ).objects[4]
    assert lamp.centre == pytest.approx((-1.0, 1.7, 0.8))


@pytest.mark.parametrize("size", [{"width": 0, "depth": 1, "height": 1}, {"width": 1e9, "depth": 1, "height": 1}])
def test_impossible_metres_are_not_taken(analysis: SceneAnalysis, size: dict[str, float]) -> None:
    fix = {"id": "bed", "centre_m": {"x_m": 1e9, "y_m": 0.8}, "size_m": size}
    bed = merged(analysis, corrections=[fix]).objects[0]
    assert bed.size == analysis.objects[0].size and bed.centre[:2] == analysis.objects[0].centre[:2]


def missed(identifier: str, category: str, box: tuple[float, float, float, float], picture: int) -> dict[str, Any]:
    return {
        "id": identifier, "category": category, "picture": picture, "placement": "surface",
        "box": dict(zip(("x_min", "y_min", "x_max", "y_max"), box, strict=True)),
        "centre_m": {"x_m": 0, "y_m": 0}, "size_m": {"width": 0.1, "depth": 0.1, "height": 0.1},
    }  # fmt: skip


def test_one_cup_seen_in_two_enlarged_parts_is_one_cup(analysis: SceneAnalysis) -> None:
    bare = analysis.model_copy(update={"objects": []})
    crops = [
        None,
        ImageBox(x_min=0, y_min=0, x_max=600, y_max=600),
        ImageBox(x_min=400, y_min=0, x_max=1000, y_max=600),
    ]
    # 510-522 in the whole picture, read twice with some units of error; and its neighbour.
    twice = [
        missed("cup_a", "cup", (850, 500, 870, 520), 2),
        missed("cup_b", "coffee cup", (186, 505, 207, 526), 3),
        missed("cup_c", "cup", (226, 500, 246, 520), 3),
    ]
    assert [o.id for o in merged(bare, crops, missed=twice).objects] == ["cup_a", "cup_c"]


def test_a_rug_cut_by_an_enlarged_part_is_the_rug(analysis: SceneAnalysis) -> None:
    rug = next(o for o in analysis.objects if o.id == "rug")
    assert rug.box is not None
    half = ImageBox(x_min=0, y_min=0, x_max=rug.box.centre[0], y_max=1000)
    piece = missed("rug_2", "rug", (rug.box.x_min * 1000 / half.x_max, rug.box.y_min, 1000, rug.box.y_max), 2)
    assert len(merged(analysis, [None, half], missed=[piece]).objects) == len(analysis.objects)


def test_what_lies_on_a_thing_of_another_name_stays(analysis: SceneAnalysis) -> None:
    bed = analysis.objects[0]
    assert bed.box is not None
    cover = missed("cover", "bedspread", tuple(bed.box.model_dump().values()), 1) | {"parent": "bed"}
    couch = missed("couch", "daybed", tuple(bed.box.model_dump().values()), 1) | {"placement": "floor"}
    ids = [o.id for o in merged(analysis, missed=[cover, couch]).objects]
    assert "cover" in ids and "couch" not in ids


def test_laden_and_large_tops_are_enlarged() -> None:
    def thing(name: str, box: tuple[float, ...], height: float, **more: Any) -> DetectedObject:
        shown = ImageBox(x_min=box[0], y_min=box[1], x_max=box[2], y_max=box[3])
        return DetectedObject(
            id=name, category="thing", box=shown, centre=(0, 0, height / 2), size=(1, 1, height), **more
        )

    room = [
        thing("shelf", (100, 100, 200, 140), 1.2),
        thing("desk", (300, 100, 450, 180), 0.75),
        thing("wardrobe", (500, 100, 700, 180), 2.2),
        thing("rug", (300, 300, 500, 500), 0.01),
        thing("bed", (0, 400, 600, 1000), 0.6),
        *[thing(f"book_{n}", (110, 110, 120, 120), 0.05, placement="surface", parent="shelf") for n in range(3)],
    ]
    quarter = ImageBox(x_min=0, y_min=0, x_max=560, y_max=560)
    names = [name for name, _ in dense_surfaces(room, quarter)]
    assert names == ["shelf", "desk"]
