"""Stages 1 to 4 from end to end: what the artist gets, what survives, and what a model cannot break."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from code_as_room.pipeline.artifacts.analysis import Calibration, SceneAnalysis
from code_as_room.pipeline.artifacts.graph import MinorObjects, SceneGraph
from code_as_room.pipeline.artifacts.layout import LayoutEdit, LayoutProgram
from code_as_room.pipeline.errors import Cancelled, ModelError, ReplyError, RoomError
from code_as_room.pipeline.memory import load_memory
from code_as_room.pipeline.program.lines import parse_layout
from code_as_room.pipeline.run import Run
from code_as_room.pipeline.stages import all_stages

FOUR = all_stages()[:4]
ANALYSIS, GRAPH, LAYOUT, AUXILIARY = FOUR


def layout_of(run: Run) -> dict[str, Any]:
    program = run.memory.latest(LayoutProgram)
    assert program is not None
    return {p.id: p for p in parse_layout(program.text).proxies}


def test_a_model_that_sees_perfectly_gives_the_true_room(run: Run, analysis: SceneAnalysis) -> None:
    run.run_all(FOUR)
    found = layout_of(run)
    for true in analysis.objects:
        proxy = found[true.id]
        flat = 2 if true.placement == "floor" else 3
        np.testing.assert_allclose(proxy.centre[:flat], true.centre[:flat], atol=0.03, err_msg=true.id)
        np.testing.assert_allclose(proxy.size, true.size, rtol=0.06, atol=0.02, err_msg=true.id)
        assert abs((proxy.yaw - true.yaw + 180) % 360 - 180) < 1, true.id


def test_everything_detected_is_in_the_ledger_once(run: Run, analysis: SceneAnalysis) -> None:
    run.run_all(FOUR)
    program = run.memory.latest(LayoutProgram)
    assert program is not None
    assert [e.id for e in program.ledger] == [o.id for o in analysis.objects]
    assert {e.state for e in program.ledger} == {"placed"}


def test_calls_and_prompts_stay_within_the_budget(run: Run) -> None:
    reports = run.run_all(FOUR)
    iterations = run.memory.latest(LayoutProgram, ("s03_layout",)).iterations  # type: ignore[union-attr]
    assert sum(r.calls for r in reports) <= 4 + 2 * len(iterations)
    assert max(r.largest_prompt for r in reports) < 40_000


def test_graph_and_sidecar_name_only_what_exists(run: Run) -> None:
    run.run_stage(ANALYSIS)
    run.run_stage(GRAPH)
    graph, minor = run.memory.latest(SceneGraph), run.memory.latest(MinorObjects)
    assert graph is not None and minor is not None
    nodes = {n.id for n in graph.nodes}
    assert all(e.source in nodes and e.target in nodes for e in graph.edges)
    assert minor.by_parent["stand"] == ["lamp"]
    found = {(e.source, e.relation, e.target) for e in graph.edges}
    assert ("stand", "against_wall", "wall_n") in found and ("stand", "supports", "lamp") in found


def test_a_stage_before_its_inputs_says_what_to_do(run: Run) -> None:
    with pytest.raises(RoomError, match="Run the stages before it first"):
        run.run_stage(LAYOUT)


def test_stale_marks_follow_a_change_upstream(run: Run) -> None:
    run.run_all(FOUR)
    assert [run.status(s) for s in FOUR] == ["done"] * 4
    assert run.run_all(FOUR) == []
    run.memory.settings["notes"] = "A guest room."
    assert [run.status(s) for s in FOUR] == ["stale", "done", "done", "done"]
    run.memory.settings["iterations"] = "2"
    assert [run.status(s) for s in FOUR] == ["stale", "done", "stale", "done"]
    run.memory.settings["known_width_m"] = "5.0"
    run.run_all(FOUR)
    assert [run.status(s) for s in FOUR] == ["done"] * 4
    width = max(p[0] for p in run.memory.latest(Calibration).floor) * 2  # type: ignore[union-attr]
    assert width == pytest.approx(5.0, abs=0.01)


def test_an_answered_question_is_not_paid_for_twice(run: Run, answers: Any) -> None:
    run.run_stage(ANALYSIS)
    paid = len(answers.asked)
    run.run_stage(ANALYSIS)
    assert len(answers.asked) == paid
    session = run.begin(ANALYSIS, fresh=True)
    while not session.finished:
        session.step()
    assert len(answers.asked) == 2 * paid


def test_a_failing_second_request_keeps_the_first_answer(run: Run, answers: Any) -> None:
    def fail(prompt: Any) -> dict[str, Any]:
        raise ModelError("The service is down.", "Try again later.")

    answers.by_key["01_second_look"] = fail
    with pytest.raises(ModelError, match="service is down"):
        run.run_stage(ANALYSIS)
    del answers.by_key["01_second_look"]
    kept = load_memory(run.backend.load_memory())
    assert [e.output["key"] for e in kept.entries if e.type == "Answer"] == ["01_analysis"]
    answers.asked.clear()
    run.run_stage(ANALYSIS)
    assert [p.key for p in answers.asked] == ["01_second_look"]


def test_stopping_in_the_loop_keeps_earlier_stages(run: Run, answers: Any) -> None:
    run.run_stage(ANALYSIS)
    run.run_stage(GRAPH)

    def stop(prompt: Any) -> dict[str, Any]:
        run.cancel.set()
        return {"score": 10, "edits": []}

    answers.by_key["03_critique"] = stop
    with pytest.raises(Cancelled):
        run.run_stage(LAYOUT)
    assert [run.status(s) for s in FOUR] == ["done", "done", "not run", "not run"]
    assert load_memory(run.backend.load_memory()) == run.memory


def test_hand_edits_win_over_the_critic(run: Run, answers: Any, scene: Any) -> None:
    run.run_all(FOUR)
    moved = LayoutEdit(op="move", id="chair", centre=(1.2, -1.3, 0.4), origin="artist")
    gone = LayoutEdit(op="remove", id="stand", origin="artist")
    scene.edits = [moved, gone]
    box = {"x_min": 150, "y_min": 500, "x_max": 300, "y_max": 700}
    answers.by_key["03_critique"] = {"score": 20, "edits": [{"op": "move", "id": "chair", "box": box}]}
    for stage in (LAYOUT, AUXILIARY):
        session = run.begin(stage, fresh=True)
        while not session.finished:
            session.step()
    found = layout_of(run)
    assert found["chair"].centre == (1.2, -1.3, 0.4)
    assert "stand" not in found
    refused = run.memory.latest(LayoutProgram, ("s03_layout",)).iterations[0].refused  # type: ignore[union-attr]
    assert any(f.about == "chair" and "by hand" in f.message for f in refused)


def test_the_critic_mends_a_wrong_box_and_the_best_round_is_kept(
    run: Run, answers: Any, analysis: SceneAnalysis
) -> None:
    bed = next(o for o in answers.by_key["01_analysis"]["objects"] if o["id"] == "bed")
    right = dict(bed["box"])
    bed["box"] = {k: v + (25 if k.startswith("y") else 0) for k, v in right.items()}
    bed["centre_m"] = {"x_m": 0.2, "y_m": 0.75}
    rounds: list[str] = []

    def critic(prompt: Any) -> dict[str, Any]:
        rounds.append(prompt.key)
        edits = [{"op": "move", "id": "bed", "box": right, "reason": "too low"}] if len(rounds) == 1 else []
        return {"score": 80, "edits": edits}

    answers.by_key["03_critique"] = critic
    run.run_all(FOUR)
    program = run.memory.latest(LayoutProgram, ("s03_layout",))
    assert program is not None and len(program.iterations) == len(rounds) == 2 and program.best == 1
    first, last = (parse_layout(i.program).proxy("bed") for i in program.iterations)
    assert first is not None and last is not None
    true = next(o for o in analysis.objects if o.id == "bed").centre[1]
    assert abs(last.centre[1] - true) < abs(first.centre[1] - true) - 0.02
    assert parse_layout(program.text).proxy("bed") == last


@pytest.mark.parametrize(("allowed", "asked"), [("0", 0), ("1", 1), ("3", 2)])
def test_the_artist_limits_the_rounds(run: Run, answers: Any, allowed: str, asked: int) -> None:
    box = next(o["box"] for o in answers.by_key["01_analysis"]["objects"] if o["id"] == "closet")
    moved = {k: v + (25 if k.startswith("x") else 0) for k, v in box.items()}
    edit = {"op": "move", "id": "closet", "box": moved}
    answers.by_key["03_critique"] = lambda p: {"score": 50, "edits": [edit] if p.key.endswith("/0") else []}
    run.memory.settings["iterations"] = allowed
    run.run_all(FOUR)
    assert sum(p.key.startswith("03_critique") for p in answers.asked) == asked


def test_nonsense_from_the_critic_changes_nothing(run: Run, answers: Any) -> None:
    answers.by_key["03_critique"] = {
        "score": 1e9,
        "edits": [
            {"op": "move", "id": "ghost", "box": {"x_min": 0, "y_min": 0, "x_max": 9, "y_max": 9}},
            {"op": "remove", "id": "bed"},
            {"op": "remove", "id": "wall_n"},
            {"op": "move", "id": "bed", "box": {"x_min": 900, "y_min": 900, "x_max": 990, "y_max": 990}},
            {"op": "resize", "id": "bed"},
            {"op": "add", "id": "x", "category": "sofa"},
        ],
    }
    run.run_all(FOUR)
    program = run.memory.latest(LayoutProgram, ("s03_layout",))
    assert program is not None and len(program.iterations) == 1
    assert len(program.iterations[0].refused) == 6 and program.iterations[0].edits == []
    assert 0 <= program.score.total <= 1


@pytest.mark.parametrize("text", ["", "I cannot help with that.", '{"view": "perspective"', "[1, 2]", '{"view": 3}'])
def test_an_unusable_first_answer_is_an_error_in_words(run: Run, answers: Any, text: str) -> None:
    answers.by_key["01_analysis"] = text
    with pytest.raises(ReplyError) as caught:
        run.run_stage(ANALYSIS)
    assert caught.value.message and "Traceback" not in str(caught.value)
    assert len(answers.asked) == 2, "one repair round"
    assert run.status(ANALYSIS) == "not run"


def test_one_broken_object_does_not_cost_the_others(run: Run, answers: Any) -> None:
    answers.by_key["01_analysis"]["objects"][0]["centre_m"] = {"x_m": None, "y_m": "left"}
    run.run_all(FOUR)
    assert len(layout_of(run)) == 6


def test_surface_and_wall_objects_touch_what_carries_them(run: Run) -> None:
    run.run_all(FOUR)
    found = layout_of(run)
    lamp, stand, art = found["lamp"], found["stand"], found["art"]
    top = stand.centre[2] + stand.size[2] / 2
    assert lamp.centre[2] - lamp.size[2] / 2 == pytest.approx(top, abs=0.002)
    assert art.parent == "wall_n" and art.centre[1] + art.size[1] / 2 == pytest.approx(1.95, abs=0.01)
    assert math.isclose(art.yaw % 360, 0.0, abs_tol=0.5)


def test_an_orphan_is_asked_about_once_and_deferred_when_it_stays_open(run: Run, answers: Any) -> None:
    for item in answers.by_key["01_analysis"]["objects"]:
        if item["id"] == "lamp":
            item.update(parent=None, box={"x_min": 700, "y_min": 480, "x_max": 720, "y_max": 500})
    run.run_all(FOUR)
    assert sum(p.key == "04_auxiliary" for p in answers.asked) == 1
    ledger = {e.id: e for e in run.memory.latest(LayoutProgram).ledger}  # type: ignore[union-attr]
    assert ledger["lamp"].state == "deferred" and ledger["lamp"].reason


def test_another_picture_is_refused(run: Run, answers: Any, scene: Any) -> None:
    run.memory.picture_hash = "0" * 64
    with pytest.raises(RoomError, match="another picture"):
        Run(run.picture, run.memory, answers, scene)
