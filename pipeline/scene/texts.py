# SPDX-License-Identifier: GPL-3.0-or-later
"""The room's two text datablocks: the program `room.py` and the memory.

Each belongs to one room: the room's collection points to it, so names may change and several scenes may have rooms.
A text is written in one assignment (Blender's text datablocks are quadratic in the length of a line, so lines stay
short). What an artist wrote into it and would be lost is set aside under another name first.
"""

from __future__ import annotations

import hashlib
import json
from typing import Any

import bpy

from ..errors import SceneError

PROGRAM = "room.py"
MEMORY = "Code-as-Room Memory"
_WRITTEN = "code_as_room_written"  # on a text: digest of what we wrote last
_LONGEST_LINE = 20_000  # characters; 100 kB on one line take 0.2 s, 2 MB take minutes


def read_text(room: Any, name: str) -> str:
    """The text as it stands, "" when there is none."""
    block = room.get(name) if room is not None else None
    return str(block.as_string()) if isinstance(block, bpy.types.Text) else ""


def is_hand_edited(room: Any, name: str) -> bool:
    """Whether the text differs from what was written last."""
    block = room.get(name)
    return isinstance(block, bpy.types.Text) and block.get(_WRITTEN) != _digest(block.as_string())


def write_text(room: Any, name: str, text: str) -> str:
    """Make this the room's text of that name.

    Returns:
        One sentence when an artist's edits were set aside, else "".

    Raises:
        SceneError: a line is so long that Blender would stand still.
    """
    if max(map(len, text.split("\n")), default=0) > _LONGEST_LINE:
        raise SceneError(f"A line of {name} is too long for a text in Blender.", "Break it into shorter lines.")
    block = room.get(name)
    if not isinstance(block, bpy.types.Text):
        room[name] = block = bpy.data.texts.new(name)
        block.use_fake_user = True
    notice = ""
    current = block.as_string()
    if current == text:
        return ""
    if current and block.get(_WRITTEN) != _digest(current) and _would_be_lost(name, current):
        kept = bpy.data.texts.new(f"{name} (edited by hand)")
        kept.from_string(current)
        kept.use_fake_user = True
        notice = f'Your edits of "{block.name}" could not be taken over; they were kept in "{kept.name}".'
    block.from_string(text)
    block[_WRITTEN] = _digest(block.as_string())
    return notice


def _would_be_lost(name: str, current: str) -> bool:
    """Whether hand edits are more than what a stage read and wrote on: a memory that is still whole was read."""
    if name != MEMORY:
        return True
    try:
        json.loads(current)
    except ValueError:
        return True
    return False


def _digest(text: str) -> str:
    return hashlib.sha1(text.rstrip("\n").encode(), usedforsecurity=False).hexdigest()[:20]
