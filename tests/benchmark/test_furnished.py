# SPDX-License-Identifier: GPL-3.0-or-later
"""Floating, sinking, loose and crossing things are found on meshes, and sound ones are not accused."""

from __future__ import annotations

from pathlib import Path

import bpy
import pytest
from code_as_room.pipeline.artifacts.analysis import Calibration, SceneAnalysis
from code_as_room.pipeline.artifacts.layout import LayoutProgram, LedgerEntry, Score
from code_as_room.pipeline.geometry.camera import camera_looking_at
from code_as_room.pipeline.geometry.footprint import image_box_of
from code_as_room.pipeline.memory import EntryMeta, Memory
from code_as_room.pipeline.program.evaluate import evaluate
from code_as_room.pipeline.scene.realise import realise_record

from benchmark.built.account import ledger_of, shown_distances
from benchmark.built.bodies import BuiltRoom, read_room
from benchmark.built.contact import contact_of
from benchmark.built.solids import crossings, filling_of, loose_parts
from benchmark.furnished import measure, summary

SHELL = """room(size=(4, 4, 2.5), floor=[(-2, -2), (2, -2), (2, 2), (-2, 2)])
wall("wall_n", (2, 2), (-2, 2), height=2.5)
"""
TABLE = """proxy("table", "table", centre=(0, 0, 0.36), size=(1, 0.6, 0.72))
def table(size):
    w, d, h = size
    legs = [box((0.05, 0.05, h - 0.03), at=(x * 0.4, y * 0.2, (h - 0.03) / 2)) for x in (-1, 1) for y in (-1, 1)]
    return [part("leg", legs, material="wood"), part("top", box((w, d, 0.03), at=(0, 0, h - 0.015)), material="wood")]
furnish("table", table((1, 0.6, 0.72)))
"""


def cup(height: float, x: float = 0.2, name: str = "cup") -> str:
    """A round thing whose underside is at a height."""
    centre = (x, 0.1, round(height + 0.05, 4))
    return (
        f'proxy("{name}", "cup", centre={centre}, size=(0.08, 0.08, 0.1), placement="surface", parent="table")\n'
        f'furnish("{name}", [part("body", cylinder(0.04, 0.1, at=(0, 0, 0.05)), material="ceramic")])\n'
    )


def built(*lines: str) -> BuiltRoom:
    bpy.ops.wm.read_factory_settings(use_empty=True)
    realise_record(evaluate("".join([SHELL, *lines, "build()\n"])))
    return read_room(bpy.context.scene)


@pytest.mark.parametrize("gap", [0.0, 0.012, -0.012, 0.3])
def test_how_far_a_thing_floats_or_sinks_is_measured_on_what_carries_it(gap: float) -> None:
    room = built(TABLE, cup(0.72 + gap))
    contact = contact_of(room, room.things["cup"])
    assert contact.gap == pytest.approx(gap, abs=1e-3) and contact.on == "table"
    assert contact.held == (gap == 0.0)
    table = contact_of(room, room.things["table"])
    assert table.held and table.on == "floor"


def test_a_thing_beside_its_table_is_on_the_floor_and_not_where_it_says() -> None:
    room = built(TABLE, cup(0.0, x=0.9))
    contact = contact_of(room, room.things["cup"])
    assert contact.on == "floor" and contact.gap == pytest.approx(0.0, abs=1e-3) and not contact.named


def test_things_on_walls_are_measured_against_their_wall() -> None:
    for away in (0.0, 0.04):
        line = (
            f'proxy("art", "picture", centre=(0, {1.98 - away}, 1.5), size=(0.6, 0.04, 0.4), yaw=0, placement="wall")\n'
        )
        room = built(line)
        assert contact_of(room, room.things["art"]).gap == pytest.approx(away, abs=2e-3)


def test_parts_that_touch_nothing_and_boxes_that_are_not_filled_are_found() -> None:
    loose = TABLE.replace(
        'return [part("leg"', 'return [part("knob", box((0.02, 0.02, 0.02), at=(0, 0, 0.3))), part("leg"'
    )
    sound, broken = built(TABLE).things["table"], built(loose).things["table"]
    assert loose_parts(sound) == (0, 5) and loose_parts(broken) == (1, 6)
    half = built(TABLE.replace('furnish("table", table((1, 0.6, 0.72)))', 'furnish("table", table((0.5, 0.6, 0.72)))'))
    filling = filling_of(half.things["table"])
    assert filling is not None and filling.share == pytest.approx(0.85, abs=0.02)
    sound_fill = filling_of(sound)
    assert sound_fill is not None and sound_fill.share == pytest.approx(1.0, abs=1e-3)


def test_neighbours_that_run_through_each_other_are_told_and_those_that_touch_are_not() -> None:
    through = built(TABLE, cup(0.72), cup(0.72, 0.23, "other"))
    [(a, b, deep)] = crossings(through)
    assert {a, b} == {"cup", "other"} and 0.01 < deep < 0.04
    assert crossings(built(TABLE, cup(0.72), cup(0.72, 0.281, "other"))) == []


def test_the_ledger_closes_only_when_everything_is_there_or_has_a_reason(analysis: SceneAnalysis) -> None:
    room = built(TABLE)
    kept = analysis.objects[:2]
    memory = Memory()
    objects = [kept[0].model_copy(update={"id": "table"}), kept[1].model_copy(update={"id": "lost"})]
    memory.append("s01_analysis", analysis.model_copy(update={"objects": objects}), EntryMeta(time="t"))

    def closes(state: str, reason: str) -> bool:
        entries = [
            LedgerEntry(id="table", category="table", state="detailed"),
            LedgerEntry.model_validate({"id": "lost", "category": "x", "state": state, "reason": reason}),
        ]
        score = Score(total=1, measured=1, coverage=1, overlap=1, bounds=1, relations=1, boxes=1)
        program = LayoutProgram(text="", stage="s07_surfaces", score=score, ledger=entries)
        memory.append("s07_surfaces", program, EntryMeta(time="t"))
        ledger = ledger_of(memory, room)
        assert ledger is not None and ledger.detected == 2 and ledger.share == 0.5
        return ledger.closes

    assert not closes("detailed", "")  # it is not in the room
    assert not closes("dropped", "") and not closes("deferred", "no place yet")
    assert closes("dropped", "no surface for it was found")


def test_things_are_held_against_the_picture_by_what_of_them_is_seen(analysis: SceneAnalysis) -> None:
    """A cup under a table top is nowhere in the picture; one that comes out from under it by half is where its half is."""
    camera = camera_looking_at("perspective", (0, 0, 5), (0, 0, 0), 50.0, (800, 800))
    room = built(TABLE, cup(0.72, -0.3, "open"), cup(0.3, 0.1, "hidden"), cup(0.3, 0.56, "half"))
    floor = [(-2.0, -2.0), (2.0, -2.0), (2.0, 2.0), (-2.0, 2.0)]
    calibration = Calibration(camera=camera, floor=floor, height=2.5, error_px=0.0, scale_source="truth")
    # The picture's boxes go round what is seen: of the half one, what lies right of the table's edge.
    places = {"hidden": (-0.4, 0.1, 0.3), "half": (0.572, 0.1, 0.35), "open": (-0.3, 0.1, 0.77)}
    boxes = {
        name: image_box_of(camera, at, (0.056 if name == "half" else 0.08, 0.08, 0.1), 0.0)
        for name, at in places.items()
    }
    kept = analysis.objects[0]
    objects = [kept.model_copy(update={"id": name, "placement": "surface", "box": box}) for name, box in boxes.items()]
    memory = Memory()
    memory.append("s01_analysis", analysis.model_copy(update={"objects": objects}), EntryMeta(time="t"))
    memory.append("s01_analysis", calibration, EntryMeta(time="t"))
    found = shown_distances(memory, room)
    assert set(found) == {"half", "open"}
    assert found["open"] < 0.01 and found["half"] < 0.02
    objects[2] = objects[2].model_copy(update={"box": image_box_of(camera, (-0.1, 0.1, 0.77), (0.08, 0.08, 0.1), 0.0)})
    memory.append("s01_analysis", analysis.model_copy(update={"objects": objects}), EntryMeta(time="t"))
    assert shown_distances(memory, room)["open"] == pytest.approx(0.2, abs=0.02)


def test_a_file_is_measured_as_a_whole(tmp_path: Path) -> None:
    built(TABLE, cup(0.72), cup(0.78, -0.2, "other"))
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "room.blend"))
    sheet = measure(tmp_path / "room.blend")
    assert [row.id for row in sheet.rows if not row.held] == ["other"] and sheet.support == pytest.approx(2 / 3)
    assert ("floats or sinks by more than 5 mm", "1 of 3", False) in summary(sheet)
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "empty.blend"))
    with pytest.raises(ValueError, match="no room"):
        measure(tmp_path / "empty.blend")
