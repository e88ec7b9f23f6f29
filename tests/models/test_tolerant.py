# SPDX-License-Identifier: GPL-3.0-or-later
"""Reading the JSON in a model's answer."""

import contextlib
import json
import math

import pytest
from code_as_room.pipeline.errors import CutReplyError, ReplyError
from code_as_room.pipeline.models.tolerant import MAX_CHARACTERS, MAX_DEPTH, read_json, read_json_noted
from hypothesis import given
from hypothesis import strategies as st

READABLE = {
    '{"a": 1}': {"a": 1},
    '\ufeff {"a": 1}\n': {"a": 1},
    '```json\n{"a": 1}\n```': {"a": 1},
    "```\n[1, 2]\n```": [1, 2],
    'Here it is:\n```json\n{"a": {"b": 2}}\n```\nI hope {this} helps [1].': {"a": {"b": 2}},
    'The bed\'s [left] side. {"a": 1, "b": [2, 3]} Done.': {"a": 1, "b": [2, 3]},
    '{"a": "</think>", "b": 1}': {"a": "</think>", "b": 1},
    '<think>maybe {"a": 9, "b": 9, "c": 9}?</think>{"a": 1}': {"a": 1},
    '{"a": 1, "b": [1, 2,],}': {"a": 1, "b": [1, 2]},
    '{"a": 1, // one\n /* two */ "b": 2}': {"a": 1, "b": 2},
    '{"url": "http://x/*y*/", "a": 1,}': {"url": "http://x/*y*/", "a": 1},
    "{'a': True, 'b': None, 'it': \"don't\"}": {"a": True, "b": None, "it": "don't"},
    "{a: 1, b_2: .5, c: +3, d: -1., e: 1e3}": {"a": 1, "b_2": 0.5, "c": 3, "d": -1.0, "e": 1000.0},
    "{“a”: “b”, “c”: 1}": {"a": "b", "c": 1},
    '{"a": "say “hi”"}': {"a": "say “hi”"},
    '{"a": "line\nbreak"}': {"a": "line\nbreak"},
    '{"a": NaN, "b": -Infinity, "c": 1e999, "d": Infinity}': {"a": None, "b": None, "c": None, "d": None},
    '{"a": 1, "a": 2}': {"a": 2},
    '{"a": "\\ud83d\\ude00 \\ud800"}': {"a": "😀 \ufffd"},
    '{"a": ' + "9" * 5000 + "}": {"a": None},
    'As asked, in the form {"id": ...}: {"id": "bed", "size": [1, 2, 3]}': {"id": "bed", "size": [1, 2, 3]},
    'First {"a": 1, "b": 2}. Wait, better: {"a": 3, "b": 4}': {"a": 3, "b": 4},
}

CUT = [
    '{"a": 1',
    '{"a": [1, 2',
    '{"a": "x',
    '{"a": "x\\',
    '{"a": "\\u00',
    '{"objects": [{"id": "bed"}, {"id": "so',
    "[1, 2,",
    '{"a":',
    '{"a": tru',
    "[-",
    'Sure, here it is:\n```json\n{"objects": [{"id": "bed"}, ',
    '{"a": 1, /* and',
]

UNREADABLE = [
    "",
    "   ",
    "I cannot see a room in this picture.",
    "{a}",
    '[{"a": 1} {"b": 2}]',
    '{"a" 1, "objects": [{"id": "bed", "size": [1, 2, 3]}]}',
    '{"objects": [{"id": "bed"}, ...]}',
    '{"a": 1 "b": 2}',
]


@pytest.mark.parametrize("text", READABLE)
def test_what_is_safe_to_forgive_is_read(text):
    assert read_json(text) == READABLE[text]


@pytest.mark.parametrize("text", CUT)
def test_a_cut_tail_is_an_error_of_its_own_kind(text):
    with pytest.raises(CutReplyError):
        read_json(text)


@pytest.mark.parametrize("text", UNREADABLE)
def test_what_cannot_be_read_is_refused_and_never_read_in_part(text):
    with pytest.raises(ReplyError) as caught:
        read_json(text)
    assert not isinstance(caught.value, CutReplyError)
    assert caught.value.problems


def test_what_was_forgiven_is_reported():
    _, notes = read_json_noted('{"a": NaN,} and {"b": 2}')
    assert any("tolerantly" in note for note in notes)
    assert any("2 JSON values" in note for note in notes)
    assert read_json_noted('{"a": 1}')[1] == ()


def test_the_place_of_the_mistake_is_named():
    with pytest.raises(ReplyError) as caught:
        read_json('{"a": 1,\n "b" 2}')
    assert "line 2" in caught.value.problems[0]


@pytest.mark.parametrize("opening, closing", [("[", "]"), ('{"a":', "}")])
@pytest.mark.parametrize("levels", [MAX_DEPTH + 1, 200_000])
def test_deep_nesting_is_refused(opening, closing, levels):
    with pytest.raises(ReplyError):
        read_json(opening * levels + "1" + closing * levels)
    with pytest.raises(ReplyError):
        read_json(opening * levels + "1," + closing * levels)


def test_the_allowed_depth_is_read():
    value = read_json("[" * MAX_DEPTH + "]" * MAX_DEPTH)
    assert isinstance(value, list)


@pytest.mark.parametrize(
    "text", ["x" * (MAX_CHARACTERS + 1), "{" * 300_000, "{a}" * 50_000, "[1 " * 100_000, "/*" * 99_999]
)
def test_hostile_texts_end_in_an_error(text):
    with pytest.raises(ReplyError):
        read_json(text)


json_values = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats(allow_nan=False, allow_infinity=False) | st.text(),
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(st.text(max_size=8), inner, max_size=4),
    max_leaves=20,
)


def _with_bounded_numbers(value):
    """What reading makes of numbers beyond a float's useful range and of lone surrogates."""
    if isinstance(value, dict):
        return {key: _with_bounded_numbers(item) for key, item in value.items()}
    if isinstance(value, list):
        return [_with_bounded_numbers(item) for item in value]
    if isinstance(value, (int, float)) and not isinstance(value, bool) and abs(value) > 1e300:
        return None
    return value


@given(json_values)
def test_strict_json_is_read_as_it_is(value):
    assert read_json(json.dumps(value)) == _with_bounded_numbers(value)


@given(st.dictionaries(st.text(max_size=8), json_values, max_size=4))
def test_objects_in_fences_and_prose_are_read(value):
    fenced = f"Certainly!\n```json\n{json.dumps(value, indent=2)}\n```\nAnything else?"
    assert read_json(fenced) == _with_bounded_numbers(value)


@given(st.dictionaries(st.text(max_size=8), json_values, min_size=1, max_size=4), st.data())
def test_every_proper_beginning_of_an_object_is_cut_not_misread(value, data):
    text = json.dumps(value)
    end = data.draw(st.integers(1, len(text) - 1))
    with pytest.raises(CutReplyError):
        read_json(text[:end])


def _all_finite(value) -> bool:
    if isinstance(value, dict):
        return all(_all_finite(item) for item in value.values())
    if isinstance(value, list):
        return all(_all_finite(item) for item in value)
    return not isinstance(value, float) or math.isfinite(value)


pieces = st.sampled_from([*"{}[]\",:'/*\\“1eN-. \n`", "NaN", "//", "```json"])


@given(json_values, st.lists(st.tuples(st.integers(0, 400), pieces), max_size=6))
def test_mutated_json_gives_a_finite_value_or_a_reply_error(value, changes):
    text = json.dumps(value)
    for place, piece in changes:
        place %= len(text) + 1
        text = text[:place] + piece + text[place + (place % 2) :]
    try:
        result = read_json(text)
    except ReplyError:
        return
    assert _all_finite(result)
    json.dumps(result, allow_nan=False).encode()


@given(st.text(max_size=200))
def test_any_text_gives_a_value_or_a_reply_error(text):
    with contextlib.suppress(ReplyError):
        read_json(text)
