# SPDX-License-Identifier: GPL-3.0-or-later
"""Statements are found in what a model writes, whole or still on its way."""

from __future__ import annotations

import json

import pytest
from code_as_room.pipeline.draft.prompt import EXAMPLE
from code_as_room.pipeline.draft.statements import split

from .drafts import ROOM, TABLE


def texts(text: str, whole: bool = True) -> list[str]:
    return [s.text.split("(")[0].split(" =")[0] for s in split(text, whole).statements]


def test_a_room_comes_out_the_same_however_it_is_wrapped() -> None:
    plain = texts(EXAMPLE)
    assert len(plain) == 18
    indented = "\n".join(f"    {row}" for row in EXAMPLE.split("\n"))
    wrapped = [
        f"```python\n{EXAMPLE}```",
        f"Here is the room (all of it):\n\n```\n{EXAMPLE}```\nI hope it fits (mostly).",
        f"~~~py\n{EXAMPLE}",
        EXAMPLE.replace("\n", "\r\n"),
        f"```python\n{indented}\n```",
        json.dumps({"program": EXAMPLE}),
        EXAMPLE[: len(EXAMPLE) // 2].rpartition("\nproxy")[0]
        + "\n"
        + "proxy"
        + EXAMPLE.partition(EXAMPLE[: len(EXAMPLE) // 2].rpartition("\nproxy")[0] + "\nproxy")[2],
    ]
    for text in wrapped:
        assert texts(text) == plain, text[:60]
    assert split(wrapped[1]).style.startswith("calm Scandinavian")


def test_a_program_in_two_blocks_is_one_program() -> None:
    text = f"First the room:\n```python\n{ROOM}```\nThen a table:\n```python\n{TABLE}build()\n```"
    assert texts(text) == ["room", "proxy", "def table_1", "build"]


@pytest.mark.parametrize("step", [1, 7, 40])
def test_what_is_complete_stays_so_while_more_is_written(step: int) -> None:
    text = f"Sure.\n```python\n{ROOM}{TABLE}build()\n```\n"
    before: list[str] = []
    for end in range(0, len(text) + step, step):
        now = [s.text for s in split(text[:end], whole=False).statements]
        assert now[: len(before)] == before
        before = now
    assert [b.split("(")[0] for b in before] == ["room", "proxy", "def table_1", "build"]


def test_a_line_is_complete_with_its_last_bracket_and_a_def_with_what_follows() -> None:
    proxy, body = TABLE.split("\n", 1)
    assert texts(f"```python\n{ROOM}{proxy}", False) == ["room"]
    assert texts(f"```python\n{ROOM}{proxy}\n", False) == ["room", "proxy"]
    assert texts(f"```python\n{ROOM}{proxy}\n{body}", False) == ["room", "proxy"]
    assert texts(f"```python\n{ROOM}{proxy}\n{body}build()", False) == ["room", "proxy", "def table_1"]


def test_a_bracket_that_is_never_closed_costs_one_statement() -> None:
    text = "proxy('a', 'chair', at=(0, 0, 0), size=(1, 1\nproxy('b', 'chair', at=(1, 0, 0), size=(1, 1, 1))\nbuild()\n"
    assert [s.text[:9] for s in split(text).statements] == ["proxy('a'", "proxy('b'", "build()"]


def test_arguments_at_the_left_margin_belong_to_their_call() -> None:
    text = "proxy('a', 'chair',\nat=(0, 0, 0),\nsize=(1, 1, 1),\n)\nbuild()\n"
    assert texts(text) == ["proxy", "build"]


def test_an_answer_that_was_cut_says_so() -> None:
    (first, last) = split(f"```python\n{ROOM}proxy('a', 'chair', at=(0, 0").statements
    assert not first.cut and last.cut
