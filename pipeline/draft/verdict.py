# SPDX-License-Identifier: GPL-3.0-or-later
"""How good a draft is, by what was measured on it, in a sentence for the artist."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TypeVar

from pydantic import BaseModel

from ..analysis.merge import SEEN_AGAIN
from ..artifacts.analysis import SceneAnalysis
from ..artifacts.draft import DraftProgram
from ..artifacts.layout import LayoutProgram
from ..memory import Memory

A = TypeVar("A", bound=BaseModel)
MOST_LOST = 0.25
"""Share of a draft's statements that may be unusable before going on stage by stage is advised."""
LEAST_FIT = 0.8
"""Measured score of the layout below which it is."""
MOST_MISSED = 0.35
"""Share of the objects that only the second look found."""
FEW = 3
"""Objects below which a draft is no room."""


@dataclass(frozen=True)
class Verdict:
    """What is to be said of a draft.

    Attributes:
        is_poor: whether going on stage by stage is advised. sentence: for the artist.
        lost: share of the statements of which nothing stands. fit: measured score of its layout, None before stage 3.
        missed: share of the objects that the draft did not have, None before stage 1.
    """

    is_poor: bool
    sentence: str
    lost: float
    fit: float | None = None
    missed: float | None = None


def judge(memory: Memory) -> Verdict | None:
    """The verdict on the draft that stands in a memory; None without one."""
    draft = memory.latest(DraftProgram)
    if draft is None:
        return None
    counted = [s for s in draft.statements if s.kind not in ("import", "build")]
    lost = len(draft.lost) / max(1, len(counted))
    drafted = {s.id for s in draft.statements if s.kind == "proxy" and not s.is_lost}
    objects = len(drafted)
    analysis, program = _since(memory, SceneAnalysis), _since(memory, LayoutProgram)
    missed = None
    if analysis is not None and analysis.objects:
        # A second look corrects as well; what it corrected was drafted.
        missed = sum(o.source == SEEN_AGAIN and o.id not in drafted for o in analysis.objects) / len(analysis.objects)
    fit = program.score.measured if program is not None else None
    wrong = []
    if lost > MOST_LOST:
        wrong.append(f"{lost:.0%} of its program could not be used")
    if objects < FEW:
        wrong.append(f"it has only {objects} object{'' if objects == 1 else 's'}")
    if fit is not None and fit < LEAST_FIT:
        wrong.append(f"its layout fits the picture only to {fit:.0%}")
    if missed is not None and missed > MOST_MISSED:
        wrong.append(f"it missed {missed:.0%} of the objects")
    if wrong:
        said = " and ".join(wrong[:2])
        sentence = f"The draft is poor: {said}. Go on stage by stage; what was understood is kept."
        return Verdict(True, sentence, lost, fit, missed)
    return Verdict(False, _good(draft, objects, lost, fit, missed), lost, fit, missed)


def _good(draft: DraftProgram, objects: int, lost: float, fit: float | None, missed: float | None) -> str:
    """What is said of a draft that can be worked with."""
    facts = [f"{objects} objects"]
    if fit is not None:
        facts.append(f"the layout fits to {fit:.0%}")
    if missed:
        facts.append(f"{missed:.0%} were seen only at a second look")
    if draft.lost:
        facts.append(f"{len(draft.lost)} of {len(draft.statements)} statements could not be used")
    if not draft.whole:
        facts.append("it ends early")
    return f"Draft: {', '.join(facts)}."


def _since(memory: Memory, kind: type[A]) -> A | None:
    """An artifact that was written after the draft, None where the one there is is older."""
    for entry in reversed(memory.entries):
        if entry.type == DraftProgram.__name__:
            return None
        if entry.type == kind.__name__:
            return kind.model_validate(entry.output)
    return None
