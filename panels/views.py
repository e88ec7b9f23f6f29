# SPDX-License-Identifier: GPL-3.0-or-later
"""The panel Views: looking through the room's cameras, and rendering them."""

from __future__ import annotations

from typing import Any

from ..operators import render_ops
from ..operators.view_state import RoomState
from .base import RoomPanel
from .sentences import draw_sentence


class CODE_AS_ROOM_PT_views(RoomPanel):
    """The room's cameras."""

    bl_idname = "CODE_AS_ROOM_PT_views"
    bl_label = "Views"
    bl_order = 5
    bl_options = {"DEFAULT_CLOSED"}

    def draw_state(self, layout: Any, context: Any, state: RoomState) -> None:
        """A row for each camera, then how to render all of them."""
        found = render_ops.cameras(context.scene)
        if not found:
            draw_sentence(layout, "Views to render are here once the room has its light.", context)
            return
        active = context.scene.camera
        shown = str(active.get("code_as_room_id", "")) if active is not None else ""
        column = layout.column(align=True)
        for name, title in found:
            row = column.row(align=True)
            row.operator("code_as_room.show_view", text=title, depress=name == shown).camera = name
            row.operator("code_as_room.render_views", text="", icon="RENDER_STILL").camera = name
        settings = context.scene.code_as_room
        layout.row().prop(settings, "render_engine", expand=True)
        layout.row().prop(settings, "render_quality", expand=True)
        layout.operator("code_as_room.render_views", icon="RENDER_STILL").camera = ""
        said = render_ops.progress()
        if said:
            draw_sentence(layout, said, context, icon="TIME")
        if render_ops.folder_of(context.scene) is not None:
            layout.operator("code_as_room.open_views", icon="FILE_FOLDER")


CLASSES = (CODE_AS_ROOM_PT_views,)
