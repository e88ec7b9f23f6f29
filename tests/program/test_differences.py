# SPDX-License-Identifier: GPL-3.0-or-later
"""What changed in a text becomes typed edits: applying them to the former layout gives the new one."""

from __future__ import annotations

import math
from typing import Any

from code_as_room.pipeline.artifacts.layout import (
    DoorLine,
    Layout,
    LayoutEdit,
    LightLine,
    OpeningLine,
    ProxyLine,
    RoomLine,
    WallLine,
    WindowLine,
)
from code_as_room.pipeline.layout.hand import apply_hand_edits
from code_as_room.pipeline.program.differences import differences, merged, own_code
from code_as_room.pipeline.program.edits import LISTS, apply_edits
from code_as_room.pipeline.program.lines import canonical, parse_layout, print_layout
from code_as_room.pipeline.program.patch import patch_text
from code_as_room.pipeline.program.words import edit_in_words, edits_taken_over
from hypothesis import given, settings
from hypothesis import strategies as st

IDS = [f"thing_{n}" for n in range(8)]
number = st.integers(-40_000, 40_000).map(lambda v: v / 10_000)
length = st.integers(1, 40_000).map(lambda v: v / 10_000)


@st.composite
def rooms(draw) -> Layout:
    """A layout with few ids, so that two of them share many, for things of every kind."""
    names = draw(st.permutations(IDS))[: draw(st.integers(1, 8))]
    width = draw(st.sampled_from([4.0, 5.0]))
    layout = Layout(room=RoomLine(size=(width, 4, 2.5), floor=[(0, 0), (width, 0), (width, 4), (0, 4)]))
    wall = names[0]
    for place, name in enumerate(names):
        kind = (
            "wall"
            if place == 0
            else draw(st.sampled_from(["proxy", "proxy", "wall", "door", "window", "opening", "light"]))
        )
        span: dict[str, Any] = {"start": (draw(number), 0.0), "end": (5.0, 1.0)}
        if kind == "wall":
            layout.walls.append(WallLine(id=name, **span, height=draw(length)))
        elif kind == "door":
            layout.doors.append(DoorLine(id=name, wall=wall, **span))
        elif kind == "window":
            layout.windows.append(WindowLine(id=name, wall=wall, **span))
        elif kind == "opening":
            layout.openings.append(OpeningLine(id=name, wall=wall, **span))
        elif kind == "light":
            layout.lights.append(LightLine(id=name, kind="point", at=(draw(number), 0, 1), energy=draw(length)))
        else:
            fixed = [x.id for x in (*layout.walls, *layout.doors, *layout.windows, *layout.openings)]
            layout.proxies.append(
                ProxyLine(
                    id=name, category=draw(st.sampled_from(["bed", "chair"])), centre=(draw(number), 0.0, 0.5),
                    size=(draw(length), 1.0, 1.0), yaw=draw(st.sampled_from([0.0, 90.0])),
                    placement=draw(st.sampled_from(["floor", "surface"])),
                    parent=draw(st.sampled_from([None, *(p.id for p in layout.proxies), *fixed])),
                    salience=draw(st.sampled_from(["major", "minor"])), shape=draw(st.sampled_from(["box", "round"])),
                )
            )  # fmt: skip
    return layout


def by_id(layout: Layout) -> dict[str, Any]:
    """All lines of a layout as they are printed, whatever their order."""
    whole = canonical(layout)
    lines = {line.id: line for name in (*LISTS, "proxies") for line in getattr(whole, name)}
    return {"": whole.room, **lines}


@settings(max_examples=300)
@given(rooms(), rooms())
def test_applying_the_differences_gives_the_other_layout(before: Layout, after: Layout) -> None:
    edits = differences(before, after)
    result, findings = apply_edits(before, edits)
    assert by_id(result) == by_id(after)
    assert not [f for f in findings if f.severity == "warning"]
    assert all(edit.origin == "artist" and edit_in_words(edit).endswith(".") for edit in edits)
    assert differences(after, after) == []


@settings(max_examples=150)
@given(rooms(), rooms())
def test_the_text_and_the_history_take_them_too(before: Layout, after: Layout) -> None:
    edits = differences(before, after)
    text, _ = patch_text(print_layout(before), edits)
    assert by_id(parse_layout(text)) == by_id(after)
    assert by_id(apply_hand_edits(before, edits)[0]) == by_id(after)


ROOM = """\
room(size=(4, 4, 2.5), floor=[(-2, -2), (2, -2), (2, 2), (-2, 2)])
wall("wall_s", (-2, -2), (2, -2), height=2.5, thickness=0.12)
window("window_1", wall="wall_s", start=(-1, -2), end=(0, -2), sill=0.9, height=1.2)
proxy("bed_1", "bed", centre=(0, 0, 0.25), size=(1, 2, 0.5))
proxy("pillow_1", "pillow", centre=(0, 0.5, 0.6), size=(0.5, 0.5, 0.2), placement="surface", parent="bed_1")
build()
"""


def ops(text: str) -> list[tuple[str, str]]:
    return [(e.op, e.id) for e in differences(parse_layout(ROOM), parse_layout(text))]


def test_a_changed_number_is_one_edit_of_one_object() -> None:
    assert ops(ROOM) == []
    assert ops(ROOM.replace("centre=(0, 0, 0.25)", "centre=(0.5, 0, 0.25)")) == [("move", "bed_1")]
    assert ops(ROOM.replace("size=(1, 2, 0.5)", "size=(1, 2.2, 0.5)")) == [("resize", "bed_1")]
    assert ops(ROOM.replace('"pillow",', '"cushion",')) == [("recategorise", "pillow_1")]
    assert ops(ROOM.replace("sill=0.9", "sill=0.8")) == [("line", "window_1")]
    assert ops(ROOM.replace('window("window_1"', 'opening("window_1"')) == [("remove", "window_1"), ("add", "window_1")]
    assert ops(ROOM.replace("2.5), floor", "2.6), floor")) == [("line", "room")]


def test_a_new_id_is_a_new_name_and_takes_its_children_along() -> None:
    assert ops(ROOM.replace('"bed_1"', '"grand_bed"')) == [("rename", "bed_1")]


def test_the_text_wins_where_both_changed_one_object() -> None:
    typed = differences(
        parse_layout(ROOM), parse_layout(ROOM.replace('"bed_1"', '"bed_9"').replace("sill=0.9", "sill=1"))
    )
    seen = [
        LayoutEdit(op="move", id="bed_1", centre=(1, 0, 0.25), origin="artist"),
        LayoutEdit(op="line", id="window_1", line="", origin="artist"),
        LayoutEdit(
            op="add", id="cup", category="cup", centre=(0, 0, 1), size=(1, 1, 1), parent="bed_1", origin="artist"
        ),
    ]
    kept, findings = merged(typed, seen)
    assert [(e.op, e.id, e.parent) for e in kept] == [("move", "bed_9", None), ("add", "cup", "bed_9")]
    assert [f.about for f in findings] == ["window_1"] and "the text counts" in findings[0].message


def test_own_code_is_all_that_is_no_layout_line() -> None:
    assert own_code(ROOM) == ()
    text = ROOM.replace("build()", "def bed_1():\n    return [box((1, 2, 0.5))]\n\nfurnish('bed_1', bed_1())\nbuild()")
    assert [code.split("(")[0] for code in own_code(text)] == ["def bed_1", "furnish"]
    assert own_code("room(") == ()


def test_edits_in_words() -> None:
    edits = [
        LayoutEdit(op="move", id="bed_1", centre=(0.2, math.pi, 0), origin="artist"),
        LayoutEdit(op="move", id="lamp_1", centre=(0, 0, 0), origin="parent", reason="moved along with bed_1"),
        LayoutEdit(
            op="line", id="window_1", line='window("window_1", wall="w", start=(0, 0), end=(1, 0))', origin="artist"
        ),
    ]
    assert [edit_in_words(e) for e in edits] == [
        "Moved bed_1 to 0.20, 3.14 m.",
        "lamp_1 moved along with bed_1.",
        "Changed window window_1.",
    ]
    assert edits_taken_over(edits) == "2 edits taken over" and edits_taken_over([]) == ""
