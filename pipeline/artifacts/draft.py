# SPDX-License-Identifier: GPL-3.0-or-later
"""A whole room that a model wrote in one answer, and what became of each of its statements."""

from __future__ import annotations

from .common import Artifact


class DraftStatement(Artifact):
    """One top-level statement of a draft.

    Attributes:
        kind: what it is: "room", "proxy", "def", "look", "number", "furnish", "finish", ... "" for what is none of them.
        id: of what it speaks of, "" for nothing. first, last: 1-based lines in the program as it was written.
        verdict: "ok", "mended", "refused", or "replaced by " and the library's piece that stands instead.
        sentence: why it is not "ok".
    """

    kind: str = ""
    id: str = ""
    first: int = 0
    last: int = 0
    verdict: str = "ok"
    sentence: str = ""

    @property
    def is_lost(self) -> bool:
        """Whether nothing of it stands in the room."""
        return self.verdict == "refused" or self.verdict.startswith("replaced")


class DraftProgram(Artifact):
    """What the stage "Draft" writes.

    Attributes:
        text: the model's program as it was written. room_text: the room of it, in the room language.
        statements: what became of each, in their order.
        amended: programs that were asked again, in the order in which they were taken.
        style: of the room, in the model's words. whole: False where it was stopped or cut before its end.
        refused_at_first: how many statements could not be used before anything was asked again.
        twins: id of each object that is made like another one -> id of that one.
    """

    text: str
    room_text: str
    statements: list[DraftStatement] = []
    amended: list[str] = []
    style: str = ""
    whole: bool = True
    refused_at_first: int = 0
    twins: dict[str, str] = {}

    @property
    def lost(self) -> list[DraftStatement]:
        """Statements of which nothing stands."""
        return [s for s in self.statements if s.is_lost]
