# SPDX-License-Identifier: GPL-3.0-or-later
"""What the artist wrote of materials into the room's program is kept in memory, and holds against every stage."""

from __future__ import annotations

from .artifacts.layout import LayoutProgram
from .artifacts.materials import OwnFinishes
from .errors import ProgramError
from .materials.own import own_among, with_own
from .memory import EntryMeta, Memory, now
from .run_corrections import ARTIST, edits_of, program_of


def own_finishes_of(memory: Memory) -> OwnFinishes:
    """What the artist says of materials."""
    return memory.latest(OwnFinishes) or OwnFinishes()


def note_own_finishes(memory: Memory, text: str) -> list[str]:
    """Keep the finishes and looks that the artist wrote or changed in the program's text.

    Returns:
        Ids of what has a finish of the artist's now and had none, or another one.
    """
    stages = {e.stage for e in memory.entries if e.type == LayoutProgram.__name__}
    programs = [p.text for stage in sorted(stages) if (p := program_of(memory, (stage,))) is not None]
    old = own_finishes_of(memory)
    try:
        new = own_among(text, programs, old)
    except ProgramError:
        return []
    if new == old:
        return []
    memory.append(ARTIST, new, EntryMeta(time=now(), model=ARTIST))
    return [name for name, finish in new.finishes.items() if old.finishes.get(name) != finish]


def with_own_finishes(memory: Memory, text: str) -> str:
    """A room text that a stage made, with what the artist wrote of materials."""
    own = own_finishes_of(memory)
    return with_own(text, own, edits_of(memory)) if own.looks or own.finishes else text
