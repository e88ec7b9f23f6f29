# SPDX-License-Identifier: GPL-3.0-or-later
"""Known length: click two points of the floor, type metres, and the room and every size follow."""

from __future__ import annotations

import math
from typing import Any

import bpy

from ...pipeline.artifacts.common import ImagePoint
from ...pipeline.artifacts.corrections import KnownLength
from ...pipeline.errors import RoomError
from ...pipeline.geometry.handles import nearest_point
from ...pipeline.geometry.measuring import LENGTH_RANGE, along_walls, floor_distance, parse_length
from ...pipeline.geometry.polygon import Point
from ..base import RoomOperator, allow
from . import draft, hits, shown
from .composing import Frame
from .tools import CANCELLED, FINISHED, RUNNING, Tool, analysis_blocker, correct, pointer, scale_of

LEAST_PIXELS = 8.0
UNDO = "Known Length"
FIRST = "Known length: click where it begins on the floor     Ctrl: Snap to Corners     Esc or Right Mouse: Cancel"
SECOND = "Click where it ends     Ctrl: Snap to Corners or Along the Walls     Esc or Right Mouse: Cancel"
DIGITS = "0123456789.,'\" cmftindy"


class CODE_AS_ROOM_OT_known_length(Tool):
    """Click the two ends of something on the floor whose length you know, then type the length.
    The room and every size in it follow"""

    bl_idname = "code_as_room.known_length"
    bl_label = "Known Length"

    _start: Point | None = None
    _end: Point | None = None
    _text = ""

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[Any]:
        """Wait for the first click."""
        self._start, self._end, self._text = None, None, ""
        return self.begin(context, FIRST)

    def handle(self, context: Any, event: Any, frame: Frame) -> set[Any]:
        """Two clicks, then keys."""
        if event.type in ("ESC", "RIGHTMOUSE") and event.value == "PRESS":
            return CANCELLED
        if self._end is not None:
            return self._type(context, event)
        at = pointer(context, event)
        point = None if at is None else self._snapped(context, frame, at, event.ctrl)
        self._draw(context, point)
        if event.type == "LEFTMOUSE" and event.value == "PRESS" and point is not None:
            self._click(context, frame, point)
        return RUNNING

    def _snapped(self, context: Any, frame: Frame, at: Point, snap: bool) -> Point:
        """The picture's point under the pointer; with Ctrl a corner nearby, else along a wall's direction."""
        point = frame.back(at)
        if not snap:
            return point
        known = shown.peek(context.scene)
        near = nearest_point([frame.point(c) for c in known.corners], at, 2.0 * hits.REACH * scale_of(context))
        if near is not None:
            return known.corners[near]
        if self._start is not None and known.camera is not None:
            return along_walls(known.camera, self._start, point)
        return point

    def _click(self, context: Any, frame: Frame, point: Point) -> None:
        if self._start is None:
            self._start = point
            self.hint(context, SECOND)
        elif math.dist(frame.point(self._start), frame.point(point)) >= LEAST_PIXELS * scale_of(context):
            self._end = point
            self._draw(context, point)
            self._say(context)

    def _draw(self, context: Any, point: Point | None) -> None:
        """The line as it would be, with the length that it has by the present camera."""
        if self._start is None:
            draft.change(pointer=point)
        elif point is not None:
            draft.change(pointer=None, line=(self._start, point), line_text=self._measured(context, point))

    def _measured(self, context: Any, point: Point) -> str:
        camera = shown.peek(context.scene).camera
        if camera is None or self._start is None:
            return ""
        metres = floor_distance(camera, self._start, point)
        return "" if metres is None else f"now {metres:.2f} m"

    def _say(self, context: Any) -> None:
        """Show what was typed, at the line and in the status bar."""
        unit = "" if self._text.rstrip()[-1:].isalpha() else " ft" if in_feet(context.scene) else " m"
        shown_text = f"{self._text}_{unit}" if self._text else ""
        if shown_text:
            draft.change(line_text=shown_text)
        elif self._end is not None:
            draft.change(line_text=f"{self._measured(context, self._end)}, type its length")
        hint = f"Known length: {shown_text or 'type it, such as 4.2'}     Enter: Confirm     Esc or Right Mouse: Cancel"
        self.hint(context, hint)

    def _type(self, context: Any, event: Any) -> set[Any]:
        if event.value != "PRESS":
            return RUNNING
        if event.type in ("RET", "NUMPAD_ENTER"):
            return self._confirm(context)
        if event.type == "BACK_SPACE":
            self._text = "" if event.ctrl else self._text[:-1]
        elif event.unicode and event.unicode.lower() in DIGITS and len(self._text) < 20:
            self._text += event.unicode
        else:
            return RUNNING
        self._say(context)
        return RUNNING

    def _confirm(self, context: Any) -> set[Any]:
        metres = parse_length(self._text, in_feet(context.scene))
        if metres is None or self._start is None or self._end is None:
            low, high = LENGTH_RANGE
            asked = f"Type the length in metres, from {low:g} to {high:g}, such as 4.2; then press Enter"
            self.hint(context, f"{asked}     Esc or Right Mouse: Cancel")
            draft.change(line_text="type its length, such as 4.2")
            self._text = "" if metres is None else self._text
            return RUNNING
        length = KnownLength(start=image_point(self._start), end=image_point(self._end), metres=metres)
        self.correct(context, lambda c: c.model_copy(update={"known_length": length}), UNDO)
        self.report({"INFO"}, f"The room was scaled: this length is {metres:.2f} m now")
        return FINISHED


class CODE_AS_ROOM_OT_set_known_length(RoomOperator):
    """Give the known length another value; the room and every size in it follow"""

    bl_idname = "code_as_room.set_known_length"
    bl_label = "Set Known Length"
    bl_options = {"REGISTER"}

    metres: bpy.props.FloatProperty(  # type: ignore[valid-type]
        name="Length",
        description="How far the two points on the floor are apart",
        subtype="DISTANCE",
        unit="LENGTH",
        default=1.0,
        min=LENGTH_RANGE[0],
        max=LENGTH_RANGE[1],
        precision=3,
    )

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """There must be a known length."""
        return allow(cls, length_blocker(context))

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[Any]:
        """Ask for the value."""
        known = shown.peek(context.scene).known
        if known is not None:
            self.metres = known.metres
        manager: Any = context.window_manager
        return set(manager.invoke_props_dialog(self))

    def perform(self, context: bpy.types.Context) -> None:
        """Set it."""
        set_metres(context.scene, self.metres)


class CODE_AS_ROOM_OT_remove_known_length(RoomOperator):
    """Forget the known length; sizes are estimated again, or follow the known width"""

    bl_idname = "code_as_room.remove_known_length"
    bl_label = "Remove Known Length"
    bl_options = {"REGISTER"}

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """There must be a known length."""
        return allow(cls, length_blocker(context))

    def perform(self, context: bpy.types.Context) -> None:
        """Remove it."""
        correct(context.scene, lambda c: c.model_copy(update={"known_length": None}), "Remove Known Length")


def length_blocker(context: Any) -> str:
    """Why the known length cannot be changed now, "" when it can."""
    known = shown.peek(context.scene).known
    return analysis_blocker(context) or ("" if known is not None else "There is no known length yet")


def set_metres(scene: Any, metres: float) -> None:
    """Give the known length another value.

    Raises:
        RoomError: there is none, or it cannot be.
    """
    known = shown.refresh(scene).known
    if known is None:
        raise RoomError("There is no known length yet.", "Click its two ends with Known Length first.")
    length = KnownLength(start=image_point(known.start), end=image_point(known.end), metres=metres)
    correct(scene, lambda c: c.model_copy(update={"known_length": length}), UNDO)


def image_point(point: Point) -> ImagePoint:
    """A point of the picture as memory keeps it."""
    return ImagePoint(x=point[0], y=point[1])


def in_feet(scene: Any) -> bool:
    """Whether a number without a unit is in feet in this scene."""
    return bool(scene.unit_settings.system == "IMPERIAL")


CLASSES = (
    CODE_AS_ROOM_OT_known_length,
    CODE_AS_ROOM_OT_set_known_length,
    CODE_AS_ROOM_OT_remove_known_length,
)
