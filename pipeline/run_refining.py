# SPDX-License-Identifier: GPL-3.0-or-later
"""Does the steps that a drafted room calls for, without a window; what a step makes worse is taken back."""

from __future__ import annotations

from collections.abc import Callable

from .artifacts.layout import LayoutProgram
from .draft.looking import LookingClient
from .draft.refine import Step, is_better, plan
from .errors import Cancelled, ModelError
from .memory import Memory, dump_memory
from .models.base import ModelClient
from .run import Run
from .run_corrections import program_of
from .stages import all_stages
from .stages.base import Stage


def refine(run: Run, real: ModelClient, say: Callable[[str], None] = lambda words: None) -> list[Step]:
    """Do what `refine.plan` says: each step with the model, all that follows it from the draft.

    Args:
        run: its client answers from the draft. real: who is asked. say: is told what is done and what was taken back.

    Raises:
        Cancelled: the run was stopped; what was done before the step on its way stays.
        RoomError: a stage that follows a step failed.
    """
    drafted, done = run.client, []
    stages = {stage.id: stage for stage in all_stages()}
    for step in plan(run.memory):
        _settle(run, step.stage)
        say(f"Refining: {step.why}")
        before, held = program_of(run.memory, (step.stage,)), len(run.memory.entries)
        text = run.backend.program_text()
        run.client = LookingClient(drafted, real) if step.looks else real
        try:
            _do(run, stages[step.stage], step)
        except Cancelled:
            raise
        except ModelError as error:
            say(f"It stays as it was: {error}")
            continue
        finally:
            run.client = drafted
        if LayoutProgram in stages[step.stage].writes and not is_better(_only(run.memory, step.stage), before):
            _take_back(run, held, text)
            say("It was no better; taken back.")
            continue
        done.append(step)
    _settle(run, "")
    return done


def _settle(run: Run, until: str) -> None:
    """Run all stages before one, "" for all, that something before them has changed."""
    stages = all_stages()
    ids = [stage.id for stage in stages]
    run.run_all(stages[: ids.index(until)] if until else stages)


def _do(run: Run, stage: Stage, step: Step) -> None:
    try:
        session = run.begin(stage, only=step.only)
        while not session.finished:
            session.step()
    except BaseException:
        run.put_back()
        raise


def _only(memory: Memory, stage: str) -> Memory:
    """A memory in which a stage's program is the latest."""
    kept = [e for e in memory.entries if e.type != LayoutProgram.__name__ or e.stage == stage]
    return Memory(memory.picture_name, memory.picture_hash, memory.settings, kept)


def _take_back(run: Run, held: int, text: str) -> None:
    """The room and its memory as they were; answers stay, since they were paid for."""
    answers = [e for e in run.memory.entries[held:] if e.type == "Answer"]
    run.memory.entries[held:] = answers
    if text and run.backend.program_text() != text:
        run.backend.build(text)
    run.backend.save_memory(dump_memory(run.memory))
