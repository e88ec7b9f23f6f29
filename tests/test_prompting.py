# SPDX-License-Identifier: GPL-3.0-or-later
"""Prompt templates and hashes."""

from pathlib import Path

import code_as_room.prompts
import pytest
from code_as_room.pipeline.errors import RoomError
from code_as_room.pipeline.prompting import PROMPT_LIMIT, fill_template, load_template, prompt_hash, repair_prompt
from hypothesis import given
from hypothesis import strategies as st

TEMPLATES = sorted(path.stem for path in Path(next(iter(code_as_room.prompts.__path__))).glob("*.md"))


@pytest.mark.parametrize("name", TEMPLATES)
def test_every_template_loads_and_is_well_formed(name):
    text = load_template(name)
    assert text.strip() and not text.startswith("<!--")
    assert text.count("{{") == text.count("}}")
    assert len(text.encode()) < PROMPT_LIMIT / 2


@pytest.mark.parametrize("name", ["no_such_prompt", "../pyproject", "", "a/b", "01_analysis.md"])
def test_a_missing_template_is_a_plain_error(name):
    with pytest.raises(RoomError):
        load_template(name)


def test_places_are_filled_once():
    assert fill_template("{{a}} and {{ b_2 }}, {{a}}", {"a": "{{b_2}}", "b_2": r"\1"}) == r"{{b_2}} and \1, {{b_2}}"


@pytest.mark.parametrize("values", [{}, {"a": "1", "b": "2"}, {"b": "2"}])
def test_missing_and_unused_values_are_errors(values):
    with pytest.raises(RoomError):
        fill_template("{{a}}", values)


parts = st.tuples(st.text(max_size=9), st.lists(st.binary(max_size=9), max_size=3), st.text(max_size=9))


@given(parts, parts)
def test_different_prompts_have_different_hashes(one, other):
    assert (prompt_hash(*one) == prompt_hash(*other)) == (one == other)


def test_a_repair_prompt_quotes_the_problems_and_what_fits_of_the_answer(a_request_prompt):
    prompt = repair_prompt(a_request_prompt, ["objects[3].size: too short", "score: missing"], '{"score": "ü"}')
    assert prompt.repair and prompt.hash != a_request_prompt.hash
    assert prompt.text.startswith(a_request_prompt.text)
    assert "- objects[3].size: too short\n- score: missing" in prompt.text and '{"score": "ü"}' in prompt.text
    long = repair_prompt(a_request_prompt, ["x"], "ü" * 100_000)
    assert len(long.text.encode()) <= PROMPT_LIMIT and "its beginning" in long.text


@pytest.fixture
def a_request_prompt():
    from code_as_room.pipeline.models.base import Prompt

    return Prompt("s01", "k", "Look at the room.", (), "Answer", {}, prompt_hash("Look at the room.", (), "Answer"))
