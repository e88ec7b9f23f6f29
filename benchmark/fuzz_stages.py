# SPDX-License-Identifier: GPL-3.0-or-later
"""Whole stages of the sample, asked and repaired as in a run, with damaged answers to some of their questions."""

from __future__ import annotations

import json
import random
import threading
import time
import traceback
from collections import Counter
from collections.abc import Callable
from typing import Any

from code_as_room.pipeline.errors import RoomError
from code_as_room.pipeline.memory import dump_memory, load_memory
from code_as_room.pipeline.models.base import Prompt, Reply
from code_as_room.pipeline.models.builtin.empty import empty_value
from code_as_room.pipeline.models.recorded import RecordedClient
from code_as_room.pipeline.picture import load_picture
from code_as_room.pipeline.program.lines import parse_layout
from code_as_room.pipeline.run import Run
from code_as_room.pipeline.stages import all_stages

from .fuzz_replies import SAMPLE, mutated, not_finite
from .plain_backend import PlainBackend


class FuzzedClient:
    """Answers as it was recorded, damaged now and then. `chance` is that of a damaged answer."""

    name = "fuzzed"
    describes = "Recorded answers, damaged"

    def __init__(self) -> None:
        self._recorded = RecordedClient(SAMPLE / "replies")
        self._lock = threading.Lock()
        self.chance, self.draw = 0.0, random.Random(0)
        self.said: list[str] = []

    def answer(self, prompt: Prompt, cancel: threading.Event, progress: Callable[[str], None] | None = None) -> Reply:
        """The recorded answer, nothing to add where there is none, or what mutation makes of either."""
        try:
            text = self._recorded.answer(prompt, cancel).text
        except RoomError:
            text = json.dumps(empty_value(prompt.schema))
        with self._lock:
            if self.draw.random() < self.chance:
                text = mutated(json.loads(text), self.draw)
            self.said.append(text)
        return Reply(text=text, model=self.name)


class StageFuzz:
    """A good run of the sample, whose stages are then done again with damaged answers."""

    def __init__(self, last: str = "s99") -> None:
        self.client, self.backend = FuzzedClient(), PlainBackend()
        self.stages = [stage for stage in all_stages() if stage.id < last]
        self._before: dict[str, tuple[str, str]] = {}
        self.seconds: Counter[str] = Counter()
        self._picture = load_picture(SAMPLE / "picture.png")
        run = Run(self._picture, load_memory(""), self.client, self.backend)
        run.memory.settings["iterations"] = "1"
        for stage in self.stages:
            self._before[stage.id] = (dump_memory(run.memory), self.backend.program_text())
            run.run_stage(stage)

    def once(self, stage: Any, seed: int) -> str:
        """Do one stage with damaged answers: "done", or "refused" in words. Raises what is neither."""
        memory, text = self._before[stage.id]
        self.client.chance, self.client.draw, self.client.said = 0.7, random.Random(seed), []
        if text:
            self.backend.build(text)
        run = Run(self._picture, load_memory(memory), self.client, self.backend)
        began = time.perf_counter()
        try:
            session = run.begin(stage, fresh=True)
            while not session.finished:
                session.step()
        except RoomError as error:
            assert error.message, "an error in words"
            if isinstance(error.__cause__, Exception) and not isinstance(error.__cause__, RoomError):
                raise error.__cause__ from None
            return "refused"
        finally:
            self.seconds[stage.id] += time.perf_counter() - began  # type: ignore[assignment]
        for entry in run.memory.entries:
            assert not list(not_finite(entry)), f"not finite in {entry.kind}"
        program = self.backend.program_text()
        if program:
            assert not list(not_finite(parse_layout(program))), "not finite in the program"
        assert load_memory(dump_memory(run.memory)).entries
        return "done"


def fuzz_stages(runs: int, seed: int, only: str = "") -> tuple[dict[str, Counter[str]], list[str], StageFuzz]:
    """Do each stage so often; how they ended, and what went wrong."""
    fuzz = StageFuzz()
    ends: dict[str, Counter[str]] = {}
    wrong: list[str] = []
    for stage in fuzz.stages:
        if only not in stage.id:
            continue
        ends[stage.id] = Counter()
        for number in range(runs):
            try:
                ends[stage.id][fuzz.once(stage, seed * 100_000 + number)] += 1
            except Exception:
                wrong.append(f"{stage.id} seed {seed * 100_000 + number}: {traceback.format_exc(limit=-6)}")
    return ends, wrong, fuzz
