# SPDX-License-Identifier: GPL-3.0-or-later
"""Stage 8 from end to end: everything has a look whatever a model says, geometry stays, and so does what the artist wrote."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import pytest
from code_as_room.pipeline.artifacts.layout import LayoutEdit, LayoutProgram
from code_as_room.pipeline.artifacts.materials import Materials
from code_as_room.pipeline.memory import EntryMeta, now
from code_as_room.pipeline.program.evaluate import evaluate
from code_as_room.pipeline.program.finishes import Materials as Finishes
from code_as_room.pipeline.program.finishes import read_materials, with_materials
from code_as_room.pipeline.program.limits import FINISHED_ROOM_LIMITS
from code_as_room.pipeline.program.lines import parse_layout
from code_as_room.pipeline.program.prelude.record import Record
from code_as_room.pipeline.run import Run
from code_as_room.pipeline.stages import all_stages
from code_as_room.pipeline.stages.s07_surfaces import STAGE as BEFORE
from code_as_room.pipeline.stages.s08_materials import MOST_CALLS, STAGE

EARLIER = [s for s in all_stages() if s.id <= BEFORE.id]


@pytest.fixture
def run(run: Run, answers: Any) -> Iterator[Run]:
    run.memory.settings |= {"iterations": "0", "objects": "library"}
    answers.by_key["08_materials"] = "no idea"
    run.run_all(EARLIER)
    yield run


def texts(run: Run) -> tuple[str, str]:
    """The program before the stage, and the one that it wrote."""
    before, after = run.memory.latest(LayoutProgram, (BEFORE.id,)), run.memory.latest(LayoutProgram, (STAGE.id,))
    assert before is not None and after is not None and after.text == run.backend.program_text()
    return before.text, after.text


def record(text: str) -> Record:
    return evaluate(text, FINISHED_ROOM_LIMITS)


def materials(run: Run) -> Materials:
    found = run.memory.latest(Materials)
    assert found is not None
    return found


def rewrite(run: Run, text: str) -> None:
    """What the artist wrote into the stage's program, as memory has it then."""
    program = run.memory.latest(LayoutProgram, (STAGE.id,))
    assert program is not None
    run.memory.append(STAGE.id, program.model_copy(update={"text": text}), EntryMeta(time=now(), model="artist"))


def test_without_a_usable_answer_every_part_has_a_look(run: Run) -> None:
    run.run_stage(STAGE)
    made = record(texts(run)[1])
    for name, shapes in made.furnished.items():
        for shape in shapes:
            keys = {shape.part, shape.material, shape.material.split(" #")[0]}
            assert keys & set(made.finishes[name]), (name, shape.part, shape.material)
    assert {"walls", "ceiling"} <= set(made.finishes)
    assert any("no usable answer" in f.message for f in materials(run).findings)


def test_only_looks_and_finishes_are_new_and_no_mesh_moves(run: Run) -> None:
    run.run_stage(STAGE)
    before, after = texts(run)
    assert with_materials(after, Finishes()) == before
    assert [line for line in before.splitlines() if line not in after.splitlines()] == []
    assert parse_layout(before) == parse_layout(after)
    one, other = record(before).furnished, record(after).furnished
    assert {n: [(s.vertices.tolist(), s.faces, s.material) for s in made] for n, made in one.items()} == {
        n: [(s.vertices.tolist(), s.faces, s.material) for s in made] for n, made in other.items()
    }


def test_looks_are_shared_and_a_second_run_changes_nothing(run: Run) -> None:
    run.run_stage(STAGE)
    first = texts(run)[1]
    looks = read_materials(first).looks
    assert len(set(looks.values())) == len(looks)
    assert all(name.rpartition("_")[2].isdigit() for name in looks)
    run.run_stage(STAGE)
    assert texts(run)[1] == first


def test_an_answer_decides_families_and_its_nonsense_costs_nothing(run: Run, answers: Any) -> None:
    answers.by_key["08_materials"] = {
        "palette": [{"name": "ebony", "family": "wood", "color": "#2A2522"}],
        "objects": [
            {"id": "closet", "parts": [{"part": "", "material": "ebony", "color": "#2A2522", "veto": "as drawn"}]},
            {"id": "chair", "parts": [{"part": "wing", "material": "fur"}, {"part": "", "program": "while 1: pass"}]},
            {"id": "floor", "parts": [{"part": "", "material": "marble", "color": "#E0E0E0", "veto": "glare"}]},
            {"id": "doors", "parts": [{"part": "", "material": "oak"}]},
            {"id": "windows", "parts": [{"part": "", "material": "painted_wood"}]},
            {"id": "nobody", "parts": []},
        ],
    }
    run.run_stage(STAGE)
    made = record(texts(run)[1])
    closet = {look.colour for key, look in made.finishes["closet"].items() if look.name == "wood"}
    assert closet == {"#2A2522"} and made.finishes["floor"][""].name == "marble"
    # Glass stays glass, and handles stay metal.
    assert set(made.finishes["windows"]) == {"frame"} and set(made.finishes["doors"]) == {"door"}
    assert {"chair", "materials"} <= {f.about for f in materials(run).findings}
    assert len([p for p in answers.asked if p.key.startswith("08_materials")]) <= 2 * MOST_CALLS


def test_finishes_and_looks_that_the_artist_wrote_stay(run: Run) -> None:
    run.run_stage(STAGE)
    found = read_materials(texts(run)[1])
    mine = {"": 'leather("#102030")'}
    paint = found.finishes["walls"][""]
    found.finishes["chair"], found.looks[paint] = mine, 'plaster("#804040")'
    rewrite(run, with_materials(texts(run)[1], found))
    run.run_stage(STAGE)
    again = read_materials(texts(run)[1])
    assert again.finishes["chair"] == mine and again.looks[again.finishes["walls"][""]] == 'plaster("#804040")'
    chair = materials(run).of("chair")
    assert chair is not None and {p.source for p in chair.parts} == {"artist"}
    run.run_stage(STAGE)
    assert read_materials(texts(run)[1]) == again


def test_locked_objects_keep_their_looks(run: Run, scene: Any, answers: Any) -> None:
    run.run_stage(STAGE)
    before = record(texts(run)[1]).finishes
    answers.by_key["08_materials"] = {
        "objects": [{"id": i, "parts": [{"part": "", "material": "rubber"}]} for i in ("bed", "closet")]
    }
    scene.edits = [LayoutEdit(op="move", id="closet", centre=(2.0, -0.5, 1.0), origin="artist")]
    run.run_stage(STAGE)
    after = record(texts(run)[1]).finishes
    assert after["closet"] == before["closet"] and after["bed"] != before["bed"]
