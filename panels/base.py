# SPDX-License-Identifier: GPL-3.0-or-later
"""What all panels of the tab "Room" share. `draw` only reads what was worked out before."""

from __future__ import annotations

from typing import Any

import bpy

from ..operators import handlers, view_state
from ..operators.view_state import RoomState


class RoomPanel(bpy.types.Panel):
    """Base of the panels."""

    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"
    bl_category = "Room"

    def draw(self, context: bpy.types.Context) -> None:
        """Draw from the state, or ask for it to be worked out."""
        layout: Any = self.layout
        state = view_state.peek(context.scene)
        if state is None:
            handlers.look_soon()
            layout.label(text="Reading the room", icon="TIME")
            return
        self.draw_state(layout, context, state)

    def draw_state(self, layout: Any, context: Any, state: RoomState) -> None:
        """Draw from the state."""
        raise NotImplementedError


def base_package() -> str:
    """The name under which the add-on is enabled."""
    from .. import __package__ as package

    return package or ""
