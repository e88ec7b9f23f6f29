# SPDX-License-Identifier: GPL-3.0-or-later
"""What can be done with the objects of the room: selecting, locking, leaving out, and taking over edits by hand."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import bpy

from ..pipeline.errors import RoomError
from ..pipeline.program.words import edits_taken_over
from ..pipeline.report_objects import ObjectRow
from . import driver, object_list, own_room, room_memory, view_state
from .base import RoomOperator, allow

RUNNING = "A run is going on; wait for it, or stop it"
GROUPS = (
    ("ALL", "All", "Everything that stands in the room"),
    ("SAME", "Same Category", "Everything of the active object's category"),
    ("LOCKED", "Locked", "What no stage may change"),
    ("EDITED", "Edited by Hand", "What you moved, turned or changed"),
    ("FREE", "Not Locked", "What stages may still change"),
    ("MAJOR", "Large Furniture", "What the layout stage places"),
    ("MINOR", "Small Things", "What the auxiliary stage places"),
)


def rows_of(scene: Any, group: str) -> list[ObjectRow]:
    """The rows of a group, see `GROUPS`."""
    state = view_state.peek(scene)
    rows = state.objects if state is not None else ()
    active = object_list.active_row(scene)
    wanted: dict[str, Callable[[ObjectRow], bool]] = {
        "ALL": lambda row: True,
        "SAME": lambda row: active is not None and row.category == active.category,
        "LOCKED": lambda row: row.locked,
        "EDITED": lambda row: row.edited,
        "FREE": lambda row: not row.locked,
        "MAJOR": lambda row: row.major,
        "MINOR": lambda row: not row.major,
    }
    return [row for row in rows if wanted[group](row)]


def nothing_seen(context: Any) -> str:
    """Why there is no object to do something with, "" when there is one."""
    state = view_state.peek(context.scene)
    return "" if state is None or state.objects else "Run the scene analysis first"


class CODE_AS_ROOM_OT_select_objects(RoomOperator):
    """Select objects of the room in the viewport"""

    bl_idname = "code_as_room.select_objects"
    bl_label = "Select Room Objects"
    bl_options = {"REGISTER", "UNDO"}

    group: bpy.props.EnumProperty(name="Group", description="Which objects", items=GROUPS)  # type: ignore[valid-type]
    extend: bpy.props.BoolProperty(name="Extend", description="Keep what is selected")  # type: ignore[valid-type]

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """There must be objects, in Object mode."""
        mode = "" if context.mode == "OBJECT" else "Go back to Object mode first"
        return allow(cls, mode or nothing_seen(context))

    def perform(self, context: bpy.types.Context) -> None:
        """Select them."""
        rows = [row for row in rows_of(context.scene, self.group) if row.name]
        if not rows:
            raise RoomError("There is no such object in the room.")
        object_list.select(context.scene, [row.id for row in rows], self.extend)
        object_list.follow(context.scene)


class CorrectionOperator(RoomOperator):
    """Base of the operators that say something of several objects."""

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """There must be objects, and no run."""
        return allow(cls, RUNNING if driver.is_running() else nothing_seen(context))


def targets(scene: Any, group: str, identifier: str) -> list[ObjectRow]:
    """The rows that a verb is about: one by its id, what is selected in the viewport, or a group.

    Raises:
        RoomError: there is none.
    """
    state = view_state.peek(scene)
    if identifier:
        rows = [row for row in (state.objects if state is not None else ()) if identifier in (row.id, row.name)]
    elif group == "SELECTED":
        names = object_list.selected_names(scene)
        rows = [row for row in rows_of(scene, "ALL") if row.name in names]
    else:
        rows = rows_of(scene, group)
    if not rows:
        raise RoomError("There is no such object.", "Select one in the list or in the viewport.")
    return rows


_SOME = (("SELECTED", "Selected", "What is selected in the viewport"), *GROUPS)


class CODE_AS_ROOM_OT_lock_objects(CorrectionOperator):
    """Lock objects of the room, so that no stage changes them; or free them again"""

    bl_idname = "code_as_room.lock_objects"
    bl_label = "Lock Room Objects"
    bl_options = {"REGISTER", "UNDO"}

    group: bpy.props.EnumProperty(name="Group", description="Which objects", items=_SOME)  # type: ignore[valid-type]
    lock: bpy.props.BoolProperty(name="Lock", description="Lock them, or free them", default=True)  # type: ignore[valid-type]
    identifier: bpy.props.StringProperty(  # type: ignore[valid-type]
        name="Object", description="Id of one object, instead of a group", options={"SKIP_SAVE"}
    )

    @classmethod
    def description(cls, context: bpy.types.Context, properties: Any) -> str:
        """The tooltip says what happens."""
        if properties.lock:
            return "Lock these objects: no stage moves or changes them"
        return "Free these objects: stages may move and change them again"

    def perform(self, context: bpy.types.Context) -> None:
        """Lock or free them."""
        rows = [r for r in targets(context.scene, self.group, self.identifier) if r.name and r.locked != self.lock]
        if rows:
            object_list.correct_many(context.scene, [object_list.lock_name(r) for r in rows], locked=self.lock)


class CODE_AS_ROOM_OT_include_objects(CorrectionOperator):
    """Take objects into the room, or leave them out of it"""

    bl_idname = "code_as_room.include_objects"
    bl_label = "Include Room Objects"
    bl_options = {"REGISTER", "UNDO"}

    group: bpy.props.EnumProperty(name="Group", description="Which objects", items=_SOME)  # type: ignore[valid-type]
    include: bpy.props.BoolProperty(name="Include", description="Take them in, or leave them out", default=True)  # type: ignore[valid-type]

    @classmethod
    def description(cls, context: bpy.types.Context, properties: Any) -> str:
        """The tooltip says what happens."""
        if properties.include:
            return "Take these objects into the room again"
        return "Leave these objects out of the room; they stay in the list"

    def perform(self, context: bpy.types.Context) -> None:
        """Switch them on or off."""
        rows = [r for r in targets(context.scene, self.group, "") if r.included != self.include]
        if rows:
            object_list.correct_many(context.scene, [r.id for r in rows], include=self.include)


class CODE_AS_ROOM_OT_take_over(RoomOperator):
    """Take over now what you moved, turned, scaled, renamed, deleted or added by hand; every run does this first"""

    bl_idname = "code_as_room.take_over"
    bl_label = "Take Over Hand Edits"
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """There must be a room, in Object mode, and no run."""
        if driver.is_running():
            return allow(cls, RUNNING)
        if context.mode != "OBJECT":
            return allow(cls, "Go back to Object mode first")
        state = view_state.peek(context.scene)
        return allow(cls, "" if state is None or state.has_layout else "Run the stages up to the layout first")

    def perform(self, context: bpy.types.Context) -> None:
        """Read the scene back."""
        scene = context.scene
        own_room.prepare(scene)
        run = room_memory.run_of(scene)
        edits = run.take_over_edits()
        if edits:
            room_memory.keep(run)
        view_state.refresh(scene)
        count = edits_taken_over(edits) or "Nothing was edited by hand"
        driver.note_outcome(scene, count)
        self.report({"INFO"}, count)


CLASSES = (
    CODE_AS_ROOM_OT_select_objects,
    CODE_AS_ROOM_OT_lock_objects,
    CODE_AS_ROOM_OT_include_objects,
    CODE_AS_ROOM_OT_take_over,
)
