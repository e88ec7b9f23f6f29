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
from ..program.differences import loses_code

PROGRAM = "room.py"
MEMORY = "Code-as-Room Memory"
_WRITTEN = "code_as_room_written"  # on a text: digest of what we wrote last
_OURS = (
    "code_as_room_ours"  # on a text: digest of what a build made of it last, with nothing of the artist's in between
)
_LONGEST_LINE = 20_000  # characters; 100 kB on one line take 0.2 s, 2 MB take minutes


def read_text(room: Any, name: str) -> str:
    """The text as it stands, "" when there is none."""
    block = room.get(name) if room is not None else None
    return str(block.as_string()) if isinstance(block, bpy.types.Text) else ""


def is_hand_edited(room: Any, name: str) -> bool:
    """Whether the text differs from what was written last."""
    block = room.get(name)
    return isinstance(block, bpy.types.Text) and block.get(_WRITTEN) != _digest(block.as_string())


def mark_written(room: Any, name: str, on: bool) -> None:
    """Take the text as it stands for what we wrote; False takes it for the artist's."""
    block = room.get(name)
    if isinstance(block, bpy.types.Text):
        block[_WRITTEN] = _digest(block.as_string()) if on else ""


def write_text(room: Any, name: str, text: str) -> str:
    """Make this the room's text of that name.

    Returns:
        One sentence when an artist's edits were set aside, else "".

    Raises:
        SceneError: a line is so long that Blender would stand still.
    """
    check_lines(name, text)
    block = room.get(name)
    if not isinstance(block, bpy.types.Text):
        room[name] = block = bpy.data.texts.new(name)
        block.use_fake_user = True
    notice = ""
    current = block.as_string()
    if current == text:
        block[_WRITTEN] = _digest(current)
        return ""
    if current and block.get(_WRITTEN) != _digest(current) and _would_be_lost(name, current):
        kept = _keep_aside(name, current)
        notice = f'Your edits of "{block.name}" could not be taken over; they were kept in "{kept.name}".'
    elif name == PROGRAM and block.get(_OURS) != _digest(current) and loses_code(current, text):
        kept = _keep_aside(name, current)
        notice = f'The program was written anew without your functions; the former one was kept in "{kept.name}".'
    block.from_string(text)
    block[_WRITTEN] = block[_OURS] = _digest(block.as_string())
    return notice


def _keep_aside(name: str, text: str) -> Any:
    """A text of its own with what would be lost."""
    kept = bpy.data.texts.new(f"{name} (edited by hand)")
    kept.from_string(text)
    kept.use_fake_user = True
    return kept


def check_lines(name: str, text: str) -> None:
    """SceneError when a line of the text is so long that Blender would stand still."""
    if max(map(len, text.split("\n")), default=0) > _LONGEST_LINE:
        raise SceneError(f"A line of {name} is too long for a text in Blender.", "Break it into shorter lines.")


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
