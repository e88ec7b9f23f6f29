# SPDX-License-Identifier: GPL-3.0-or-later
"""Mutated replies through everything that reads them: `python -m benchmark.fuzz [--replies 100000] [--minutes 25] [--processes 2]`.

Recorded replies of every kind are damaged, then parsed, repaired and validated as the answers of several vendors' models. What was
read, and differs from all that was read before, is given to the stage that asks for it (`fuzz_waiting.py`), which goes on to its end.
Last, whole stages of the full sample are asked and repaired with damaged answers (`fuzz_stages.py`). Only our own errors may
come out, and no number that is not finite may reach a reply, an artifact, a program, a line, a look or a mesh. The exit code is 1
where something else did; what did it is printed with its number, which makes it again: `--only NUMBER`.

A stage that takes long gets fewer replies: the minutes are shared out evenly, and what others leave goes to those.
"""

from __future__ import annotations

import argparse
import gc
import hashlib
import random
import sys
import time
import traceback
from collections.abc import Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, field
from functools import cache
from multiprocessing import get_context

from pydantic import BaseModel

from .fuzz_replies import MODELS, Seed, mutated, read_as
from .fuzz_rooms import rooms, waiting_seeds
from .fuzz_stages import fuzz_stages
from .fuzz_waiting import Waiting

Place = tuple[str, str]
"""A room's name and a request's key."""
_SLOW = ("01_analysis", "01_second_look", "06_pieces", "06_programs", "06_correct", "10_light")
"""Kinds whose stages take long; they come last, when it is known how much time the others left."""


@dataclass
class Row:
    """What became of the replies to one question.

    Attributes:
        twice: read, but of a value that was tried before. done, stopped: at the end of the stage, or by an error of ours.
        left: read, but there was no time for the stage. seconds: in stages; longest: of them.
    """

    kind: str
    mutated: int = 0
    refused: int = 0
    read: int = 0
    twice: int = 0
    done: int = 0
    stopped: int = 0
    left: int = 0
    seconds: float = 0.0
    longest: float = 0.0
    wrong: list[str] = field(default_factory=list)

    def add(self, other: Row) -> None:
        """Count another row of this kind in."""
        for name in ("mutated", "refused", "read", "twice", "done", "stopped", "left", "seconds"):
            setattr(self, name, getattr(self, name) + getattr(other, name))
        self.longest = max(self.longest, other.longest)
        self.wrong += other.wrong


@cache
def _known() -> tuple[tuple[Place, Seed], ...]:
    return tuple(waiting_seeds().items())


def reply_of(number: int, seed: int) -> tuple[Place, Seed, random.Random]:
    """Which question a numbered reply answers, and the source of chance that damages it."""
    draw = random.Random(f"{seed}/{number}")
    place, good = draw.choice(_known())
    return place, good, draw


def different(place: Place, numbers: Sequence[int], seed: int, row: Row) -> Iterator[tuple[int, BaseModel]]:
    """Reads these replies, counts them in the row, and gives those that are read and not like one before."""
    tried: set[bytes] = set()
    for number in numbers:
        _, good, draw = reply_of(number, seed)
        text = mutated(good.data, draw)
        row.mutated += 1
        try:
            reply = read_as(text, good.kind, number % 2 == 0, MODELS[number % len(MODELS)])
        except Exception:
            row.wrong.append(f"{number} {'/'.join(place)}: {traceback.format_exc(limit=-4)}{text[:300]!r}")
            continue
        if reply is None:
            row.refused += 1
            continue
        row.read += 1
        mark = hashlib.sha256(reply.model_dump_json().encode()).digest()
        if mark in tried:
            row.twice += 1
            continue
        tried.add(mark)
        yield number, reply


def through(place: Place, numbers: Sequence[int], seed: int, until: float) -> Row:
    """Read the replies to one question, and give them to its stage until `until` (of `time.monotonic`)."""
    name, key = place
    row = Row(key.partition("/")[0])
    good = dict(_known())[place]
    waiting: Waiting | None = None
    for number, reply in different(place, numbers, seed, row):
        if time.monotonic() > until:
            row.left += 1
            continue
        if waiting is None:
            waiting = Waiting.warm(rooms()[name], key, good.kind.model_validate(good.data))
            # What is there is not looked at again: else every copy of the process would copy its memory, too.
            gc.collect()
            gc.freeze()
        end, seconds = waiting.forked(reply)
        row.seconds += seconds
        row.longest = max(row.longest, seconds)
        if end in ("done", "stopped"):
            row.done += end == "done"
            row.stopped += end == "stopped"
        else:
            row.wrong.append(f"{number} {name}/{key}: {end}")
    gc.unfreeze()
    return row


def share(part: int, parts: int, count: int, seed: int, minutes: float, kinds: tuple[str, ...] = ("",)) -> list[Row]:
    """One process' part of the questions, with all of their replies; `kinds` are how the keys of those taken begin."""
    began = time.monotonic()
    places = [place for place, _ in _known() if place[1].startswith(kinds)]
    slow = [place for place in places if place[1].startswith(_SLOW)]
    mine = [place for place in places if place not in slow][part::parts] + slow[part::parts]
    numbers: dict[Place, list[int]] = {place: [] for place in mine}
    for number in range(count):
        place = reply_of(number, seed)[0]
        if place in numbers:
            numbers[place].append(number)
    rows = []
    for index, place in enumerate(mine):
        now = time.monotonic()
        left = max(0.0, began + 60 * minutes - now)
        # The quick ones may take what they need.
        until = now + (left / (len(mine) - index) if place in slow else left)
        row = through(place, numbers[place], seed, until)
        rows.append(row)
        # At once, so that a run which is ended has not been for nothing.
        said = f"{row.mutated} mutated, {row.read} read, {row.done} done, {row.stopped} stopped, {row.left} left"
        wrong = "".join(f"\n{text}" for text in row.wrong)
        line = f"{time.monotonic() - began:6.0f} s  {'/'.join(place)}: {said}, {len(row.wrong)} wrong{wrong}"
        print(line, file=sys.stderr, flush=True)
    return rows


def table(rows: Sequence[Row]) -> str:
    """The rows by kind, with a sum."""
    kinds: dict[str, Row] = {}
    for row in rows:
        kinds.setdefault(row.kind, Row(row.kind)).add(row)
    total = Row("all")
    for row in kinds.values():
        total.add(row)
    titles = ("mutated", "refused", "read", "twice", "left", "through", "done", "stopped", "wrong", "s each", "longest")
    lines = [f"{'kind':<17}" + "".join(f"{title:>9}" for title in titles)]
    for row in (*sorted(kinds.values(), key=lambda r: r.kind), total):
        passed = row.done + row.stopped
        counts = (
            row.mutated,
            row.refused,
            row.read,
            row.twice,
            row.left,
            passed,
            row.done,
            row.stopped,
            len(row.wrong),
        )
        each = row.seconds / max(1, passed)
        lines.append(f"{row.kind:<17}" + "".join(f"{n:>9}" for n in counts) + f"{each:>9.3f}{row.longest:>9.2f}")
    return "\n".join(lines)


def once(number: int, seed: int) -> str:
    """Do one numbered reply here and now, without catching anything."""
    place, good, draw = reply_of(number, seed)
    text = mutated(good.data, draw)
    print("/".join(place), text, sep="\n")
    reply = read_as(text, good.kind, number % 2 == 0, MODELS[number % len(MODELS)])
    return "refused" if reply is None else Waiting(rooms()[place[0]], place[1]).go_on(reply)


def main(arguments: Sequence[str] | None = None) -> int:
    """Print what came of it; 1 where anything but a result or an error of ours did."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--replies", type=int, default=100_000, help="mutated replies to read")
    parser.add_argument("--minutes", type=float, default=25.0, help="time for the stages that read them")
    parser.add_argument("--processes", type=int, default=2)
    parser.add_argument(
        "--runs", type=int, default=3, help="runs of each whole stage of the full sample with damaged answers"
    )
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--kinds", default="", help="only questions whose keys begin so, such as 01_analysis,06")
    parser.add_argument("--only", type=int, help="the reply of this number, with everything it raises")
    options = parser.parse_args(arguments)
    if options.only is not None:
        print(once(options.only, options.seed))
        return 0
    began = time.perf_counter()
    parts = max(1, options.processes)
    with ProcessPoolExecutor(parts, mp_context=get_context("spawn")) as pool:
        given = (parts, options.replies, options.seed, options.minutes, tuple(options.kinds.split(",")))
        work = [pool.submit(share, n, *given) for n in range(parts)]
        rows = [row for done in work for row in done.result()]
    read = sum(row.mutated for row in rows)
    print(f"{read} replies, seed {options.seed}, {parts} processes, {time.perf_counter() - began:.0f} s")
    print(table(rows))
    wrong = [text for row in rows for text in row.wrong]
    if options.runs:
        by_stage, failed, fuzz = fuzz_stages(options.runs, options.seed)
        for name, counted in by_stage.items():
            each = fuzz.seconds[name] / options.runs
            print(f"{name:<18}{counted['done']:5} done{counted['refused']:5} refused   {each:7.2f} s each")
        wrong += failed
    for text in wrong[:20]:
        print(text)
    print("Nothing but results and errors of ours." if not wrong else f"{len(wrong)} WRONG")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
