# SPDX-License-Identifier: GPL-3.0-or-later
"""One object is modelled again: small things stay on their surfaces, nothing else changes, and no stage becomes stale."""

from __future__ import annotations

from typing import Any

import pytest
from code_as_room.pipeline.program.lines import parse_layout
from code_as_room.pipeline.run import Run
from code_as_room.pipeline.stages import all_stages
from code_as_room.pipeline.stages.s06_geometry import STAGE as GEOMETRY
from code_as_room.pipeline.stages.s07_surfaces import STAGE as SMALL


@pytest.mark.parametrize("chosen", ["closet", "stand"])
def test_small_things_stay_and_the_stages_stay_done(run: Run, answers: Any, scene: Any, chosen: str) -> None:
    run.memory.settings |= {"iterations": "0", "objects": "library"}
    run.run_all(all_stages()[: all_stages().index(SMALL) + 1])
    before = {p.id: p for p in parse_layout(scene.text).proxies}
    for stage in (GEOMETRY, SMALL):
        session = run.begin(stage, fresh=True, only=frozenset({chosen}))
        while not session.finished:
            session.step()
        session.apply()
        assert {p.id: p for p in parse_layout(scene.text).proxies} == before, f"something jumped after {stage.title}"
    assert run.status(GEOMETRY) == "done" and run.status(SMALL) == "done"
