# SPDX-License-Identifier: GPL-3.0-or-later
"""The panel Output: what the artist takes away."""

from __future__ import annotations

from typing import Any

from ..operators import rooms
from ..operators.view_state import RoomState
from .base import RoomPanel
from .sentences import draw_sentence


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


CLASSES = (CODE_AS_ROOM_PT_output,)
