"""What is locked stays exactly where it is, and what is not chosen stays when only a part is done anew."""

from __future__ import annotations

import math
from typing import Any

import pytest
from code_as_room.pipeline.artifacts.analysis import SceneAnalysis
from code_as_room.pipeline.artifacts.corrections import Corrections, ObjectCorrection
from code_as_room.pipeline.artifacts.layout import LayoutEdit, LayoutProgram, ProxyLine
from code_as_room.pipeline.errors import RoomError
from code_as_room.pipeline.program.evaluate import evaluate
from code_as_room.pipeline.program.lines import parse_layout
from code_as_room.pipeline.run import Run
from code_as_room.pipeline.run_corrections import correct, corrections_of
from code_as_room.pipeline.stages import all_stages

FOUR = all_stages()[:4]
ANALYSIS, GRAPH, LAYOUT, AUXILIARY = FOUR


def proxies(run: Run, *stages: str) -> dict[str, ProxyLine]:
    found = run.memory.latest(LayoutProgram, stages or None)
    assert found is not None
    evaluate(found.text)
    return {p.id: p for p in parse_layout(found.text).proxies}


def again(run: Run, *stages: Any, only: set[str] | None = None) -> None:
    for stage in stages:
        session = run.begin(stage, fresh=True, only=None if only is None else frozenset(only))
        while not session.finished:
            session.step()


def lock(run: Run, identifier: str, on: bool | None = True) -> None:
    correct(run, corrections_of(run.memory).having(ObjectCorrection(id=identifier, locked=on)))


def pushed(answers: Any, identifier: str, by: float) -> None:
    """From now on the picture shows an object elsewhere, and the critic wants it there."""
    item = next(o for o in answers.by_key["01_analysis"]["objects"] if o["id"] == identifier)
    item["box"] = {k: v + (by if k.startswith("x") else 0) for k, v in item["box"].items()}
    item["centre_m"]["x_m"] += by / 120
    edit = {"op": "move", "id": identifier, "box": item["box"]}
    answers.by_key["03_critique"] = {"score": 20, "edits": [edit]}


@pytest.mark.parametrize("identifier", ["chair", "rug", "lamp", "art", "bed"])
def test_a_locked_object_stays_whatever_is_seen_or_asked(run: Run, answers: Any, scene: Any, identifier: str) -> None:
    run.run_all(FOUR)
    before = proxies(run)[identifier]
    lock(run, identifier)
    pushed(answers, identifier, 60.0)
    again(run, ANALYSIS)
    run.run_all(FOUR)
    assert proxies(run)[identifier] == before
    assert parse_layout(scene.text).proxy(identifier) == before
    program = run.memory.latest(LayoutProgram, (LAYOUT.id,))
    assert program is not None
    assert all(e.id != identifier for i in program.iterations for e in i.edits)
    lock(run, identifier, None)
    again(run, LAYOUT, AUXILIARY)
    assert proxies(run)[identifier] != before, "unlocked, it goes where it is seen"


def test_a_locked_object_that_another_analysis_misses_stays(run: Run, answers: Any) -> None:
    run.run_all(FOUR)
    lock(run, "chair")
    lock(run, "art")
    before = proxies(run)
    seen = answers.by_key["01_analysis"]["objects"]
    answers.by_key["01_analysis"]["objects"] = [o for o in seen if o["id"] not in ("chair", "art")]
    again(run, ANALYSIS)
    run.run_all(FOUR)
    assert proxies(run)["chair"] == before["chair"] and proxies(run)["art"] == before["art"]


def test_a_moved_object_keeps_its_size_too(run: Run, answers: Any, scene: Any) -> None:
    run.run_all(FOUR)
    size = proxies(run)["chair"].size
    scene.edits = [LayoutEdit(op="move", id="chair", centre=(1.2, -1.3, size[2] / 2), origin="artist")]
    run.take_over_edits()
    item = next(o for o in answers.by_key["01_analysis"]["objects"] if o["id"] == "chair")
    item["size_m"] = {"width": 1.2, "depth": 1.1, "height": 0.7}
    again(run, ANALYSIS)
    run.run_all(FOUR)
    assert proxies(run)["chair"].size == size


def test_an_unlocked_edit_is_free_for_critic_and_solver(run: Run, answers: Any, scene: Any) -> None:
    run.run_all(FOUR)
    item = next(o for o in answers.by_key["01_analysis"]["objects"] if o["id"] == "chair")
    scene.edits = [
        LayoutEdit(op="move", id="chair", centre=(1.2, -1.3, 0.4), origin="artist"),
        LayoutEdit(op="move", id="stand", centre=(-3.0, 0.5, 0.25), origin="artist"),
    ]
    shifted = {k: v + (6 if k.startswith("x") else 0) for k, v in item["box"].items()}
    answers.by_key["03_critique"] = lambda p: {
        "score": 20,
        "edits": [{"op": "move", "id": "chair", "box": shifted}] if p.key.endswith("/0") else [],
    }
    again(run, LAYOUT, AUXILIARY)
    assert proxies(run)["chair"].centre == (1.2, -1.3, 0.4)
    assert proxies(run)["stand"].centre[0] == -3.0, "outside the room, as the artist wanted it"
    lock(run, "chair", False)
    lock(run, "stand", False)
    again(run, LAYOUT, AUXILIARY)
    assert math.dist(proxies(run)["chair"].centre[:2], (item["centre_m"]["x_m"], item["centre_m"]["y_m"])) < 0.2
    assert proxies(run)["stand"].centre[0] > -2.3, "the solver may bring it into the room"


def test_locks_follow_names(run: Run, scene: Any) -> None:
    run.run_all(FOUR)
    scene.edits = [LayoutEdit(op="rename", id="chair", new_id="seat", origin="artist")]
    run.take_over_edits()
    lock(run, "chair", False)
    assert not {"chair", "seat"} & run.view(LAYOUT).locked
    correct(run, Corrections())
    assert "seat" in run.view(LAYOUT).locked
    lock(run, "seat", False)
    assert not {"chair", "seat"} & run.view(LAYOUT).locked


def test_only_the_chosen_objects_of_the_layout_are_done_anew(run: Run, answers: Any) -> None:
    run.run_all(FOUR)
    before = proxies(run, LAYOUT.id)
    for item in answers.by_key["01_analysis"]["objects"]:
        if item["id"] in ("chair", "closet"):
            item["box"] = {k: v + (15 if k.startswith("y") else 0) for k, v in item["box"].items()}
            item["centre_m"]["y_m"] -= 0.08
    again(run, ANALYSIS, GRAPH)
    answers.asked.clear()
    other = {"op": "turn", "id": "bed", "facing": "up", "yaw_deg": 180}
    new = {"op": "add", "id": "x", "category": "sofa", "box": {"x_min": 1, "y_min": 1, "x_max": 90, "y_max": 90}}
    answers.by_key["03_critique"] = {"score": 60, "edits": [other, new]}
    again(run, LAYOUT, only={"chair"})
    after = proxies(run, LAYOUT.id)
    assert after["chair"].centre[1] < before["chair"].centre[1] - 0.02
    assert {i: p for i, p in after.items() if i != "chair"} == {i: p for i, p in before.items() if i != "chair"}
    prompt = answers.asked[0].text
    listed = prompt.partition("counter-clockwise")[2].partition("Measured problems")[0]
    assert "chair, armchair" in listed and "bed, double bed" not in listed and "Only these are judged" in listed
    program = run.memory.latest(LayoutProgram, (LAYOUT.id,))
    assert program is not None
    assert [f.about for f in program.iterations[0].refused] == ["bed", "x"] and not program.iterations[0].edits


def test_only_the_chosen_small_things_are_placed_anew(run: Run, answers: Any) -> None:
    run.run_all(FOUR)
    before = proxies(run)
    for item in answers.by_key["01_analysis"]["objects"]:
        if item["id"] in ("rug", "art", "lamp"):
            item["box"] = {k: v + (20 if k.startswith("x") else 0) for k, v in item["box"].items()}
            item["centre_m"]["x_m"] += 0.11
    again(run, ANALYSIS)
    again(run, LAYOUT, AUXILIARY, only={"rug"})
    after = proxies(run)
    assert after["rug"].centre[0] > before["rug"].centre[0] + 0.05
    assert {i: p for i, p in after.items() if i != "rug"} == {i: p for i, p in before.items() if i != "rug"}


def test_what_stands_on_a_chosen_thing_follows_it(run: Run, answers: Any) -> None:
    run.run_all(FOUR)
    before = proxies(run)
    for item in answers.by_key["01_analysis"]["objects"]:
        if item["id"] == "stand":
            item["box"] = {k: v + (60 if k.startswith("y") else 0) for k, v in item["box"].items()}
            item["centre_m"]["y_m"] -= 0.35
    again(run, ANALYSIS, GRAPH)
    again(run, LAYOUT, AUXILIARY, only={"stand"})
    after = proxies(run)
    assert after["stand"].centre[1] < before["stand"].centre[1] - 0.1
    reach = after["stand"].size[1] / 2
    assert abs(after["lamp"].centre[1] - after["stand"].centre[1]) < reach, "the lamp is still on its table"
    assert after["rug"] == before["rug"] and after["bed"] == before["bed"]


def test_a_part_cannot_be_redone_of_what_is_not_there(run: Run) -> None:
    with pytest.raises(RoomError, match="nothing yet"):
        again(run, ANALYSIS, only={"bed"})
    run.run_stage(ANALYSIS)
    run.run_stage(GRAPH)
    with pytest.raises(RoomError, match="no layout yet"):
        again(run, LAYOUT, only={"bed"})
    with pytest.raises(RoomError, match="Nothing that is selected"):
        again(run, ANALYSIS, only={"ghost"})


def test_the_analysis_looks_again_at_chosen_objects_only(run: Run, answers: Any) -> None:
    run.run_all(FOUR)
    before = {o.id: o for o in run.memory.latest(SceneAnalysis).objects}  # type: ignore[union-attr]
    box = before["chair"].box
    other = {"id": "bed", "category": "sofa", "box": box.model_dump(), "centre_m": {"x_m": 0, "y_m": 0},
             "size_m": {"width": 1, "depth": 1, "height": 1}, "picture": 1}  # fmt: skip
    chair = {**other, "id": "chair", "category": "rocking chair", "centre_m": {"x_m": -1.5, "y_m": -1.1}, "picture": 2,
             "box": {"x_min": 250, "y_min": 250, "x_max": 750, "y_max": 750}}  # fmt: skip
    answers.by_key["01_again"] = {"missed": [chair, other], "corrections": [{"id": "bed", "remove": True}]}
    answers.asked.clear()
    again(run, ANALYSIS, only={"chair"})
    assert [p.key for p in answers.asked] == ["01_again"] and len(answers.asked[0].images) == 2
    after = {o.id: o for o in run.memory.latest(SceneAnalysis).objects}  # type: ignore[union-attr]
    assert after["chair"].category == "rocking chair" and after["chair"].centre[:2] == pytest.approx((-1.5, -1.1))
    # The box was given in the enlarged part, whose middle is the middle of the old box.
    assert after["chair"].box.centre == pytest.approx(box.centre, abs=0.5)
    assert {i: o for i, o in after.items() if i != "chair"} == {i: o for i, o in before.items() if i != "chair"}
    assert [run.status(s) for s in FOUR] == ["done", "stale", "stale", "stale"]


def statuses(run: Run) -> list[str]:
    return [run.status(stage) for stage in FOUR]


def test_redoing_what_was_corrected_makes_the_stages_done(run: Run) -> None:
    run.run_all(FOUR)
    chair = ObjectCorrection(id="chair", category="rocking chair", note="It has no arms.")
    correct(run, corrections_of(run.memory).having(chair))
    again(run, GRAPH)
    assert statuses(run) == ["done", "done", "stale", "stale"]
    again(run, LAYOUT, AUXILIARY, only={"chair"})
    assert statuses(run) == ["done"] * 4
    assert proxies(run)["chair"].category == "rocking chair"


def test_redoing_one_of_two_corrected_things_leaves_the_stages_stale(run: Run) -> None:
    run.run_all(FOUR)
    for identifier in ("chair", "bed"):
        said = ObjectCorrection(id=identifier, category=f"another {identifier}")
        correct(run, corrections_of(run.memory).having(said))
    again(run, GRAPH)
    again(run, LAYOUT, only={"chair"})
    assert statuses(run)[2] == "stale"
    again(run, LAYOUT, only={"chair", "bed"})
    assert statuses(run)[2] == "done"
