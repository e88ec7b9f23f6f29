# SPDX-License-Identifier: GPL-3.0-or-later
"""Dragging what is drawn over the picture: the floor's corners, and the boxes of the objects."""

from __future__ import annotations

import math
from typing import Any

import bpy

from ...pipeline.artifacts.analysis import Calibration
from ...pipeline.artifacts.common import ImageBox, ImagePoint
from ...pipeline.artifacts.corrections import AddedObject, Corrections
from ...pipeline.errors import RoomError
from ...pipeline.geometry.handles import (
    LEAST_CORNERS,
    drag_box,
    moved_corner,
    outline_fault,
    with_corner,
    without_corner,
)
from ...pipeline.geometry.measuring import fit_quality
from ...pipeline.geometry.polygon import Point
from .. import room_memory
from . import draft, hits, selection, shown
from .composing import Frame, Hot
from .drawing import text_width, wanted_in
from .tools import CANCELLED, FINISHED, RUNNING, Tool, pointer, scale_of, window_region

CLICK = 4.0
"""Pixels, at a scale of 1, that the pointer may move while a press still counts as a click."""
DRAG_HINT = "Drag to where it belongs     Release: Confirm     Esc or Right Mouse: Put Back     Shift: Precise"


class CODE_AS_ROOM_OT_drag_handle(Tool):
    """Drag to where the picture shows it.
    At the plus on an edge: adds a corner. Ctrl-click: removes a corner"""

    bl_idname = "code_as_room.drag_handle"
    bl_label = "Drag Handle"
    bl_options = {"REGISTER", "INTERNAL"}
    cursor = "SCROLL_XY"

    _hot: Hot = Hot()
    _press: Point = (0.0, 0.0)
    _last: Point = (0.0, 0.0)
    _shift: tuple[float, float] = (0.0, 0.0)
    _moved = False

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[Any]:
        """Called with the button pressed on a handle."""
        at, wanted = pointer(context, event), wanted_in(context)
        found = hits.hit_at(wanted, at, True, text_width) if wanted is not None and at is not None else None
        if found is None or at is None:
            return {"PASS_THROUGH"}
        scene = context.scene
        if found.corner >= 0 and event.ctrl:
            return self._remove_corner(context, found.corner)
        if found.box:
            selection.activate(scene, found.box)
        self._hot, self._press, self._last = found, at, at
        self._shift, self._moved = (0.0, 0.0), False
        result = self.begin(context, DRAG_HINT)
        hits.heat(found)
        return result

    def handle(self, context: Any, event: Any, frame: Frame) -> set[Any]:
        """The pointer moves, or the button is released."""
        if event.type in ("ESC", "RIGHTMOUSE") and event.value == "PRESS":
            return CANCELLED
        if event.type == "LEFTMOUSE" and event.value == "RELEASE":
            return self._release(context, frame)
        if event.type in ("MOUSEMOVE", "INBETWEEN_MOUSEMOVE"):
            self._follow(context, event, frame)
        return RUNNING

    def _follow(self, context: Any, event: Any, frame: Frame) -> None:
        region = window_region(context)
        if region is None:
            return
        at = float(event.mouse_x - region.x), float(event.mouse_y - region.y)
        pace = 0.1 if event.shift else 1.0
        self._shift = (
            self._shift[0] + (at[0] - self._last[0]) * pace,
            self._shift[1] + (at[1] - self._last[1]) * pace,
        )
        self._last = at
        self._moved = self._moved or math.hypot(*self._shift) > CLICK * scale_of(context)
        if self._moved:
            self._draw(context, frame)

    def _draw(self, context: Any, frame: Frame) -> None:
        """The outline or the box as it would be."""
        if self._hot.box:
            box = self._box(context, frame)
            if box is not None:
                draft.change(box=(box.x_min, box.y_min, box.x_max, box.y_max), box_id=self._hot.box)
        else:
            outline = self._outline(context, frame)
            draft.change(outline=tuple(outline), faulty=bool(outline_fault(outline)))

    def _box(self, context: Any, frame: Frame) -> ImageBox | None:
        known = shown.peek(context.scene).box_of(self._hot.box)
        if known is None or self._hot.grip is None:
            return None
        shift = (self._shift[0] / frame.across, self._shift[1] / frame.down)
        return drag_box(known.image_box, self._hot.grip, shift)

    def _outline(self, context: Any, frame: Frame) -> list[Point]:
        corners = list(shown.peek(context.scene).corners)
        edge = self._hot.edge
        if edge is not None:
            begun = edge.point
            corners = with_corner(corners, edge.edge, (0.0, 0.0))
            index = edge.edge + 1
        else:
            index = self._hot.corner
            begun = frame.point(corners[index])
        to = frame.back((begun[0] + self._shift[0], begun[1] + self._shift[1]))
        inside = (min(max(to[0], 0.0), 1000.0), min(max(to[1], 0.0), 1000.0))
        return moved_corner(corners, index, inside)

    def _release(self, context: Any, frame: Frame) -> set[Any]:
        if not self._moved:
            return CANCELLED  # a click: the object is the active one now, and nothing else is changed
        if self._hot.box:
            return self._keep_box(context, frame)
        outline = self._outline(context, frame)
        return self._keep_outline(context, outline, "Add Floor Corner" if self._hot.edge else "Move Floor Corner")

    def _keep_box(self, context: Any, frame: Frame) -> set[Any]:
        box = self._box(context, frame)
        if box is None:
            return CANCELLED
        identifier = self._hot.box
        self.correct(context, lambda c: with_box(c, identifier, box), "Change Box")
        return FINISHED

    def _keep_outline(self, context: Any, outline: list[Point], undo: str) -> set[Any]:
        fault = outline_fault(outline)
        if fault:
            raise RoomError(fault, "The corner was put back.")
        points = [ImagePoint(x=x, y=y) for x, y in outline]
        self.correct(context, lambda c: c.model_copy(update={"floor_polygon": points}), undo)
        self.report({"INFO"}, fit_sentence(context.scene))
        return FINISHED

    def _remove_corner(self, context: Any, corner: int) -> set[Any]:
        corners = list(shown.peek(context.scene).corners)
        try:
            if len(corners) <= LEAST_CORNERS:
                raise RoomError(f"A floor needs at least {LEAST_CORNERS} corners.")
            return self._keep_outline(context, without_corner(corners, corner), "Remove Floor Corner")
        except RoomError as error:
            return self.refuse(context, error)


def with_box(corrections: Corrections, identifier: str, box: ImageBox) -> Corrections:
    """The corrections with this box for an object, whether it was detected or drawn in."""
    if any(a.id == identifier for a in corrections.added):
        added = [
            AddedObject(id=a.id, category=a.category, box=box) if a.id == identifier else a for a in corrections.added
        ]
        return corrections.model_copy(update={"added": added})
    return corrections.having(corrections.of(identifier).model_copy(update={"box": box}))


def fit_sentence(scene: Any) -> str:
    """How well the floor's corners fit the camera now."""
    calibration = room_memory.memory_of(scene).latest(Calibration)
    if calibration is None:
        return "The corner was moved"
    judged = fit_quality(calibration.error_px, calibration.camera.image_size)
    return f"The camera was fitted anew; the corners fit within {calibration.error_px:.1f} pixels ({judged})"


CLASSES = (CODE_AS_ROOM_OT_drag_handle,)
