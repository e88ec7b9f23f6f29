# SPDX-License-Identifier: GPL-3.0-or-later
"""Add what the analysis missed: draw a box around it in the picture, then say what it is."""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import Any

import bpy

from ...pipeline.artifacts.common import ImageBox
from ...pipeline.artifacts.corrections import AddedObject, Corrections
from ...pipeline.errors import RoomError
from ...pipeline.geometry.handles import Rectangle, box_between, is_large_enough
from ...pipeline.geometry.polygon import Point
from .. import view_state
from ..base import RoomOperator, allow
from . import draft, selection, shown
from .composing import Frame
from .tools import CANCELLED, RUNNING, Tool, analysis_blocker, correct, pointer

FIRST = "Drag a box around what was missed     Esc or Right Mouse: Cancel"
SECOND = "Release: Name It     Esc or Right Mouse: Cancel"
SUGGESTED = (
    "armchair", "bed", "bench", "bookcase", "cabinet", "ceiling lamp", "chair", "coffee table", "curtain", "desk",
    "dining table", "dresser", "floor lamp", "mirror", "nightstand", "office chair", "ottoman", "painting", "plant",
    "radiator", "rug", "shelf", "sideboard", "sofa", "stool", "table", "table lamp", "television", "wardrobe",
)  # fmt: skip
MOST_LETTERS = 60


class CODE_AS_ROOM_OT_add_missing(Tool):
    """Draw a box around something that the analysis missed, then say what it is"""

    bl_idname = "code_as_room.add_missing"
    bl_label = "Add Missing"

    _start: Point | None = None

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[Any]:
        """Wait for the first corner."""
        self._start = None
        scene: Any = context.scene
        scene.code_as_room.show_boxes = True  # what is known already must be seen
        return self.begin(context, FIRST)

    def handle(self, context: Any, event: Any, frame: Frame) -> set[Any]:
        """Press, drag, release; or two clicks."""
        if event.type in ("ESC", "RIGHTMOUSE") and event.value == "PRESS":
            return CANCELLED
        at = pointer(context, event)
        if at is None:
            return RUNNING
        point = frame.back(at)
        if self._start is None:
            draft.change(pointer=point)
            if event.type == "LEFTMOUSE" and event.value == "PRESS":
                self._start = point
                self.hint(context, SECOND)
            return RUNNING
        box = box_between(self._start, point)
        draft.change(pointer=None, box=(box.x_min, box.y_min, box.x_max, box.y_max))
        # A click without dragging is the first of two: the release of the second one ends it.
        if event.type == "LEFTMOUSE" and event.value == "RELEASE" and is_large_enough(box):
            return self._name(context, box)
        return RUNNING

    def _name(self, context: Any, box: ImageBox) -> set[Any]:
        self.end(context)
        sides = (box.x_min, box.y_min, box.x_max, box.y_max)
        draft.show(draft.Draft(context.scene.session_uid, box=sides))
        ours: Any = bpy.ops
        ours.code_as_room.add_object("INVOKE_DEFAULT", box=sides)
        return DRAWN


DRAWN: set[Any] = {"FINISHED"}
"""Finished, and what is drawn stays for the dialog that follows."""


def _suggestions(operator: Any, context: Any, text: str) -> Iterator[str]:
    """Categories that are in the room already, then usual ones."""
    state = view_state.peek(context.scene)
    known = {row.category.replace("_", " ") for row in state.objects} if state is not None else set()
    yield from sorted(known | set(SUGGESTED))


class CODE_AS_ROOM_OT_add_object(RoomOperator):
    """Add an object that is in the picture but was not detected"""

    bl_idname = "code_as_room.add_object"
    bl_label = "Add Missing Object"
    bl_options = {"REGISTER", "INTERNAL"}

    category: bpy.props.StringProperty(  # type: ignore[valid-type]
        name="What It Is",
        description="A plain name for its kind, such as floor lamp",
        maxlen=MOST_LETTERS,
        search=_suggestions,
        search_options={"SUGGESTION"},
    )
    box: bpy.props.FloatVectorProperty(  # type: ignore[valid-type]
        name="Box",
        description="Left, top, right and bottom of its box, 0 to 1000 of the picture's width and height",
        size=4,
        default=(0.0, 0.0, 0.0, 0.0),
        options={"HIDDEN"},
    )
    _drawn = False

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """The analysis must have run."""
        return allow(cls, analysis_blocker(context))

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[Any]:
        """Ask what it is."""
        self.category = ""
        manager: Any = context.window_manager
        return set(manager.invoke_props_dialog(self, width=260, confirm_text="Add"))

    def draw(self, context: bpy.types.Context) -> None:
        """The name."""
        layout: Any = self.layout
        # Only at first: Enter ends typing, and must not begin it again.
        layout.activate_init = not self._drawn
        self._drawn = True
        # Blender puts the pointer on the first row: on the field, Enter would begin to type anew.
        layout.label(text="What is in the box?")
        layout.prop(self, "category", text="")

    def cancel(self, context: bpy.types.Context) -> None:
        """The dialog was left."""
        draft.clear()
        shown.redraw()

    def perform(self, context: bpy.types.Context) -> None:
        """Add it."""
        scene = context.scene
        draft.clear()
        category = clean_category(self.category)
        if not category:
            raise RoomError("What was drawn has no name.", "Draw it again and say what it is, such as floor lamp.")
        sides: Rectangle = tuple(self.box)
        box = box_between(sides[:2], sides[2:])
        if not is_large_enough(box):
            raise RoomError("The box is too small.", "Draw it again, around the whole object.")
        before = {b.id for b in shown.refresh(scene).boxes}
        made = added_id(category, before)
        correct(scene, lambda c: with_added(c, AddedObject(id=made, category=category, box=box)), "Add Missing Object")
        # What was made of the id is known now: the one that was not there before.
        new = next((b.id for b in shown.peek(scene).boxes if b.id not in before), made)
        selection.activate(scene, new)


class CODE_AS_ROOM_OT_delete_added(RoomOperator):
    """Delete the active object, which you drew into the picture; what was detected can only be left out"""

    bl_idname = "code_as_room.delete_added"
    bl_label = "Delete Added Object"
    bl_options = {"REGISTER"}

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """The active object must be one that was drawn in."""
        box = shown.peek(context.scene).box_of(selection.active_id(context.scene))
        ours = "" if box is not None and box.added else "Only an object that you drew in can be deleted"
        return allow(cls, analysis_blocker(context) or ours)

    def perform(self, context: bpy.types.Context) -> None:
        """Delete it."""
        identifier = selection.active_id(context.scene)
        correct(context.scene, lambda c: without_object(c, identifier), "Delete Added Object")


def clean_category(text: str) -> str:
    """A category as the analysis spells them: lower case words joined by underscores."""
    return "_".join(re.findall(r"[^\W_]+", text.lower()))[:MOST_LETTERS].strip("_")


def added_id(category: str, taken: set[str]) -> str:
    """An id for a new object of this category that nothing has yet."""
    stem = re.sub(r"[^a-z0-9_]", "", category) or "object"
    number = 1
    while f"{stem}_{number}" in taken:
        number += 1
    return f"{stem}_{number}"


def with_added(corrections: Corrections, item: AddedObject) -> Corrections:
    """The corrections with one more object."""
    return corrections.model_copy(update={"added": [*corrections.added, item]})


def without_object(corrections: Corrections, identifier: str) -> Corrections:
    """The corrections without an object that was drawn in, and without what was said of it."""
    return corrections.model_copy(
        update={
            "added": [a for a in corrections.added if a.id != identifier],
            "objects": [c for c in corrections.objects if c.id != identifier],
        }
    )


CLASSES = (CODE_AS_ROOM_OT_add_missing, CODE_AS_ROOM_OT_add_object, CODE_AS_ROOM_OT_delete_added)
