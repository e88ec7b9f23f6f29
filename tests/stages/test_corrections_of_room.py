"""The artist's corrections: what follows them at once, what becomes stale, and that nothing is asked for them."""

from __future__ import annotations

import math
from typing import Any

import pytest
from code_as_room.pipeline.artifacts.analysis import Calibration, SceneAnalysis
from code_as_room.pipeline.artifacts.common import ImageBox, ImagePoint
from code_as_room.pipeline.artifacts.corrections import (
    AddedObject,
    Corrections,
    KnownLength,
    ObjectCorrection,
)
from code_as_room.pipeline.artifacts.layout import Layout, LayoutEdit, LayoutProgram
from code_as_room.pipeline.errors import RoomError
from code_as_room.pipeline.geometry.measuring import floor_distance
from code_as_room.pipeline.memory import load_memory
from code_as_room.pipeline.program.evaluate import evaluate
from code_as_room.pipeline.program.lines import parse_layout
from code_as_room.pipeline.run import Run
from code_as_room.pipeline.run_corrections import correct, corrections_of, found_of
from code_as_room.pipeline.stages import all_stages

FOUR = all_stages()[:4]
ANALYSIS, GRAPH, LAYOUT, AUXILIARY = FOUR


def said(identifier: str, **values: Any) -> Corrections:
    return Corrections(objects=[ObjectCorrection(id=identifier, **values)])


def statuses(run: Run) -> list[str]:
    return [run.status(stage) for stage in FOUR]


def analysis_of(run: Run) -> SceneAnalysis:
    found = run.memory.latest(SceneAnalysis)
    assert found is not None
    return found


def calibration_of(run: Run) -> Calibration:
    found = run.memory.latest(Calibration)
    assert found is not None
    return found


def objects(run: Run) -> dict[str, Any]:
    return {o.id: o for o in analysis_of(run).objects}


def program(run: Run, *stages: str) -> LayoutProgram:
    found = run.memory.latest(LayoutProgram, stages or None)
    assert found is not None
    evaluate(found.text)
    return found


def ledger(run: Run) -> dict[str, tuple[str, str]]:
    return {e.id: (e.state, e.reason) for e in program(run).ledger}


def length(
    metres: float, start: tuple[float, float] = (300, 300), end: tuple[float, float] = (700, 600)
) -> KnownLength:
    a, b = (ImagePoint(x=x, y=y) for x, y in (start, end))
    return KnownLength(start=a, end=b, metres=metres)


def in_picture(known: KnownLength) -> tuple[tuple[float, float], tuple[float, float]]:
    return (known.start.x, known.start.y), (known.end.x, known.end.y)


def lengths(layout: Layout) -> list[float]:
    """Everything that is measured in metres, line by line."""
    result: list[float] = [*layout.room.size, *(v for p in layout.room.floor for v in p)]
    for wall in layout.walls:
        result += [*wall.start, *wall.end, wall.height, wall.thickness]
    for door in layout.doors:
        result += [*door.start, *door.end, door.height]
    for proxy in layout.proxies:
        result += [*proxy.centre, *proxy.size]
    for camera in layout.cameras:
        result += [camera.matrix[3], camera.matrix[7], camera.matrix[11]]
    return result


def test_a_known_length_scales_the_room_and_asks_nothing(run: Run, answers: Any, scene: Any) -> None:
    run.run_all(FOUR)
    before, asked, entries = parse_layout(scene.text), len(answers.asked), len(run.memory.entries)
    known = length(5.0)
    factor = 5.0 / floor_distance(calibration_of(run).camera, *in_picture(known))  # type: ignore[operator]
    bed = objects(run)["bed"]
    lens = calibration_of(run).camera.fov_y
    correct(run, Corrections(known_length=known))
    assert statuses(run) == ["done"] * 4 and len(answers.asked) == asked
    assert floor_distance(calibration_of(run).camera, *in_picture(known)) == pytest.approx(5.0, abs=1e-9)
    assert calibration_of(run).camera.fov_y == lens and calibration_of(run).scale_source == "known length"
    assert objects(run)["bed"].size == pytest.approx([v * factor for v in bed.size])
    after = parse_layout(scene.text)
    assert lengths(after) == pytest.approx([v * factor for v in lengths(before)], abs=3e-4)
    assert scene.text == program(run).text, "the built room is what memory says"
    assert after.walls[0].thickness == pytest.approx(0.12 * factor, abs=1e-4)
    assert run.run_all(FOUR) == [] and len(answers.asked) == asked, "nothing is left to do"
    assert load_memory(scene.memory) == run.memory
    correct(run, Corrections())
    assert scene.text == print_again(before) and len(run.memory.entries) == entries
    assert statuses(run) == ["done"] * 4


def print_again(layout: Layout) -> str:
    from code_as_room.pipeline.program.lines import print_layout

    return print_layout(layout)


def test_dragging_a_slider_leaves_one_correction_in_memory(run: Run, scene: Any) -> None:
    run.run_all(FOUR)
    before, counts = scene.text, set()
    for step in range(12):
        run.memory.settings["known_width_m"] = f"{4.0 + step / 7:.3f}"
        correct(run, corrections_of(run.memory))
        counts.add(len(run.memory.entries))
    assert len(counts) == 1
    run.memory.settings["known_width_m"] = f"{analysis_width(before):.9g}"
    correct(run, corrections_of(run.memory))
    del run.memory.settings["known_width_m"]
    correct(run, corrections_of(run.memory))
    assert scene.text == before, "no rounding is left of twelve changes"


def analysis_width(text: str) -> float:
    return parse_layout(text).room.size[0]


def test_hand_edits_and_locked_things_are_scaled_with_the_room(run: Run, scene: Any) -> None:
    run.run_all(FOUR)
    scene.edits = [
        LayoutEdit(op="move", id="chair", centre=(1.2, -1.3, 0.4), origin="artist"),
        LayoutEdit(op="resize", id="closet", size=(1.0, 0.5, 1.5), origin="artist"),
    ]
    width = analysis_of(run).room_size[0]
    run.memory.settings["known_width_m"] = f"{2 * width:.12g}"
    correct(run, corrections_of(run.memory))
    assert statuses(run) == ["done"] * 4
    edits = run.hand_edits()
    assert edits[0].centre == pytest.approx((2.4, -2.6, 0.8)) and edits[1].size == pytest.approx((2.0, 1.0, 3.0))
    chair = parse_layout(scene.text).proxy("chair")
    assert chair is not None and chair.centre == pytest.approx((2.4, -2.6, 0.8), abs=1e-4)
    closet = parse_layout(scene.text).proxy("closet")
    assert closet is not None and closet.size == pytest.approx((2.0, 1.0, 3.0), abs=1e-4)
    stood = scene.text
    for stage in (LAYOUT, AUXILIARY):
        again(run, stage)
    assert parse_layout(scene.text).proxy("chair") == chair, stood
    assert parse_layout(scene.text).proxy("closet") == closet


def again(run: Run, stage: Any, only: frozenset[str] | None = None) -> None:
    session = run.begin(stage, fresh=True, only=only)
    while not session.finished:
        session.step()


def test_another_wall_height_changes_the_walls_and_nothing_else(run: Run, answers: Any, scene: Any) -> None:
    run.run_all(FOUR)
    before, asked = parse_layout(scene.text), len(answers.asked)
    run.memory.settings["wall_height_m"] = "3.1"
    correct(run, corrections_of(run.memory))
    after = parse_layout(scene.text)
    assert {w.height for w in after.walls} == {3.1} and after.room.size[2] == 3.1
    assert after.proxies == before.proxies and after.room.floor == before.room.floor
    assert [w.start for w in after.walls] == [w.start for w in before.walls]
    assert statuses(run) == ["done"] * 4 and len(answers.asked) == asked
    assert calibration_of(run).height == 3.1
    # The camera is another one, through which the same corners are where they were.
    assert calibration_of(run).error_px < 2.0
    assert calibration_of(run).camera.fov_y != pytest.approx(before.cameras[0].fov_y, abs=1e-3)


def test_known_length_and_wall_height_together_are_both_exact(run: Run) -> None:
    run.run_all(FOUR)
    run.memory.settings["wall_height_m"] = "3.1"
    known = length(6.5)
    correct(run, Corrections(known_length=known))
    assert floor_distance(calibration_of(run).camera, *in_picture(known)) == pytest.approx(6.5, abs=1e-9)
    assert calibration_of(run).height == 3.1 and statuses(run) == ["done"] * 4


def test_a_known_length_wins_over_a_known_width_and_says_so(run: Run) -> None:
    run.run_stage(ANALYSIS)
    run.memory.settings["known_width_m"] = "9"
    findings = correct(run, Corrections(known_length=length(2.0)))
    assert any("known length is used" in f.message for f in findings)


@pytest.mark.parametrize(
    "known",
    [length(0.0), length(1e9), length(math.pi, (300, 300), (300, 300)), length(2.0, (-1e7, 9e8), (1e9, -4e8))],
)
def test_an_impossible_length_is_refused_and_changes_nothing(run: Run, scene: Any, known: KnownLength) -> None:
    run.run_all(FOUR)
    memory, text = scene.memory, scene.text
    with pytest.raises(RoomError) as caught:
        correct(run, Corrections(known_length=known))
    assert caught.value.fix and (scene.memory, scene.text) == (memory, text) and statuses(run) == ["done"] * 4


def test_moved_corners_fit_the_camera_anew_and_the_built_room_follows(run: Run, scene: Any, answers: Any) -> None:
    run.run_all(FOUR)
    scene.edits = [LayoutEdit(op="move", id="chair", centre=(1.2, -1.3, 0.4), origin="artist")]
    asked = len(answers.asked)
    run.take_over_edits()
    camera, text = calibration_of(run).camera, scene.text
    polygon = [p.model_copy() for p in analysis_of(run).floor_polygon]
    right = max(p.x for p in polygon)
    wider = [p.model_copy(update={"x": p.x + 40}) if p.x > right - 100 else p for p in polygon]
    correct(run, Corrections(floor_polygon=wider))
    width = analysis_of(run).room_size[0]
    assert width > 4.6 * 1.03 and statuses(run) == ["done", "stale", "stale", "stale"]
    assert len(answers.asked) == asked
    moved = parse_layout(scene.text)
    assert moved.room.size[0] == pytest.approx(width, abs=1e-3), "the walls stand where the corners are"
    chair, before = moved.proxy("chair"), parse_layout(text).proxy("chair")
    assert chair is not None and before is not None
    from code_as_room.pipeline.geometry.camera import project

    was = project(camera, [(*before.centre[:2], 0.0)])[0]
    now = project(calibration_of(run).camera, [(*chair.centre[:2], 0.0)])[0]
    assert math.dist(was, now) < 25, "what the artist placed stays on its place in the picture, nearly"
    assert run.hand_edits()[0].centre == pytest.approx(chair.centre, abs=1e-3)
    run.run_all(FOUR)
    assert statuses(run) == ["done"] * 4
    assert parse_layout(scene.text).proxy("chair") == chair, "locked"
    correct(run, Corrections())
    assert analysis_of(run) == found_of(run.memory).analysis  # type: ignore[union-attr]


def test_a_room_without_floor_is_refused(run: Run, scene: Any) -> None:
    run.run_all(FOUR)
    memory = scene.memory
    with pytest.raises(RoomError):
        correct(run, Corrections(floor_polygon=[ImagePoint(x=10, y=10), ImagePoint(x=500, y=500)]))
    assert scene.memory == memory


def test_what_is_left_out_is_gone_from_the_room_and_in_the_ledger(run: Run) -> None:
    run.run_all(FOUR)
    correct(run, said("stand", include=False))
    assert statuses(run) == ["done", "stale", "stale", "stale"]
    run.run_all(FOUR)
    assert parse_layout(program(run).text).proxy("stand") is None
    assert ledger(run)["stand"] == ("dropped", "left out by the artist")
    assert len(ledger(run)) == 7
    correct(run, Corrections())
    run.run_all(FOUR)
    assert ledger(run)["stand"][0] == "placed"


def test_a_corrected_box_moves_the_object_and_an_undone_correction_leaves_no_trace(run: Run) -> None:
    run.run_all(FOUR)
    chair = objects(run)["chair"]
    box = chair.box.model_copy(update={"x_min": chair.box.x_min + 250, "x_max": chair.box.x_max + 250})
    correct(run, said("chair", box=box, category="wing chair"))
    moved = objects(run)["chair"]
    assert moved.category == "wing chair" and moved.box == box and moved.confidence == 1.0
    assert moved.centre[0] - chair.centre[0] > 0.8 and moved.size == chair.size
    assert statuses(run) == ["done", "stale", "stale", "stale"]
    run.run_all(FOUR)
    placed = parse_layout(program(run).text).proxy("chair")
    assert placed is not None and placed.category == "wing chair"
    assert placed.centre[0] - chair.centre[0] > 0.8
    before = run.memory.hash_of("SceneAnalysis", ("s01_analysis",))
    correct(run, Corrections())
    assert run.memory.hash_of("SceneAnalysis") == before


def test_an_added_object_is_placed_by_its_box_and_never_taken_away(run: Run, answers: Any) -> None:
    run.run_all(FOUR)
    box = ImageBox(x_min=380, y_min=700, x_max=480, y_max=810)
    added = AddedObject(id="Big Pouf!", category="pouf", box=box)
    correct(run, Corrections(added=[added]))
    pouf = objects(run)["big_pouf"]
    assert pouf.placement == "floor" and pouf.salience == "major" and 0.05 <= pouf.size[2] <= 0.9
    edits = [{"op": "remove", "id": "big_pouf", "reason": "not there"}]
    answers.by_key["03_critique"] = {"score": 50, "edits": edits}
    run.run_all(FOUR)
    proxy = parse_layout(program(run).text).proxy("big_pouf")
    assert proxy is not None
    # It shows where it was drawn.
    from code_as_room.pipeline.geometry.footprint import image_box_of

    assert image_box_of(calibration_of(run).camera, proxy.centre, proxy.size, proxy.yaw).iou(box) > 0.8
    assert correct(run, corrections_of(run.memory)) == []
    assert statuses(run) == ["done"] * 4, "the same corrections again change nothing"


def test_what_is_drawn_on_a_table_or_on_a_wall_goes_there(run: Run) -> None:
    run.run_stage(ANALYSIS)
    bed = objects(run)["bed"].box
    x, y = bed.centre
    on_bed = ImageBox(x_min=x - 20, y_min=y - 20, x_max=x + 20, y_max=y + 20)
    floor = analysis_of(run).floor_polygon
    left = min(p.x for p in floor)
    on_wall = ImageBox(x_min=left - 30, y_min=400, x_max=left - 5, y_max=520)
    tray, shelf = (
        AddedObject(id="tray", category="tray", box=on_bed),
        AddedObject(id="shelf", category="x", box=on_wall),
    )
    correct(run, Corrections(added=[tray, shelf]))
    assert (objects(run)["tray"].placement, objects(run)["tray"].parent) == ("surface", "bed")
    assert objects(run)["shelf"].placement == "wall"
    run.run_all(FOUR)
    assert ledger(run)["tray"][0] == ledger(run)["shelf"][0] == "placed"
    proxy = parse_layout(program(run).text).proxy("shelf")
    assert proxy is not None and proxy.parent == "wall_w"


def test_corrections_wait_for_an_analysis_and_survive_another_one(run: Run, answers: Any) -> None:
    correct(run, Corrections(known_length=length(5.0)))
    run.run_stage(ANALYSIS)
    assert floor_distance(calibration_of(run).camera, (300, 300), (700, 600)) == pytest.approx(5.0, abs=1e-9)
    run.run_all(FOUR)
    correct(run, corrections_of(run.memory).having(ObjectCorrection(id="chair", include=False)))
    correct(run, corrections_of(run.memory).having(ObjectCorrection(id="bed", note="It is 1.6 m wide.")))
    for item in answers.by_key["01_analysis"]["objects"]:
        item["id"] = f"thing_{item['id']}"
        item["parent"] = f"thing_{item['parent']}" if item["parent"] == "stand" else item["parent"]
    again(run, ANALYSIS)
    assert set(objects(run)) == {"bed", "stand", "closet", "lamp", "rug", "art"}, "ids last"
    assert objects(run)["lamp"].parent == "stand"
    assert [o.id for o in analysis_of(run).left_out] == ["chair"]
    assert floor_distance(calibration_of(run).camera, (300, 300), (700, 600)) == pytest.approx(5.0, abs=1e-9)
    assert corrections_of(run.memory).of("bed").note == "It is 1.6 m wide."


def test_a_correction_that_fits_nothing_any_more_is_kept_or_reported(run: Run, answers: Any) -> None:
    run.run_all(FOUR)
    chair = objects(run)["chair"].box
    wanted = Corrections(
        objects=[
            ObjectCorrection(id="chair", box=chair, category="wing chair"),
            ObjectCorrection(id="art", note="by my aunt"),
        ]
    )
    correct(run, wanted)
    seen = answers.by_key["01_analysis"]["objects"]
    answers.by_key["01_analysis"]["objects"] = [o for o in seen if o["id"] not in ("chair", "art")]
    again(run, ANALYSIS)
    assert objects(run)["chair"].category == "wing chair", "kept as added"
    assert any(f.about == "art" and "not found again" in f.message for f in analysis_of(run).findings)


def test_the_analysis_finding_what_was_added_does_not_double_it(run: Run, answers: Any) -> None:
    seen = answers.by_key["01_analysis"]["objects"]
    closet = next(o for o in seen if o["id"] == "closet")
    answers.by_key["01_analysis"]["objects"] = [o for o in seen if o is not closet]
    run.run_stage(ANALYSIS)
    correct(run, Corrections(added=[AddedObject(id="tall_one", category="wardrobe", box=ImageBox(**closet["box"]))]))
    run.run_all(FOUR)
    answers.by_key["01_analysis"]["objects"] = seen
    again(run, ANALYSIS)
    assert "closet" not in objects(run)
    assert objects(run)["tall_one"].size[2] == pytest.approx(2.0, abs=0.05), "measured by the analysis"


def test_notes_go_with_the_questions_about_their_object_and_nothing_else_changes(run: Run, answers: Any) -> None:
    for item in answers.by_key["01_analysis"]["objects"]:
        if item["id"] == "lamp":
            item.update(parent=None, box={"x_min": 700, "y_min": 480, "x_max": 720, "y_max": 500})
    run.run_all(FOUR)
    plain = {p.key: p.text for p in answers.asked}
    answers.asked.clear()
    correct(run, Corrections(objects=[ObjectCorrection(id="bed", locked=True)]))
    assert statuses(run) == ["done"] * 4, "a lock is no reason to ask anything again"
    correct(run, said("lamp", note="  It stands\non the sill. "))
    assert statuses(run) == ["done", "stale", "stale", "stale"]
    run.run_all(FOUR)
    noted = {p.key: p.text for p in answers.asked}
    assert {"02_graph", "04_auxiliary"} <= set(noted)
    for key in ("02_graph", "04_auxiliary"):
        assert "The artist says of these:\nlamp: It stands on the sill." in noted[key]
        assert noted[key].replace("\n\nThe artist says of these:\nlamp: It stands on the sill.", "") == plain[key]
    assert "03_critique/0" not in noted, "the lamp takes no part in the layout loop: that question was answered before"
    correct(run, Corrections())
    assert statuses(run)[1:] != ["done"] * 3
    answers.asked.clear()
    run.run_all(FOUR)
    assert answers.asked == [], "without the note the questions are the old ones, and were answered"
