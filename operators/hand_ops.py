# SPDX-License-Identifier: GPL-3.0-or-later
"""The artist's own objects become part of the room: what counts is the collection that an object is in."""

from __future__ import annotations

from typing import Any

import bpy

from ..pipeline.scene.tags import ROLE, find_room_collection
from . import driver, own_room
from .base import RoomOperator, allow, busy_blocker


class CODE_AS_ROOM_OT_add_to_room(RoomOperator):
    """Make the selected objects part of the room, each with everything parented to it. The next stage takes them over"""

    bl_idname = "code_as_room.add_to_room"
    bl_label = "Add Selected to Room"
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Something must be selected that is not in the room yet."""
        busy = busy_blocker(context)
        if busy:
            return allow(cls, busy)
        room = find_room_collection(context.scene)
        if room is None:
            return allow(cls, "There is no room yet; run the stages up to the layout first")
        return allow(cls, "" if _outside(context, room) else "Select objects that are not in the room's collection yet")

    def perform(self, context: bpy.types.Context) -> None:
        """Move the objects into the room's collection."""
        scene: Any = context.scene
        own_room.prepare(scene)
        room = find_room_collection(scene)
        assert room is not None
        home = next((c for c in room.children_recursive if c.get(ROLE) == "layout"), room)
        collection: Any = scene.collection
        in_scene = {collection, *collection.children_recursive}
        found = _outside(context, room)
        for obj in {thing for top in found for thing in (top, *top.children_recursive)}:
            for owner in list(obj.users_collection):
                if owner in in_scene:
                    owner.objects.unlink(obj)
            home.objects.link(obj)
        text = f"{len(found)} object{'' if len(found) == 1 else 's'} added; the next stage takes them over"
        driver.note_outcome(scene, text)
        self.report({"INFO"}, text)


def _outside(context: Any, room: Any) -> list[Any]:
    """The selected objects that are not in the room, without those below another of them."""
    inside = set(room.all_objects)
    chosen = [o for o in context.selected_objects if o not in inside and o.library is None]
    return [o for o in chosen if o.parent not in chosen]


CLASSES = (CODE_AS_ROOM_OT_add_to_room,)
