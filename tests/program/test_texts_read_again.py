# SPDX-License-Identifier: GPL-3.0-or-later
"""A room's text is read many times: what one reader does to its result is not seen by the next, and refusals stay exact."""

from __future__ import annotations

import pytest
from code_as_room.pipeline.errors import ProgramError
from code_as_room.pipeline.objects.text import relaid
from code_as_room.pipeline.program.evaluate import evaluate
from code_as_room.pipeline.program.limits import FINISHED_ROOM_LIMITS
from code_as_room.pipeline.program.lines import parse_layout
from code_as_room.pipeline.program.parse_safe import parse

HEAD = """room(size=(4, 4, 2.5), floor=[(-2, -2), (2, -2), (2, 2), (-2, 2)])
proxy("a", "stool", centre=(0, 0, 0.25), size=(0.4, 0.4, 0.5))
proxy("b", "stool", centre=(1, 0, 0.25), size=(0.4, 0.4, 0.5))


def stool(size):
    return part("seat", box(size, at=(0, 0, size[2] / 2)), material="wood")


"""
ROOM = HEAD + 'furnish("a", stool)\nfurnish("b", stool)\nfinish("a", {"wood": wood("#804020")})\nbuild()\n'


def room(text: str = ROOM):
    return evaluate(text, FINISHED_ROOM_LIMITS)


def test_every_reader_has_a_record_and_a_layout_of_its_own() -> None:
    record, layout = room(), parse_layout(ROOM)
    record.furnished["a"].clear()
    record.proxies[0]["centre"] = (9.0, 9.0, 9.0)
    record.finishes["a"].clear()
    layout.proxies[0].centre = (9.0, 9.0, 9.0)
    layout.proxies.pop()
    again = room()
    assert len(again.furnished["a"]) == 1 and again.proxies[0]["centre"] == (0, 0, 0.25) and again.finishes["a"]
    assert [p.centre for p in parse_layout(ROOM).proxies] == [(0, 0, 0.25), (1, 0, 0.25)]


def test_things_that_are_alike_share_their_shapes() -> None:
    made = room(HEAD.replace("0.4, 0.4, 0.5", "0.41, 0.4, 0.5") + 'furnish("a", stool)\nfurnish("b", stool)\nbuild()\n')
    assert made.furnished["a"][0] is made.furnished["b"][0]


@pytest.mark.parametrize(
    ("more", "line", "word"),
    (
        ("def two(size):\n    return [\n\n\ndef three(size):\n    return 1\n", 11, "never closed"),
        ('def two(size):\n    """a\n\n\ndef three(size):\n    return """ é\n', 15, "not allowed"),
        ("def two(size):\n    return 0x" + "1" * 60 + "\n", 11, "too many digits"),
        ("def two(size):\n    return " + "(" * 60 + ")" * 60 + "\n", 11, "nested"),
        ("def two(size):\n    return " + "-" * 99 + "1 \\\n\n\ndef three(size):\n    return 'ä\n", 15, "not closed"),
    ),
)
def test_what_is_refused_is_refused_at_its_line_however_often_the_rest_was_read(
    more: str, line: int, word: str
) -> None:
    parse(HEAD, FINISHED_ROOM_LIMITS)
    for _ in range(2):
        with pytest.raises(ProgramError, match=word) as error:
            parse(HEAD + more, FINISHED_ROOM_LIMITS)
        assert error.value.line == line


def test_a_layout_line_in_a_function_is_refused_each_time() -> None:
    text = HEAD + 'def two(size):\n    proxy("c", "stool", centre=(0, 0, 0), size=(1, 1, 1))\n'
    for _ in range(2):
        with pytest.raises(ProgramError, match="left margin"):
            parse_layout(text)


def test_the_same_layout_leaves_a_text_as_it_is() -> None:
    commented = ROOM.replace("def stool", "# Mine\ndef stool")
    assert relaid(commented, parse_layout(commented)) == commented
