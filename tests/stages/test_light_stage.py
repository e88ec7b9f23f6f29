# SPDX-License-Identifier: GPL-3.0-or-later
"""Stage 10 from end to end: it ends without answers, takes those that come, and keeps what the artist did to the light."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import pytest
from code_as_room.pipeline.artifacts.correction import FAULT_KINDS, CorrectionReport
from code_as_room.pipeline.artifacts.layout import Layout, LayoutEdit, LayoutProgram
from code_as_room.pipeline.artifacts.light import LightPlan
from code_as_room.pipeline.correction.correct import correct
from code_as_room.pipeline.light.tone import AGX, MEDIUM_HIGH
from code_as_room.pipeline.program.evaluate import evaluate
from code_as_room.pipeline.program.lines import parse_layout, print_line
from code_as_room.pipeline.run import Run
from code_as_room.pipeline.stages import all_stages, s10_finish
from code_as_room.pipeline.stages.s07_surfaces import STAGE as BEFORE
from code_as_room.pipeline.stages.s10_finish import CORRECTIONS_OFF, STAGE

EARLIER = [s for s in all_stages() if s.id <= BEFORE.id]


@pytest.fixture
def run(run: Run, answers: Any) -> Iterator[Run]:
    run.memory.settings |= {"iterations": "0", "objects": "library"}
    answers.by_key["10_light"] = "no idea"
    run.run_all(EARLIER)
    yield run


def finished(run: Run) -> Layout:
    program = run.memory.latest(LayoutProgram, (STAGE.id,))
    assert program is not None
    return parse_layout(program.text)


def plan(run: Run) -> LightPlan:
    found = run.memory.latest(LightPlan)
    assert found is not None
    return found


def test_without_a_usable_answer_the_room_is_lit_and_looked_at(run: Run, scene: Any) -> None:
    run.run_stage(STAGE)
    layout = finished(run)
    assert plan(run).source == "measured"
    assert {c.id for c in layout.cameras} == {"reference", "top", "eye_1", "eye_2"}
    assert layout.lights and len(layout.worlds) == len(layout.views) == 1
    assert layout.views[0].ceiling > 2 and scene.built[-1] == scene.text
    evaluate(scene.text)


def test_what_is_in_the_way_is_moved_said_and_not_moved_again(run: Run) -> None:
    former = run.memory.latest(LayoutProgram, (BEFORE.id,))
    assert former is not None
    run.run_stage(STAGE)
    report = run.memory.latest(CorrectionReport)
    assert report is not None
    moved = {fix.id for fix in report.fixes if fix.kind == "blocked"}
    before, after = parse_layout(former.text), finished(run)
    differ = {p.id for p, q in zip(before.proxies, after.proxies, strict=True) if p != q}
    assert differ == moved == {"closet"} and "door_1" in report.fixes[0].message
    assert correct(run.backend.program_text()).report.fixes == []
    # What the artist switches off is told of and stays.
    run.memory.settings[CORRECTIONS_OFF] = "blocked,outside"
    assert run.status(STAGE) == "stale"
    run.run_stage(STAGE)
    report = run.memory.latest(CorrectionReport)
    assert report is not None and [f.about for f in report.left] == ["closet"] and report.off == ["outside", "blocked"]
    assert finished(run).proxies == before.proxies
    run.memory.settings[CORRECTIONS_OFF] = "blocked:closet"
    run.run_stage(STAGE)
    report = run.memory.latest(CorrectionReport)
    assert report is not None and not report.fixes and "You keep it as it is" in report.left[0].message
    assert finished(run).proxies == before.proxies


def test_light_moves_nothing(run: Run) -> None:
    run.memory.settings[CORRECTIONS_OFF] = ",".join(FAULT_KINDS)
    former = run.memory.latest(LayoutProgram, (BEFORE.id,))
    assert former is not None
    before = parse_layout(former.text)
    run.run_stage(STAGE)
    after = finished(run)
    for name in ("room", "walls", "doors", "windows", "openings", "proxies"):
        assert getattr(after, name) == getattr(before, name)
    assert after.cameras[0] == before.cameras[0]
    shapes = [{n: [s.vertices.tolist() for s in made] for n, made in evaluate(t).furnished.items()}
              for t in (former.text, run.backend.program_text())]  # fmt: skip
    assert shapes[0] == shapes[1]


def test_a_second_run_changes_nothing(run: Run) -> None:
    run.run_stage(STAGE)
    first = finished(run)
    run.run_stage(STAGE)
    assert finished(run) == first


def test_an_answer_decides_the_style(run: Run, answers: Any) -> None:
    answers.by_key["10_light"] = {"style": "night", "sun_from": "none", "windows": [], "lamps_on": [], "warmth": "cool"}
    run.run_stage(STAGE)
    assert plan(run).style == "night" and plan(run).source == "model"


def test_lights_that_the_artist_changed_or_removed_stay_so(run: Run, scene: Any) -> None:
    run.run_stage(STAGE)
    layout = finished(run)
    light = layout.lights[0].model_copy(update={"energy": 12.5})
    view = layout.views[0].model_copy(update={"exposure": 1.25})
    own = light.model_copy(update={"id": "mine", "energy": 3.0})
    scene.edits = [
        LayoutEdit(op="line", id=light.id, line=print_line(light), origin="artist"),
        LayoutEdit(op="line", id="view", line=print_line(view), origin="artist"),
        LayoutEdit(op="remove", id="eye_2", origin="artist"),
        LayoutEdit(op="add", id="mine", line=print_line(own), origin="artist"),
    ]
    run.run_stage(STAGE)
    after = {line.id: line for line in finished(run).lights}
    assert after[light.id].energy == 12.5 and after["mine"].energy == 3.0
    assert finished(run).views[0].exposure == 1.25
    assert "eye_2" not in {c.id for c in finished(run).cameras}


def test_a_picture_from_behind_a_filmic_transform_makes_a_room_behind_it(
    run: Run, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(s10_finish, "tone_of", lambda picture: (AGX, MEDIUM_HIGH))
    run.run_stage(STAGE)
    shown = finished(run).views[0]
    assert (shown.transform, shown.look) == (AGX, MEDIUM_HIGH)
    # Floor and walls are as bright on the screen as the picture's, under that transform.
    for brightness in plan(run).brightness:
        assert brightness.after == pytest.approx(brightness.picture, abs=0.12)
