# SPDX-License-Identifier: GPL-3.0-or-later
"""The panel Stages: who answers, a row a stage, and the run that is going on."""

from __future__ import annotations

import time
from typing import Any

from ..operators import driver, view_state
from ..operators.job import Progress
from ..operators.view_state import RoomState, StageRow
from .base import RoomPanel, base_package
from .sentences import draw_sentence

ICONS = {"not run": "RADIOBUT_OFF", "done": "CHECKMARK", "stale": "FILE_REFRESH", "failed": "ERROR"}
STATUS = {"not run": "", "done": "done", "stale": "out of date", "failed": "failed"}
MOST_NOTICES = 3


class CODE_AS_ROOM_PT_stages(RoomPanel):
    """The stages and the run that is going on."""

    bl_idname = "CODE_AS_ROOM_PT_stages"
    bl_label = "Stages"
    bl_order = 2

    def draw_state(self, layout: Any, context: Any, state: RoomState) -> None:
        """What answers, a row a stage, progress, and how the last run ended."""
        draw_model(layout, context, state)
        settings = context.scene.code_as_room
        inputs = layout.column()
        inputs.enabled = not driver.is_running()
        if state.uses_model:
            inputs.prop(settings, "notes", text="", placeholder="Notes to the model")
        row = inputs.row()
        row.label(text="Layout rounds")
        row.prop(settings, "iterations", text="")
        progress = driver.progress_of(context.scene)
        if state.stages:
            column = layout.box().column(align=True)
            for stage in state.stages:
                draw_stage(column, stage, progress)
        if progress is not None:
            draw_progress(layout, context, progress)
        else:
            big = layout.row()
            big.scale_y = 1.4
            big.operator("code_as_room.run_all", icon="PLAY")
        draw_failures(layout, context, state, progress)
        draw_outcome(layout, context)


def draw_model(layout: Any, context: Any, state: RoomState) -> None:
    """What answers, and where that is chosen."""
    if state.client_problem is not None:
        problem = state.client_problem
        draw_sentence(layout, f"{problem.message} {problem.fix}".strip(), context, icon="ERROR", alert=True)
    else:
        draw_sentence(layout, state.answers, context, icon="WORLD" if state.uses_model else "DESKTOP")
    package = base_package()
    if package in context.preferences.addons:
        operator = layout.operator("preferences.addon_show", text="Choose Who Answers", icon="PREFERENCES")
        operator.module = package


def draw_failures(layout: Any, context: Any, state: RoomState, progress: Progress | None) -> None:
    """Why stages failed."""
    for stage in state.stages:
        if stage.status == "failed" and (progress is None or progress.stage != stage.id):
            draw_sentence(layout, f"{stage.title}: {stage.detail}", context, icon="ERROR", alert=True)


def draw_stage(layout: Any, stage: StageRow, progress: Progress | None) -> None:
    """One stage's row: state, title, buttons to run and to redo it."""
    running = progress is not None and progress.stage == stage.id
    row = layout.row(align=True)
    row.label(text=stage.title, icon="TIME" if running else ICONS[stage.status])
    state = row.row(align=True)
    state.alignment = "RIGHT"
    state.label(text="running" if running else STATUS[stage.status])
    buttons = row.row(align=True)
    buttons.enabled = not stage.blocked and progress is None
    again = buttons.row(align=True)
    again.enabled = stage.status in ("done", "stale", "failed")
    operator = again.operator("code_as_room.run_stage", text="", icon="LOOP_BACK", emboss=False)
    operator.stage, operator.fresh = stage.id, True
    operator = buttons.operator("code_as_room.run_stage", text="", icon="PLAY", emboss=False)
    operator.stage, operator.fresh = stage.id, False


def draw_progress(layout: Any, context: Any, progress: Progress) -> None:
    """What is being done, how far it is, and Stop."""
    box = layout.box().column()
    seconds = int(time.monotonic() - progress.began)
    box.progress(factor=progress.fraction, text=f"{progress.title}, {seconds} s", type="BAR")
    said = "Stopping" if progress.stopping else progress.what
    draw_sentence(box, said if not progress.note else f"{said}: {progress.note}", context)
    row = box.row()
    row.enabled = not progress.stopping
    row.operator("code_as_room.stop", icon="CANCEL")


def draw_outcome(layout: Any, context: Any) -> None:
    """How the last run or verb ended."""
    outcome = driver.outcome_of(context.scene)
    if outcome is None:
        return
    if outcome.text:
        draw_sentence(layout, outcome.text, context)
    for notice in outcome.notices[:MOST_NOTICES]:
        draw_sentence(layout, notice, context, icon="INFO")
    if len(outcome.notices) > MOST_NOTICES:
        layout.label(text=f"and {len(outcome.notices) - MOST_NOTICES} more")
    shown = [row.status for row in getattr(view_state.peek(context.scene), "stages", ())]
    if outcome.problem is not None and "failed" not in shown:
        text = f"{outcome.problem.message} {outcome.problem.fix}".strip()
        draw_sentence(layout, text, context, icon="ERROR", alert=True)


CLASSES = (CODE_AS_ROOM_PT_stages,)
