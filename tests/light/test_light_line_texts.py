# SPDX-License-Identifier: GPL-3.0-or-later
"""Lights, sky, view and cut cameras as text: printed, parsed, patched, and refused when they cannot be."""

from __future__ import annotations

import pytest
from code_as_room.pipeline.analysis.rescale import Similarity, rescaled_line
from code_as_room.pipeline.artifacts.layout import (
    CameraLine,
    Layout,
    LayoutEdit,
    LightLine,
    ProxyLine,
    RoomLine,
    ViewLine,
    WallLine,
    WindowLine,
    WorldLine,
)
from code_as_room.pipeline.errors import ProgramError
from code_as_room.pipeline.program.evaluate import evaluate
from code_as_room.pipeline.program.lines import canonical, parse_layout, parse_line, print_layout, print_line
from code_as_room.pipeline.program.patch import patch_text
from code_as_room.pipeline.program.prelude.recorder import VIEW_TRANSFORMS
from hypothesis import given, settings
from hypothesis import strategies as st

number = st.floats(-1000, 1000)
length = st.floats(0, 100)
point = st.tuples(number, number, number)
colour = st.tuples(*[st.floats(0, 20)] * 3)
FLOOR = [(-2.0, -2.0), (2.0, -2.0), (2.0, 2.0), (-2.0, 2.0)]

lights = st.builds(
    LightLine,
    id=st.just("light_1"),
    kind=st.sampled_from(["sun", "area", "point", "spot"]),
    at=point,
    energy=st.floats(0, 1e6),
    color=colour,
    size=length,
    size_y=length,
    target=st.none() | point,
    kelvin=st.floats(0, 40_000),
    parent=st.sampled_from([None, "lamp_1", "window_1", "wall_s"]),
)
worlds = st.builds(
    WorldLine, id=st.just("sky"), color=colour, strength=st.floats(0, 1e4), kelvin=st.floats(0, 4e4), background=colour
)
views = st.builds(
    ViewLine,
    id=st.just("view"),
    exposure=st.floats(-32, 32),
    transform=st.sampled_from(VIEW_TRANSFORMS),
    look=st.text(max_size=20),
    ceiling=length,
    cut=length,
)


def layout(light: LightLine, world: WorldLine | None = None, view: ViewLine | None = None) -> Layout:
    return Layout(
        room=RoomLine(size=(4, 4, 2.5), floor=FLOOR),
        walls=[WallLine(id="wall_s", start=(-2, -2), end=(2, -2), height=2.5)],
        windows=[WindowLine(id="window_1", wall="wall_s", start=(-1, -2), end=(1, -2))],
        proxies=[ProxyLine(id="lamp_1", category="lamp", centre=(0, 0, 0.5), size=(0.3, 0.3, 1.0))],
        lights=[light],
        worlds=[world] if world else [],
        views=[view] if view else [],
        cameras=[CameraLine(id="top", kind="orthographic", matrix=(1.0,) * 16, ortho_height=5.0, near=3.5)],
    )


@settings(max_examples=80, deadline=None)
@given(lights, worlds, views)
def test_lines_come_back_as_they_were_printed_and_run(light: LightLine, world: WorldLine, view: ViewLine) -> None:
    before = layout(light, world, view)
    text = print_layout(before)
    assert parse_layout(text) == canonical(before)
    assert print_layout(parse_layout(text)) == text
    record = evaluate(text)
    assert record.lights == [canonical(before).lights[0].model_dump()]
    assert record.worlds == [canonical(before).worlds[0].model_dump()]
    assert record.views == [canonical(before).views[0].model_dump()]


@settings(max_examples=30, deadline=None)
@given(views, views)
def test_a_changed_line_changes_its_statement_only(first: ViewLine, second: ViewLine) -> None:
    light = LightLine(id="light_1", kind="point", at=(0, 0, 1), energy=10)
    text = print_layout(layout(light, view=first)) + "# mine\n"
    patched, findings = patch_text(text, [LayoutEdit(op="line", id="view", line=print_line(second))])
    assert not findings
    assert parse_layout(patched).views == canonical(layout(light, view=second)).views
    before, after = ([row for row in t.splitlines() if not row.startswith(("view(", "    "))] for t in (text, patched))
    assert before == after


def test_a_lamps_light_goes_with_the_lamp_and_follows_its_name() -> None:
    light = LightLine(id="light_1", kind="point", at=(0, 0, 1), energy=10, parent="lamp_1")
    text = print_layout(layout(light))
    renamed, _ = patch_text(text, [LayoutEdit(op="rename", id="lamp_1", new_id="lamp_left")])
    assert parse_layout(renamed).lights[0].parent == "lamp_left"
    evaluate(renamed)
    gone, findings = patch_text(text, [LayoutEdit(op="remove", id="lamp_1")])
    assert not parse_layout(gone).lights and "light_1" in findings[-1].message
    evaluate(gone)


def test_a_windows_light_goes_with_its_wall() -> None:
    light = LightLine(id="light_1", kind="area", at=(0, -1.9, 1.5), energy=10, parent="window_1")
    gone, _ = patch_text(print_layout(layout(light)), [LayoutEdit(op="remove", id="wall_s")])
    assert not parse_layout(gone).lights
    evaluate(gone)


@pytest.mark.parametrize(
    "line",
    [
        'view("view", transform="Sepia")',
        'world("sky", strength=-1)',
        'light("l", "point", at=(0, 0, 1), energy=5, kelvin=-3)',
        'camera("c", "perspective", matrix=(1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1), fov_y=1, near=0)',
    ],
)
def test_what_no_room_can_have_is_refused_in_a_sentence(line: str) -> None:
    with pytest.raises(ProgramError):
        parse_line(line)


def test_a_second_sky_and_a_light_from_nowhere_are_refused() -> None:
    light = LightLine(id="light_1", kind="point", at=(0, 0, 1), energy=10, parent="nobody")
    with pytest.raises(ProgramError, match="nobody"):
        evaluate(print_layout(layout(light)))
    with pytest.raises(ProgramError, match="already a world line"):
        parse_layout(print_layout(layout(light, WorldLine(id="sky"))) + 'world("sky_2")\n')


def test_another_scale_keeps_the_brightness() -> None:
    light = LightLine(id="l", kind="area", at=(1, 0, 2), energy=10, size=2, size_y=1)
    twice = rescaled_line(light, Similarity(factor=2.0))
    assert isinstance(twice, LightLine)
    assert (twice.size, twice.size_y, twice.energy) == (4, 2, 40)
    view = rescaled_line(ViewLine(id="view", exposure=1, ceiling=2.5, cut=2), Similarity(factor=2.0))
    assert isinstance(view, ViewLine) and (view.exposure, view.ceiling, view.cut) == (1, 5, 4)
