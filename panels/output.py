# SPDX-License-Identifier: GPL-3.0-or-later
"""The panel Output: what the artist takes away."""

from __future__ import annotations

from typing import Any

from ..operators import rooms
from ..operators.view_state import RoomState
from .base import RoomPanel, can_now
from .sentences import draw_sentence


class CODE_AS_ROOM_PT_output(RoomPanel):
    """What the artist takes away."""

    bl_idname = "CODE_AS_ROOM_PT_output"
    bl_label = "Output"
    bl_order = 6

    def draw_state(self, layout: Any, context: Any, state: RoomState) -> None:
        """Write the results; look at the texts; apply an edited program."""
        if can_now("code_as_room.apply_program"):
            draw_sentence(layout, "The room's program was edited.", context, icon="GREASEPENCIL")
            layout.operator("code_as_room.apply_program", icon="CHECKMARK")
        layout.operator("code_as_room.write_outputs", icon="EXPORT")
        row = layout.row(align=True)
        row.operator("code_as_room.export_glb")
        row.operator("code_as_room.export_usdz")
        folder = rooms.results_of(context.scene)
        if folder is not None:
            row = layout.row(align=True)
            row.operator("code_as_room.open_report", text="Report", icon="URL")
            row.operator("code_as_room.open_results", text="Folder", icon="FILE_FOLDER").what = "FOLDER"
            row = layout.row(align=True)
            row.operator("code_as_room.open_results", text="From Above", icon="IMAGE_DATA").what = "TOP"
            row.operator("code_as_room.open_results", text="From a Corner", icon="IMAGE_DATA").what = "VIEW"
            draw_sentence(layout, f"Written to {folder}", context)
        row = layout.row(align=True)
        row.enabled = state.has_memory
        row.operator("code_as_room.open_text", text="Program", icon="TEXT").which = "PROGRAM"
        row.operator("code_as_room.open_text", text="Memory", icon="TEXT").which = "MEMORY"
        row.operator("code_as_room.show_prompts", text="Prompts", icon="TEXT")


CLASSES = (CODE_AS_ROOM_PT_output,)
