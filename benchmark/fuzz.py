# SPDX-License-Identifier: GPL-3.0-or-later
"""Mutated replies through everything that reads them: `python -m benchmark.fuzz [--replies 100000] [--runs 60] [--seed 1]`.

Recorded replies of every kind are damaged, as text (cut, doubled, spliced, sprinkled) and as values (other types, infinite and
huge numbers, odd texts), then parsed, repaired and validated; some of them are also what a whole stage gets to read. Only our
own errors may come out, and no number that is not finite may reach a reply, an artifact or a program. The exit code is 1 where
something else did; what did it is printed with the seed.
"""

from __future__ import annotations

import argparse
import copy
import json
import math
import random
import sys
import threading
import time
import traceback
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from code_as_room.pipeline.artifacts import light, materials, objects, replies
from code_as_room.pipeline.errors import ReplyError, RoomError
from code_as_room.pipeline.memory import dump_memory, load_memory
from code_as_room.pipeline.models.base import Prompt, Reply
from code_as_room.pipeline.models.builtin.empty import empty_value
from code_as_room.pipeline.models.recorded import RecordedClient, load_replies
from code_as_room.pipeline.models.schema import strict_schema
from code_as_room.pipeline.models.validate import validate_reply
from code_as_room.pipeline.picture import load_picture
from code_as_room.pipeline.program.lines import parse_layout
from code_as_room.pipeline.run import Run
from code_as_room.pipeline.stages import all_stages
from pydantic import BaseModel

from .plain_backend import PlainBackend

HERE = Path(__file__).resolve().parent
SAMPLE = HERE.parent / "samples" / "bedroom"
KINDS: dict[str, type[BaseModel]] = {
    "01_analysis": replies.AnalysisReply,
    "01_second_look": replies.SecondLookReply,
    "02_graph": replies.GraphReply,
    "03_critique": replies.CritiqueReply,
    "04_auxiliary": replies.AuxiliaryReply,
    "05_descriptions": objects.DescriptionsReply,
    "06_pieces": objects.PiecesReply,
    "06_programs": objects.ProgramsReply,
    "06_correct": objects.ProgramsReply,
    "08_materials": materials.MaterialsReply,
    "10_light": light.LightReply,
}
VALUES: tuple[Any, ...] = (
    *(None, True, False, 0, -1, 1, 7, 1e-300, 1e308, -1e308, 10**30, -(10**400), math.inf, -math.inf, math.nan, 0.1),
    *(
        "",
        " ",
        "x",
        "bed",
        "1e999",
        "NaN",
        "12 m",
        "null",
        "\u0000",
        "\ud800",
        "😀" * 40,
        "a" * 5000,
        "../../etc",
        "{{x}}",
    ),
    *([], {}, [[]], [None], [1, 2, 3], {"id": "x"}, {"x": 1}, {"error": "no"}, ["a"] * 200),
)
SPRINKLES = (
    *(
        "{",
        "}",
        "[",
        "]",
        '"',
        "'",
        ",",
        ":",
        "\\",
        "\\u",
        "\\ud800",
        "\n",
        "\x00",
        "//",
        "/*",
        "*/",
        "```",
        "```json\n",
    ),
    *(
        "NaN",
        "-Infinity",
        "1e999",
        "undefined",
        "None",
        "True",
        "</think>",
        "<think>",
        "\ufeff",
        "\u201c",
        "-",
        "+",
        ".",
        "e9",
    ),
    *("data: ", "[DONE]", "Sure! Here it is:\n", "9" * 500, "[" * 80, '{"a":' * 80),
)


@dataclass(frozen=True)
class Seed:
    """A good reply of one kind, as data."""

    name: str
    kind: type[BaseModel]
    data: Any


def seeds() -> list[Seed]:
    """All recorded replies, and for kinds that were never recorded one that says nothing."""
    found: list[Seed] = []
    folders = [SAMPLE / "replies", *(path.parent for path in sorted((HERE / "recordings").rglob("replies.json")))]
    for folder in folders:
        for key, entry in sorted(load_replies(folder).items()):
            name = key.split("/")[1]
            if name in KINDS and isinstance(entry.get("reply"), dict):
                found.append(Seed(name, KINDS[name], entry["reply"]))
    missing = set(KINDS) - {seed.name for seed in found}
    return found + [Seed(name, KINDS[name], empty_value(strict_schema(KINDS[name]))) for name in sorted(missing)]


def mutated(data: Any, draw: random.Random) -> str:
    """A damaged reply's text. `draw` may be hypothesis' own, which then shrinks what it finds."""
    tree = json.loads(json.dumps(data))
    if draw.random() < 0.7:
        for _ in range(draw.choice((1, 1, 2, 5))):
            tree = _other_value(tree, draw)
    text = json.dumps(tree, ensure_ascii=draw.random() < 0.5)
    if draw.random() < 0.5:
        for _ in range(draw.choice((1, 1, 3))):
            text = _damaged(text, draw)
    return text


def _other_value(tree: Any, draw: random.Random) -> Any:
    """The tree with one value at a random place replaced, left out, or put elsewhere. Changed in place."""
    holder, key = {"root": tree}, "root"
    root: Any = holder
    inner: Any = tree
    while isinstance(inner, (dict, list)) and inner and (holder is root or draw.random() < 0.85):
        keys: Sequence[Any] = list(inner) if isinstance(inner, dict) else range(len(inner))
        holder, key = inner, draw.choice(keys)
        inner = holder[key]
    way = draw.random()
    if way < 0.1 and holder is not root:
        del holder[key]
    elif way < 0.2 and isinstance(inner, (int, float)) and abs(inner) < 1e300:
        holder[key] = inner * draw.choice((-1, 0, 1e3, 1e-6, 1e30))
    elif way < 0.3 and isinstance(holder, dict) and holder is not root:
        holder[draw.choice(("ID", "x y", key.upper(), key + "_", "\ud800"))] = holder.pop(key)
    elif way < 0.4 and isinstance(holder, list):
        holder.extend(holder[:] if len(holder) < 200 else [])
    else:
        holder[key] = copy.deepcopy(draw.choice(VALUES))
    return root["root"]


def _damaged(text: str, draw: random.Random) -> str:
    """The text with one piece cut, doubled, moved or sprinkled in."""
    at, end = sorted((draw.randrange(len(text) + 1), draw.randrange(len(text) + 1)))
    near = min(end, at + draw.choice((1, 2, 10, 300)))
    ways: tuple[Callable[[], str], ...] = (
        lambda: text[:at],
        lambda: text[at:],
        lambda: text[:at] + text[near:],
        lambda: text[:near] + text[at:],
        lambda: text[:at] + draw.choice(SPRINKLES) + text[at:],
        lambda: text[:at] + draw.choice(SPRINKLES) + text[near:],
        lambda: f"Sure!\n```json\n{text}\n```\nAnything else?",
        lambda: text.replace('"', draw.choice(("'", "\u201d", "")), draw.choice((1, 4, -1))),
        lambda: text.replace(",", draw.choice((",,", "", ";")), draw.choice((1, -1))),
        lambda: text + text,
    )
    return draw.choice(ways)()


def not_finite(value: Any, path: str = "") -> Iterator[str]:
    """Where numbers are not finite, in anything that pydantic or JSON can hold."""
    if isinstance(value, BaseModel):
        value = value.model_dump()
    if isinstance(value, dict):
        for key, item in value.items():
            yield from not_finite(item, f"{path}.{key}")
    elif isinstance(value, (list, tuple, set, frozenset)):
        for number, item in enumerate(value):
            yield from not_finite(item, f"{path}[{number}]")
    elif isinstance(value, float) and not math.isfinite(value):
        yield path


def read(text: str, kind: type[BaseModel], salvage: bool) -> str:
    """How reading a reply ends: "read" or "refused".

    Raises:
        AssertionError: a number that is not finite was let through, or an error is no sentence; whatever else was raised.
    """
    try:
        reply, notes = validate_reply(text, kind, salvage)
    except ReplyError as error:
        assert error.message and "\n".join((*error.problems, str(error))).encode(), "an error in words"
        return "refused"
    places = list(not_finite(reply))
    assert not places, f"not finite: {places[:5]}"
    reply.model_dump_json().encode()
    assert all(note.encode() for note in notes)
    return "read"


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


def fuzz_replies(count: int, seed: int) -> tuple[Counter[str], list[str]]:
    """Read this many mutated replies; how they ended, and what went wrong."""
    known, ends, wrong = seeds(), Counter[str](), []
    for number in range(count):
        draw = random.Random(f"{seed}/{number}")
        chosen = draw.choice(known)
        text = mutated(chosen.data, draw)
        try:
            ends[read(text, chosen.kind, number % 2 == 0)] += 1
        except Exception:
            wrong.append(f"{seed}/{number} {chosen.name}: {traceback.format_exc(limit=-4)}{text[:300]!r}")
    return ends, wrong


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


def main(arguments: Sequence[str] | None = None) -> int:
    """Print what came of it; 1 where anything but a result or an error of ours did."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--replies", type=int, default=100_000, help="mutated replies to read")
    parser.add_argument("--runs", type=int, default=60, help="runs of each stage with damaged answers")
    parser.add_argument("--stage", default="", help="only this one")
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args(arguments)
    began = time.perf_counter()
    ends, wrong = fuzz_replies(options.replies, options.seed)
    took = time.perf_counter() - began
    print(
        f"{options.replies} replies in {took:.0f} s: {ends['read']} read, {ends['refused']} refused, {len(wrong)} wrong"
    )
    if options.runs:
        by_stage, failed, fuzz = fuzz_stages(options.runs, options.seed, options.stage)
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
