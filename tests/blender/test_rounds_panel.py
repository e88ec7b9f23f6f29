# SPDX-License-Identifier: GPL-3.0-or-later
"""The layout loop in the panel: pictures of its rounds, taking one, comparing; and what the run's clock says."""

from __future__ import annotations

import io
import random
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import bpy
import code_as_room
import pytest
from code_as_room.operators import object_list, room_memory, round_pictures, rounds, view_state
from code_as_room.operators.progress import Progress
from code_as_room.operators.state_reading import LOOP
from code_as_room.operators.view_state import RoomState
from code_as_room.panels.stages import costs_in_words, time_in_words
from code_as_room.pipeline.artifacts.layout import LayoutEdit, LayoutProgram
from code_as_room.pipeline.program.lines import parse_layout, print_layout
from PIL import Image, ImageDraw

KINDS = ("scenes", "objects", "meshes", "materials", "collections", "cameras", "texts", "images", "worlds")


@pytest.fixture(scope="module")
def looped(tmp_path_factory: pytest.TempPathFactory) -> str:
    """A file with a room whose loop had three rounds, of which the last was kept."""
    folder = tmp_path_factory.mktemp("rounds")
    image = Image.new("RGB", (480, 400), "white")
    pen = ImageDraw.Draw(image)
    pen.rectangle((30, 30, 450, 370), fill=(120, 120, 125))
    pen.rectangle((45, 45, 435, 355), fill=(205, 170, 130))
    pen.rectangle((170, 50, 310, 220), fill=(90, 120, 180))
    pen.rectangle((370, 120, 430, 280), fill=(235, 235, 230))
    image.save(folder / "flat.png")
    bpy.ops.wm.read_factory_settings(use_empty=True)
    code_as_room.register()
    bpy.ops.code_as_room.load_picture(filepath=str(folder / "flat.png"))
    scene = bpy.context.scene
    scene.code_as_room.iterations = 1
    bpy.ops.code_as_room.run_stage()
    bpy.ops.code_as_room.run_to(stage=LOOP)
    run = room_memory.run_of(scene)
    entry = run.memory.latest_entry(LayoutProgram.__name__, (LOOP,))
    assert entry is not None
    run.memory.append(LOOP, with_three_rounds(LayoutProgram.model_validate(entry.output)), entry.meta)
    room_memory.keep(run)
    path = str(folder / "looped.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    code_as_room.unregister()
    return path


def with_three_rounds(program: LayoutProgram) -> LayoutProgram:
    """The program with two rounds before its own, in which everything stood a little elsewhere."""
    chance, last = random.Random(5), program.iterations[0]
    items = []
    for number in range(2):
        layout = parse_layout(last.program)
        moved = [
            p.model_copy(update={"centre": (p.centre[0] + chance.uniform(0.05, 0.2), *p.centre[1:])})
            for p in layout.proxies
        ]
        asked = [LayoutEdit(op="move", id=moved[0].id, centre=(0.1, 0.2, 0.3), reason="nearer to the wall")]
        text = print_layout(layout.model_copy(update={"proxies": moved}))
        items.append(last.model_copy(update={"number": number, "program": text, "edits": asked}))
    items.append(last.model_copy(update={"number": 2}))
    return program.model_copy(update={"iterations": items, "best": 2})


@pytest.fixture(autouse=True)
def scene(looped: str) -> Iterator[Any]:
    """The room, opened anew."""
    code_as_room.register()
    bpy.ops.wm.open_mainfile(filepath=looped)
    yield bpy.context.scene
    code_as_room.unregister()


def state() -> RoomState:
    found = view_state.peek(bpy.context.scene)
    assert found is not None
    return found


def places(scene: Any) -> dict[str, tuple[float, ...]]:
    return {i: tuple(round(v, 4) for v in o.matrix_world.translation) for i, o in object_list.proxies(scene).items()}


def test_rounds_say_what_the_critic_asked_and_the_kept_one_is_shown_first(scene: Any) -> None:
    assert [row.kept for row in state().rounds] == [False, False, True]
    assert "nearer to the wall" in state().rounds[0].asked[0]
    shown = rounds.shown_round(scene)
    assert shown is not None and shown.number == 2
    bpy.ops.code_as_room.show_round(number=1)
    shown = rounds.shown_round(scene)
    assert shown is not None and shown.number == 0


def test_taking_a_round_moves_what_stands_and_the_next_stage_has_to_run(scene: Any) -> None:
    before = places(scene)
    bpy.ops.code_as_room.take_round(number=1)
    wanted = {p.id: p.centre for p in parse_layout(rounds.iteration_of(scene, 0).program).proxies}
    bpy.context.view_layer.update()
    after = places(scene)
    assert after != before
    assert all(abs(after[i][0] - wanted[i][0]) < 1e-3 for i in wanted)
    assert [row.kept for row in state().rounds] == [True, False, False]
    stage = state().stage(LOOP)
    assert stage is not None and stage.status == "done"
    bpy.ops.code_as_room.take_round(number=3)
    bpy.context.view_layer.update()
    assert places(scene) == before


def test_missing_pictures_are_drawn_and_nothing_of_that_stays_in_the_file(scene: Any) -> None:
    round_pictures.forget_all()
    keys = [row.picture for row in state().rounds]
    counts = {kind: len(getattr(bpy.data, kind)) for kind in KINDS}
    before = places(scene)
    bpy.ops.code_as_room.draw_rounds()
    assert {kind: len(getattr(bpy.data, kind)) for kind in KINDS} == counts
    assert places(scene) == before
    found = [round_pictures.find(key) for key in keys]
    assert all(png is not None and png.startswith(b"\x89PNG") for png in found) and len(set(found)) == 3


def test_a_run_keeps_the_picture_of_each_round_that_it_renders(scene: Any) -> None:
    round_pictures.forget_all()
    bpy.ops.code_as_room.run_stage(stage=LOOP)
    assert round_pictures.find(state().rounds[0].picture) is not None


def test_the_comparison_shows_picture_and_layout_at_one_height(scene: Any) -> None:
    for _ in range(2):
        bpy.ops.code_as_room.compare_round(number=1)
    [image] = [i for i in bpy.data.images if rounds.MARK in i]
    png = round_pictures.find(state().rounds[0].picture)
    assert png is not None
    with Image.open(io.BytesIO(png)) as layout:
        assert image.size[1] == layout.height and image.size[0] > layout.width * 1.9


def test_a_broken_picture_file_is_drawn_as_none(tmp_path: Path, scene: Any) -> None:
    round_pictures.keep(state().rounds[0].picture, b"not a picture")
    view_state.refresh(scene)
    assert round_pictures.icon(state().rounds[0].picture) == 0


def test_a_room_without_rounds_says_what_to_do() -> None:
    bpy.ops.wm.read_factory_settings(use_empty=True)
    view_state.refresh(bpy.context.scene)
    assert rounds.shown_round(bpy.context.scene) is None
    with pytest.raises(RuntimeError, match="Run the major layout first"):
        bpy.ops.code_as_room.take_round(number=1)


@pytest.mark.parametrize(
    ("passed", "expected", "words"),
    [
        (12, None, "12 s"),
        (65, 105.0, "1 min 5 s, about 40 s left"),
        (10, 200.0, "10 s, about 3 min 30 s left"),
        (300, 200.0, "5 min, longer than expected"),
    ],
)
def test_the_clock_in_words(passed: int, expected: float | None, words: str) -> None:
    assert time_in_words(Progress(began=100.0, expected=expected), 100.0 + passed) == words


def test_costs_in_words() -> None:
    assert costs_in_words(Progress()) == ""
    told = costs_in_words(Progress(calls_open=2, calls_done=3, tokens=12345, cost=0.0421))
    assert told == "2 requests open, 3 answered, 12.3k tokens, $0.04"
