# SPDX-License-Identifier: GPL-3.0-or-later
"""The panel Light and Corrections: how the room is lit, what was mended in it, and what the artist keeps as it was."""

from __future__ import annotations

from typing import Any

from ..operators import driver, view_state
from ..operators.finish_rows import FixRow
from ..operators.view_state import RoomState
from .base import RoomPanel
from .sentences import draw_sentence, plural

MOST = 10


class CODE_AS_ROOM_PT_finish(RoomPanel):
    """The light, and what was corrected."""

    bl_idname = "CODE_AS_ROOM_PT_finish"
    bl_label = "Light and Corrections"
    bl_order = 4
    bl_options = {"DEFAULT_CLOSED"}

    def draw_state(self, layout: Any, context: Any, state: RoomState) -> None:
        """The light in words, a row a correction, and what was left."""
        finish = state.finish
        if not finish.ran:
            draw_sentence(layout, "The light, and what was mended, is told here once the last stage has run.", context)
            return
        column = layout.column(align=True)
        for number, sentence in enumerate(finish.light):
            draw_sentence(column, sentence, context, icon="LIGHT_SUN" if number == 0 else "BLANK1")
        if finish.fixes:
            layout.label(text=f"{plural(len(finish.fixes), 'correction')}; untick what shall stay")
            box = layout.box().column()
            for row in finish.fixes[:MOST]:
                draw_fix(box, context, row)
            if len(finish.fixes) > MOST:
                box.label(text=f"and {len(finish.fixes) - MOST} more, in the report")
        else:
            draw_sentence(layout, "Nothing had to be mended.", context, icon="CHECKMARK")
        for sentence in finish.left[:MOST]:
            draw_sentence(layout, sentence, context, icon="ERROR")
        if finish.waits:
            draw_sentence(layout, "You have switched corrections since.", context, icon="INFO")
            again = layout.row()
            again.enabled = not driver.is_running()
            operator = again.operator("code_as_room.run_stage", text="Run Light and Views Again", icon="FILE_REFRESH")
            operator.stage = "s10_finish"


def draw_fix(column: Any, context: Any, row: FixRow) -> None:
    """One correction: a tick, the thing, how far, and why."""
    line = column.row(align=True)
    line.enabled = not driver.is_running()
    icon = "CHECKBOX_DEHLT" if row.spared else "CHECKBOX_HLT"
    line.operator("code_as_room.spare", text="", icon=icon, emboss=False).key = row.key
    name = line.row()
    name.active = not row.spared
    name.label(text=f"{row.title}, {row.change}" if row.change else row.title)
    draw_sentence(column, row.message, context, icon="BLANK1")


class CODE_AS_ROOM_PT_mended(RoomPanel):
    """Which kinds of faults are mended."""

    bl_idname = "CODE_AS_ROOM_PT_mended"
    bl_label = "What Is Mended"
    bl_parent_id = "CODE_AS_ROOM_PT_finish"
    bl_options = {"DEFAULT_CLOSED"}

    @classmethod
    def poll(cls, context: Any) -> bool:
        """Only where there is a room to finish."""
        state = view_state.peek(context.scene)
        return state is not None and bool(state.stages)

    def draw_state(self, layout: Any, context: Any, state: RoomState) -> None:
        """A tick for each kind."""
        column = layout.column(align=True)
        column.enabled = not driver.is_running()
        column.prop(context.scene.code_as_room, "corrections")


CLASSES = (CODE_AS_ROOM_PT_finish, CODE_AS_ROOM_PT_mended)
