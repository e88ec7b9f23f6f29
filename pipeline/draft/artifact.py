# SPDX-License-Identifier: GPL-3.0-or-later
"""A draft as memory keeps it, and read again from there."""

from __future__ import annotations

from functools import lru_cache

from ..artifacts.draft import DraftProgram
from ..errors import ReplyError
from ..memory import Memory
from .camera import first_camera
from .reading import Draft, read
from .statements import Split, split
from .text import room_text


def draft_program(
    text: str, written: Split, draft: Draft, amended: list[str], at_first: int, image_size: tuple[int, int]
) -> DraftProgram:
    """What the stage writes.

    Raises:
        ReplyError: no room can be made of the draft.
    """
    draft.close()
    camera = first_camera(draft.room, image_size) if draft.room is not None else None
    room = room_text(draft, camera)
    if not room:
        raise ReplyError("No room can be made of this draft.", "Try again, or go on stage by stage.")
    twins = {t.id: first for t in draft.things.values() if (first := draft.first_of(t)) != t.id}
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
    return _read(program.text, tuple(program.amended))


@lru_cache(maxsize=2)
def _read(text: str, amended: tuple[str, ...]) -> tuple[Draft, str]:
    """Reading a draft evaluates all of its programs; every question of every stage needs it."""
    written = split(text)
    again = [statement for one in amended for statement in split(one).statements]
    return read(written.statements, again), written.style
