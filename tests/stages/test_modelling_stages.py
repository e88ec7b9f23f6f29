# SPDX-License-Identifier: GPL-3.0-or-later
"""Stages 5 and 6 from end to end: every object is modelled whatever a model says, and what the artist did stays."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from typing import Any

import pytest
from code_as_room.pipeline.artifacts.layout import LayoutEdit, LayoutProgram
from code_as_room.pipeline.artifacts.objects import Descriptions, Geometry, OwnModelling, RoomStyle
from code_as_room.pipeline.errors import ModelError, NotRecordedError
from code_as_room.pipeline.models.base import Prompt
from code_as_room.pipeline.models.strength import modelling_of
from code_as_room.pipeline.program.evaluate import evaluate
from code_as_room.pipeline.program.limits import FINISHED_ROOM_LIMITS
from code_as_room.pipeline.program.lines import parse_layout
from code_as_room.pipeline.run import Run, StageSession
from code_as_room.pipeline.run_modelling import forget_own, note_own_functions, show_as_boxes
from code_as_room.pipeline.stages import all_stages, carrying

STAGES = all_stages()[:6]
DESCRIPTIONS, GEOMETRY = STAGES[4:]
PLAIN = """def {name}(size):
    w, d, h = size
    return [part("body", rounded_box((w, d, h), 0.02, at=(0, 0, h / 2)), material="wood #112233"),
            part("plate", box((w, d, 0.01), at=(0, 0, 0.005)), material="steel")]
"""


@pytest.fixture
def run(run: Run) -> Iterator[Run]:
    run.memory.settings["iterations"] = "0"
    run.memory.settings["objects"] = "library"
    yield run


def furnished(run: Run) -> dict[str, list[Any]]:
    program = run.memory.latest(LayoutProgram)
    assert program is not None and run.backend.program_text() == program.text
    return dict(evaluate(program.text, FINISHED_ROOM_LIMITS).furnished)


def names_asked(prompt: Prompt) -> dict[str, str]:
    """Object id -> the name that its def is to have, as the prompt says."""
    return {m[1]: m[2] for m in re.finditer(r"^\d+, (\w+),.*name the def (\w+)$", prompt.text, re.MULTILINE)}


def programs(prompt: Prompt) -> dict[str, Any]:
    objects = [{"id": i, "program": PLAIN.format(name=name), "keep": False} for i, name in names_asked(prompt).items()]
    return {"objects": objects}


def test_everything_is_modelled_and_the_ledger_says_so(run: Run) -> None:
    run.run_all(STAGES)
    program, geometry = run.memory.latest(LayoutProgram), run.memory.latest(Geometry)
    assert program is not None and geometry is not None
    placed = {p.id for p in parse_layout(program.text).proxies}
    assert set(furnished(run)) == placed
    assert {e.state for e in program.ledger} == {"detailed"} and len(program.ledger) == len(placed)
    assert {o.source for o in geometry.objects} == {"library"}
    assert [run.status(s) for s in STAGES] == ["done"] * 6


def test_poses_are_exactly_those_of_the_layout(run: Run) -> None:
    run.run_all(STAGES)
    before, after = run.memory.latest(LayoutProgram, ("s04_auxiliary",)), run.memory.latest(LayoutProgram)
    assert before is not None and after is not None
    assert parse_layout(before.text) == parse_layout(after.text)


def test_a_model_that_answers_nothing_usable_costs_nothing(run: Run, answers: Any) -> None:
    answers.by_key |= {"05_descriptions": "Sorry.", "06_pieces": "I cannot."}
    run.run_all(STAGES)
    descriptions = run.memory.latest(Descriptions)
    assert descriptions is not None and "no usable answer" in descriptions.findings[-1].message
    assert {e.state for e in run.memory.latest(LayoutProgram).ledger} == {"detailed"}  # type: ignore[union-attr]


def test_answers_that_were_never_recorded_leave_the_library(run: Run, answers: Any) -> None:
    def missing(prompt: Prompt) -> Any:
        raise NotRecordedError("No answer is recorded.")

    run.memory.settings["objects"] = "programs"
    answers.by_key |= {"05_descriptions": missing, "06_programs": missing}
    run.run_all(STAGES)
    assert {o.source for o in run.memory.latest(Geometry).objects} == {"library"}  # type: ignore[union-attr]


def test_a_service_that_fails_ends_the_stage_and_keeps_the_room(run: Run, answers: Any) -> None:
    def down(prompt: Prompt) -> Any:
        raise ModelError("The service is down.")

    run.run_all(STAGES[:5])
    standing = run.backend.program_text()
    answers.by_key |= {"06_pieces": down}
    with pytest.raises(ModelError):
        run.run_stage(GEOMETRY)
    assert run.status(GEOMETRY) == "not run" and run.backend.program_text() == standing


def test_words_and_the_rooms_style_are_kept_beside_the_measured_colours(run: Run, answers: Any) -> None:
    def described(prompt: Prompt) -> dict[str, Any]:
        ids = re.findall(r"^\d+, (\w+),", prompt.text, re.MULTILINE)
        words = {
            "colour": "blue " * 90,
            "main_colour": "#1020ff",
            "material": "oak",
            "function": "",
            "structure": "",
            "style": "",
        }
        return {"room_style": "nordic", "objects": [{"id": i, **words} for i in [*ids, "nobody"]]}

    answers.by_key |= {"05_descriptions": described}
    run.run_all(STAGES[:5])
    found, style = run.memory.latest(Descriptions), run.memory.latest(RoomStyle)
    assert found is not None and style is not None and style.style == "nordic"
    assert all(o.material == "oak" and o.code == "1020FF" and len(o.colour) <= 160 for o in found.objects)
    assert "nobody" not in {o.id for o in found.objects}
    asked = [p for p in answers.asked if p.key.startswith("05_")]
    assert len(asked) == -(-len(found.objects) // 8) and all(len(p.images) <= 9 for p in asked)


def test_a_model_chooses_pieces_and_its_bad_choices_are_left_out(run: Run, answers: Any) -> None:
    def chosen(prompt: Prompt) -> dict[str, Any]:
        lines = re.findall(r"^\d+, (\w+), ([\w ]+)", prompt.text, re.MULTILINE)
        objects = [
            {"id": i, "piece": "stool" if c == "chair" else "atlantis", "parameters": [], "colours": []}
            for i, c in lines
        ]
        return {"objects": objects}

    answers.by_key |= {"06_pieces": chosen}
    run.run_all(STAGES)
    geometry = run.memory.latest(Geometry)
    assert geometry is not None
    assert "atlantis" in " ".join(f.message for f in geometry.findings)
    assert {o.source for o in geometry.objects} == {"library"} and "atlantis" not in {o.piece for o in geometry.objects}
    assert sum(p.key.startswith("06_") for p in answers.asked) == 1


def test_programs_are_written_seen_and_mended_once(run: Run, answers: Any) -> None:
    def mended(prompt: Prompt) -> dict[str, Any]:
        ids = re.findall(r"^(\w+), box ", prompt.text, re.MULTILINE)
        names = re.findall(r"^def (\w+)\(size\):$", prompt.text.split("Programs, with their boxes")[1], re.MULTILINE)
        better = [PLAIN.format(name=n).replace("112233", "445566") for n in names]
        return {"objects": [{"id": i, "program": p, "keep": False} for i, p in zip(ids, better, strict=True)]}

    run.memory.settings["objects"] = "programs"
    answers.by_key |= {"06_programs": programs, "06_correct": mended}
    run.run_all(STAGES)
    geometry = run.memory.latest(Geometry)
    assert geometry is not None and {o.source for o in geometry.objects} == {"program"}
    assert {s.material for shapes in furnished(run).values() for s in shapes} == {"wood #445566", "steel"}
    keys = [p.key for p in answers.asked if p.key.startswith("06_")]
    assert len(keys) == len(set(keys)) and sum(k.startswith("06_correct") for k in keys) == len(keys) / 2


def test_one_broken_program_stops_no_other(run: Run, answers: Any) -> None:
    def one_broken(prompt: Prompt) -> dict[str, Any]:
        reply = programs(prompt)
        broken = {"closet": "def closet(size):\n    return [sphere(1) for i in range(10 ** 9)]", "rug": "import os"}
        for item in reply["objects"]:
            item["program"] = broken.get(item["id"], item["program"])
        return reply

    run.memory.settings["objects"] = "programs"
    answers.by_key |= {"06_programs": one_broken}
    run.run_all(STAGES)
    geometry = run.memory.latest(Geometry)
    assert geometry is not None
    sources = {o.id: o.source for o in geometry.objects}
    assert sources["closet"] == sources["rug"] == "library" and set(sources.values()) == {"library", "program"}
    assert "could not be used" in geometry.of("closet").note  # type: ignore[union-attr]
    assert {e.state for e in run.memory.latest(LayoutProgram).ledger} == {"detailed"}  # type: ignore[union-attr]


def test_a_worse_correction_is_not_taken(run: Run, answers: Any) -> None:
    def worse(prompt: Prompt) -> dict[str, Any]:
        ids = re.findall(r"^(\w+), box ", prompt.text, re.MULTILINE)
        return {
            "objects": [
                {"id": i, "program": f"def {i}(size):\n    return box((0.9, 0.9, 0.9))", "keep": False} for i in ids
            ]
        }

    run.memory.settings["objects"] = "programs"
    answers.by_key |= {"06_programs": programs, "06_correct": worse}
    run.run_all(STAGES)
    assert {s.material for shapes in furnished(run).values() for s in shapes} == {"wood #112233", "steel"}


def test_only_the_chosen_are_modelled_anew(run: Run) -> None:
    run.run_all(STAGES)
    before = furnished(run)
    run.memory.settings["objects"] = "programs"
    run.client.by_key |= {"06_programs": programs}  # type: ignore[attr-defined]
    session = StageSession(run, GEOMETRY, only=frozenset({"bed"}))
    while not session.finished:
        session.step()
    after = furnished(run)
    assert {s.material for s in after["bed"]} == {"wood #112233", "steel"}
    assert all(after[i][0] is before[i][0] for i in before if i != "bed"), "the others are the very same shapes"


def own_function(run: Run, name: str) -> str:
    """What the artist does: the object's function edited in the text."""
    text = run.backend.program_text()
    statement = next(line for line in text.splitlines() if line.startswith(f'furnish("{name}"'))
    mine = PLAIN.format(name="mine").replace("112233", "ABCDEF")
    return text.replace(statement, f'{mine}\n\nfurnish("{name}", mine)')


def test_a_function_that_the_artist_edited_stays(run: Run) -> None:
    run.run_all(STAGES)
    edited = own_function(run, "bed")
    assert note_own_functions(run.memory, edited) == ["bed"]
    run.backend.build(edited)
    run.run_stage(STAGES[3])
    run.run_stage(GEOMETRY)
    assert "wood #ABCDEF" in {s.material for s in furnished(run)["bed"]}
    assert run.memory.latest(Geometry).of("bed").source == "artist"  # type: ignore[union-attr]
    forget_own(run.memory, {"bed"})
    run.run_stage(GEOMETRY)
    assert "wood #ABCDEF" not in {s.material for s in furnished(run)["bed"]}


def test_a_text_that_was_not_edited_is_nobodys_own(run: Run) -> None:
    run.run_all(STAGES)
    assert note_own_functions(run.memory, run.backend.program_text() + "\n# a remark\n") == []
    assert run.memory.latest(OwnModelling) is None


def test_boxes_and_back(run: Run) -> None:
    run.run_all(STAGES)
    whole = furnished(run)
    assert show_as_boxes(run, {"bed", "nobody"}, True) == 1
    assert set(whole) - set(furnished(run)) == {"bed"}
    assert run.status(GEOMETRY) == "done"
    run.run_stage(GEOMETRY)
    assert "bed" not in furnished(run), "the stage leaves it a box"
    forget_own(run.memory, set())
    run.run_stage(GEOMETRY)
    show_as_boxes(run, {"rug"}, True)
    assert show_as_boxes(run, {"rug"}, False) == 1
    assert "rug" in furnished(run)


def test_what_was_moved_and_resized_by_hand_stays_and_is_modelled_in_its_size(run: Run, scene: Any) -> None:
    run.run_all(STAGES[:4])
    scene.edits = [
        LayoutEdit(op="resize", id="closet", size=(2.0, 0.6, 2.2), centre=(0.123456, 0.3, 1.1), origin="artist"),
        LayoutEdit(op="rename", id="rug", new_id="carpet", origin="artist"),
    ]
    run.run_stage(DESCRIPTIONS)
    run.run_stage(GEOMETRY)
    line = parse_layout(run.backend.program_text()).proxy("closet")
    assert line is not None and line.size == (2.0, 0.6, 2.2)
    points = [s.vertices for s in furnished(run)["closet"]]
    assert abs(max(p[:, 0].max() for p in points) - 1.0) < 0.002
    assert "carpet" in furnished(run) and "rug" not in furnished(run)


def test_a_known_length_keeps_the_geometry_done_and_scales_it(run: Run) -> None:
    from code_as_room.pipeline.run_corrections import bring_up_to_date

    run.run_all(STAGES)
    before = {i: max(s.vertices[:, 2].max() for s in shapes) for i, shapes in furnished(run).items()}
    run.memory.settings["known_width_m"] = "6.9"
    bring_up_to_date(run)
    assert run.status(GEOMETRY) == "done"
    after = {i: max(s.vertices[:, 2].max() for s in shapes) for i, shapes in furnished(run).items()}
    assert all(abs(after[i] / before[i] - 6.9 / 4.6) < 0.02 for i in before)


def test_a_room_of_forty_objects_asks_within_the_budget(run: Run, answers: Any) -> None:
    first = answers.by_key["01_analysis"]
    chairs = []
    for n in range(30):
        size = (0.2 + 0.015 * n, 0.3, 0.5)
        at = {"x_m": -2.0 + 0.14 * n, "y_m": -1.5}
        base = json.loads(json.dumps(first["objects"][0]))
        chairs.append({**base, "id": f"thing_{n}", "category": "cabinet", "parent": None, "centre_m": at, "base_m": 0,
                       "placement": "surface" if n % 3 else "floor", "salience": "minor",
                       "size_m": dict(zip(("width", "depth", "height"), size, strict=True))})  # fmt: skip
    answers.by_key |= {"01_analysis": {**first, "objects": [*first["objects"], *chairs]}, "06_programs": programs}
    run.memory.settings["objects"] = "programs"
    reports = {r.stage: r for r in run.run_all(STAGES)}
    mine = [reports[s.id] for s in (DESCRIPTIONS, GEOMETRY)]
    assert sum(r.calls for r in mine) <= 17, "three are left for the small objects"
    assert sum(r.prompt_bytes for r in mine) <= 230_000


def test_rows_of_books_are_written_once_and_none_is_like_another(run: Run, answers: Any) -> None:
    first = answers.by_key["01_analysis"]
    rows = []
    for n in range(3):
        base = json.loads(json.dumps(first["objects"][0]))
        rows.append({**base, "id": f"row_{n}", "category": "books", "parent": None, "base_m": 0, "placement": "floor",
                     "centre_m": {"x_m": -1.5 + n, "y_m": -1.5}, "salience": "minor",
                     "size_m": {"width": 0.8, "depth": 0.2, "height": 0.25}})  # fmt: skip
    row = """def {name}(size, seed=1):
    w, d, h = size
    low = rand((seed, 1), 0.6, 0.9)
    return [part("tall", box((w / 2, d, h), at=(-w / 4, 0, h / 2)), material="paper"),
            part("low", box((w / 2, d, low * h), at=(w / 4, 0, low * h / 2)), material="paper")]
"""

    def written(prompt: Prompt) -> dict[str, Any]:
        found = programs(prompt)
        asked = re.findall(
            r"^\d+, (row_\d),.*it makes 3 such rows, so def (\w+)\(size, seed=1\)", prompt.text, re.MULTILINE
        )
        found["objects"] += [{"id": i, "program": row.format(name=name), "keep": False} for i, name in asked]
        return found

    answers.by_key |= {"01_analysis": {**first, "objects": [*first["objects"], *rows]}, "06_programs": written}
    run.memory.settings["objects"] = "programs"
    run.run_all(STAGES)
    listed = [re.findall(r"^\d+, (row_\d),", p.text, re.MULTILINE) for p in answers.asked if p.key.startswith("06_pro")]
    assert sum(len(ids) for ids in listed) == 1
    geometry, made = run.memory.latest(Geometry), furnished(run)
    assert geometry is not None
    assert {o.source for o in geometry.objects if o.id.startswith("row_")} == {"program"}
    assert len({round(float(made[f"row_{n}"][1].vertices[:, 2].max()), 4) for n in range(3)}) == 3
    text = run.memory.latest(LayoutProgram).text  # type: ignore[union-attr]
    assert text.count("low = rand(") == 1


@pytest.mark.parametrize(
    ("client", "way"),
    [
        ("builtin", "library"),
        ("openai:gpt-5", "programs"),
        ("openai:gpt-5-mini", "library"),
        ("anthropic:claude-opus-4", "programs"),
        ("gemini:gemini-2.5-flash", "library"),
        ("openai:qwen3-vl-8b-instruct", "library"),
        ("ollama:llava", "library"),
        ("recorded:1234", "programs"),
    ],
)
def test_strong_models_write_and_weak_ones_choose(client: str, way: str) -> None:
    assert modelling_of(client) == way


def test_laying_out_again_keeps_the_furniture(run: Run) -> None:
    run.run_all(STAGES)
    before = furnished(run)
    major = {p.id for p in parse_layout(run.memory.latest(LayoutProgram, ("s03_layout",)).text).proxies}  # type: ignore[union-attr]
    small = set(before) - major
    assert major and small
    run.run_stage(next(s for s in STAGES if s.id == "s03_layout"))
    assert set(furnished(run)) == major
    run.run_stage(next(s for s in STAGES if s.id == "s04_auxiliary"))
    assert set(furnished(run)) == set(before)
    assert run.backend.program_text() == run.memory.latest(LayoutProgram).text  # type: ignore[union-attr]


def test_a_thing_that_became_another_is_a_box_until_it_is_modelled(run: Run, answers: Any) -> None:
    run.run_all(STAGES)
    text = run.memory.latest(LayoutProgram).text  # type: ignore[union-attr]
    layout = parse_layout(text)
    changed = layout.proxies[0].model_copy(update={"category": "harp"})
    new = layout.model_copy(update={"proxies": [changed, *layout.proxies[1:]]})
    view = run.view(next(s for s in STAGES if s.id == "s04_auxiliary"))
    kept = carrying.furnished(view, new)
    assert f'furnish("{changed.id}"' not in kept and f'furnish("{layout.proxies[1].id}"' in kept
    assert parse_layout(kept) == new
