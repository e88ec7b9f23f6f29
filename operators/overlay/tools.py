# SPDX-License-Identifier: GPL-3.0-or-later
"""What all operators over the picture share: when they can run, where the pointer is, and how they end.

While one of them runs, the view can be zoomed and panned; turning it away, undoing or loading ends the operator. Nothing
is written before its last step.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import bpy

from ...pipeline.artifacts.corrections import Corrections
from ...pipeline.errors import RoomError
from ...pipeline.geometry.polygon import Point
from .. import correcting, driver, fitted_view, view_state
from ..base import RoomOperator, busy_blocker, log
from . import draft, hits, shown
from .composing import Frame, Hot
from .drawing import ui_scale

NAVIGATION = {
    "MIDDLEMOUSE", "WHEELUPMOUSE", "WHEELDOWNMOUSE", "WHEELINMOUSE", "WHEELOUTMOUSE", "WHEELLEFTMOUSE",
    "WHEELRIGHTMOUSE", "TRACKPADPAN", "TRACKPADZOOM", "MOUSEROTATE", "MOUSESMARTZOOM", "NDOF_MOTION", "TIMER",
}  # fmt: skip
"""Events that Blender is left to handle."""
RUNNING: set[Any] = {"RUNNING_MODAL"}
CANCELLED: set[Any] = {"CANCELLED"}
FINISHED: set[Any] = {"FINISHED"}


def analysis_blocker(context: Any) -> str:
    """Why nothing can be corrected now, "" when it can. No I/O."""
    busy = busy_blocker(context)
    if busy:
        return busy
    state = view_state.peek(context.scene)
    if state is None or not state.picture_name:
        return "Load a picture of a room first"
    return "" if state.room_size is not None else "Run the scene analysis first"


def view_blocker(context: Any) -> str:
    """As `analysis_blocker`, for what is done with the pointer in the picture."""
    blocked = analysis_blocker(context)
    if blocked:
        return blocked
    return "" if context.area is not None and context.area.type == "VIEW_3D" else "This is used in a 3D view"


def push_undo(message: str) -> None:
    """One undo step for one action. Our operators push it themselves, so that it names what was done."""
    if not bpy.app.background:
        bpy.ops.ed.undo_push(message=message)


def window_region(context: Any) -> Any | None:
    """The region with the picture: that of the context, or its area's, when the sidebar's button was pressed."""
    region = context.region
    if region is not None and region.type == "WINDOW":
        return region
    area = context.area
    return next((r for r in area.regions if r.type == "WINDOW"), None) if area is not None else None


def pointer(context: Any, event: Any) -> Point | None:
    """Where the pointer is in the region with the picture, pixels; None outside of it or over a sidebar."""
    region = window_region(context)
    if region is None:
        return None
    x, y = event.mouse_x, event.mouse_y
    if not (region.x <= x < region.x + region.width and region.y <= y < region.y + region.height):
        return None
    others = [r for r in context.area.regions if r.type != "WINDOW" and r.width > 1 and r.height > 1]
    if any(r.x <= x < r.x + r.width and r.y <= y < r.y + r.height for r in others):
        return None
    return float(x - region.x), float(y - region.y)


class Tool(RoomOperator):
    """Base of the operators that are used with the pointer in the picture."""

    bl_options = {"REGISTER"}
    cursor = "CROSSHAIR"
    _scene_uid = 0

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """The analysis must have run, and nothing else may be going on."""
        blocked = view_blocker(context)
        if blocked:
            cls.poll_message_set(blocked)
        return not blocked

    def execute(self, context: bpy.types.Context) -> set[Any]:
        """Scripts have no pointer; they use `add_object`, `set_known_length` and `correcting.apply`."""
        self.report({"ERROR"}, f"{self.bl_label} is used with the pointer, in a view through the fitted camera")
        return CANCELLED

    def begin(self, context: Any, hint: str) -> set[Any]:
        """Take the pointer over, in a view through the room's camera."""
        if not fitted_view.is_looking_through(context):
            ours: Any = bpy.ops
            ours.code_as_room.look_through()
        self._scene_uid = context.scene.session_uid
        draft.show(draft.Draft(self._scene_uid))
        hits.heat(Hot())
        context.window.cursor_modal_set(self.cursor)
        context.window_manager.modal_handler_add(self)
        self.hint(context, hint)
        shown.redraw()
        return RUNNING

    def modal(self, context: bpy.types.Context, event: bpy.types.Event) -> set[Any]:
        """Called by Blender for every event; an error ends the operator."""
        try:
            frame = self._frame(context)
            if frame is None:
                self.end(context)
                self.report({"INFO"}, f"{self.bl_label} ended: the view does not look through the camera any more")
                return CANCELLED
            if event.type in NAVIGATION:
                return {"PASS_THROUGH"}
            result = self.handle(context, event, frame)
        except RoomError as error:
            self.end(context)
            return self.refuse(context, error)
        except Exception as error:
            log.exception("%s failed unexpectedly", type(self).__name__)
            self.end(context)
            return self.refuse(context, error)
        shown.redraw()
        if result is FINISHED or result is CANCELLED:
            self.end(context)
        return result

    def handle(self, context: Any, event: Any, frame: Frame) -> set[Any]:
        """One event. What is returned as FINISHED or CANCELLED ends the operator."""
        raise NotImplementedError

    def cancel(self, context: bpy.types.Context) -> None:
        """Blender ends the operator, as before it loads another file."""
        self.end(context)

    def end(self, context: Any) -> None:
        """Give pointer and status bar back. May be called twice."""
        draft.clear()
        if context.window is not None:
            context.window.cursor_modal_restore()
        self.hint(context, None)
        hits.heat(Hot())
        shown.redraw()

    def hint(self, context: Any, text: str | None) -> None:
        """What can be done now, in the status bar."""
        if context.workspace is not None:
            context.workspace.status_text_set(text)

    def _frame(self, context: Any) -> Frame | None:
        scene = context.scene
        if scene is None or scene.session_uid != self._scene_uid or driver.is_running():
            return None
        return hits.frame_of(context)

    def correct(self, context: Any, change: Callable[[Corrections], Corrections], undo: str) -> None:
        """Make a correction, as one undo step.

        Raises:
            RoomError: it cannot be; nothing was changed.
        """
        correct(context.scene, change, undo)


def correct(scene: Any, change: Callable[[Corrections], Corrections], undo: str) -> None:
    """Make a correction, as one undo step with this name, and draw what has become of it.

    Raises:
        RoomError: it cannot be; nothing was changed.
    """
    correcting.apply(scene, change)
    push_undo(undo)
    shown.refresh(scene)
    shown.redraw()


def scale_of(context: Any) -> float:
    """Blender's resolution scale."""
    return ui_scale()
