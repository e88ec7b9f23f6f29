# SPDX-License-Identifier: GPL-3.0-or-later
"""Damaged replies through parsing, repair, validation and a stage: only errors of ours come out, only finite numbers go on.

`python -m benchmark.fuzz` does the same a hundred thousand times, and for every stage.
"""

from __future__ import annotations

import json
import math
import os
import random
import subprocess
import sys
import time

import pytest
from code_as_room.pipeline.artifacts.replies import AnalysisReply, CritiqueReply, SecondLookReply
from code_as_room.pipeline.errors import ReplyError
from code_as_room.pipeline.models.validate import validate_reply
from code_as_room.pipeline.stages import s02_graph, s03_layout
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from benchmark.fuzz import Place, reply_of, table, through
from benchmark.fuzz_replies import KINDS, Seed, mutated, read, seeds
from benchmark.fuzz_rooms import rooms, waiting_seeds
from benchmark.fuzz_stages import StageFuzz
from benchmark.fuzz_waiting import Waiting

SEEDS = seeds()
FORKS = pytest.mark.skipif(not hasattr(os, "fork"), reason="this system copies no processes")
SMALL = [seed for seed in SEEDS if len(json.dumps(seed.data)) < 3500]


def test_every_kind_of_reply_has_a_seed() -> None:
    assert {seed.name for seed in SEEDS} == set(KINDS)


@settings(max_examples=600, suppress_health_check=list(HealthCheck))
@given(st.sampled_from(SMALL), st.randoms(use_true_random=False), st.booleans())
def test_a_damaged_reply_is_read_or_refused(seed: Seed, draw: random.Random, salvage: bool) -> None:
    read(mutated(seed.data, draw), seed.kind, salvage)


@pytest.mark.parametrize("seed", SEEDS, ids=lambda seed: seed.name)
def test_long_damaged_replies_are_read_or_refused(seed: Seed) -> None:
    draw = random.Random(3)
    ends = [read(mutated(seed.data, draw), seed.kind, number % 2 == 0) for number in range(60)]
    assert set(ends) <= {"read", "refused"}


@pytest.mark.parametrize("word", ["NaN", "nan", "Infinity", "-inf", "1e999", " 1e999 m", "-1E400"])
def test_a_number_in_words_that_is_not_finite_counts_as_missing(word: str) -> None:
    data = {"score": word, "remarks": "", "edits": []}
    reply, notes = validate_reply(json.dumps(data), CritiqueReply)
    assert reply.score is None and notes
    first = next(seed.data for seed in SEEDS if seed.kind is AnalysisReply)
    reply, notes = validate_reply(json.dumps({**first, "wall_height_m": word}), AnalysisReply)
    assert reply.wall_height_m == AnalysisReply.model_fields["wall_height_m"].default and notes
    with pytest.raises(ReplyError, match="room_width_m"):
        validate_reply(json.dumps({**first, "room_width_m": word}), AnalysisReply)
    correction = {"id": "bed", "yaw_deg": word}
    looked, _ = validate_reply(json.dumps({"missed": [], "corrections": [correction]}), SecondLookReply)
    assert looked.corrections[0].yaw_deg is None


def test_a_stage_reads_damaged_answers() -> None:
    fuzz = StageFuzz(last="s03")
    stage = fuzz.stages[-1]
    ends = [fuzz.once(stage, seed) for seed in range(25)]
    assert "done" in ends and set(ends) <= {"done", "refused"}


def numbers_of(place: Place, count: int) -> list[int]:
    """The first numbers whose replies answer this question."""
    return [number for number in range(60 * count) if reply_of(number, 1)[0] == place][:count]


def test_every_question_of_a_stage_is_waited_at() -> None:
    asked = {key.partition("/")[0] for _, key in waiting_seeds()}
    assert asked == {*KINDS, "01_again"}


@FORKS
@pytest.mark.parametrize("key", ["01_again", "02_graph", "03_critique/0", "04_auxiliary"])
def test_what_was_read_goes_through_the_stage_that_asked(key: str) -> None:
    place = ("bedroom", key)
    row = through(place, numbers_of(place, 25), 1, time.monotonic() + 600)
    assert not row.wrong, row.wrong
    assert row.mutated == 25 == row.read + row.refused
    assert row.done + row.stopped == row.read - row.twice > 2
    assert row.done > 0


COPIED = """
import os, threading
import numpy as np
matrices, rounds = np.eye(6) + np.ones((1024, 6, 6)) / 10, 0
def compute():
    global rounds
    while rounds < 40:
        np.linalg.solve(matrices, np.ones((1024, 6, 1)))
        np.linalg.inv(np.eye(300) + np.ones((300, 300)) @ np.ones((300, 300)))
        rounds += 1
thread = threading.Thread(target=compute, daemon=True)
thread.start()
while thread.is_alive():
    child = os.fork()
    if child == 0:
        os._exit(0)
    os.waitpid(child, 0)
    thread.join(0.002)
print(rounds)
"""


@FORKS
def test_a_thread_that_computes_goes_on_when_the_process_is_copied() -> None:
    # With several threads of OpenBLAS both wait for ever; tests/conftest.py and benchmark/__init__.py see to it.
    said = subprocess.run([sys.executable, "-W", "ignore", "-c", COPIED], capture_output=True, text=True, timeout=300)
    assert said.stdout.split() == ["40"], said.stderr


@FORKS
def test_the_fuzzer_finds_what_is_wrong(monkeypatch: pytest.MonkeyPatch) -> None:
    place = ("bedroom", "02_graph")
    numbers = numbers_of(place, 12)

    def broken(*_: object) -> None:
        raise ZeroDivisionError

    with monkeypatch.context() as patched:
        # Not before the good answer has gone through, so that it is the damaged ones that meet it.
        make, calls = s02_graph.make_graph, iter(range(1000))
        patched.setattr(s02_graph, "make_graph", lambda *a: make(*a) if next(calls) == 0 else broken())
        row = through(place, numbers, 1, time.monotonic() + 600)
    assert row.wrong and not row.done and "ZeroDivisionError" in row.wrong[0]
    assert str(len(row.wrong)) in table([row])


def test_the_fuzzer_finds_a_number_that_is_not_finite(monkeypatch: pytest.MonkeyPatch) -> None:
    waiting, good = Waiting(rooms()["bedroom"], "03_critique/0"), waiting_seeds()["bedroom", "03_critique/0"]
    score = s03_layout.with_model
    monkeypatch.setattr(s03_layout, "with_model", lambda *a: score(*a).model_copy(update={"boxes": math.nan}))
    with pytest.raises(AssertionError, match="not finite in LayoutProgram"):
        waiting.go_on(good.kind.model_validate(good.data))
