# SPDX-License-Identifier: GPL-3.0-or-later
"""The panel Calibration: how the room was seen and how large it is, and what the artist knows better."""

from __future__ import annotations

from typing import Any

from ..operators import driver
from ..operators.overlay import length_field, shown
from ..operators.view_state import RoomState
from ..pipeline.geometry.measuring import fit_quality
from .base import RoomPanel
from .sentences import draw_sentence
from .through_camera import draw_look_through

QUALITY_ICONS = {"good": "CHECKMARK", "fair": "INFO", "poor": "ERROR"}
CAMERAS = {"perspective": "Perspective camera", "orthographic": "Straight-down plan, no perspective"}


class CODE_AS_ROOM_PT_calibration(RoomPanel):
    """How the room was seen and how large it is."""

    bl_idname = "CODE_AS_ROOM_PT_calibration"
    bl_label = "Calibration"
    bl_order = 1

    def draw_state(self, layout: Any, context: Any, state: RoomState) -> None:
        """What was found, the handles, and the lengths that are known."""
        if not state.picture_name:
            draw_sentence(layout, "Load a picture first.", context)
            return
        if state.room_size is not None:
            draw_found(layout, context, state)
            draw_handles(layout, context)
        draw_known(layout, context, state)
        if state.room_size is None:
            text = "Sizes are estimated where you give none. Corners and lengths can be set after the scene analysis."
            draw_sentence(layout, text, context)


def draw_found(layout: Any, context: Any, state: RoomState) -> None:
    """The room's size and how sure it is, the camera, and how well both fit."""
    assert state.room_size is not None
    width, depth, height = state.room_size
    box = layout.box().column(align=True)
    box.label(text=f"{width:.2f} x {depth:.2f} m, {height:.2f} m high", icon="HOME")
    if state.scale_words:
        draw_sentence(box, f"{state.scale_words}.", context, "DRIVER_DISTANCE")
    camera = f"Taken {state.camera_name}" if state.camera_name else CAMERAS.get(state.camera_kind, state.camera_kind)
    draw_sentence(box, f"{camera}.", context, "CAMERA_DATA")
    quality = fit_quality(state.error_px, state.picture_size)
    text = f"Fits within {state.error_px:.1f} px: {quality}"
    row = box.row()
    row.alignment = "LEFT"
    row.alert = quality == "poor"
    row.operator("code_as_room.explain_fit", text=text, icon=QUALITY_ICONS[quality], emboss=False)


def draw_handles(layout: Any, context: Any) -> None:
    """The corners as handles; they need the view through the camera."""
    settings = context.scene.code_as_room
    row = layout.row(align=True)
    row.prop(settings, "show_corners", text="Corner Handles", icon="HANDLE_VECTOR", toggle=True)
    row.operator("code_as_room.reset_corners", text="", icon="LOOP_BACK")
    draw_look_through(layout, context, settings.show_corners, "Drag the corners in the view.")


def draw_known(layout: Any, context: Any, state: RoomState) -> None:
    """What the artist knows: a length, the width, the height of the walls."""
    settings = context.scene.code_as_room
    column = layout.column(align=True)
    column.enabled = not driver.is_running()
    if state.room_size is not None:
        draw_length(column.row(align=True), context)
        column.separator(factor=0.6)
    for switch, value in (("use_known_width", "known_width"), ("use_wall_height", "wall_height")):
        row = column.row(align=True)
        row.prop(settings, switch)
        field = row.row(align=True)
        field.enabled = getattr(settings, switch)
        field.prop(settings, value, text="")


def draw_length(row: Any, context: Any) -> None:
    """The known length: measure it, or change and remove it."""
    if shown.peek(context.scene).known is None:
        row.operator("code_as_room.known_length", icon="DRIVER_DISTANCE")
        return
    row.label(text="Known length")
    field = row.row(align=True)
    field.prop(context.window_manager, length_field.NAME, text="")
    field.operator("code_as_room.known_length", text="", icon="DRIVER_DISTANCE")
    field.operator("code_as_room.remove_known_length", text="", icon="X")


CLASSES = (CODE_AS_ROOM_PT_calibration,)
