# SPDX-License-Identifier: GPL-3.0-or-later
"""The rounds of the layout loop, for people: what each one was worth, and what the critic asked for after it."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass

from .artifacts.layout import Iteration, LayoutProgram
from .report_words import PARTS, edit_words


@dataclass(frozen=True)
class RoundRow:
    """One round.

    Attributes:
        number: from 0, as `Iteration.number`. score: 0..1.
        parts: what was measured, (title, 0..1) each; the model's own judgement last, where it gave one.
        kept: whether its layout is the one that stage 3 hands on.
        asked, refused: the critic's edits, and those that were not made, in words.
        picture: the key of its picture, see `text_key`.
    """

    number: int
    score: float
    parts: tuple[tuple[str, float], ...]
    kept: bool
    asked: tuple[str, ...]
    refused: tuple[str, ...]
    remarks: str
    picture: str

    @property
    def title(self) -> str:
        """What it is called; people count from one."""
        return f"Round {self.number + 1}"


def round_rows(program: LayoutProgram | None) -> tuple[RoundRow, ...]:
    """A row for each round of a program that stage 3 wrote."""
    return tuple(_row(item, program.best) for item in program.iterations) if program is not None else ()


def _row(item: Iteration, best: int) -> RoundRow:
    parts = [(title, float(getattr(item.score, part))) for part, title in PARTS.items()]
    if item.score.model is not None:
        parts.append(("Model says", item.score.model))
    return RoundRow(
        number=item.number,
        score=item.score.total,
        parts=tuple(parts),
        kept=item.number == best,
        asked=tuple(f"{edit.id} {edit_words(edit)}" for edit in item.edits),
        refused=tuple(f"{finding.about}: {finding.message}" for finding in item.refused),
        remarks=item.remarks,
        picture=text_key(item.program),
    )


def text_key(text: str) -> str:
    """The key under which the picture of a room program (text after the prelude) is kept."""
    return hashlib.sha256(text.strip().encode()).hexdigest()[:24]
