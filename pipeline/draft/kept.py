# SPDX-License-Identifier: GPL-3.0-or-later
"""What memory tells of drafts: which entries were derived from one, and which are older than it."""

from __future__ import annotations

from ..artifacts.draft import DraftProgram
from ..memory import Entry, Memory

DRAFT_STAGE = "s00_draft"
PREFIX = "draft:"
"""What the names begin with under which memory keeps derived answers."""
DRAFTED = "drafted"
"""The setting "objects" of a stage that is answered from a draft: everything is as the draft has it."""

LOOKED = "looked at"
"""The setting "objects" of a stage in which a draft's programs are mended by eyes that see them rendered."""
LOOK_PREFIX = "look:"
"""What the names begin with under which memory keeps what came of that."""


def is_looked_at(client: str) -> bool:
    """Whether an entry of this client's name is a draft's, mended after a look."""
    return client.startswith(LOOK_PREFIX)


def is_drafted(client: str) -> bool:
    """Whether an entry of this client's name was derived from a draft."""
    return client.startswith(PREFIX)


def is_before_draft(memory: Memory, stage: str, entry: Entry) -> bool:
    """Whether a stage's result was there before the draft that stands now."""
    draft = memory.latest_entry(DraftProgram.__name__)
    if draft is None or stage == DRAFT_STAGE:
        return False
    return any(other is draft for other in _after(memory, entry))


def _after(memory: Memory, entry: Entry) -> list[Entry]:
    place = next((n for n, other in enumerate(memory.entries) if other is entry), len(memory.entries))
    return memory.entries[place + 1 :]
