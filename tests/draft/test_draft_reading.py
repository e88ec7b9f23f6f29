# SPDX-License-Identifier: GPL-3.0-or-later
"""Each statement of a draft is judged alone, and what is plainly meant is taken."""

from __future__ import annotations

import pytest
from code_as_room.pipeline.draft.prompt import EXAMPLE
from code_as_room.pipeline.draft.text import room_text
from code_as_room.pipeline.program.evaluate import evaluate
from code_as_room.pipeline.program.limits import FINISHED_ROOM_LIMITS

from .drafts import ROOM, TABLE, read_text


def test_the_prompts_own_example_is_a_draft_without_a_fault() -> None:
    draft = read_text(EXAMPLE)
    assert [s for s in draft.statements if s.verdict != "ok"] == []
    assert set(draft.made) == {"armchair_1", "side_table_1", "mug_1", "pouf_1", "pouf_2"}
    assert all(made.written.checked.penalty < 0.1 for made in draft.made.values())
    record = evaluate(room_text(draft), FINISHED_ROOM_LIMITS)
    assert record.built and set(record.furnished) == set(draft.made)
    assert {"floor", "walls", "armchair_1", "pouf_2"} <= set(record.finishes)


def test_a_twin_is_made_by_the_same_def_and_a_coloured_one_by_its_own() -> None:
    twins = (
        "proxy('table_2', 'table', at=(1, 1, 0), size=(1, 0.8, 0.7), like='table_1')\n"
        "proxy('table_3', 'table', at=(-1, 1, 0), size=(1, 0.8, 0.7), like='table_1', colors={'wood': '#223344'})\n"
    )
    draft = read_text(ROOM + TABLE + twins + "build()\n")
    text = room_text(draft)
    assert 'furnish("table_2", table_1)' in text and 'furnish("table_3", table_3)' in text
    record = evaluate(text, FINISHED_ROOM_LIMITS)
    assert {s.material for s in record.furnished["table_3"]} == {"wood #223344"}
    assert {s.material for s in record.furnished["table_2"]} == {"wood #A87C52"}


def test_what_stands_on_a_rug_stands_on_the_floor_and_what_lies_on_a_table_does_not() -> None:
    lines = (
        "proxy('rug_1', 'rug', at=(1, 0, 0), size=(2, 1.4, 0.02))\n"
        "proxy('chair_1', 'armchair', at=(1, 0, 0.02), size=(0.7, 0.7, 0.9), placement='surface', parent='rug_1')\n"
        "proxy('ball_1', 'ball', at=(1.5, 0.5, 0.02), size=(0.2, 0.2, 0.2), placement='surface', parent='rug_1')\n"
        "proxy('cup_1', 'cup', at=(0, 0, 0.7), size=(0.1, 0.1, 0.1), placement='surface', parent='table_1')\n"
    )
    things = read_text(ROOM + TABLE + lines + "build()\n").things
    chair, ball, cup = (things[name] for name in ("chair_1", "ball_1", "cup_1"))
    assert (chair.placement, chair.parent, chair.at[2], chair.salience) == ("floor", None, 0.0, "major")
    assert (ball.placement, ball.salience) == ("floor", "minor")
    assert (cup.placement, cup.parent) == ("surface", "table_1")


def test_looks_in_parts_become_materials_that_find_their_look_again() -> None:
    text = (
        ROOM
        + "oak = wood('#A87C52', figure=0.9)\nash = wood('#A87C52', figure=0.1)\n"
        + TABLE.replace(
            "part('top', box((w, d, 0.03), at=(0, 0, h - 0.015)), material='wood #A87C52')",
            "part('top', box((w, d, 0.03), at=(0, 0, h - 0.015)), material=oak)",
        ).replace("material='wood #A87C52'", "material=ash")
    )
    draft = read_text(text + "build()\n")
    found = {s.part: draft.palette.roles[s.material] for s in draft.made["table_1"].written.shapes}
    assert "0.9" in found["top"] and "0.1" in found["leg"]
    assert "oak = wood(" in room_text(draft)


def test_helpers_and_numbers_are_shared_and_stand_once() -> None:
    helper = "thick = 0.03\ndef leg(x, y, h):\n    return box((thick, thick, h), at=(x, y, h / 2))\n"
    thing = (
        "proxy('{0}', 'stool', at=({1}, 0, 0), size=(0.4, 0.4, 0.5))\n"
        "def {0}(size):\n    w, d, h = size\n"
        "    legs = [leg(s * 0.185, t * 0.185, h - 0.02) for s in (-1, 1) for t in (-1, 1)]\n"
        "    seat = box((w, d, 0.03), at=(0, 0, h - 0.015))\n"
        "    return [part('leg', legs, material='metal'), part('seat', seat, material='wood #8A5A3C')]\n"
    )
    draft = read_text(ROOM + helper + thing.format("stool_a", 0.5) + thing.format("stool_b", -0.5) + "build()\n")
    assert [s.verdict for s in draft.statements] == ["ok"] * 8
    text = room_text(draft)
    assert text.count("def shared_leg(") == 1 and "thick" not in text.replace("thickness", "")


@pytest.mark.parametrize(
    ("line", "verdict"),
    [
        ("proxy('a', 'chair', centre=(1, 0.5, 0.4), size=(0.4, 0.4, 0.8))", "ok"),
        ("proxy('a', 'chair', at=(1, 0.5), size=(0.4, 0.4, 0.8))", "ok"),
        ("for k in range(1):\n    proxy('a', 'chair', at=(1 + k, 0.5, 0), size=(0.4, 0.4, 0.8))", "mended"),
        ("proxy('a', 'chair', at=(2 / 2, 0.5, 0), size=(0.4, 0.4, 0.8), wobble=3)", "mended"),
        ("proxy('a', 'chair', at=(1, 0.5, 0), size=(0.4, 0.4, 0.8)),", "ok"),
        ("proxy('a', 'chair', at=(1, 0.5, 0), size=('x', 1, 2))", "refused"),
        ("proxy('a', 'chair', at=(1, 0.5, 0), size=(0.4, 0.4, 1e999))", "refused"),
        ("proxy('a', 'chair')", "refused"),
        ("import math", "mended"),
        ("chair.location = (0, 0, 0)", "refused"),
        ("open('/etc/passwd')", "refused"),
        ("finish('nothing', wood('#AA8866'))", "refused"),
        ("finish('floor', 3)", "refused"),
        ("furnish('ghost', table_1)", "refused"),
        ("__import__('os').system('x')", "refused"),
    ],
)
def test_lines_as_models_write_them(line: str, verdict: str) -> None:
    draft = read_text(f"{ROOM}{line}\nbuild()\n")
    found = [s for s in draft.statements if s.kind not in ("room", "build")]
    assert [s.verdict for s in found] == [verdict], found
    if verdict in ("ok", "mended") and "'a'" in line:
        assert draft.things["a"].at == (1.0, 0.5, 0.0)
    assert bool(found[0].sentence) == (verdict != "ok")
    evaluate(room_text(draft), FINISHED_ROOM_LIMITS)


def test_a_def_in_other_peoples_python_is_mended_and_a_useless_one_gives_way_to_the_library() -> None:
    python = (
        TABLE.replace("w, d, h = size\n", "w, d, h = size\n    parts = []\n")
        .replace("return [part('top'", "parts.append(part('top'")
        .replace(
            "), part('leg', legs, material='wood #A87C52')]",
            "))\n    parts.append(part('leg', legs, material='wood #A87C52'))\n    return parts",
        )
    )
    draft = read_text(ROOM + python + "build()\n")
    assert next(s for s in draft.statements if s.kind == "def").verdict == "mended"
    broken = TABLE.replace("box((w, d, 0.03)", "boxes((w, d, 0.03)")
    draft = read_text(ROOM + broken + "build()\n")
    told = next(s for s in draft.statements if s.kind == "def")
    assert told.verdict.startswith("replaced by ") and "boxes" in told.sentence
    assert draft.refused_programs()[0][0] == "table_1"
    assert "table_1" in evaluate(room_text(draft), FINISHED_ROOM_LIMITS).furnished


def test_what_is_asked_again_takes_the_place_of_what_was_refused() -> None:
    from code_as_room.pipeline.draft.reading import read
    from code_as_room.pipeline.draft.statements import split

    broken = TABLE.replace("box((w, d, 0.03)", "boxes((w, d, 0.03)")
    written = split(ROOM + broken + "build()\n").statements
    again = split("```python\n" + TABLE.split("\n", 1)[1] + "```").statements
    draft = read(written, again)
    told = next(s for s in draft.statements if s.kind == "def")
    assert told.verdict == "mended" and "again" in told.sentence and "table_1" in draft.made
    assert draft.refused_programs() == []


def test_doubles_unknown_parents_and_circles_cost_nothing() -> None:
    text = (
        ROOM
        + TABLE
        + "proxy('table_1', 'table', at=(0, 0, 0), size=(1.2, 0.8, 0.7))\n"
        + "proxy('table_1', 'table', at=(1, 1, 0), size=(0.6, 0.6, 0.5))\n"
        + "proxy('a', 'vase', at=(0, 0, 0.7), size=(0.1, 0.1, 0.2), placement='surface', parent='b')\n"
        + "proxy('b', 'vase', at=(0, 0, 0.9), size=(0.1, 0.1, 0.2), placement='surface', parent='a')\n"
        + "proxy('c', 'vase', at=(0.2, 0, 0.7), size=(0.1, 0.1, 0.2), parent='nowhere')\n"
        + ROOM
    )
    draft = read_text(text)
    assert [s.verdict for s in draft.statements if s.kind == "room"] == ["ok", "refused"]
    assert set(draft.things) == {"table_1", "table_1_2", "a", "b", "c"}
    record = evaluate(room_text(draft), FINISHED_ROOM_LIMITS)
    assert len(record.proxies) == 5 and not draft.ended


def test_a_room_line_that_is_missing_is_made_of_the_walls_or_of_the_things() -> None:
    walls = "".join(
        f"wall('w{n}', {a}, {b}, height=2.7)\n"
        for n, (a, b) in enumerate([((-3, -2), (3, -2)), ((3, -2), (3, 2)), ((3, 2), (-3, 2)), ((-3, 2), (-3, -2))])
    )
    record = evaluate(room_text(read_text(walls + TABLE)), FINISHED_ROOM_LIMITS)
    assert record.room is not None and record.room["size"] == (6, 4, 2.7)
    record = evaluate(room_text(read_text(TABLE)), FINISHED_ROOM_LIMITS)
    assert record.room is not None and record.room["size"][0] > 1.2
    assert room_text(read_text("Sorry, I cannot see a room.")) == ""
