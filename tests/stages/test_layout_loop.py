"""The layout loop and stage 4: what the critic may do, what the scene shows, and that nothing is lost on the way."""

from __future__ import annotations

import copy
from typing import Any

import pytest
from code_as_room.pipeline.artifacts.layout import LayoutProgram
from code_as_room.pipeline.errors import Cancelled
from code_as_room.pipeline.memory import Memory
from code_as_room.pipeline.program.evaluate import evaluate
from code_as_room.pipeline.program.lines import parse_layout
from code_as_room.pipeline.run import Run
from code_as_room.pipeline.stages import all_stages

FOUR = all_stages()[:4]

LAYOUT = FOUR[2]


def said(answers: Any, identifier: str) -> dict[str, Any]:
    """What the scripted model says of one object; the test may change it."""
    found: dict[str, Any] = next(o for o in answers.by_key["01_analysis"]["objects"] if o["id"] == identifier)
    return found


def one_round(*edits: dict[str, Any]) -> Any:
    return lambda prompt: {"score": 50, "edits": list(edits) if prompt.key.endswith("/0") else []}


def shifted(box: dict[str, float], by: float) -> dict[str, float]:
    return {k: v + (by if k.startswith("x") else 0) for k, v in box.items()}


def layout_program(run: Run) -> LayoutProgram:
    found = run.memory.latest(LayoutProgram, (LAYOUT.id,))
    assert found is not None
    return found


def states(run: Run) -> dict[str, str]:
    found = run.memory.latest(LayoutProgram)
    assert found is not None
    return {e.id: e.state for e in found.ledger}


def test_a_moved_object_whose_parent_is_not_a_major_still_builds(run: Run, answers: Any, scene: Any) -> None:
    chair = said(answers, "chair")
    right = dict(chair["box"])
    chair.update(parent="rug", box=shifted(right, 25))
    chair["centre_m"]["x_m"] += 0.2
    answers.by_key["03_critique"] = one_round({"op": "move", "id": "chair", "box": right})
    run.run_all(FOUR)
    for text in scene.built:
        evaluate(text)
    assert len(layout_program(run).iterations) == 2


def test_the_scene_shows_the_round_that_is_kept(run: Run, answers: Any, scene: Any) -> None:
    worse = {"op": "move", "id": "chair", "box": shifted(said(answers, "chair")["box"], 6)}
    answers.by_key["03_critique"] = one_round(worse)
    run.run_all(FOUR[:3])
    program = layout_program(run)
    assert program.best == 0 and len(program.iterations) == 2
    assert scene.text == program.text


def test_a_turn_and_a_new_name_that_boxes_cannot_judge_are_kept(run: Run, answers: Any) -> None:
    said(answers, "bed")["yaw_deg"] = 180
    answers.by_key["03_critique"] = one_round(
        {"op": "turn", "id": "bed", "facing": "down", "yaw_deg": 0},
        {"op": "recategorise", "id": "chair", "category": "stool"},
    )
    run.run_all(FOUR)
    layout = parse_layout(layout_program(run).text)
    bed, chair = layout.proxy("bed"), layout.proxy("chair")
    assert bed is not None and bed.yaw == 0 and chair is not None and chair.category == "stool"


def test_what_was_hardly_seen_may_be_taken_out_and_is_in_the_ledger(run: Run, answers: Any) -> None:
    said(answers, "chair")["confidence"] = 0.3
    answers.by_key["03_critique"] = one_round({"op": "remove", "id": "chair"})
    run.run_all(FOUR)
    assert parse_layout(layout_program(run).text).proxy("chair") is None
    assert states(run)["chair"] == "dropped"


@pytest.mark.parametrize("at", range(1, 9))
def test_a_stop_is_obeyed_wherever_it_comes(run: Run, at: int) -> None:
    stopped = Run(run.picture, Memory(), run.client, run.backend)
    told = []

    def progress(what: str, step: int, steps: int) -> None:
        told.append(what)
        if len(told) == at:
            stopped.cancel.set()

    stopped.progress = progress
    with pytest.raises(Cancelled):
        stopped.run_all(FOUR)
    assert len(told) == at
    stopped.run_all(FOUR)
    assert [stopped.status(s) for s in FOUR] == ["done"] * 4


def test_a_tall_stack_named_from_top_to_bottom_is_placed(run: Run, answers: Any) -> None:
    for number in range(30, 0, -1):
        book = copy.deepcopy(said(answers, "lamp"))
        book.update(id=f"book_{number}", category="book", parent=f"book_{number - 1}" if number > 1 else "stand")
        book["size_m"] = {"width": 0.2, "depth": 0.2, "height": 0.02}
        answers.by_key["01_analysis"]["objects"].append(book)
    run.run_all(FOUR)
    assert set(states(run).values()) == {"placed"}
    assert not any(p.key == "04_auxiliary" for p in answers.asked)


@pytest.mark.parametrize("cup", [{"placement": "surface", "parent": "tray", "base_m": 0.05}, None])
def test_open_things_may_stand_on_one_another(run: Run, answers: Any, cup: dict[str, Any] | None) -> None:
    for name in ("cup", "tray"):
        thing = copy.deepcopy(said(answers, "lamp"))
        thing.update(id=name, category=name, parent="tray" if cup is None and name == "cup" else None)
        thing["box"] = {"x_min": 700, "y_min": 700, "x_max": 720, "y_max": 720}
        thing["centre_m"] = {"x_m": 0.9, "y_m": -1.0}
        answers.by_key["01_analysis"]["objects"].append(thing)
    answered = [{"id": "tray", "placement": "floor", "parent": None, "base_m": 0}]
    answers.by_key["04_auxiliary"] = {"placements": [*([{"id": "cup", **cup}] if cup else []), *answered]}
    run.run_all(FOUR)
    assert states(run)["cup"] == states(run)["tray"] == "placed"


def test_an_empty_room_is_a_room(run: Run, answers: Any) -> None:
    answers.by_key["01_analysis"]["objects"] = []
    run.run_all(FOUR)
    found = run.memory.latest(LayoutProgram)
    assert found is not None and found.ledger == [] and len(evaluate(found.text).walls) == 4
