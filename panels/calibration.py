# SPDX-License-Identifier: GPL-3.0-or-later
"""The panel Calibration: what is known of the room's size, and what was found."""

from __future__ import annotations

from typing import Any

from ..operators import driver
from ..operators.view_state import RoomState
from .base import RoomPanel
from .sentences import draw_sentence


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


CLASSES = (CODE_AS_ROOM_PT_calibration,)
