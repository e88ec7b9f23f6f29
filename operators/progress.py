# SPDX-License-Identifier: GPL-3.0-or-later
"""What the panel shows while a job runs, as plain values, and how long stages took before."""

from __future__ import annotations

import statistics
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from ..pipeline.ask import AskEvent
from ..pipeline.memory import Entry, Memory
from .user_files import read_json, write_json

_KEPT, _MOST = 7, 200
_FILE = "durations.json"


@dataclass
class Progress:
    """What the panel shows while the job runs; plain values.

    Attributes:
        stage, title: id and title of the stage that runs; what, step, steps: what it is doing, step of steps.
        note: what the model client or the driver has to say.
        began: `time.monotonic()` of the job's begin; stage_began: of the stage's.
        number, total: the stage's place among those of the job.
        expected: seconds that the whole job may take, going by earlier runs; None when that is not known.
        stage_expected: the same of the present stage.
        tokens, cost: of the room so far, this job included: tokens, US dollars (None when no price is known).
        calls_open, calls_done: questions of this job that wait for an answer, and that have one.
    """

    stage: str = ""
    title: str = ""
    what: str = ""
    step: int = 0
    steps: int = 0
    note: str = ""
    began: float = 0.0
    stage_began: float = 0.0
    number: int = 0
    total: int = 1
    stopping: bool = False
    expected: float | None = None
    stage_expected: float | None = None
    tokens: int = 0
    cost: float | None = None
    calls_open: int = 0
    calls_done: int = 0
    _open: set[str] = field(default_factory=set)

    @property
    def fraction(self) -> float:
        """How much of the job is done, 0..1, going by stages and the steps that they tell."""
        inside = max(0, self.step - 1) / self.steps if self.steps else 0.0
        return min(1.0, (max(0, self.number - 1) + inside) / max(1, self.total))

    @property
    def expected_words(self) -> str:
        """The expected time of the whole job, labelled as the estimate that it is; "" when it is not known."""
        return "" if self.expected is None else f"about {in_words(self.expected)}"

    def take(self, event: AskEvent) -> None:
        """Note what happened to a question."""
        if event.kind == "heard":
            return
        self.note = event.text
        if event.kind == "asked":
            self._open.add(event.key)
        elif event.kind in ("answered", "recalled", "failed"):
            self._open.discard(event.key)
            self.calls_done += event.kind == "answered"
        self.calls_open = len(self._open)

    def count(self, memory: Memory) -> None:
        """Tokens and cost as memory knows them."""
        asked, answered, _ = memory.cost()
        known = [e.meta.cost for e in memory.entries if e.type == "Answer" and e.meta.cost is not None]
        self.tokens, self.cost = asked + answered, sum(known) if known else None


def in_words(seconds: float) -> str:
    """A rough time, such as "40 s" or "3 min"."""
    if seconds < 10:
        return f"{max(1, round(seconds))} s"
    return f"{round(seconds / 5) * 5} s" if seconds < 100 else f"{round(seconds / 60)} min"


class Durations:
    """How long stages took, by what answered: of this memory, and of other files from a small file of the user's.

    Args:
        folder: the add-on's folder for the user's data; None where there is none.
    """

    def __init__(self, folder: Path | None) -> None:
        self._path = folder / _FILE if folder is not None else None
        self._seconds = {key: _numbers(values) for key, values in read_json(self._path).items()}

    def expected(self, memory: Memory, stage: str, client: str) -> float | None:
        """The middle of the last times of a stage in seconds, None when it never ran with this client."""
        here = [
            e.meta.seconds
            for e in memory.entries
            if e.stage == stage and e.meta.client == client and e.type != "Answer" and _was_asked(e)
        ]
        known = [*self._seconds.get(f"{stage} {client}", []), *dict.fromkeys(here)][-_KEPT:]
        return statistics.median(known) if known else None

    def expected_all(self, memory: Memory, stages: Sequence[str], client_of: dict[str, str]) -> float | None:
        """The same of several stages together; None when one of them is not known."""
        times = [self.expected(memory, stage, client_of[stage]) for stage in stages]
        return None if None in times or not times else sum(t for t in times if t is not None)

    def note(self, stage: str, client: str, seconds: float) -> None:
        """Remember how long a stage took that asked something; never raises."""
        key = f"{stage} {client}"
        self._seconds[key] = [*self._seconds.get(key, []), round(seconds, 1)][-_KEPT:]
        write_json(self._path, dict(list(self._seconds.items())[-_MOST:]))


def _numbers(values: Any) -> list[float]:
    """What is usable of a list of times."""
    return (
        [float(v) for v in values if isinstance(v, (int, float)) and v >= 0][-_KEPT:]
        if isinstance(values, list)
        else []
    )


def _was_asked(entry: Entry) -> bool:
    """Whether the stage asked something, and did not only use earlier answers again."""
    return entry.meta.completion_tokens > 0 or entry.meta.client == "builtin"
