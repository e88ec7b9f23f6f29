# SPDX-License-Identifier: GPL-3.0-or-later
"""One object is modelled again: small things stay on their surfaces, nothing else changes, and no stage becomes stale."""

from __future__ import annotations

from typing import Any

import pytest
from code_as_room.pipeline.program.evaluate import evaluate
from code_as_room.pipeline.program.limits import FINISHED_ROOM_LIMITS
from code_as_room.pipeline.program.lines import parse_layout
from code_as_room.pipeline.run import Run
from code_as_room.pipeline.stages import all_stages
from code_as_room.pipeline.stages.base import Stage
from code_as_room.pipeline.stages.s06_geometry import STAGE as GEOMETRY
from code_as_room.pipeline.stages.s07_surfaces import STAGE as SMALL


def redo(run: Run, stage: Stage, chosen: frozenset[str]) -> None:
    """As the window does it: what can be done for single objects is, and all else as far as it is stale."""
    session = run.begin(stage, fresh=stage.partial, only=chosen if stage.partial else None)
    while not session.finished:
        session.step()
    session.apply()


def test_a_finished_room_is_finished_again(run: Run, answers: Any, scene: Any) -> None:
    run.memory.settings |= {"iterations": "0", "objects": "library"}
    run.run_all(all_stages())
    before, asked = evaluate(scene.text, FINISHED_ROOM_LIMITS), len(answers.asked)
    for stage in all_stages()[all_stages().index(GEOMETRY) :]:
        redo(run, stage, frozenset({"chair"}))
    after = evaluate(scene.text, FINISHED_ROOM_LIMITS)
    assert [run.status(stage) for stage in all_stages()] == ["done"] * len(all_stages())
    assert after.proxies == before.proxies and after.lights == before.lights and after.views == before.views
    keys = {name: {k: look.key for k, look in finish.items()} for name, finish in before.finishes.items()}
    again = {name: {k: look.key for k, look in finish.items()} for name, finish in after.finishes.items()}
    assert {n: f for n, f in again.items() if n != "chair"} == {n: f for n, f in keys.items() if n != "chair"}
    # Geometry and materials ask about the chosen one; the light is known.
    assert {p.key.split("/")[0] for p in answers.asked[asked:]} <= {"06_programs", "06_pieces", "08_materials"}


@pytest.mark.parametrize("chosen", ["closet", "stand"])
def test_small_things_stay_and_the_stages_stay_done(run: Run, answers: Any, scene: Any, chosen: str) -> None:
    run.memory.settings |= {"iterations": "0", "objects": "library"}
    run.run_all(all_stages()[: all_stages().index(SMALL) + 1])
    before = {p.id: p for p in parse_layout(scene.text).proxies}
    for stage in (GEOMETRY, SMALL):
        redo(run, stage, frozenset({chosen}))
        assert {p.id: p for p in parse_layout(scene.text).proxies} == before, f"something jumped after {stage.title}"
    assert run.status(GEOMETRY) == "done" and run.status(SMALL) == "done"
