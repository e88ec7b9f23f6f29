# SPDX-License-Identifier: GPL-3.0-or-later
"""A draft as memory keeps it, and read again from there."""

from __future__ import annotations

from ..artifacts.draft import DraftProgram
from ..errors import ReplyError
from ..memory import Memory
from .camera import first_camera
from .reading import Draft
from .readings import keep, read_text
from .statements import Split
from .text import room_text


def draft_program(
    text: str, written: Split, draft: Draft, amended: list[str], at_first: int, image_size: tuple[int, int]
) -> DraftProgram:
    """What the stage writes; the draft, read to its end, is kept for the stages after it.

    Raises:
        ReplyError: no room can be made of the draft.
    """
    camera = first_camera(draft.room, image_size) if draft.room is not None else None
    room = room_text(draft, camera)
    if not room:
        raise ReplyError("No room can be made of this draft.", "Try again, or go on stage by stage.")
    keep(text, amended, draft, written.style)
    twins = {name: first for name, first in draft.firsts().items() if first != name}
    return DraftProgram(
        text=text,
        room_text=room,
        statements=draft.statements,
        amended=amended,
        style=written.style,
        whole=draft.ended,
        refused_at_first=at_first,
        twins=twins,
    )


def latest_draft(memory: Memory) -> DraftProgram | None:
    """The draft that stands in a memory, None without one."""
    return memory.latest(DraftProgram)


def read_again(program: DraftProgram) -> tuple[Draft, str]:
    """A kept draft, read as it was, and the room's style in its words."""
    return read_text(program.text, program.amended)
