# SPDX-License-Identifier: GPL-3.0-or-later
"""A room in one answer, and going on from it."""

from __future__ import annotations

import textwrap
from typing import Any

import bpy

from ..pipeline.draft.refine import Step, plan
from ..pipeline.errors import RoomError
from . import clients, consent, driver, room_memory, view_state, ways
from .base import RoomOperator, allow, busy_blocker, manager, stage_blocker
from .stage_ops import StageOperator, start_left

_WIDTH, _CHARACTERS = 440, 72


class CODE_AS_ROOM_OT_draft_room(StageOperator):
    """Let the model write the whole room in one answer: it grows while it is written, and what stands when you stop stays"""

    bl_idname = "code_as_room.draft_room"
    bl_label = "Draft Room"
    bl_options = {"REGISTER"}

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """The model must be one that drafts."""
        state = view_state.peek(context.scene)
        offered = state is None or state.offers_draft
        reason = "" if offered else "What answers now cannot write a whole room; choose a model in the preferences"
        return allow(cls, stage_blocker(context) or reason)

    def begin(self, context: bpy.types.Context) -> None:
        """Start the draft and what follows from it; all of it anew where it is done."""
        scene, stages = context.scene, ways.path_of("draft")
        state = view_state.peek(scene)
        row = state.stage(ways.DRAFT) if state is not None else None
        if row is not None and not row.is_done:
            start_left(context, None)
            return
        again = state is not None and state.has_draft
        driver.start(scene, stages, again=again, fresh=again, derived=ways.derived(scene, stages))


class CODE_AS_ROOM_OT_go_staged(RoomOperator):
    """Go on stage by stage: what was understood stays, and each stage is asked on top of the draft when you run it"""

    bl_idname = "code_as_room.go_staged"
    bl_label = "Go on Stage by Stage"
    bl_options = {"REGISTER"}

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Nothing may be going on."""
        return allow(cls, busy_blocker(context))

    def perform(self, context: bpy.types.Context) -> None:
        """Choose the other way."""
        ways.choose("stages")
        view_state.refresh_all()
        driver.redraw()


class CODE_AS_ROOM_OT_refine_all(StageOperator):
    """Ask for what the draft's measured findings call for, and nothing else; what would be no better stays as it is"""

    bl_idname = "code_as_room.refine_all"
    bl_label = "Refine All"
    bl_options = {"REGISTER"}

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """There must be a finished draft."""
        state = view_state.peek(context.scene)
        ready = state is not None and state.has_draft and not any(row.status == "not run" for row in state.stages)
        return allow(cls, stage_blocker(context) or ("" if ready else "Draft the room first, to its end"))

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[Any]:
        """Show what would be asked and what it may cost."""
        if bpy.app.background:
            return self.execute(context)
        if consent.ask_first(context, self):
            return {"FINISHED"}
        try:
            self._lines = refine_lines(context.scene)
        except RoomError as error:
            return self.refuse(context, error)
        result: set[Any] = manager(context).invoke_props_dialog(
            self, width=_WIDTH, title="Refine All", confirm_text="Refine"
        )
        return result

    def draw(self, context: bpy.types.Context) -> None:
        """The steps and the estimate."""
        layout: Any = self.layout
        column = layout.column(align=True)
        for line, icon in getattr(self, "_lines", []):
            for number, part in enumerate(textwrap.wrap(line, _CHARACTERS)):
                column.label(text=part, icon=icon if number == 0 else "BLANK1")

    def execute(self, context: bpy.types.Context) -> set[Any]:
        """After the dialog: start, and let the timer go on; a script waits for the end."""
        if bpy.app.background:
            return super().execute(context)
        try:
            self.begin(context)
        except RoomError as error:
            return self.refuse(context, error)
        driver.run_in_window()
        return {"FINISHED"}

    def begin(self, context: bpy.types.Context) -> None:
        """Start the steps."""
        driver.start_refining(context.scene, steps_of(context.scene), self.bl_label)


def steps_of(scene: Any) -> list[Step]:
    """What a drafted room calls for; RoomError where nothing does."""
    steps = plan(room_memory.memory_of(scene))
    if not steps:
        raise RoomError("Nothing that was measured calls for refining.", "Redo any stage by hand if you want another.")
    return steps


def refine_lines(scene: Any) -> list[tuple[str, str]]:
    """What would be asked, why, and what it may cost: sentences, each with its icon."""
    steps, titles = steps_of(scene), {stage.id: stage.title for stage in ways.path_of("draft")}
    lines = [(f"{titles[step.stage]}: {step.why}", "DOT") for step in steps]
    estimate = clients.refine_estimate(steps)
    if estimate is not None:
        lines.append((f"{estimate.sentence()}.", "WORLD"))
    lines.append(("What is no better afterwards is taken back. All of it is one undo step.", "NONE"))
    return lines


CLASSES = (CODE_AS_ROOM_OT_draft_room, CODE_AS_ROOM_OT_go_staged, CODE_AS_ROOM_OT_refine_all)
