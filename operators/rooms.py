# SPDX-License-Identifier: GPL-3.0-or-later
"""A scene's room as a whole: its texts, putting it aside, and where its results were written last."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import bpy

from ..pipeline.scene.holding import forget_aside
from ..pipeline.scene.tags import ID, find_room_collection
from ..pipeline.scene.texts import MEMORY, PROGRAM
from . import driver, own_room, view_state

_results: dict[int, Path] = {}


def room_text(scene: Any, which: str) -> Any | None:
    """The text datablock of the room's "PROGRAM" or "MEMORY", None when there is none yet."""
    room = find_room_collection(scene)
    text = room.get(PROGRAM if which == "PROGRAM" else MEMORY) if room is not None else None
    return text if isinstance(text, bpy.types.Text) else None


def put_aside(scene: Any) -> str:
    """Remove the room that was built in this scene; its memory stays in the file as a text. Returns that text's name.

    Only what we made is removed; what the artist put into the room's collection moves to the scene's own.

    Raises:
        RoomError: the room is linked from another file.
    """
    own_room.prepare(scene)
    memory = room_text(scene, "MEMORY")
    name = ""
    if memory is not None:
        kept = bpy.data.texts.new(f"Memory of {scene.code_as_room.picture_name or 'an earlier room'}")
        kept.from_string(memory.as_string())
        kept.use_fake_user = True
        name = kept.name
    room = find_room_collection(scene)
    if room is not None:
        _remove_room(scene, room, [t for t in (memory, room_text(scene, "PROGRAM")) if t is not None])
    _results.pop(scene.session_uid, None)
    driver.forget_scene(scene.session_uid)
    view_state.forget_failure(scene.session_uid)
    return name


def _remove_room(scene: Any, room: Any, texts: list[Any]) -> None:
    forget_aside(room)
    inside = {room, *room.children_recursive}
    for obj in list(room.all_objects):
        elsewhere = any(owner not in inside for owner in obj.users_collection)
        if ID in obj and not elsewhere:
            bpy.data.objects.remove(obj)
        elif not elsewhere:
            scene.collection.objects.link(obj)
    for collection in [*room.children_recursive, room]:
        bpy.data.collections.remove(collection)
    for text in texts:
        bpy.data.texts.remove(text)


def note_results(scene: Any, folder: Path) -> None:
    """Remember where the results were written."""
    _results[scene.session_uid] = folder


def results_of(scene: Any) -> Path | None:
    """Where the results were written last in this session."""
    return _results.get(scene.session_uid)


def forget_all() -> None:
    """Another file is opened."""
    _results.clear()
