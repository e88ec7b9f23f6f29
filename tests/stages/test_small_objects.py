"""Stage 7 from end to end: small objects stand on the built surfaces, and what the artist holds stays where it is."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

import pytest
from code_as_room.pipeline.artifacts.layout import LayoutEdit, LayoutProgram, ProxyLine
from code_as_room.pipeline.artifacts.surfaces import SmallObjects
from code_as_room.pipeline.program.lines import parse_layout
from code_as_room.pipeline.run import Run
from code_as_room.pipeline.stages import all_stages
from code_as_room.pipeline.stages.s07_surfaces import STAGE, _Seating, shapes_of
from code_as_room.pipeline.surfaces.choose import base_of, to_local
from code_as_room.pipeline.surfaces.rasters import sample

STAGES = all_stages()[: all_stages().index(STAGE) + 1]


@pytest.fixture
def run(run: Run, answers: Any) -> Iterator[Run]:
    run.memory.settings["iterations"] = "0"
    run.memory.settings["objects"] = "library"
    yield run


def program_of(run: Run) -> LayoutProgram:
    program = run.memory.latest(LayoutProgram, (STAGE.id,))
    assert program is not None
    return program


def proxy(run: Run, name: str) -> ProxyLine:
    found = parse_layout(program_of(run).text).proxy(name)
    assert found is not None
    return found


def height_under(run: Run, small: ProxyLine) -> float:
    """Greatest height above the floor of the carrier's mesh under the middle of a small object, below its top."""
    text = program_of(run).text
    carrier = parse_layout(text).proxy(small.parent or "")
    assert carrier is not None
    samples = sample(shapes_of(text)[carrier.id], 0.01)
    assert samples is not None
    x, y = to_local(carrier, small.centre[:2])
    column, row = samples.grid.index(x, y)
    here = (samples.cells == column * samples.grid.shape[1] + row) & samples.up
    heights = [base_of(carrier) + float(h) for h in samples.heights[here]]
    return max((h for h in heights if h <= base_of(small) + small.size[2]), default=math.nan)


def small_ones(run: Run) -> list[ProxyLine]:
    return [p for p in parse_layout(program_of(run).text).proxies if p.placement == "surface"]


def test_small_objects_stand_on_the_meshes_that_carry_them(run: Run) -> None:
    run.run_all(STAGES)
    small = small_ones(run)
    assert small
    for item in small:
        assert base_of(item) == pytest.approx(height_under(run, item), abs=0.03), item.id
    written = run.memory.latest(SmallObjects)
    assert written is not None and {p.id for p in written.places} == {p.id for p in small}


def test_nothing_else_moves(run: Run) -> None:
    run.run_all(STAGES)
    before = run.memory.latest(LayoutProgram, ("s06_geometry",))
    assert before is not None
    stays = [p for p in parse_layout(before.text).proxies if p.placement != "surface"]
    assert stays and all(proxy(run, p.id) == p for p in stays)


def test_a_second_run_changes_nothing(run: Run) -> None:
    run.run_all(STAGES)
    first = program_of(run).text
    run.run_stage(STAGE)
    assert program_of(run).text == first


def test_a_small_object_that_was_moved_by_hand_stays_bit_for_bit(run: Run, scene: Any) -> None:
    run.run_all(STAGES)
    item = small_ones(run)[0]
    x, y, z = item.centre
    moved = (round(x + 0.0123, 4), round(y - 0.0077, 4), round(z + 0.3, 4))
    scene.edits = [LayoutEdit(op="move", id=item.id, centre=moved, origin="artist")]
    run.run_stage(STAGE)
    assert proxy(run, item.id).centre == moved


def test_a_program_that_fails_in_another_size_keeps_its_own_and_the_room_is_built() -> None:
    """One loft whose heights did not rise any more ended a whole run."""
    made = (
        "def vase_1(size):\n    w, d, h = size\n"
        "    rings = [rectangle(w, d), rectangle(w / 2, d / 2), rectangle(w, d)]\n"
        "    return [part('body', loft(rings, [0, 0.2, h]), material='ceramic')]\n"
    )
    lines = (
        "room(size=(4, 4, 2.5), floor=[(-2, -2), (2, -2), (2, 2), (-2, 2)])\n"
        "proxy('table_1', 'table', centre=(0, 0, 0.35), size=(1, 1, 0.7))\n"
        "proxy('vase_1', 'vase', centre=(0, 0, 0.85), size=(0.2, 0.2, 0.3), placement='surface', parent='table_1')\n"
    )
    text = f"{lines}\n{made}\nfurnish('vase_1', vase_1)\nbuild()\n"
    layout = parse_layout(text)
    seating = _Seating(None, layout, {})  # type: ignore[arg-type]
    vase = layout.proxy("vase_1")
    assert vase is not None
    smaller = vase.model_copy(update={"size": (0.1, 0.1, 0.15), "centre": (0.2, 0.1, 0.775)})
    seating._place(smaller)
    found = parse_layout(seating.sound(text, layout)).proxy("vase_1")
    assert found is not None and found.size == vase.size and found.centre == (0.2, 0.1, 0.85)
    assert [f.about for f in seating.findings] == ["vase_1"]
    # What can be made smaller is.
    seating = _Seating(None, layout, {})  # type: ignore[arg-type]
    seating._place(smaller.model_copy(update={"size": (0.1, 0.1, 0.25), "centre": (0.2, 0.1, 0.825)}))
    found = parse_layout(seating.sound(text, layout)).proxy("vase_1")
    assert found is not None and found.size == (0.1, 0.1, 0.25) and seating.findings == []
