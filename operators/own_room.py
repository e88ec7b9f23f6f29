# SPDX-License-Identifier: GPL-3.0-or-later
"""Before anything is written to a scene's room: it is this file's, this scene's, and whole."""

from __future__ import annotations

import logging
from typing import Any

import bpy

from ..pipeline.errors import RoomError
from ..pipeline.scene.backend import COLLECTION, BlenderScene
from ..pipeline.scene.ownership import check_own, make_whole, separate_rooms, stamp
from ..pipeline.scene.tags import LINE, find_room_collection
from ..pipeline.scene.texts import MEMORY
from . import reference

log = logging.getLogger(__name__)


def prepare(scene: Any) -> list[str]:
    """See to it that the scene's room may be written to. Main thread only.

    Returns:
        Sentences on what was put right, for the artist.

    Raises:
        RoomError: the room is linked from another file, or shared in a way that only the artist can undo.
    """
    check_own(scene)
    notices = make_whole(scene, COLLECTION, reference.picture_mark(scene))
    separate_rooms()
    stamp(scene)
    reference.pack_again(scene)
    room = find_room_collection(scene)
    if room is None:
        return notices
    built = any(LINE in obj for obj in room.all_objects)
    backend = BlenderScene(scene)
    if notices and not built and backend.program_text():
        backend.build(backend.program_text())
    if built and not isinstance(room.get(MEMORY), bpy.types.Text):
        notices.append("The memory of this room was deleted; answers that are kept on this computer are used again.")
    return notices


def look_after_copies() -> None:
    """Give copied scenes rooms of their own as soon as they are seen; never raises."""
    try:
        separate_rooms()
    except RoomError as error:
        log.info("%s", error)
