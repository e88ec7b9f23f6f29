# SPDX-License-Identifier: GPL-3.0-or-later
"""Whose a room is: one scene's own, in this file, and whole.

Blender lets Python write to data that is linked from another file, and loses it on the next load; a copied scene shares
its room's texts (and, as a linked copy, its objects) with the original; and a collection that the artist deletes takes
its pointers to memory and program along. Here each of these is seen, and refused or put right before anything is
written. Main thread only.
"""

from __future__ import annotations

import json
from pathlib import PurePath
from typing import Any

import bpy

from ..errors import SceneError
from .holding import place_aside
from .tags import AWAY, ID, KIND, LINE, ROLE, ensure_collections, find_room_collection
from .texts import _WRITTEN as WRITTEN
from .texts import MEMORY, PROGRAM

_ROLES = {"proxy": "layout", "light": "lights", "camera": "cameras"}
_OWNER = "code_as_room_scene"  # on the room's collection: name of the scene that it was in when it was written to last
_HEAD = 8  # lines of a memory text that hold its picture's hash


def check_own(scene: Any) -> None:
    """Refuse a room that is not this file's own.

    Raises:
        SceneError: the scene, its room, a text or an object of it is linked from another file or overrides such data.
    """
    if scene.library is not None:
        raise SceneError(f"This scene is linked from {_file(scene.library)}.", "Open that file to work on its room.")
    room = find_room_collection(scene)
    if room is None:
        return
    for collection in (room, *room.children_recursive):
        _refuse_foreign(collection, "The room in this scene", "Open that file to change it, or unlink it here.")
    for name in (MEMORY, PROGRAM):
        text = room.get(name)
        if isinstance(text, bpy.types.Text):
            _refuse_foreign(text, f"The text {text.name!r} of this room", "Make it local in the Text Editor first.")
    for obj in room.all_objects:
        fix = "Make it local (Object, Relations, Make Local), or take it out of the room's collection."
        _refuse_foreign(obj, f"The object {obj.name!r} in the room", fix)
        if LINE in obj and obj.data is not None:
            _refuse_foreign(obj.data, f"The data of {obj.name!r} in the room", fix)


def _refuse_foreign(data: Any, what: str, fix: str) -> None:
    if data.library is not None:
        raise SceneError(f"{what} is linked from {_file(data.library)}.", fix)
    override = data.override_library
    if override is not None:
        library = override.reference.library if override.reference is not None else None
        raise SceneError(f"{what} is a library override of {_file(library)}.", fix)


def _file(library: Any) -> str:
    """A library's file name without its folder."""
    if library is None:
        return "another file"
    return PurePath(library.filepath.replace("\\", "/").removeprefix("//")).name or "another file"


# ---- copies of scenes ----


def separate_rooms() -> None:
    """Give every scene of this file a room of its own: copied scenes get copies of what they share.

    Raises:
        SceneError: two scenes share the room through a collection of the artist's.
    """
    rooms: list[Any] = []
    for scene in sorted((s for s in bpy.data.scenes if s.library is None), key=lambda s: s.session_uid):
        room = find_room_collection(scene)
        if room is None or room.library is not None or room.override_library is not None:
            continue
        if room in rooms:
            room = _own_room(scene, room)
        rooms.append(room)
    for name in (MEMORY, PROGRAM):
        taken: set[Any] = set()
        for room in rooms:
            text = room.get(name)
            if not isinstance(text, bpy.types.Text) or text.library is not None:
                continue
            if text in taken:
                room[name] = text = text.copy()
                text.use_fake_user = True
            taken.add(text)


def _own_room(scene: Any, shared: Any) -> Any:
    """Replace the room that a scene shares with another by a copy of it; returns the copy."""
    if shared.name not in scene.collection.children:
        raise SceneError(
            f"The scene {scene.name!r} shares its room with another scene through a collection that both use.",
            "Take the room's collection out of it in one of the scenes, or make the scene a full copy.",
        )
    copies: dict[Any, Any] = {}
    room = _copied(shared, copies)
    scene.collection.children.link(room)
    scene.collection.children.unlink(shared)
    for obj in copies.values():
        if obj.parent in copies:
            inverse = obj.matrix_parent_inverse.copy()
            obj.parent = copies[obj.parent]
            obj.matrix_parent_inverse = inverse
    if scene.camera in copies:
        scene.camera = copies[scene.camera]
    return room


def _copied(collection: Any, copies: dict[Any, Any]) -> Any:
    """A collection with copies of all that is in it, and of what a build set aside; fills `copies` by object."""
    result = collection.copy()
    for obj in list(result.objects):
        if obj not in copies:
            copies[obj] = obj.copy()
            if obj.data is not None and ID in obj:
                copies[obj].data = obj.data.copy()
        result.objects.unlink(obj)
        result.objects.link(copies[obj])
    for child in list(result.children):
        result.children.unlink(child)
        result.children.link(_copied(child, copies))
    aside = place_aside(collection)
    if aside is not None:
        twin = _copied(aside, copies)
        twin[AWAY] = result
        twin.use_fake_user = True
    return result


# ---- what was deleted or unlinked by hand ----


def make_whole(scene: Any, name: str, picture_hash: str) -> list[str]:
    """Give a scene back the room whose collection was deleted or unlinked by hand.

    Memory and program are found among the file's texts, the objects among the scene's.

    Args:
        name: the collection's name when it has to be made anew.
        picture_hash: of the scene's reference image; only a room that was begun with it is taken.

    Returns:
        A sentence for the artist on what was done, or nothing.
    """
    room = find_room_collection(scene)
    if not picture_hash or (room is not None and isinstance(room.get(MEMORY), bpy.types.Text)):
        return []
    unlinked = _unlinked_room(scene, picture_hash)
    if unlinked is not None:
        if room is not None:
            _drop(room)
        scene.collection.children.link(unlinked)
        return ["The room's collection was unlinked from the scene; it is linked again."]
    memories = [text for text in _orphans(MEMORY) if _picture_of(text) == picture_hash]
    if not memories:
        return []
    memory, programs = max(memories, key=lambda text: len(text.lines)), _orphans(PROGRAM)
    found = ensure_collections(scene, name)
    found["room"][MEMORY] = memory
    # Which of several programs was this room's cannot be told; without one the stages build it again from memory.
    if len(programs) == 1 and not isinstance(found["room"].get(PROGRAM), bpy.types.Text):
        found["room"][PROGRAM] = programs[0]
    _gather(scene, found)
    return ["The room's collection was deleted by hand; the room was put together again from its texts."]


def _rooms() -> list[Any]:
    return [c for c in bpy.data.collections if c.get(ROLE) == "room" and c.library is None]


def stamp(scene: Any) -> None:
    """Note on the room's collection in which scene it is, so that it is known when it was unlinked by hand."""
    room = find_room_collection(scene)
    if room is not None and room.get(_OWNER) != scene.name:
        room[_OWNER] = scene.name


def _unlinked_room(scene: Any, picture_hash: str) -> Any | None:
    """The room of this picture that was in this scene and is in none now."""
    shown = {c for scene in bpy.data.scenes for c in scene.collection.children_recursive}
    for room in _rooms():
        memory = room.get(MEMORY)
        mine = room not in shown and room.get(_OWNER) == scene.name
        if mine and isinstance(memory, bpy.types.Text) and _picture_of(memory) == picture_hash:
            return room
    return None


def _drop(room: Any) -> None:
    """Remove a room in which nothing was built yet."""
    for obj in list(room.all_objects):
        if ID in obj and LINE not in obj:
            bpy.data.objects.remove(obj)
    for collection in (*room.children_recursive, room):
        if not collection.all_objects:
            bpy.data.collections.remove(collection)


def _orphans(name: str) -> list[Any]:
    """Texts that we wrote under that name and that belong to no room any more."""
    owned = {room.get(name) for room in _rooms()}
    texts = [t for t in bpy.data.texts if t.library is None and WRITTEN in t and t not in owned]
    return [text for text in texts if text.name == name or text.name.startswith(f"{name}.")]


def _picture_of(memory: Any) -> str:
    """The picture's hash in a memory text, from its first lines; "" when it is not there."""
    for line in memory.lines[:_HEAD]:
        key, _, value = line.body.strip().rstrip(",").partition(":")
        if key == '"hash"':
            try:
                return str(json.loads(value))
            except ValueError:
                return ""
    return ""


def _gather(scene: Any, found: dict[str, Any]) -> None:
    """Put the room's objects, which were left in other collections, back into its own."""
    others = {obj for room in _rooms() if room != found["room"] for obj in room.all_objects}
    inside = set(found["room"].all_objects)
    for obj in list(scene.objects):
        if LINE not in obj or obj in others or obj in inside or obj.library is not None:
            continue
        for owner in list(obj.users_collection):
            if owner.library is None:
                owner.objects.unlink(obj)
        found[_ROLES.get(str(obj.get(KIND, "")), "shell")].objects.link(obj)
