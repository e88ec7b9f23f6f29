# SPDX-License-Identifier: GPL-3.0-or-later
"""Damaged replies through parsing, repair, validation and a stage: only errors of ours come out, only finite numbers go on.

`python -m benchmark.fuzz` does the same a hundred thousand times, and for every stage.
"""

from __future__ import annotations

import json
import random

import pytest
from code_as_room.pipeline.artifacts.replies import AnalysisReply, CritiqueReply, SecondLookReply
from code_as_room.pipeline.errors import ReplyError
from code_as_room.pipeline.models.validate import validate_reply
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from benchmark.fuzz import KINDS, Seed, StageFuzz, mutated, read, seeds

SEEDS = seeds()
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
