# SPDX-License-Identifier: GPL-3.0-or-later
"""Makes what is drawn over the picture grabbable, the way Blender's own gizmos are: brighter under the pointer, and a
press on it drags it instead of selecting. What can be grabbed is drawn by `drawing.py`; the gizmo only says where it is.
"""

from __future__ import annotations

import logging
from typing import Any

import bpy

from .. import fitted_view
from . import hits, shown
from .composing import Hot
from .drawing import text_width, wanted_in

log = logging.getLogger(__name__)
NOWHERE, HERE = -1, 0
"""A gizmo's operator belongs to one of its parts, by number; ours has one part, and `hits` knows what is there."""


class CODE_AS_ROOM_GT_handles(bpy.types.Gizmo):
    """All handles over the picture: the corners, the edges and the boxes."""

    bl_idname = "CODE_AS_ROOM_GT_handles"

    def setup(self) -> None:
        """Nothing of its own is drawn."""
        self.use_draw_modal = True

    def draw(self, context: bpy.types.Context) -> None:
        """`drawing.py` draws."""

    def test_select(self, context: bpy.types.Context, location: Any) -> int:
        """0 where something can be grabbed, -1 where not. Blender calls it when the pointer moves."""
        try:
            return self._test(context, location)
        except Exception:
            log.exception("The handles over the picture cannot be found")
            return NOWHERE

    def _test(self, context: Any, location: Any) -> int:
        wanted = wanted_in(context) if hits.can_grab(context) else None
        if wanted is None:
            return NOWHERE
        found = hits.hit_at(wanted, (location[0], location[1]), True, text_width)
        if (found or Hot()) != hits.hot():
            hits.heat(found or Hot())
            context.region.tag_redraw()
        return NOWHERE if found is None else HERE


class CODE_AS_ROOM_GGT_handles(bpy.types.GizmoGroup):
    """The handles over the picture, in views that look through the room's camera."""

    bl_idname = "CODE_AS_ROOM_GGT_handles"
    bl_label = "Room Handles"
    bl_space_type = "VIEW_3D"
    bl_region_type = "WINDOW"
    bl_options = {"PERSISTENT"}

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Only where something is drawn. Cheap: Blender asks on every redraw."""
        settings: Any = getattr(context.scene, "code_as_room", None)
        if settings is None or settings.picture is None or not (settings.show_corners or settings.show_boxes):
            return False
        space: Any = context.space_data
        if not space.overlay.show_overlays or not shown.peek(context.scene).corners:
            return False
        return fitted_view.is_looking_through(context)

    def setup(self, context: bpy.types.Context) -> None:
        """One gizmo for all handles: what is under the pointer is found by the same function that the drag uses."""
        gizmos: Any = self.gizmos
        gizmo = gizmos.new(CODE_AS_ROOM_GT_handles.bl_idname)
        gizmo.target_set_operator("code_as_room.drag_handle")


CLASSES = (CODE_AS_ROOM_GT_handles, CODE_AS_ROOM_GGT_handles)
