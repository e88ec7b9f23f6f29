"""Any round of the layout loop can be made the layout: the scene follows, edits by hand stay, stage 4 has to run again."""

from __future__ import annotations

from typing import Any

import pytest
from code_as_room.pipeline.artifacts.corrections import Corrections, ObjectCorrection
from code_as_room.pipeline.artifacts.layout import LayoutEdit, LayoutProgram, ProxyLine
from code_as_room.pipeline.errors import RoomError
from code_as_room.pipeline.memory import load_memory
from code_as_room.pipeline.program.lines import parse_layout
from code_as_room.pipeline.run import Run
from code_as_room.pipeline.run_corrections import correct
from code_as_room.pipeline.run_rounds import take_round
from code_as_room.pipeline.stages import all_stages

FOUR = all_stages()[:4]
ANALYSIS, GRAPH, LAYOUT, AUXILIARY = FOUR


@pytest.fixture
def looped(run: Run, answers: Any) -> Run:
    """A room whose loop tried a second round, in which the chair stands elsewhere, and kept the first."""
    chair = next(o for o in answers.by_key["01_analysis"]["objects"] if o["id"] == "chair")
    elsewhere = {k: v + (6 if k.startswith("x") else 0) for k, v in chair["box"].items()}
    asked = [{"op": "move", "id": "chair", "box": elsewhere}]
    answers.by_key["03_critique"] = lambda p: {"score": 50, "edits": asked if p.key.endswith("/0") else []}
    run.run_all(FOUR)
    return run


def layout_of(run: Run) -> LayoutProgram:
    found = run.memory.latest(LayoutProgram, (LAYOUT.id,))
    assert found is not None
    return found


def proxies(text: str) -> dict[str, ProxyLine]:
    return {p.id: p for p in parse_layout(text).proxies}


def other(run: Run) -> int:
    """The number of a round that was not kept."""
    program = layout_of(run)
    return next(i.number for i in program.iterations if i.number != program.best)


def test_the_scene_shows_the_round_that_is_taken_and_stage_4_has_to_run_again(looped: Run, scene: Any) -> None:
    number = other(looped)
    wanted = next(i for i in layout_of(looped).iterations if i.number == number)
    assert looped.status(AUXILIARY) == "done"
    take_round(looped, number)
    program = layout_of(looped)
    assert (program.best, program.text, program.score) == (number, wanted.program, wanted.score)
    assert scene.text == wanted.program
    assert looped.status(LAYOUT) == "done" and looped.status(AUXILIARY) == "stale"
    assert load_memory(scene.memory).entries == looped.memory.entries, "what was taken is in the file"
    looped.run_stage(AUXILIARY)
    assert proxies(scene.text)["chair"].centre == proxies(wanted.program)["chair"].centre
    assert "lamp" in proxies(scene.text)


def test_taking_one_and_then_the_first_again_brings_the_first_back(looped: Run, scene: Any) -> None:
    before = layout_of(looped)
    take_round(looped, other(looped))
    take_round(looped, before.best)
    assert layout_of(looped).model_dump() == before.model_dump()


def test_edits_by_hand_stand_on_top_of_every_round(looped: Run, scene: Any) -> None:
    first, second = layout_of(looped).best, other(looped)
    scene.edits = [
        LayoutEdit(op="move", id="bed", centre=(0.35, 0.8, 0.45), origin="artist"),
        LayoutEdit(op="rename", id="closet", new_id="armoire", origin="artist"),
    ]
    for number in (second, first, second):
        take_round(looped, number)
        found = proxies(scene.text)
        assert found["bed"].centre == (0.35, 0.8, 0.45)
        assert "armoire" in found and "closet" not in found


def test_what_is_locked_stays_where_it_stands(looped: Run, scene: Any) -> None:
    standing = proxies(scene.text)["chair"]
    number = other(looped)
    assert proxies(next(i for i in layout_of(looped).iterations if i.number == number).program)["chair"] != standing
    correct(looped, Corrections(objects=[ObjectCorrection(id="chair", locked=True)]))
    take_round(looped, number)
    assert proxies(scene.text)["chair"] == standing


def test_a_round_that_is_not_there_changes_nothing(looped: Run, scene: Any) -> None:
    entries, text = list(looped.memory.entries), scene.text
    with pytest.raises(RoomError, match="no round 8"):
        take_round(looped, 7)
    assert looped.memory.entries == entries and scene.text == text
