# SPDX-License-Identifier: GPL-3.0-or-later
"""The panel Stages: who answers, a row a stage with its verbs, and the run that is going on."""

from __future__ import annotations

import time
from typing import Any

import bpy

from ..operators import driver, journals, stage_ops, view_state, ways
from ..operators.job import Progress
from ..operators.view_state import RoomState, StageRow
from .base import RoomPanel, base_package, known_operator
from .draft import draw_button, draw_verdict, draw_way
from .sentences import draw_sentence, line_length, plural

ICONS = {
    "not run": "RADIOBUT_OFF",
    "answered": "RADIOBUT_ON",
    "done": "CHECKMARK",
    "drafted": "GREASEPENCIL",
    "stale": "FILE_REFRESH",
    "failed": "ERROR",
}
STATUS = {
    "not run": "",
    "answered": "answered, not applied",
    "done": "done",
    "drafted": "drafted",
    "stale": "out of date",
    "failed": "failed",
}
MOST_NOTICES = 3
_WIDE = 30
"""Characters from which a row has room for its status in words."""


class CODE_AS_ROOM_PT_running(RoomPanel):
    """The run that is going on: first in the tab, so that it stays in sight while the panels below grow."""

    bl_idname = "CODE_AS_ROOM_PT_running"
    bl_label = "Running"
    bl_options = {"HIDE_HEADER"}
    bl_order = 0

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Only while this scene's room is worked on."""
        return driver.progress_of(context.scene) is not None

    def draw_state(self, layout: Any, context: Any, state: RoomState) -> None:
        """How far it is, what it took, and Stop."""
        progress = driver.progress_of(context.scene)
        if progress is not None:
            draw_progress(layout, context, progress)


class CODE_AS_ROOM_PT_stages(RoomPanel):
    """The stages and the run that is going on."""

    bl_idname = "CODE_AS_ROOM_PT_stages"
    bl_label = "Stages"
    bl_order = 3

    def draw_state(self, layout: Any, context: Any, state: RoomState) -> None:
        """What answers, a row a stage, progress, and how the last run ended."""
        draw_model(layout, context, state)
        progress = driver.progress_of(context.scene)
        draw_way(layout, context, state, progress is None)
        if state.stages:
            column = layout.box().column(align=True)
            for stage in state.stages:
                draw_stage(column, context, stage, progress)
        big = layout.row()
        big.scale_y = 1.4
        if progress is None:
            draw_button(big, state)
            draw_verdict(layout, context, state)
            for sentence in (state.estimate, state.spending):
                if sentence:
                    draw_sentence(layout, sentence, context)
        else:
            big.enabled = not progress.stopping
            big.operator("code_as_room.stop", text="Stop (Esc)", icon="CANCEL")
        draw_states(layout, context, state, progress)
        draw_outcome(layout, context)


class CODE_AS_ROOM_PT_options(RoomPanel):
    """What the stages are told."""

    bl_idname = "CODE_AS_ROOM_PT_options"
    bl_label = "Options"
    bl_parent_id = "CODE_AS_ROOM_PT_stages"
    bl_options = {"DEFAULT_CLOSED"}

    def draw_state(self, layout: Any, context: Any, state: RoomState) -> None:
        """Notes, and how many rounds."""
        settings = context.scene.code_as_room
        column = layout.column()
        column.use_property_split = True
        column.use_property_decorate = False
        column.enabled = not driver.is_running()
        notes = column.row()
        notes.active = state.uses_model
        notes.prop(settings, "notes", placeholder="Hint for the model")
        column.prop(settings, "iterations")
        column.prop(settings, "modelling")
        column.prop(settings, "use_assets")
        if known_operator("code_as_room.forget_answers"):
            layout.operator("code_as_room.forget_answers", icon="TRASH")


class StageMenu(bpy.types.Menu):
    """Base of the stages' menus: one class a stage, since Blender's menus take no argument."""

    bl_label = "Stage"
    stage = ""

    def draw(self, context: bpy.types.Context) -> None:
        """The verbs; those that cannot be done now are grey, and their tooltip says why."""
        layout: Any = self.layout
        state = view_state.peek(context.scene)
        row = state.stage(self.stage) if state is not None else None
        if row is None:
            return
        layout.operator_context = "INVOKE_DEFAULT"
        ran = row.status in stage_ops.RAN
        _verb(layout, "code_as_room.run_stage", "Run", "PLAY", row, not row.blocked)
        left = state is not None and row in state.left
        _verb(layout, "code_as_room.run_to", "Run to Here", "TRACKING_FORWARDS", row, left)
        layout.separator()
        operator = _verb(layout, "code_as_room.run_stage", "Redo", "LOOP_BACK", row, ran and not row.blocked)
        operator.fresh = True
        partial = ran and not row.blocked and not stage_ops.partial_blocker(context, row)
        text = "Redo Selected Objects Only"
        operator = _verb(layout, "code_as_room.run_stage", text, "RESTRICT_SELECT_OFF", row, partial)
        operator.fresh, operator.selected = True, True
        _verb(layout, "code_as_room.redo_from", "Redo from Here", "FILE_REFRESH", row, ran and not row.blocked)


def _verb(layout: Any, name: str, text: str, icon: str, stage: StageRow, enabled: bool) -> Any:
    """An entry of a stage's menu."""
    row = layout.row()
    row.enabled = enabled
    operator = row.operator(name, text=text, icon=icon)
    operator.stage = stage.id
    return operator


def menu_name(stage: str) -> str:
    """The identifier of a stage's menu."""
    return f"CODE_AS_ROOM_MT_{stage}"


def _stage_menus() -> tuple[type, ...]:
    return tuple(
        type(menu_name(stage.id), (StageMenu,), {"bl_idname": menu_name(stage.id), "stage": stage.id})
        for stage in ways.path_of("draft")
    )


def draw_model(layout: Any, context: Any, state: RoomState) -> None:
    """What answers, and where that is chosen."""
    row = layout.row()
    if state.client_problem is not None:
        draw_sentence(row, state.client_problem.sentence, context, icon="ERROR", alert=True, beside=1)
    else:
        draw_sentence(row, state.answers, context, icon="WORLD" if state.uses_model else "DESKTOP", beside=1)
    package = base_package()
    if package in context.preferences.addons:
        operator = row.operator("preferences.addon_show", text="", icon="PREFERENCES")
        operator.module = package


def draw_stage(layout: Any, context: Any, stage: StageRow, progress: Progress | None) -> None:
    """One stage's row: state, title, a button that runs it, and its menu."""
    running = progress is not None and progress.stage == stage.id
    row = layout.row(align=True)
    row.label(text=stage.title, icon="TIME" if running else ICONS.get(stage.status, "QUESTION"))
    said = "running" if running else STATUS.get(stage.status, stage.status)
    if said and len(said) < 14 and line_length(context) >= _WIDE:
        words = row.row(align=True)
        words.alignment = "RIGHT"
        words.active = stage.status in ("stale", "failed") or running
        words.label(text=said)
    buttons = row.row(align=True)
    buttons.enabled = progress is None
    run = buttons.row(align=True)
    run.enabled = not stage.blocked
    operator = run.operator("code_as_room.run_stage", text="", icon="PLAY", emboss=False)
    operator.stage = stage.id
    buttons.menu(menu_name(stage.id), text="", icon="DOWNARROW_HLT")


def draw_states(layout: Any, context: Any, state: RoomState, progress: Progress | None) -> None:
    """Why stages failed, and which ones wait with an answer."""
    for stage in state.stages:
        if progress is not None and progress.stage == stage.id:
            continue
        if stage.status == "failed":
            draw_sentence(layout, f"{stage.title}: {stage.detail}", context, icon="ERROR", alert=True)
        elif stage.status == "answered":
            text = f"{stage.title}: answered, not applied. Run it: nothing is asked again."
            draw_sentence(layout, text, context, icon="RADIOBUT_ON")
    sentence = journals.problem_of(context.scene)
    if sentence:
        draw_sentence(layout, sentence, context, icon="ERROR")


def draw_progress(layout: Any, context: Any, progress: Progress) -> None:
    """What is being done, how far it is, what it took, and Stop."""
    box = layout.column()
    title = progress.title or "Starting"
    if progress.total > 1:
        title = f"{title}, {max(1, progress.number)} of {progress.total}"
    box.progress(factor=progress.fraction, text=title, type="BAR")
    said = "Stopping" if progress.stopping else progress.what
    draw_sentence(box, said if not progress.note else f"{said}: {progress.note}", context)
    draw_sentence(box, time_in_words(progress, time.monotonic()), context, icon="TIME")
    took = costs_in_words(progress)
    if took:
        draw_sentence(box, took, context, icon="WORLD")
    row = box.row()
    row.enabled = not progress.stopping
    row.operator("code_as_room.stop", text="Stop (Esc)", icon="CANCEL")


def time_in_words(progress: Progress, now: float) -> str:
    """How long it has been, and about how long it will be, "1 min 5 s, about 40 s left"."""
    passed = max(0, int(now - progress.began))
    expected = progress.expected
    if expected is None:
        return seconds_in_words(passed)
    left = int(expected - passed)
    if left <= 0:
        return f"{seconds_in_words(passed)}, longer than expected"
    # An estimate to the second would only look exact.
    rounded = left if left < 10 else -(-left // 5) * 5 if left < 60 else -(-left // 30) * 30
    return f"{seconds_in_words(passed)}, about {seconds_in_words(rounded)} left"


def seconds_in_words(seconds: int) -> str:
    """ "45 s", "2 min", "2 min 5 s"."""
    minutes, rest = divmod(seconds, 60)
    if not minutes:
        return f"{rest} s"
    return f"{minutes} min {rest} s" if rest else f"{minutes} min"


def costs_in_words(progress: Progress) -> str:
    """This run's requests, and the room's tokens and dollars so far; "" when nothing was asked."""
    said = []
    if progress.calls_open:
        said.append(f"{plural(progress.calls_open, 'request')} open")
    if progress.calls_done:
        said.append(f"{progress.calls_done} answered")
    tokens, cost = progress.tokens, progress.cost
    if tokens:
        said.append(f"{tokens / 1000:.1f}k tokens" if tokens >= 1000 else plural(tokens, "token"))
    if cost:
        said.append(f"${cost:.2f}" if cost >= 0.01 else f"${cost:.4f}")
    return ", ".join(said)


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
        draw_sentence(layout, outcome.problem.sentence, context, icon="ERROR", alert=True)


CLASSES = (CODE_AS_ROOM_PT_stages, CODE_AS_ROOM_PT_options)
PARTS = _stage_menus()
