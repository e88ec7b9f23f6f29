# SPDX-License-Identifier: GPL-3.0-or-later
"""The tab "Room" in the 3D view's sidebar, in the order of the work. `draw` only reads what was worked out before."""

from __future__ import annotations

import time
from typing import Any

import bpy

from ..operators import driver, handlers, rooms, view_state
from ..operators.job import Progress
from ..operators.view_state import RoomState, StageRow
from .sentences import draw_sentence, plural

ICONS = {"not run": "RADIOBUT_OFF", "done": "CHECKMARK", "stale": "FILE_REFRESH", "failed": "ERROR"}
STATUS = {"not run": "", "done": "done", "stale": "out of date", "failed": "failed"}
MOST_NOTICES = 3
SEVERITY_ICONS = {"error": "ERROR", "warning": "ERROR", "note": "INFO"}


class RoomPanel(bpy.types.Panel):
    """Base of the panels."""

    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"
    bl_category = "Room"

    def draw(self, context: bpy.types.Context) -> None:
        """Draw from the state, or ask for it to be worked out."""
        layout: Any = self.layout
        state = view_state.peek(context.scene)
        if state is None:
            handlers.look_soon()
            layout.label(text="Reading the room", icon="TIME")
            return
        self.draw_state(layout, context, state)

    def draw_state(self, layout: Any, context: Any, state: RoomState) -> None:
        """Draw from the state."""
        raise NotImplementedError


class CODE_AS_ROOM_PT_reference(RoomPanel):
    """The picture of the room."""

    bl_idname = "CODE_AS_ROOM_PT_reference"
    bl_label = "Reference"
    bl_order = 0

    def draw_state(self, layout: Any, context: Any, state: RoomState) -> None:
        """Thumbnail, name and size, and where a picture comes from."""
        image = context.scene.code_as_room.picture
        if image is not None and state.picture_name:
            layout.template_icon(icon_value=layout.icon(image), scale=7.0)
            width, height = state.picture_size
            column = layout.column(align=True)
            column.scale_y = 0.85
            column.label(text=state.picture_name)
            if width:
                column.label(text=f"{width} x {height} pixels")
        else:
            draw_sentence(layout, "Load a picture of a room, seen from above.", context)
        row = layout.row(align=True)
        row.operator(
            "code_as_room.load_picture", text="Load Picture" if image is None else "Change", icon="FILE_FOLDER"
        )
        row.operator("code_as_room.use_image", text="", icon="IMAGE_DATA")
        if state.has_memory:
            layout.operator("code_as_room.new_room", icon="FILE_NEW")
        if state.problem is not None:
            text = f"{state.problem.message} {state.problem.fix}".strip()
            draw_sentence(layout, text, context, icon="ERROR", alert=True)


class CODE_AS_ROOM_PT_calibration(RoomPanel):
    """What is known of the room's size, and what was found."""

    bl_idname = "CODE_AS_ROOM_PT_calibration"
    bl_label = "Calibration"
    bl_order = 1

    def draw_state(self, layout: Any, context: Any, state: RoomState) -> None:
        """Known lengths, and the room that follows from them."""
        settings = context.scene.code_as_room
        column = layout.column()
        column.enabled = not driver.is_running()
        for switch, value in (("use_known_width", "known_width"), ("use_wall_height", "wall_height")):
            row = column.row(align=True)
            row.prop(settings, switch)
            field = row.row()
            field.enabled = getattr(settings, switch)
            field.prop(settings, value, text="")
        if state.room_size is None:
            draw_sentence(layout, "Sizes are estimated where you give none.", context)
            return
        width, depth, height = state.room_size
        box = layout.box().column(align=True)
        box.scale_y = 0.85
        box.label(text=f"Room {width:.2f} x {depth:.2f} x {height:.2f} m")
        box.label(text=f"{state.camera_kind.capitalize()} camera")
        box.label(text=f"Corners fit within {state.error_px:.1f} pixels")
        if state.stages and state.stages[0].status == "stale":
            draw_sentence(layout, "Run the analysis again to use what you changed.", context, icon="FILE_REFRESH")


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


class CODE_AS_ROOM_PT_room(RoomPanel):
    """What became of what was seen."""

    bl_idname = "CODE_AS_ROOM_PT_room"
    bl_label = "Room"
    bl_order = 3

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Only where something was seen."""
        state = view_state.peek(context.scene)
        return state is not None and bool(state.ledger)

    def draw_state(self, layout: Any, context: Any, state: RoomState) -> None:
        """Counts of objects and findings."""
        column = layout.column(align=True)
        column.label(text=", ".join(f"{count} {word}" for word, count in state.ledger), icon="OBJECT_DATA")
        if state.score is not None:
            column.label(text=f"Layout score {state.score:.2f} of 1", icon="CHECKMARK")
        if state.hand_edits:
            column.label(text=f"{plural(state.hand_edits, 'edit')} by hand taken over", icon="LOCKED")
        for severity, count in state.severities:
            column.label(text=plural(count, severity), icon=SEVERITY_ICONS[severity])
        for finding in state.findings:
            if finding.severity != "note":
                draw_sentence(layout, f"{finding.about}: {finding.message}", context)


class CODE_AS_ROOM_PT_output(RoomPanel):
    """What the artist takes away."""

    bl_idname = "CODE_AS_ROOM_PT_output"
    bl_label = "Output"
    bl_order = 4

    def draw_state(self, layout: Any, context: Any, state: RoomState) -> None:
        """Write the results; look at the texts."""
        layout.operator("code_as_room.write_outputs", icon="EXPORT")
        row = layout.row(align=True)
        row.enabled = state.has_memory
        row.operator("code_as_room.open_text", text="Program", icon="TEXT").which = "PROGRAM"
        row.operator("code_as_room.open_text", text="Memory", icon="TEXT").which = "MEMORY"
        folder = rooms.results_of(context.scene)
        if folder is not None:
            layout.operator("code_as_room.open_report", icon="URL")
            draw_sentence(layout, f"Written to {folder}", context)


def base_package() -> str:
    """The name under which the add-on is enabled."""
    from .. import __package__ as package

    return package or ""


CLASSES = (
    CODE_AS_ROOM_PT_reference,
    CODE_AS_ROOM_PT_calibration,
    CODE_AS_ROOM_PT_stages,
    CODE_AS_ROOM_PT_room,
    CODE_AS_ROOM_PT_output,
)
