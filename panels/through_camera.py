# SPDX-License-Identifier: GPL-3.0-or-later
"""Rows of the panels for what is drawn over the picture: they say what is missing when nothing is to be seen."""

from __future__ import annotations

from typing import Any

from ..operators import driver, fitted_view
from .sentences import draw_sentence


def draw_look_through(layout: Any, context: Any, wanted: bool, hint: str = "") -> None:
    """A button to look through the camera where the view does not; else why nothing can be grabbed, or what to do."""
    if not fitted_view.is_looking_through(context):
        layout.operator("code_as_room.look_through", icon="VIEW_CAMERA")
        return
    space = context.space_data
    if not wanted or space is None or space.type != "VIEW_3D":
        return
    if not space.overlay.show_overlays:
        draw_sentence(layout, "Switch Blender's overlays on to see them.", context, icon="INFO")
    elif not space.show_gizmo:
        draw_sentence(layout, "Switch Blender's gizmos on to drag them.", context, icon="INFO")
    elif driver.is_running():
        draw_sentence(layout, "They can be dragged after the run.", context, icon="INFO")
    elif context.mode != "OBJECT":
        draw_sentence(layout, "Go back to Object mode to drag them.", context, icon="INFO")
    elif hint:
        draw_sentence(layout, hint, context)


def draw_boxes(layout: Any, context: Any) -> None:
    """Show the objects' boxes in the picture, where they can be corrected."""
    settings = context.scene.code_as_room
    layout.prop(settings, "show_boxes", icon="MESH_PLANE", toggle=True)
    if settings.show_boxes:
        draw_look_through(layout, context, True, "Drag a side of the active box; click a name to choose another.")
