# SPDX-License-Identifier: GPL-3.0-or-later
"""What was corrected, in the window: told with how far, switched off for one thing or a kind, and put back by running again."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import bpy
import code_as_room
import pytest
from code_as_room.operators import driver, room_memory, view_state
from code_as_room.operators.scene_backend import ResolvedScene
from code_as_room.panels.finish import CODE_AS_ROOM_PT_finish as Panel
from code_as_room.panels.finish import CODE_AS_ROOM_PT_mended as Kinds
from code_as_room.pipeline.artifacts.analysis import Calibration, SceneAnalysis
from code_as_room.pipeline.artifacts.camera import CameraModel
from code_as_room.pipeline.artifacts.layout import Layout, LayoutProgram, ProxyLine, RoomLine, Score
from code_as_room.pipeline.memory import EntryMeta, now
from code_as_room.pipeline.program.lines import parse_layout, print_layout
from code_as_room.pipeline.stages import s10_finish
from noted_lines import drawn

SAMPLE = Path(__file__).resolve().parents[2] / "samples" / "bedroom"
SCORE = Score(total=1, measured=1, coverage=1, overlap=1, bounds=1, relations=1, boxes=1)
LOST = (9.0, 0.0, 0.4)
"""Where a chair stands that somebody put far outside of the room."""


@pytest.fixture(autouse=True)
def scene(analysis: SceneAnalysis) -> Iterator[Any]:
    bpy.ops.wm.read_factory_settings(use_empty=True)
    code_as_room.register()
    bpy.ops.code_as_room.load_picture(filepath=str(SAMPLE / "picture.png"))
    truth = json.loads((SAMPLE / "truth.json").read_text(encoding="utf-8"))
    floor = truth["room"]["floor"]
    chair = ProxyLine(id="chair", category="chair", centre=LOST, size=(0.5, 0.5, 0.8), yaw=0, placement="floor")
    layout = Layout(room=RoomLine(size=truth["room"]["size"], floor=floor), proxies=[chair])
    camera = CameraModel.model_validate(truth["camera"])
    run, meta = room_memory.run_of(bpy.context.scene), EntryMeta(time=now())
    calibration = Calibration(camera=camera, floor=floor, height=2.6, error_px=0, scale_source="truth")
    run.memory.append("s01_analysis", analysis.model_copy(update={"view": "perspective", "architecture": []}), meta)
    run.memory.append("s01_analysis", calibration, meta)
    run.memory.append("s09_textures", LayoutProgram(text=print_layout(layout), stage="s09_textures", score=SCORE), meta)
    room_memory.keep(run)
    view_state.refresh(bpy.context.scene)
    yield bpy.context.scene
    code_as_room.unregister()


def finish() -> None:
    driver.start(bpy.context.scene, [s10_finish.STAGE], again=True)
    outcome = driver.run_blocking()
    assert outcome.problem is None, outcome.problem


def place() -> tuple[float, ...]:
    chair = parse_layout(ResolvedScene(bpy.context.scene).program_text()).proxy("chair")
    assert chair is not None
    return tuple(chair.centre)


def test_before_the_stage_has_run_it_says_so() -> None:
    assert "once the last stage has run" in drawn(Panel).replace(" | ", " ")


def test_a_correction_is_told_and_can_be_taken_back_alone() -> None:
    finish()
    assert place() != LOST
    text = drawn(Panel).replace(" | ", " ")
    assert "1 correction" in text and "chair" in text.lower() and " cm" in text and "CHECKBOX_HLT" in text
    (row,) = view_state.refresh(bpy.context.scene).finish.fixes
    bpy.ops.code_as_room.spare(key=row.key)
    assert view_state.refresh(bpy.context.scene).finish.waits and "CHECKBOX_DEHLT" in drawn(Panel).replace(" | ", " ")
    assert "Run Light and Views Again" in drawn(Panel).replace(" | ", " ")
    finish()
    assert place() == LOST
    state = view_state.refresh(bpy.context.scene).finish
    assert not state.fixes and not state.waits and "You keep it as it is" in state.left[0]
    bpy.ops.code_as_room.spare(key=row.key)
    finish()
    assert place() != LOST


def test_a_kind_that_is_switched_off_is_found_and_left() -> None:
    settings = bpy.context.scene.code_as_room
    assert "corrections" in drawn(Kinds).replace(" | ", " ")
    settings.corrections = settings.corrections - {"outside"}
    finish()
    assert place() == LOST
    assert "switched off" in drawn(Panel).replace(" | ", " ")
