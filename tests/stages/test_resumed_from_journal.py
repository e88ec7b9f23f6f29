"""A run that lost its memory (a crash, undo, a new file) goes on from the journal at the last answered request."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from code_as_room.pipeline.artifacts.corrections import Corrections, ObjectCorrection
from code_as_room.pipeline.errors import CutReplyError, ModelError, RoomError
from code_as_room.pipeline.journal import Journal
from code_as_room.pipeline.memory import EntryMeta, Memory, dump_memory
from code_as_room.pipeline.run import Run
from code_as_room.pipeline.stages import all_stages

FOUR = all_stages()[:4]


@pytest.fixture
def journal(tmp_path: Path) -> Journal:
    return Journal(tmp_path / "journal.jsonl")


def anew(run: Run, journal: Journal) -> Run:
    """The same picture in an empty file, in another Blender."""
    return Run(run.picture, Memory(), run.client, type(run.backend)(), journal=Journal(journal.path))


def statuses(run: Run) -> list[str]:
    return [run.status(stage) for stage in FOUR]


def test_a_whole_run_can_be_had_again_without_asking_anything(run: Run, answers: Any, journal: Journal) -> None:
    run.journal = journal
    run.run_all(FOUR)
    asked = len(answers.asked)
    again = anew(run, journal)
    assert statuses(again) == ["answered", "not run", "not run", "not run"]
    again.run_all(FOUR)
    assert len(answers.asked) == asked and statuses(again) == ["done"] * 4
    assert again.backend.program_text() == run.backend.program_text()
    assert again.memory.cost() == run.memory.cost(), "memory has everything that was paid for"
    assert sum(report.calls for report in again.reports) == 0
    texts = [[e.output for e in r.memory.entries if e.type == "Answer"] for r in (run, again)]
    assert texts[0] == texts[1]


@pytest.mark.parametrize("number", range(8))
def test_a_crash_after_any_answer_repeats_none(run: Run, answers: Any, journal: Journal, number: int) -> None:
    """The machine dies when the model is asked its n-th question; only the journal is left."""
    answer = answers.answer

    def dies(prompt: Any, cancel: Any, progress: Any = None) -> Any:
        if len(answers.asked) >= number:
            raise ModelError("The machine died.")
        return answer(prompt, cancel, progress)

    answers.answer = dies
    run.journal = journal
    died = False
    try:
        run.run_all(FOUR)
    except RoomError:
        died = True
    answers.answer = answer
    resumed = anew(run, journal)
    resumed.run_all(FOUR)
    hashes = [prompt.hash for prompt in answers.asked]
    assert died == (number < len(hashes)) and len(set(hashes)) == len(hashes)
    assert statuses(resumed) == ["done"] * 4


def test_a_stage_that_was_undone_is_answered_and_one_whose_inputs_changed_is_not(
    run: Run, answers: Any, journal: Journal
) -> None:
    run.journal = journal
    first, second = FOUR[:2]
    run.run_stage(first)
    before = list(run.memory.entries)
    run.run_stage(second)
    asked = len(answers.asked)
    run.memory.entries[:] = before  # what undo does to the memory's text
    assert run.status(second) == "answered"
    run.run_stage(second)
    assert run.status(second) == "done" and len(answers.asked) == asked
    run.memory.entries[:] = before
    run.memory.settings["notes"] = "A guest room."
    note = Corrections(objects=[ObjectCorrection(id="bed", note="It is a bunk bed.")])
    run.memory.append("artist", note, EntryMeta(time="t", model="artist"))
    assert run.status(first) != "done" and run.status(second) != "answered"


def test_another_client_is_not_given_the_answers_of_the_first(run: Run, answers: Any, journal: Journal) -> None:
    run.journal = journal
    run.run_stage(FOUR[0])
    other = anew(run, journal)
    other.client = replace(answers, name="another", asked=[])
    assert statuses(other)[0] == "not run"
    other.run_stage(FOUR[0])
    assert other.client.asked  # type: ignore[attr-defined]


def test_an_answer_after_a_cut_one_is_kept_under_the_question(run: Run, answers: Any, journal: Journal) -> None:
    answer, cut = answers.answer, []

    def first_is_cut(prompt: Any, cancel: Any, progress: Any = None) -> Any:
        if not cut:
            cut.append(prompt)
            raise CutReplyError("The answer was cut.")
        return answer(prompt, cancel, progress)

    answers.answer = first_is_cut
    run.journal = journal
    run.run_stage(FOUR[0])
    asked = len(answers.asked)
    anew(run, journal).run_stage(FOUR[0])
    assert len(answers.asked) == asked


def test_neither_picture_nor_path_gets_into_the_journal(run: Run, journal: Journal) -> None:
    run.journal = journal
    run.run_all(FOUR)
    text = journal.path.read_text()
    assert str(journal.path.parent) not in text and "base64" not in text
    assert len(text) < 3 * len(dump_memory(run.memory)), "answers, and not what was sent for them"
