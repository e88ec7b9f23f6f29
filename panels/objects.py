# SPDX-License-Identifier: GPL-3.0-or-later
"""The panel Objects: what was seen in the picture, and what became of it."""

from __future__ import annotations

from typing import Any

import bpy

from ..operators import view_state
from ..operators.view_state import RoomState
from .base import RoomPanel
from .sentences import draw_sentence, plural

SEVERITY_ICONS = {"error": "ERROR", "warning": "ERROR", "note": "INFO"}


class CODE_AS_ROOM_PT_room(RoomPanel):
    """What became of what was seen."""

    bl_idname = "CODE_AS_ROOM_PT_room"
    bl_label = "Room"
    bl_order = 3

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Only where something was seen."""
        state = view_state.peek(context.scene)
        return state is not None and bool(state.ledger)

    def draw_state(self, layout: Any, context: Any, state: RoomState) -> None:
        """Counts of objects and findings."""
        column = layout.column(align=True)
        column.label(text=", ".join(f"{count} {word}" for word, count in state.ledger), icon="OBJECT_DATA")
        if state.score is not None:
            column.label(text=f"Layout score {state.score:.2f} of 1", icon="CHECKMARK")
        if state.hand_edits:
            column.label(text=f"{plural(state.hand_edits, 'edit')} by hand taken over", icon="LOCKED")
        for severity, count in state.severities:
            column.label(text=plural(count, severity), icon=SEVERITY_ICONS[severity])
        for finding in state.findings:
            if finding.severity != "note":
                draw_sentence(layout, f"{finding.about}: {finding.message}", context)


CLASSES = (CODE_AS_ROOM_PT_room,)
