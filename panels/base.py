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


def known_operator(name: str) -> bool:
    """Whether an operator such as "code_as_room.stop" is registered."""
    group, verb = name.split(".")
    return hasattr(bpy.types, f"{group.upper()}_OT_{verb}")


def can_now(name: str) -> bool:
    """Whether an operator is registered and can be called now."""
    if not known_operator(name):
        return False
    group, verb = name.split(".")
    return bool(getattr(getattr(bpy.ops, group), verb).poll())


def region_width(context: Any) -> float:
    """Width of the region in which we draw, pixels at a scale of 1."""
    region = getattr(context, "region", None)
    preferences = getattr(context, "preferences", None)
    scale = preferences.system.ui_scale if preferences is not None else 1.0
    return float(region.width if region is not None else 300) / max(0.1, scale)
