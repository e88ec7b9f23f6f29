# SPDX-License-Identifier: GPL-3.0-or-later
"""The program's text as the artist edited it: what that means for the room, and what becomes of its functions."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from ..artifacts.layout import LayoutEdit
from ..errors import ProgramError
from ..program.assemble import is_assembled, split_room
from ..program.differences import differences
from ..program.evaluate import evaluate
from ..program.limits import FINISHED_ROOM_LIMITS
from ..program.lines import parse_layout
from .read_lines import built_layout
from .tags import ID, LINE, NAME, PART, WAS
from .texts import PROGRAM, mark_written, read_text


def text_edits(room: Any) -> list[LayoutEdit]:
    """What was changed in the program's text since it was built, as typed edits.

    Raises:
        ProgramError: the text is outside the room language; its line counts from the top of the whole text.
    """
    above, text = split_room(read_text(room, PROGRAM))
    try:
        evaluate(text, FINISHED_ROOM_LIMITS)
        after = parse_layout(text)
    except ProgramError as error:
        error.line += above if error.line else 0
        raise
    built = built_layout(room)
    return differences(built[0], after) if built is not None else []


def accept_text(room: Any, on: bool, renamed: Mapping[str, str]) -> None:
    """Mark the text as taken over, or as edited again. What was edited above the room is never taken over.

    Args:
        renamed: former ids of objects that the text calls otherwise, with their new ones.
    """
    for obj in room.all_objects:
        new = renamed.get(str(obj.get(ID, "")))
        if on and new is not None and LINE in obj and not obj.get(PART):
            obj[WAS], obj[ID] = obj[ID], new
            obj.name = new
            obj[NAME] = obj.name
    if not on or is_assembled(read_text(room, PROGRAM)):
        mark_written(room, PROGRAM, on)
