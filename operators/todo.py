# SPDX-License-Identifier: GPL-3.0-or-later
"""What a job is to do: stages in their order, each with who is asked and for which objects."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from ..pipeline.artifacts.layout import LayoutProgram
from ..pipeline.draft.looking import LookingClient
from ..pipeline.draft.refine import Step, is_better
from ..pipeline.memory import Entry, Memory
from ..pipeline.models.base import ModelClient
from ..pipeline.run_corrections import program_of
from ..pipeline.stages.base import Stage

if TYPE_CHECKING:
    from ..pipeline.run import Run, StageSession


@dataclass(frozen=True)
class Todo:
    """One stage of a job.

    Attributes:
        again: run it even where it is done. fresh: ask again even where memory holds an answer.
        only: ids of the objects that are to be done anew, None for all.
        client: who is asked. keeps_best: whether what it writes stays only where it is no worse than before.
    """

    stage: Stage
    client: ModelClient
    again: bool = False
    fresh: bool = False
    only: frozenset[str] | None = None
    keeps_best: bool = False

    @property
    def scope(self) -> tuple[bool, frozenset[str] | None]:
        """`fresh` and `only`; a stage that always does everything is not asked anew for the sake of a few objects."""
        if self.only is not None and not self.stage.partial:
            return False, None
        return self.fresh, self.only


def refining(steps: Sequence[Step], stages: Sequence[Stage], real: ModelClient, drafted: ModelClient) -> list[Todo]:
    """Each step asked of the model, and after it what follows from it, answered from the draft."""
    looking, todo = LookingClient(drafted, real), []
    for stage in stages:
        # What the steps before it have changed is brought up to date first, so that only its own objects are asked for.
        todo.append(Todo(stage, drafted))
        for step in steps:
            if step.stage == stage.id:
                client: ModelClient = looking if step.looks else real
                todo.append(Todo(stage, client, True, False, step.only, keeps_best=True))
    return todo


def apply_best(run: Run, session: StageSession) -> bool:
    """Let a stage write what it found, and take it back where the room is worse by it; False then. No worker's business
    but the one that has the session.
    """
    memory, stage = run.memory, session.stage
    before, held = program_of(memory, (stage.id,)), {id(entry) for entry in memory.entries}
    session.apply()
    if LayoutProgram not in stage.writes or is_better(_only(memory, stage.id), before):
        return True
    memory.entries[:] = [e for e in memory.entries if id(e) in held or not _is_of(e, stage.id)]
    return False


def _is_of(entry: Entry, stage: str) -> bool:
    """Whether a stage wrote this; answers stay, since they were paid for."""
    return entry.stage == stage and entry.type != "Answer"


def _only(memory: Memory, stage: str) -> Memory:
    """A memory in which a stage's program is the latest."""
    kept = [e for e in memory.entries if e.type != LayoutProgram.__name__ or e.stage == stage]
    return Memory(memory.picture_name, memory.picture_hash, memory.settings, kept)
