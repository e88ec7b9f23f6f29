# SPDX-License-Identifier: GPL-3.0-or-later
"""How the add-on's own things are found again: by custom properties, never by name or by a kept reference."""

from __future__ import annotations

from typing import Any

import bpy

ID = "code_as_room_id"  # the line's id; on every object that a line made
PART = "code_as_room_part"  # "leaf" on a door's leaf, absent otherwise
KIND = "code_as_room_kind"  # "proxy", "wall", "door", "light", "camera", "floor", ...
NAME = "code_as_room_name"  # the name that Blender gave the object when we made it, so that a renaming is seen
LINE = "code_as_room_line"  # digest of the line as it was built; absent on what the artist added
WAS = "code_as_room_was"  # id before the artist renamed the object, until the program knows the new one
FIELD = "code_as_room_"  # + category, label, placement, parent, salience, shape, furnished, box; wall; height
ROLE = "code_as_room_role"  # on collections: "room", "shell", "layout", "lights", "cameras"
COLOUR = "code_as_room_colour"  # on materials: "family/role"
BUILT_IDS = "code_as_room_ids"  # on the room's collection: the ids of the proxies that were last built
BUILT_LINES = "code_as_room_lines"  # on the room's collection: the layout lines that were last built, as JSON
HELD = "code_as_room_held"  # on what the artist edited, copied, added or locked: builds leave it as it stands
GROUP = "code_as_room_group"  # on an object of the artist whose parts (its untagged children) count with it
AWAY = "code_as_room_away"  # on what a build set aside (see `holding`); on the collection it is kept in: its room
COPIED = "code_as_room_copied"  # id of the line whose object the artist copied, until the program knows the copy
SLOTS = "code_as_room_slots"  # on meshes: role and key of the material of each slot, as they were written
DIGEST = "code_as_room_digest"  # on meshes: digest of the shapes that they were made from
ASSET = "code_as_room_asset"  # on meshes: key of the asset of the artist's that it is (see `assets`)
FINGERPRINT = "code_as_room_fingerprint"  # on meshes: digest of the mesh as it stood after it was made

SUB_COLLECTIONS = {"shell": "Room Shell", "layout": "Room Layout", "lights": "Room Lights", "cameras": "Room Cameras"}


def find_room_collection(scene: Any) -> Any | None:
    """The add-on's own collection in this scene, or None; one that is linked from another file only when it is the only one."""
    rooms = [c for c in scene.collection.children_recursive if c.get(ROLE) == "room"]
    return next((c for c in rooms if c.library is None and c.override_library is None), rooms[0] if rooms else None)


def ensure_collections(scene: Any, name: str) -> dict[str, Any]:
    """The add-on's collection ("room") and its parts by role; what is missing is made.

    An artist's collection of the same name is left alone: ours then gets Blender's number behind its name.
    """
    room = find_room_collection(scene)
    if room is None:
        room = bpy.data.collections.new(name)
        room[ROLE] = "room"
        scene.collection.children.link(room)
    found = {c.get(ROLE): c for c in room.children_recursive if c.get(ROLE) in SUB_COLLECTIONS}
    for role, title in SUB_COLLECTIONS.items():
        if role not in found:
            found[role] = bpy.data.collections.new(title)
            found[role][ROLE] = role
            room.children.link(found[role])
    found["room"] = room
    return found


def tagged_objects(room: Any) -> dict[tuple[str, str], list[Any]]:
    """Objects of the collection by (id, part), the one we made first, then its copies.

    A copy carries its original's id. The original is the one that still has the name we gave it, else the one that
    has been in this session longest.
    """
    found: dict[tuple[str, str], list[Any]] = {}
    for obj in room.all_objects:
        if ID in obj:
            found.setdefault((str(obj[ID]), str(obj.get(PART, ""))), []).append(obj)
    for same in found.values():
        same.sort(key=lambda o: (LINE not in o, o.get(NAME) != o.name, o.session_uid))
    return found


def world_matrix(obj: Any) -> Any:
    """The object's matrix in the room from its own and its parents' settings, right before Blender's next update too.

    Where constraints, bones or vertices have a say it is what Blender worked out last.
    """
    if len(obj.constraints) or (obj.parent is not None and obj.parent_type != "OBJECT"):
        return obj.matrix_world.copy()
    if obj.parent is None:
        return obj.matrix_basis.copy()
    return world_matrix(obj.parent) @ obj.matrix_parent_inverse @ obj.matrix_basis
