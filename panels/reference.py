# SPDX-License-Identifier: GPL-3.0-or-later
"""The panel Reference: the picture of the room, where it comes from, and looking at the room through its camera."""

from __future__ import annotations

from typing import Any

from ..operators import fitted_view
from ..operators.view_state import RoomState
from .base import RoomPanel
from .sentences import draw_sentence


class CODE_AS_ROOM_PT_reference(RoomPanel):
    """The picture of the room."""

    bl_idname = "CODE_AS_ROOM_PT_reference"
    bl_label = "Reference"
    bl_order = 0

    def draw_state(self, layout: Any, context: Any, state: RoomState) -> None:
        """Thumbnail, name and size, where a picture comes from, and how it is seen in the view."""
        image = context.scene.code_as_room.picture
        if state.problem is not None:
            text = f"{state.problem.message} {state.problem.fix}".strip()
            draw_sentence(layout, text, context, icon="ERROR", alert=True)
        if image is not None and state.picture_name:
            _draw_thumbnail(layout, image, state)
        elif image is None:
            draw_sentence(layout, "Load a picture of a room, seen from above. You can also drop it here.", context)
        _draw_sources(layout, image is not None)
        if image is not None:
            _draw_view(layout, context)
        if state.has_memory:
            layout.operator("code_as_room.new_room", icon="FILE_NEW")


def _draw_thumbnail(layout: Any, image: Any, state: RoomState) -> None:
    width, height = state.picture_size
    if width:
        layout.template_icon(icon_value=layout.icon(image), scale=7.0)
    column = layout.column(align=True)
    column.scale_y = 0.85
    column.label(text=state.picture_name)
    if width:
        column.label(text=f"{width} x {height} pixels")


def _draw_sources(layout: Any, has_picture: bool) -> None:
    """A file, the clipboard, an image that is open."""
    row = layout.row(align=True)
    text = "Change" if has_picture else "Load Picture"
    row.operator("code_as_room.load_picture", text=text, icon="FILE_FOLDER")
    row.operator("code_as_room.paste_picture", text="", icon="PASTEDOWN")
    row.operator("code_as_room.use_image", text="", icon="IMAGE_DATA")


def _draw_view(layout: Any, context: Any) -> None:
    """Looking through the camera, and the picture's part in what is seen."""
    settings = context.scene.code_as_room
    looking = fitted_view.is_looking_through(context)
    column = layout.column(align=True)
    text = "Back to the Former View" if looking else "Look Through Fitted Camera"
    column.operator("code_as_room.look_through", text=text, icon="CAMERA_DATA", depress=looking)
    row = column.row(align=True)
    row.prop(settings, "reference_opacity", slider=True)
    row.prop(settings, "reference_in_front", text="", icon="IMAGE_REFERENCE")
    space = context.space_data
    if looking and space is not None and not space.overlay.show_overlays:
        draw_sentence(layout, "Overlays are off in this view, so the picture is not shown.", context, icon="INFO")


CLASSES = (CODE_AS_ROOM_PT_reference,)
