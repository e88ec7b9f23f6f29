"""Stages run again after hand edits: nothing is doubled, lost or taken back, and the ledger says what became of it."""

from __future__ import annotations

from typing import Any

import pytest
from code_as_room.pipeline.artifacts.layout import LayoutEdit, LayoutProgram, ProxyLine
from code_as_room.pipeline.errors import Cancelled
from code_as_room.pipeline.layout.hand import apply_hand_edits
from code_as_room.pipeline.program.evaluate import evaluate
from code_as_room.pipeline.program.lines import parse_layout
from code_as_room.pipeline.run import Run
from code_as_room.pipeline.stages import all_stages
from code_as_room.pipeline.stages.base import Stage

FOUR = all_stages()[:4]
ANALYSIS, GRAPH, LAYOUT, AUXILIARY = FOUR


def edit(op: Any, identifier: str, **values: Any) -> LayoutEdit:
    return LayoutEdit(op=op, id=identifier, origin="artist", **values)


def box(identifier: str, at: tuple[float, float, float], **values: Any) -> LayoutEdit:
    return edit("add", identifier, category="box", centre=at, size=(0.3, 0.3, 0.3), **values)


def program(run: Run) -> LayoutProgram:
    found = run.memory.latest(LayoutProgram)
    assert found is not None
    evaluate(found.text)
    return found


def proxies(run: Run) -> dict[str, ProxyLine]:
    return {p.id: p for p in parse_layout(program(run).text).proxies}


def ledger(run: Run) -> dict[str, tuple[str, str]]:
    return {e.id: (e.state, e.reason) for e in program(run).ledger}


def again(run: Run, *stages: Stage) -> None:
    for stage in stages or (LAYOUT, AUXILIARY):
        session = run.begin(stage, fresh=True)
        while not session.finished:
            session.step()


def test_renamed_objects_stay_placed_and_carry_what_stood_on_them(run: Run, scene: Any) -> None:
    run.run_all(FOUR)
    scene.edits = [edit("rename", i, new_id=f"my_{i}") for i in ("stand", "chair", "rug")]
    again(run)
    found = proxies(run)
    assert {"my_stand", "my_chair", "my_rug", "lamp"} <= set(found) and len(found) == 7
    assert found["lamp"].parent == "my_stand"
    assert {state for state, _ in ledger(run).values()} == {"placed"}
    assert program(run).score.coverage == 1.0


def test_what_was_removed_by_hand_is_dropped_in_the_ledger(run: Run, scene: Any, answers: Any) -> None:
    run.run_all(FOUR)
    scene.edits = [edit("remove", "rug"), edit("remove", "bed"), edit("remove", "lamp"), edit("remove", "stand")]
    answers.asked.clear()
    again(run)
    assert set(proxies(run)) == {"chair", "closet", "art"}
    dropped = {i: reason for i, (state, reason) in ledger(run).items() if state == "dropped"}
    assert dropped == dict.fromkeys(("rug", "bed", "lamp", "stand"), "removed by hand")
    assert not any(p.key == "04_auxiliary" for p in answers.asked), "nobody is asked where a removed thing belongs"


def test_an_added_and_renamed_object_is_there_once(run: Run, scene: Any, answers: Any) -> None:
    run.run_all(FOUR)
    scene.edits = [box("new", (1.0, -1.0, 0.15)), edit("rename", "new", new_id="crate")]
    side = next(o["box"] for o in answers.by_key["01_analysis"]["objects"] if o["id"] == "chair")
    shifted = {k: v + (12 if k.startswith("x") else 0) for k, v in side.items()}
    answers.by_key["03_critique"] = {"score": 50, "edits": [{"op": "move", "id": "chair", "box": shifted}]}
    again(run)
    assert "crate" in proxies(run) and "new" not in proxies(run)


def test_a_copy_that_took_the_old_name_does_not_take_the_old_edits(run: Run, scene: Any) -> None:
    run.run_all(FOUR)
    scene.edits = [edit("move", "chair", centre=(1.2, -1.3, 0.4)), edit("rename", "chair", new_id="seat")]
    run.take_over_edits()
    scene.edits = [box("chair", (-1.0, -1.0, 0.15))]
    again(run)
    found = proxies(run)
    assert found["seat"].centre == (1.2, -1.3, 0.4) and found["chair"].centre == (-1.0, -1.0, 0.15)
    assert ledger(run)["chair"][0] == "placed"


def test_what_the_critic_adds_does_not_take_the_place_of_what_was_added_by_hand(
    run: Run, scene: Any, answers: Any
) -> None:
    run.run_all(FOUR)
    scene.edits = [box("pouf", (1.0, -1.0, 0.15))]
    spot = {"x_min": 380, "y_min": 700, "x_max": 450, "y_max": 790}
    size = {"width": 0.4, "depth": 0.4, "height": 0.4}
    asked = {"op": "add", "id": "pouf", "category": "pouf", "box": spot, "size_m": size}
    answers.by_key["03_critique"] = lambda p: {"score": 20, "edits": [asked] if p.key.endswith("/0") else []}
    again(run)
    assert proxies(run)["pouf"].centre == (1.0, -1.0, 0.15)
    program_3 = run.memory.latest(LayoutProgram, (LAYOUT.id,))
    assert program_3 is not None
    assert [e.id for e in program_3.iterations[0].edits] == ["pouf_2"], program_3.iterations[0].refused


def test_a_copy_on_something_minor_survives_a_new_layout(run: Run, scene: Any) -> None:
    run.run_all(FOUR)
    scene.edits = [box("copy", (0.2, 0.2, 0.16), parent="rug", placement="surface")]
    again(run)
    assert proxies(run)["copy"].parent == "rug"


def test_what_stands_on_a_moved_object_moves_with_it(run: Run, scene: Any) -> None:
    for stage in (ANALYSIS, GRAPH, LAYOUT):
        run.run_stage(stage)
    scene.edits = [edit("move", "stand", centre=(-1.6, -0.2, 0.25))]
    run.run_stage(AUXILIARY)
    found = proxies(run)
    assert found["stand"].centre == (-1.6, -0.2, 0.25)
    assert abs(found["lamp"].centre[0] + 1.6) < 0.23 and abs(found["lamp"].centre[1] + 0.2) < 0.23


def test_everything_locked_stays_bit_exact(run: Run, scene: Any) -> None:
    run.run_all(FOUR)
    before = proxies(run)
    scene.edits = [edit("move", i, centre=p.centre) for i, p in before.items()]
    again(run)
    assert proxies(run) == before


@pytest.mark.parametrize("count", range(7))
def test_a_layout_that_holds_a_part_of_the_edits_gets_the_rest(run: Run, count: int) -> None:
    run.run_all(FOUR)
    layout = parse_layout(program(run).text)
    edits = [
        edit("move", "chair", centre=(1.2, -1.3, 0.4)),
        edit("rename", "chair", new_id="seat"),
        box("chair", (-1.0, -1.0, 0.15)),
        edit("turn", "chair", yaw=30.0),
        edit("rename", "chair", new_id="crate"),
        edit("remove", "bed"),
    ]
    whole, findings = apply_hand_edits(layout, edits)
    part, _ = apply_hand_edits(layout, edits[:count])
    assert not findings
    assert apply_hand_edits(part, edits, count) == (whole, [])


def test_a_stopped_second_run_leaves_the_room_that_stood(run: Run, answers: Any, scene: Any) -> None:
    run.run_all(FOUR)
    scene.edits = [edit("move", "chair", centre=(1.2, -1.3, 0.4))]
    run.take_over_edits()
    stood = scene.text

    def stop(prompt: Any) -> dict[str, Any]:
        run.cancel.set()
        return {"score": 10, "edits": []}

    answers.by_key["03_critique"] = stop
    run.memory.settings["iterations"] = "4"
    with pytest.raises(Cancelled):
        run.run_all(FOUR)
    assert len(scene.built) > 3 and scene.text == stood
