# SPDX-License-Identifier: GPL-3.0-or-later
"""The panel Reference: the picture of the room."""

from __future__ import annotations

from typing import Any

from ..operators.view_state import RoomState
from .base import RoomPanel
from .sentences import draw_sentence


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


CLASSES = (CODE_AS_ROOM_PT_reference,)
