# SPDX-License-Identifier: GPL-3.0-or-later
"""Which answers the built-in analysis gave in a weak model's stead (`ask_floor`), told from memory."""

from __future__ import annotations

from collections.abc import Iterable

from .artifacts.analysis import Finding
from .memory import Entry, Memory
from .stages import all_stages

NOTE = "The built-in analysis answered instead of the model"
"""How the note on such an answer begins; what was wrong follows after a colon."""
_FEW = 4


def replaced_answers(memory: Memory, stages: Iterable[str] | None = None) -> list[Finding]:
    """A finding for each stage whose present result stands on answers that the built-in analysis gave.

    Args:
        stages: ids of the stages to look at, None for all.
    """
    written = {entry.stage: entry.meta.client for entry in memory.entries if entry.type != "Answer"}
    wanted = written if stages is None else set(stages)
    answers: dict[str, dict[str, Entry]] = {}
    for entry in memory.entries:
        # What another client answered earlier or later has no part in the present result.
        if entry.type == "Answer" and entry.stage in wanted and entry.meta.client == written.get(entry.stage):
            answers.setdefault(entry.stage, {})[str(entry.output.get("key", ""))] = entry
    return [found for stage, held in answers.items() if (found := _finding(stage, held)) is not None]


def _finding(stage: str, answers: dict[str, Entry]) -> Finding | None:
    """What is told of one stage's answers, by their questions' keys; None where the model gave them all."""
    keys = [key for key, entry in answers.items() if any(note.startswith(NOTE) for note in entry.meta.notes)]
    if not keys:
        return None
    model = answers[keys[0]].meta.client.partition(":")[2] or "the model"
    named = ", ".join(keys[:_FEW]) + (f" and {len(keys) - _FEW} more" if len(keys) > _FEW else "")
    return Finding(
        about=next((known.title for known in all_stages() if known.id == stage), stage),
        message=(
            f"The built-in analysis answered {len(keys)} of {len(answers)} questions ({named}), since what {model} said "
            "could not be used. Choose a stronger model and run the stage again, or correct the room by hand."
        ),
        severity="warning",
    )
