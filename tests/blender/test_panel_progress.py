# SPDX-License-Identifier: GPL-3.0-or-later
"""What the panel knows of a run's time, tokens and money, and the consent before the first request."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from code_as_room.operators import clients, consent
from code_as_room.operators.progress import Durations, Progress, in_words
from code_as_room.pipeline.artifacts.graph import MinorObjects
from code_as_room.pipeline.ask import AskEvent
from code_as_room.pipeline.memory import EntryMeta, Memory


def test_expected_times_come_from_earlier_runs_in_this_and_other_files(tmp_path: Path) -> None:
    memory = Memory()
    assert Durations(tmp_path).expected(memory, "s02_graph", "big") is None
    for seconds in (40.0, 44.0, 300.0):
        Durations(tmp_path).note("s02_graph", "big", seconds)
    later = Durations(tmp_path)
    assert later.expected(memory, "s02_graph", "big") == 44.0, "one run that took long does not count"
    assert later.expected(memory, "s02_graph", "small") is None, "another model has times of its own"
    meta = EntryMeta(time="2026-01-01T00:00:00+00:00", client="small", completion_tokens=10, seconds=12.0)
    memory.append("s02_graph", MinorObjects(by_parent={}), meta)
    assert later.expected(memory, "s02_graph", "small") == 12.0
    names = {"s02_graph": "big", "s03_layout": "big"}
    assert later.expected_all(memory, ["s02_graph", "s03_layout"], names) is None
    assert later.expected_all(memory, ["s02_graph"], names) == 44.0


def test_a_file_of_times_that_is_broken_is_no_reason_to_stop(tmp_path: Path) -> None:
    (tmp_path / "durations.json").write_text('{"s02_graph big": "soon", "x": [1, "y"]', encoding="utf-8")
    times = Durations(tmp_path)
    assert times.expected(Memory(), "s02_graph", "big") is None
    times.note("s02_graph", "big", 5.0)
    assert Durations(tmp_path).expected(Memory(), "s02_graph", "big") == 5.0


def test_progress_counts_questions_and_labels_estimates() -> None:
    progress = Progress()
    for key in ("a", "b"):
        progress.take(AskEvent(key, "asked", ""))
    progress.take(AskEvent("a", "answered", ""))
    assert (progress.calls_open, progress.calls_done) == (1, 1)
    progress.take(AskEvent("b", "failed", ""))
    assert (progress.calls_open, progress.calls_done) == (0, 1)
    assert progress.expected_words == ""
    progress.expected = 41.0
    assert progress.expected_words == "about 40 s" and in_words(200) == "3 min"


def test_tokens_and_cost_are_those_of_the_room_and_no_price_is_not_no_cost() -> None:
    memory, progress = Memory(), Progress()
    meta = EntryMeta(time="", prompt_tokens=1000, completion_tokens=200)
    memory.keep_answer("s02_graph", "a", "{}", meta)
    progress.count(memory)
    assert progress.tokens == 1200 and progress.cost is None
    memory.keep_answer("s02_graph", "b", "{}", meta.model_copy(update={"cost": 0.02}))
    progress.count(memory)
    assert progress.tokens == 2400 and progress.cost == pytest.approx(0.02)


def test_consent_is_remembered_for_one_host_and_can_be_taken_back(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(clients, "user_folder", lambda: tmp_path)
    assert consent.is_allowed(""), "nothing leaves this computer"
    assert not consent.is_allowed("models.example.com")
    consent.allow("models.example.com")
    consent._session.clear()  # as after a restart
    assert consent.is_allowed("models.example.com") and not consent.is_allowed("other.example.com")
    consent.forget()
    assert not consent.is_allowed("models.example.com")


def test_the_dialog_names_the_host_and_what_is_sent() -> None:
    class Settings:
        picture, picture_name, notes = None, "room.png", "the bed is 1.4 m wide"

    class Context:
        scene: Any = type("Scene", (), {"code_as_room": Settings()})()

    said = " ".join(line for line, _ in consent.what_is_sent(Context, "models.example.com"))
    assert "models.example.com" in said and "room.png" in said and "notes" in said
