# SPDX-License-Identifier: GPL-3.0-or-later
"""Small verbs of calibration: the corners as they were found, and what the fit's number means."""

from __future__ import annotations

from typing import Any

import bpy

from ...pipeline.geometry.measuring import FAIR, GOOD, fit_quality
from .. import view_state
from ..base import RoomOperator, allow
from . import shown
from .dragging import fit_sentence
from .tools import analysis_blocker, correct


class CODE_AS_ROOM_OT_reset_corners(RoomOperator):
    """Put the floor's corners back to where the analysis found them"""

    bl_idname = "code_as_room.reset_corners"
    bl_label = "Reset Corners"
    bl_options = {"REGISTER"}

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Some corner must have been moved."""
        moved = "" if shown.peek(context.scene).moved else "The corners are where the analysis found them"
        return allow(cls, analysis_blocker(context) or moved)

    def perform(self, context: bpy.types.Context) -> None:
        """Put them back."""
        correct(context.scene, lambda c: c.model_copy(update={"floor_polygon": None}), "Reset Floor Corners")
        self.report({"INFO"}, fit_sentence(context.scene))


ADVICE = {
    "good": "Nothing to do",
    "fair": "Look through the fitted camera and see whether every corner is where two walls meet the floor",
    "poor": "Some corner is in the wrong place, or the floor has more corners than were found: drag them right",
}


class CODE_AS_ROOM_OT_explain_fit(bpy.types.Operator):
    """How far the floor's corners, seen through the fitted camera, are from where the picture shows them"""

    bl_idname = "code_as_room.explain_fit"
    bl_label = "Reprojection Error"
    bl_options = {"INTERNAL"}

    @classmethod
    def description(cls, context: bpy.types.Context, properties: Any) -> str:
        """The thresholds, in this picture's pixels."""
        return " ".join(explanation(context.scene)).rstrip(".")

    def execute(self, context: bpy.types.Context) -> set[Any]:
        """Say the same in a box that stays."""
        lines = explanation(context.scene)

        def draw(menu: Any, _: Any) -> None:
            for line in lines:
                menu.layout.label(text=line)

        manager: Any = context.window_manager
        if not bpy.app.background:
            manager.popup_menu(draw, title=self.bl_label)
        return {"FINISHED"}


def explanation(scene: Any) -> list[str]:
    """What the reprojection error means, a sentence a line."""
    lines = ["The corners of the floor, seen through the fitted camera, miss the picture's corners by this much."]
    state = view_state.peek(scene)
    if state is None or state.room_size is None:
        return lines
    longest = max(state.picture_size)
    lines.append(f"In this picture up to {GOOD * longest:.1f} px is good and up to {FAIR * longest:.1f} px is fair.")
    return [*lines, f"{ADVICE[fit_quality(state.error_px, state.picture_size)]}."]


CLASSES = (CODE_AS_ROOM_OT_reset_corners, CODE_AS_ROOM_OT_explain_fit)
