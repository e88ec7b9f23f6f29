# SPDX-License-Identifier: GPL-3.0-or-later
"""Printing and parsing layout lines are inverse, and what cannot be read is refused with its line."""

from __future__ import annotations

import pytest
from code_as_room.pipeline.artifacts.layout import ProxyLine, RoomLine
from code_as_room.pipeline.errors import ProgramError
from code_as_room.pipeline.program.evaluate import evaluate
from code_as_room.pipeline.program.lines import parse_layout, print_layout, print_line, quoted
from hypothesis import given, settings
from hypothesis import strategies as st

SAMPLE = """# Shell
room(size=(4.6, 3.9, 2.6), floor=[(-2.3, -1.95), (2.3, -1.95), (2.3, 1.95), (-2.3, 1.95)])
wall("wall_s", (-2.3, -1.95), (2.3, -1.95), height=2.6, thickness=0.12)
wall("wall_p", (0, -1.95), (0, 0), height=2.6, thickness=0.08, partition=True)

# Doors, windows and openings
door("door_1", wall="wall_s", start=(1.2, -1.95), end=(2.05, -1.95), height=2.05, open=80)
window("window_1", wall="wall_s", start=(-1, -1.95), end=(0, -1.95), sill=0.9, height=1.3)
opening("opening_1", wall="wall_p", start=(0, -1), end=(0, -0.2), sill=0, height=2.1)

# Major objects
proxy("bed_1", "double bed", centre=(0.2, 0.7, 0.5), size=(1.7, 2.1, 1), yaw=0, placement="floor", salience="major")

# Minor objects
proxy("pillow_1", "pillow", centre=(0.2, 1.4, 1.1), size=(0.6, 0.4, 0.2), yaw=-12.5, placement="surface", parent="bed_1", salience="minor",
    label="grey, \\"soft\\"", shape="round")

# Lights
light("sun_1", "sun", at=(0, 0, 5), energy=3, size=0.1, target=(0, 0, 0))

# Cameras
camera("reference", "perspective", matrix=(1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 6.123456789, 0, 0, 0, 1), fov_y=0.9, image_size=(1024, 768))

build()
"""


def test_the_canonical_form() -> None:
    layout = parse_layout(SAMPLE)
    assert print_layout(layout) == SAMPLE
    assert layout.proxies[1].label == 'grey, "soft"' and layout.proxies[1].yaw == -12.5
    assert layout.walls[1].partition and layout.cameras[0].image_size == (1024, 768)


@given(st.text())
def test_any_text_survives_as_a_literal(label: str) -> None:
    room = RoomLine(size=(1, 1, 1), floor=[(0, 0), (1, 0), (0, 1)])
    line = ProxyLine(id="a", category="b", centre=(0, 0, 0), size=(1, 1, 1), label=label[:2000])
    assert parse_layout(print_line(room) + "\n" + print_line(line)).proxies[0].label == label[:2000]
    assert quoted(label).isprintable()


def test_numbers_are_rounded_to_a_tenth_of_a_millimetre() -> None:
    line = ProxyLine(id="a", category="b", centre=(0.123456, -0.00001, 1e-9), size=(1, 2.00004, 1 / 3), yaw=1e3)
    assert "centre=(0.1235, 0, 0), size=(1, 2, 0.3333), yaw=1000," in print_line(line)


def test_whatever_is_not_a_layout_line_is_passed_over() -> None:
    text = SAMPLE.replace("build()", 'def bed_1():\n    return box((1, 1, 1))\n\nfurnish("bed_1", bed_1())\nbuild()')
    assert parse_layout(text) == parse_layout(SAMPLE)


ROOM = "room(size=(1, 1, 1), floor=[(0, 0), (1, 0), (0, 1)])\n"
REFUSED = {
    "layout lines take literal values only": ROOM + 'proxy("a", "b", (0, 0, x), (1, 1, 1))',
    "literal values": ROOM + 'proxy("a", "b", (0, 0, 1 + 1), (1, 1, 1))',
    "without * or **": ROOM + 'proxy("a", "b", *c)',
    "statement of its own": ROOM + 'if True:\n    proxy("a", "b", (0, 0, 0), (1, 1, 1))',
    "not in a loop": ROOM + 'for i in range(3):\n    proxy("a", "b", (0, 0, i), (1, 1, 1))',
    "missing 1 required positional argument: 'size'": ROOM + '\nproxy("a", "b", (0, 0, 0))',
    "unexpected keyword argument 'color'": ROOM + 'proxy("a", "b", (0, 0, 0), (1, 1, 1), color=3)',
    "three positive numbers": ROOM + 'proxy("a", "b", (0, 0, 0), (1, -1, 1))',
    "three finite numbers": ROOM + 'proxy("a", "b", (0, 0, 1e999), (1, 1, 1))',
    "is used twice": ROOM + 'proxy("a", "b", (0, 0, 0), (1, 1, 1))\nproxy("a", "b", (0, 0, 0), (1, 1, 1))',
    "already a room line": ROOM + ROOM,
    "the room line is missing": "build()",
    "not Python": ROOM + 'proxy("a"',
}


@pytest.mark.parametrize("sentence", REFUSED)
def test_what_cannot_be_read_is_refused_with_its_line(sentence: str) -> None:
    text = REFUSED[sentence]
    with pytest.raises(ProgramError) as caught:
        parse_layout(text)
    assert sentence in str(caught.value)
    lines = text.rstrip().split("\n")
    assert caught.value.line in ((0,) if text == "build()" else range(2, len(lines) + 2))


@settings(max_examples=200, deadline=None)
@given(st.text(alphabet='room(size=1,"a)[]\n-.proxy', max_size=60))
def test_any_text_is_read_or_refused(text: str) -> None:
    try:
        parse_layout(text)
    except ProgramError as error:
        assert error.message


def test_a_function_may_call_something_of_its_own_by_a_lines_name() -> None:
    own = """
def tent_1(size):
    def door(u, v):
        return (u, 0, v)
    wall = [door(0, 0), door(1, 0), door(1, 1)]
    return [part("trim", tube(wall, 0.01), material="fabric")]


proxy("tent_1", "tent", centre=(0, 0, 0.5), size=(1, 1, 1))
furnish("tent_1", tent_1)
build()
"""
    assert [p.id for p in parse_layout(ROOM + own).proxies] == ["tent_1"]
    assert evaluate(ROOM + own).furnished["tent_1"]
    outside = own.replace("    def door(u, v):\n        return (u, 0, v)\n", "")
    with pytest.raises(ProgramError, match="layout line"):
        parse_layout(ROOM + outside)


def test_numbers_that_print_under_another_name_are_written_as_numbers() -> None:
    """numpy 2, which newer Blenders have, prints its own floats as np.float64(...), and nothing could read that again."""

    class Named(float):
        def __repr__(self) -> str:
            return f"np.float64({float(self)})"

        def __round__(self, digits: int | None = None) -> Named:
            return Named(round(float(self), digits or 0))

    proxy = ProxyLine(id="a", category="chair", centre=(0.0, 0.0, 0.5), size=(1.0, 1.0, 1.0))
    odd = proxy.model_copy(update={"size": (Named(0.25), Named(0.5), Named(1.0)), "yaw": Named(12.5)})
    text = print_line(odd)
    assert "np" not in text and "size=(0.25, 0.5, 1)" in text and "yaw=12.5" in text
