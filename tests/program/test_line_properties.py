# SPDX-License-Identifier: GPL-3.0-or-later
"""Printing and parsing are inverse, and patching a text is editing its layout, for any layout."""

from __future__ import annotations

import difflib

from code_as_room.pipeline.artifacts.layout import (
    CameraLine,
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
from code_as_room.pipeline.program.evaluate import evaluate
from code_as_room.pipeline.program.lines import canonical, parse_layout, print_layout
from code_as_room.pipeline.program.patch import apply_edits, patch_text
from code_as_room.pipeline.program.prelude.recorder import Recorder
from hypothesis import given, settings
from hypothesis import strategies as st

coordinate = st.one_of(st.floats(-10_000, 10_000), st.integers(-5, 5).map(float), st.sampled_from([-0.0, 1e-300, 1e4]))
size = st.floats(0.001, 10_000)
point2 = st.tuples(coordinate, coordinate)
point3 = st.tuples(coordinate, coordinate, coordinate)
sizes = st.tuples(size, size, size)
names = st.text(min_size=1, max_size=12) | st.sampled_from(
    ['a"b', "c\\n", "d\n", "e'", "\u2028", "#", "é", "\U0001f6cf"]
)
labels = st.text(max_size=40) | st.sampled_from(['say "hi"', "back\\slash", "two\nlines", "\x00\x7f\u202e", "x" * 200])


@st.composite
def segments(draw) -> dict[str, tuple[float, float]]:
    """Start and end of something on the floor, at least 1 cm apart."""
    x, y = draw(point2)
    length = draw(st.floats(0.01, 100))
    return {"start": (x, y), "end": (x, y + length if y < 0 else y - length)}


@st.composite
def proxies(draw, identifier: str, parents: list[str]) -> ProxyLine:
    """A proxy with this id, perhaps on one of the parents."""
    return ProxyLine(
        id=identifier,
        category=draw(names),
        centre=draw(point3),
        size=draw(sizes),
        yaw=draw(st.floats(-720, 720)),
        placement=draw(st.sampled_from(["floor", "wall", "ceiling", "surface"])),
        parent=draw(st.sampled_from([None, *parents])),
        salience=draw(st.sampled_from(["major", "minor"])),
        label=draw(labels),
        shape=draw(st.sampled_from(["box", "round", "l_shape"])),
    )


@st.composite
def layouts(draw) -> Layout:
    """A layout as a program may say it: unique ids, known parents and walls."""
    ids = iter(draw(st.lists(names, min_size=14, max_size=14, unique=True)))
    west, south = draw(st.tuples(st.floats(-100, 0), st.floats(-100, 0)))
    east, north = draw(st.tuples(st.floats(0.01, 100), st.floats(0.01, 100)))
    floor = [(west, south), (east, south), (east, north), (west, north)]
    layout = Layout(room=RoomLine(size=draw(sizes), floor=floor))
    for _ in range(draw(st.integers(1, 3))):
        wall = WallLine(id=next(ids), **draw(segments()), height=draw(size), partition=draw(st.booleans()))
        layout.walls.append(wall)
    for kind, lines in ((DoorLine, layout.doors), (WindowLine, layout.windows), (OpeningLine, layout.openings)):
        if draw(st.booleans()):
            lines.append(kind(id=next(ids), wall=layout.walls[0].id, **draw(segments()), height=draw(size)))
    for _ in range(draw(st.integers(0, 5))):
        layout.proxies.append(draw(proxies(next(ids), [line.id for line in [*layout.proxies, *layout.walls]])))
    if draw(st.booleans()):
        target = draw(st.none() | point3)
        layout.lights.append(LightLine(id=next(ids), kind="spot", at=draw(point3), energy=draw(size), target=target))
    if draw(st.booleans()):
        matrix = tuple(draw(st.lists(st.floats(-100, 100), min_size=16, max_size=16)))
        fov = draw(st.floats(0.01, 3))
        layout.cameras.append(CameraLine(id=next(ids), kind="perspective", matrix=matrix, fov_y=fov))
    return layout


@st.composite
def edits(draw, layout: Layout) -> list[LayoutEdit]:
    """Edits of the layout, some of them impossible."""
    known = [line.id for line in layout.proxies] + ["nobody"]
    one = st.builds(
        LayoutEdit,
        op=st.sampled_from(["move", "resize", "turn", "add", "remove", "recategorise", "rename", "reparent"]),
        id=st.sampled_from([*known, "new_1", "new_2"]),
        centre=st.none() | point3,
        size=st.none() | sizes,
        yaw=st.none() | st.floats(-720, 720),
        category=st.none() | names,
        label=st.none() | labels,
        placement=st.sampled_from([None, "floor", "surface"]),
        parent=st.sampled_from([None, *known, layout.walls[0].id]),
        salience=st.sampled_from([None, "major", "minor"]),
        new_id=st.sampled_from([None, "new_1", "new_3", 'quo"te', *known]),
    )
    return draw(st.lists(one, max_size=6))


@settings(max_examples=60, deadline=None)
@given(layouts())
def test_print_then_parse_gives_the_layout_back(layout: Layout) -> None:
    text = print_layout(layout)
    assert parse_layout(text) == canonical(layout)
    assert print_layout(parse_layout(text)) == text
    assert canonical(canonical(layout)) == canonical(layout)


@settings(max_examples=30, deadline=None)
@given(layouts())
def test_printed_lines_are_readable(layout: Layout) -> None:
    for line in print_layout(layout).splitlines():
        assert len(line) <= 140 or '"' in line  # only a text cannot be wrapped
        assert line.isprintable()


@settings(max_examples=100, deadline=None)
@given(st.data())
def test_patching_the_text_and_editing_the_layout_agree(data) -> None:
    layout = canonical(data.draw(layouts()))
    changes = data.draw(edits(layout))
    text = print_layout(layout)
    expected, findings = apply_edits(layout, changes)
    patched, said = patch_text(text, changes)
    assert parse_layout(patched) == expected
    assert said == findings
    went = [line[2:] for line in difflib.ndiff(text.splitlines(), patched.splitlines()) if line[0] == "-"]
    assert not [line for line in went if line.startswith(("room", "wall", "door", "light", "camera", "#", "build"))]
    recorder = Recorder()
    for line in expected.proxies:
        recorder.proxy(**line.model_dump())  # whatever edits leave is a line that runs


@settings(max_examples=30, deadline=None)
@given(layouts())
def test_a_printed_layout_runs_and_records_the_same(layout: Layout) -> None:
    record = evaluate(print_layout(layout))
    expected = canonical(layout)
    assert record.built and record.room == expected.room.model_dump()
    for name in ("walls", "doors", "windows", "openings", "proxies", "lights", "cameras"):
        assert getattr(record, name) == [line.model_dump() for line in getattr(expected, name)]
