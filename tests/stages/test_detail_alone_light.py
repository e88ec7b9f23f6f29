# SPDX-License-Identifier: GPL-3.0-or-later
"""One object of a finished room is modelled otherwise: light, exposure and views stay, and no lamp glows otherwise for it."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import pytest
from code_as_room.pipeline.artifacts.layout import Layout, LayoutProgram
from code_as_room.pipeline.artifacts.objects import OwnModelling
from code_as_room.pipeline.memory import EntryMeta, now
from code_as_room.pipeline.program import finishes
from code_as_room.pipeline.program.evaluate import evaluate
from code_as_room.pipeline.program.limits import FINISHED_ROOM_LIMITS
from code_as_room.pipeline.program.lines import parse_layout
from code_as_room.pipeline.program.prelude.record import Record
from code_as_room.pipeline.run import Run
from code_as_room.pipeline.stages import all_stages
from code_as_room.pipeline.stages.s06_geometry import STAGE as GEOMETRY
from code_as_room.pipeline.stages.s10_finish import STAGE as LIGHT

BLACK_BLOCK = """
def bed_1(size):
    w, d, h = size
    return [part("frame", box((w, d, h * 0.98), at=(0, 0, h / 2)), material="wood #050505")]


furnish("bed", bed_1)
"""
LAMP = """
def lamp_1(size):
    w, d, h = size
    shade = lathe([(w / 2, h * {low}), (w / 2 - 0.004, h)], segments=16)
    return [
        part("stem", cylinder(0.02, h * {low}, at=(0, 0, h * {low} / 2)), material="metal"),
        part("shade", shade, material="shade"),
        part("bulb", sphere((0.05, 0.05, 0.05), at=(0, 0, h * ({low} + 0.2)), segments=12, rings=8), material="shade"),
    ]


furnish("lamp", lamp_1)
"""


@pytest.fixture
def run(run: Run, answers: Any) -> Iterator[Run]:
    run.memory.settings |= {"iterations": "0", "objects": "library", "corrections_off": "blocked,outside,overlap"}
    answers.by_key["10_light"] = {"style": "soft daylight", "windows": [], "lamps_on": ["lamp"], "warmth": "neutral"}
    run.run_all(all_stages())
    yield run


def detail_again(run: Run, chosen: str, snippet: str) -> None:
    """As the window's button does it, but with a function that is sure to be another one."""
    own = OwnModelling(functions={chosen: snippet.strip()})
    run.memory.append("artist", own, EntryMeta(time=now(), model="artist"))
    for stage in all_stages()[all_stages().index(GEOMETRY) :]:
        session = run.begin(stage, fresh=stage.partial, only=frozenset({chosen}) if stage.partial else None)
        while not session.finished:
            session.step()
        session.apply()


def finished(run: Run) -> tuple[Layout, Record]:
    program = run.memory.latest(LayoutProgram, (LIGHT.id,))
    assert program is not None
    return parse_layout(program.text), evaluate(program.text, FINISHED_ROOM_LIMITS)


def worn_by_lamp(run: Run) -> list[str]:
    """What the lamp's finish says, in the words of the text."""
    materials = finishes.read_materials(run.backend.program_text())
    return [materials.looks.get(look, look) for look in materials.finishes["lamp"].values()]


def looks(record: Record, but: str) -> dict[str, dict[str, str]]:
    return {n: {k: look.key for k, look in f.items()} for n, f in record.finishes.items() if n != but}


def test_a_black_block_for_a_bed_leaves_light_and_lamps_alone(run: Run, answers: Any) -> None:
    layout, record = finished(run)
    assert any(light.parent == "lamp" for light in layout.lights)
    asked = len(answers.asked)
    detail_again(run, "bed", BLACK_BLOCK)
    after, again = finished(run)
    assert [s.part for s in again.furnished["bed"]] == ["frame"]
    for kind in ("lights", "worlds", "views", "cameras"):
        assert getattr(after, kind) == getattr(layout, kind), kind
    assert looks(again, "bed") == looks(record, "bed")
    assert not any(prompt.key.startswith("10_light") for prompt in answers.asked[asked:])
    # Asked for as a whole, the stage measures again what such a bed does to the light.
    run.run_stage(LIGHT)
    anew = finished(run)[0]
    assert (anew.views, anew.lights) != (layout.views, layout.lights)


def test_a_lamp_that_is_modelled_anew_shines_from_its_new_bulb(run: Run) -> None:
    detail_again(run, "lamp", LAMP.format(low=0.3))
    low, record = finished(run)
    detail_again(run, "lamp", LAMP.format(low=0.6))
    high, again = finished(run)
    (first,), (second,) = ([light for light in found.lights if light.parent == "lamp"] for found in (low, high))
    assert second.at[2] > first.at[2] + 0.05 and second.energy == first.energy
    assert [light for light in high.lights if not light.parent] == [light for light in low.lights if not light.parent]
    assert high.views == low.views and looks(again, "lamp") == looks(record, "lamp")
    assert run.status(LIGHT) == "done"


def test_a_lamp_that_is_off_stays_off(run: Run, answers: Any) -> None:
    answers.by_key["10_light"] = {"style": "soft daylight", "windows": [], "lamps_on": [], "warmth": "neutral"}
    session = run.begin(LIGHT, fresh=True)
    while not session.finished:
        session.step()
    session.apply()
    detail_again(run, "lamp", LAMP.format(low=0.6))
    layout, record = finished(run)
    assert not any(light.parent == "lamp" for light in layout.lights)
    shining = [look for look in worn_by_lamp(run) if look.startswith(("shade(", "glow("))]
    assert shining and all(look.endswith("strength=0)") for look in shining)
