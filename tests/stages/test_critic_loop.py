"""How the layout loop spends its questions, what it remembers, and that it measures before it believes."""

from __future__ import annotations

from typing import Any

import pytest
from code_as_room.pipeline.artifacts.analysis import SceneAnalysis
from code_as_room.pipeline.artifacts.graph import SceneGraph
from code_as_room.pipeline.artifacts.layout import LayoutProgram
from code_as_room.pipeline.program.lines import parse_layout
from code_as_room.pipeline.run import Run
from code_as_room.pipeline.stages import all_stages

FOUR = all_stages()[:4]
TURN = {"op": "turn", "id": "chair", "facing": "none", "yaw_deg": 220}


def layout_of(run: Run) -> LayoutProgram:
    found = run.memory.latest(LayoutProgram, ("s03_layout",))
    assert found is not None
    return found


def critiques(answers: Any) -> list[Any]:
    return [p for p in answers.asked if p.key.startswith("03_critique")]


def moved(answers: Any, identifier: str, down: float) -> dict[str, Any]:
    """An edit that moves a thing to where the picture truly shows it, after the first answer had it elsewhere."""
    item = next(o for o in answers.by_key["01_analysis"]["objects"] if o["id"] == identifier)
    right = dict(item["box"])
    item["box"] = {k: v + (down if k.startswith("y") else 0) for k, v in right.items()}
    return {"op": "move", "id": identifier, "box": right}


def test_what_is_asked_for_at_the_target_is_done_and_nothing_more_is_asked(run: Run, answers: Any) -> None:
    answers.by_key["03_critique"] = {"score": 99, "edits": [TURN]}
    run.run_all(FOUR)
    chair = parse_layout(layout_of(run).text).proxy("chair")
    assert chair is not None and chair.yaw == 220.0
    assert len(critiques(answers)) == 1 and len(layout_of(run).iterations) == 2


def test_the_critic_hears_what_became_of_its_wishes_unless_it_has_no_memory(run: Run, answers: Any) -> None:
    edits = [TURN, {"op": "remove", "id": "stand"}, moved(answers, "bed", 40.0)]
    answers.by_key["03_critique"] = lambda p: {"score": 40, "edits": edits if p.key.endswith("/0") else []}
    run.run_all(FOUR)
    first, second = critiques(answers)
    assert "Measured problems: none" in first.text and "earlier rounds" not in first.text
    assert "turn chair" in second.text and "clearly seen" in second.text
    answers.asked.clear()
    run.memory.settings["memory"] = "off"
    assert [run.status(s) for s in FOUR][2] == "stale"
    run.run_all(FOUR)
    assert len(critiques(answers)) == 2
    assert not any("Measured problems" in p.text or "earlier rounds" in p.text for p in critiques(answers))


@pytest.mark.parametrize(("rounds", "asked"), [("0", 0), ("1", 1), ("5", 2)])
def test_the_setting_rounds_goes_before_the_panels(run: Run, answers: Any, rounds: str, asked: int) -> None:
    edits = [moved(answers, "bed", 40.0)]
    answers.by_key["03_critique"] = lambda p: {"score": 40, "edits": edits if p.key.endswith("/0") else []}
    run.memory.settings.update(rounds=rounds, iterations="3")
    run.run_all(FOUR)
    assert len(critiques(answers)) == asked


def test_a_wish_that_measures_worse_is_not_done_and_costs_the_others_nothing(run: Run, answers: Any) -> None:
    huge = {"op": "resize", "id": "closet", "size_m": {"width": 6.0, "depth": 4.0, "height": 2.4}}
    right = moved(answers, "bed", 40.0)
    answers.by_key["03_critique"] = lambda p: {"score": 40, "edits": [huge, right] if p.key.endswith("/0") else []}
    run.run_all(FOUR)
    first = layout_of(run).iterations[0]
    assert [e.id for e in first.edits] == ["bed"]
    assert any(f.about == "closet" for f in first.refused)
    assert layout_of(run).best == 1


def test_a_critic_that_never_makes_up_its_mind_is_stopped(run: Run, answers: Any) -> None:
    right = moved(answers, "bed", 40.0)

    def critic(prompt: Any) -> dict[str, Any]:
        number = int(prompt.key.rsplit("/", 1)[1])
        return {"score": 30, "edits": [{**TURN, "yaw_deg": 220 if number % 2 == 0 else 40}, right]}

    answers.by_key["03_critique"] = critic
    run.run_all(FOUR)
    assert len(critiques(answers)) < 5
    chair = parse_layout(layout_of(run).text).proxy("chair")
    assert chair is not None and chair.yaw == 220.0
    assert any("back and forth" in f.message for i in layout_of(run).iterations for f in i.refused)


def test_stages_1_to_4_ask_at_most_six_times_in_a_row_and_say_little(run: Run, answers: Any) -> None:
    reports = run.run_all(FOUR)
    assert len(answers.asked) <= 6
    assert sum(r.prompt_bytes for r in reports) < 60_000


def test_the_graph_keeps_meaning_and_drops_what_geometry_denies(
    run: Run, answers: Any, analysis: SceneAnalysis
) -> None:
    relations = [
        {"source": "chair", "relation": "faces", "target": "bed"},
        {"source": "closet", "relation": "against_wall", "target": "wall_w"},
        {"source": "chair", "relation": "under", "target": "bed"},
    ]
    answers.by_key["02_graph"] = {"attributes": [], "relations": relations}
    run.run_all(FOUR[:2])
    graph = run.memory.latest(SceneGraph)
    assert graph is not None
    said = {(e.source, e.relation, e.target) for e in graph.edges if e.origin == "model"}
    assert said == {("chair", "faces", "bed"), ("bed", "faced_by", "chair")}
    assert {f.about for f in graph.findings} == {"closet", "chair"}
