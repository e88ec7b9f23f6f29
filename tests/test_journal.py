"""The journal's file: nothing that was kept is lost, and nothing that is damaged harms the rest."""

from __future__ import annotations

import json
import os
import stat
import subprocess
import sys
import threading
import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from code_as_room.pipeline import journal as module
from code_as_room.pipeline.artifacts.replies import GraphReply
from code_as_room.pipeline.ask import perform_ask
from code_as_room.pipeline.errors import ModelError, ReplyError
from code_as_room.pipeline.journal import Journal, JournalledClient, KeptAnswer, prune
from code_as_room.pipeline.models.base import Prompt, Reply
from code_as_room.pipeline.stages.wishes import Ask, Request
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

ANSWER = KeptAnswer("s01_analysis", "01", "openai:x", "h1", '{"a": "ä\\n"}', "x-1", 10, 5, 0.01, 2.5, "t", ("note",))
INPUTS = {"picture": "abc"}


@pytest.fixture
def path(tmp_path: Path) -> Path:
    return tmp_path / "journal" / "picture.jsonl"


def test_what_was_kept_is_there_in_another_process(path: Path) -> None:
    answer = replace(ANSWER, inputs=INPUTS)
    Journal(path).keep(answer)
    assert Journal(path).answer("h1", "openai:x") == answer
    assert Journal(path).answer("h1", "openai:y") is None and Journal(path).answer("h2", "openai:x") is None


@given(st.lists(st.text(max_size=300), min_size=1, max_size=5))
@settings(suppress_health_check=[HealthCheck.function_scoped_fixture], max_examples=40)
def test_any_text_survives(path: Path, texts: list[str]) -> None:
    texts = [text.encode("utf-8", "replace").decode() for text in texts]
    path.unlink(missing_ok=True)
    for number, text in enumerate(texts):
        Journal(path).keep(replace(ANSWER, prompt_hash=str(number), text=text))
    assert [a.text for a in Journal(path).answers()] == texts


@pytest.mark.parametrize("cut", [1, 2, 30, 200])
def test_a_record_torn_by_a_crash_is_skipped_and_harms_no_other(path: Path, cut: int) -> None:
    journal = Journal(path)
    journal.keep(ANSWER)
    journal.keep(replace(ANSWER, prompt_hash="torn"))
    path.write_bytes(path.read_bytes()[:-cut])
    reopened = Journal(path)
    # Only the line break is missing after the first cut, and yet nothing may be half-read.
    assert [a.prompt_hash for a in reopened.answers()] == ["h1"]
    reopened.keep(replace(ANSWER, prompt_hash="h3"))
    again = Journal(path)
    assert again.answer("h1", "openai:x") == ANSWER and again.answer("h3", "openai:x") is not None


@pytest.mark.parametrize(
    "line",
    [b"\xff\xfe garbage", b"[" * 100_000, b"[]", b"null", b"7", b'{"is":"answer"}', b'{"is":"of a newer version","x":1}',
     b'{"is":"answer","stage":1,"key":"k","client":"c","prompt_hash":"h","text":"t"}',
     b'{"is":"answer","stage":"s","key":"k","client":"c","prompt_hash":"h","text":"t","cost":1e999}',
     b'{"is":"answer","stage":"s","key":"k","client":"c","prompt_hash":"h","text":"t","inputs":[1]}',
     b'{"is":"finished","stage":{}}', b'{"is":"unusable","stage":[]}'],
)  # fmt: skip
def test_foreign_lines_are_skipped(path: Path, line: bytes) -> None:
    Journal(path).keep(ANSWER)
    with path.open("ab") as file:
        file.write(line + b"\n")
    Journal(path).keep(replace(ANSWER, prompt_hash="h2"))
    assert [a.prompt_hash for a in Journal(path).answers()] == ["h1", "h2"]


WRITER = """
import sys
sys.path.insert(0, {parent!r})
from pathlib import Path
from code_as_room.pipeline.journal import Journal, KeptAnswer
journal = Journal(Path(sys.argv[1]))
for number in range(60):
    journal.keep(KeptAnswer("s", "k", sys.argv[2], str(number), "x" * 40_000))
"""


def test_two_processes_may_append_at_the_same_time(path: Path) -> None:
    import code_as_room

    code = WRITER.format(parent=str(Path(code_as_room.__file__ or "").parents[1]))
    reader = Journal(path)
    writers = [subprocess.Popen([sys.executable, "-c", code, str(path), name]) for name in ("one", "two")]
    while any(writer.poll() is None for writer in writers):
        assert all(a.text == "x" * 40_000 for a in reader.answers()), "read while it is written"
        time.sleep(0.02)
    assert [writer.returncode for writer in writers] == [0, 0]
    assert len(reader.answers()) == len(Journal(path).answers()) == 120


def test_threads_may_keep_answers_at_the_same_time(path: Path) -> None:
    journal = Journal(path)
    threads = [
        threading.Thread(target=lambda n=n: journal.keep(replace(ANSWER, prompt_hash=str(n)))) for n in range(12)
    ]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(Journal(path).answers()) == 12


@pytest.mark.skipif(os.name == "nt", reason="Windows keeps no such permissions")
def test_only_its_owner_may_read_it(path: Path) -> None:
    Journal(path).keep(ANSWER)
    assert stat.S_IMODE(path.stat().st_mode) == 0o600
    assert stat.S_IMODE(path.parent.stat().st_mode) == 0o700


def test_a_full_disk_stops_nothing_and_loses_nothing_of_this_session(
    path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    journal = Journal(path)
    journal.keep(ANSWER)
    write = os.write

    def half(handle: int, data: bytes) -> int:
        return write(handle, data[: len(data) // 2])

    monkeypatch.setattr(os, "write", half)
    journal.keep(replace(ANSWER, prompt_hash="h2"))
    assert "full" in journal.problem and journal.answer("h2", "openai:x") is not None
    monkeypatch.setattr(os, "write", write)
    journal.keep(replace(ANSWER, prompt_hash="h3"))
    assert journal.problem == ""
    assert {a.prompt_hash for a in Journal(path).answers()} == {"h1", "h2", "h3"}


def test_a_folder_that_cannot_be_made_stops_nothing(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("in the way")
    journal = Journal(tmp_path / "file" / "picture.jsonl")
    journal.keep(ANSWER)
    assert journal.problem and journal.answer("h1", "openai:x") == ANSWER


def test_what_was_forgotten_in_another_blender_is_forgotten_here(path: Path) -> None:
    one, other = Journal(path), Journal(path)
    one.keep(ANSWER)
    one.finish("s01_analysis", "openai:x", INPUTS)
    assert other.answer("h1", "openai:x") and other.has_finished("s01_analysis", "openai:x", INPUTS)
    one.forget()
    for journal in (one, other):
        assert not journal.answers() and not journal.has_finished("s01_analysis", "", INPUTS)
    assert not path.exists()
    other.keep(ANSWER)
    assert one.answer("h1", "openai:x") == ANSWER


def test_a_finished_stage_is_known_by_its_inputs_and_client(path: Path) -> None:
    Journal(path).finish("s02_graph", "openai:x", INPUTS)
    journal = Journal(path)
    assert journal.has_finished("s02_graph", "openai:x", INPUTS) and journal.has_finished("s02_graph", "", INPUTS)
    assert not journal.has_finished("s02_graph", "openai:y", INPUTS)
    assert not journal.has_finished("s02_graph", "", {"picture": "other"})
    assert not journal.has_finished("s01_analysis", "", INPUTS)


def test_free_answers_of_another_version_are_not_used_and_paid_ones_are(path: Path) -> None:
    old = Journal(path, "0.1.0")
    for client in ("builtin", "openai:x"):
        old.keep(replace(ANSWER, client=client))
        old.finish("s01_analysis", client, INPUTS)
    new = Journal(path, "0.2.0")
    assert [a.client for a in new.answers()] == ["openai:x"]
    assert not new.has_finished("s01_analysis", "builtin", INPUTS)
    assert len(Journal(path, "0.1.0").answers()) == 2


def aged(path: Path, days: float, size: int) -> Path:
    path.write_bytes(b"x" * size)
    used = time.time() - days * 86_400
    os.utime(path, (used, used))
    return path


def test_old_journals_go_then_the_oldest_until_the_rest_is_small_enough(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(module, "MOST_BYTES", 250)
    ages = {"ancient": 91, "older": 50, "old": 40, "young": 1, "mine": 100, "of another Blender": 0}
    paths = {name: aged(tmp_path / f"{name}.jsonl", days, 100) for name, days in ages.items()}
    foreign = aged(tmp_path / "notes.txt", 400, 100)
    deleted = prune(tmp_path, keep=paths["mine"])
    assert deleted == [paths["ancient"], paths["older"], paths["old"], paths["young"]]
    assert paths["mine"].exists() and paths["of another Blender"].exists() and foreign.exists()
    assert prune(tmp_path / "not there") == []


class Client:
    """Says what it is told to, and counts what it was asked."""

    name, describes = "openai:x", "A client for tests"

    def __init__(self, *says: Any) -> None:
        self.says, self.asked = list(says), []  # type: ignore[var-annotated]

    def answer(self, prompt: Prompt, cancel: threading.Event, progress: Callable[[str], None] | None = None) -> Reply:
        self.asked.append(prompt.repair)
        said = self.says.pop(0)
        if isinstance(said, Exception):
            raise said
        return Reply(said, "x-1", 10, 5, 0.01, 1.0)


GOOD = json.dumps({"attributes": [], "relations": []})
QUESTION = Ask((Request("02_graph", "02_graph", GraphReply, {"objects": "bed", "walls": "north"}),))


def ask(client: Client, journal: Journal, fresh: bool = False) -> Any:
    """As a stage's session asks."""
    wrapped = JournalledClient(client, journal, INPUTS, fresh)

    def refuse(key: str) -> None:
        journal.refuse("s02_graph", key, client.name, INPUTS)

    return perform_ask(QUESTION, "s02_graph", wrapped, threading.Event(), refuse=refuse)[0]


def test_an_answer_in_the_journal_is_not_asked_for_again_and_keeps_its_price(path: Path) -> None:
    first = ask(Client(GOOD), Journal(path))
    nobody = Client()
    again = ask(nobody, Journal(path))
    assert nobody.asked == [] and again.tries == 0 and first.tries == 1
    assert (again.text, again.cost, again.prompt_tokens, again.prompt_hash) == (GOOD, 0.01, 10, first.prompt_hash)
    redo = Client(GOOD)
    ask(redo, Journal(path), fresh=True)
    assert redo.asked == [False]


def test_a_crash_between_answer_and_repair_asks_only_for_the_repair(path: Path) -> None:
    with pytest.raises(ModelError):
        ask(Client("no JSON at all", ModelError("The service is down.")), Journal(path))
    after = Client(GOOD)
    assert ask(after, Journal(path)).tries == 1
    assert after.asked == [True]
    nobody = Client()
    assert ask(nobody, Journal(path)).text == GOOD and nobody.asked == []


def test_answers_that_stayed_unusable_are_asked_for_again(path: Path) -> None:
    with pytest.raises(ReplyError):
        ask(Client("no JSON", "none either"), Journal(path))
    again = Client(GOOD)
    assert ask(again, Journal(path)).text == GOOD
    assert again.asked == [False]
