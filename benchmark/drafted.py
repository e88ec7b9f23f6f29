# SPDX-License-Identifier: GPL-3.0-or-later
"""What drafts are worth as programs: `python -m benchmark.drafted FOLDER...`.

A folder holds `answer.txt`, what a model wrote, and may hold `prompt.md`. For each: kilobytes of prompt and answer, objects,
how many of its statements were in the language at the first try, what became of the others, seconds to read, evaluate and
put together, and what stands when a third of its statements is spoilt.
"""

from __future__ import annotations

import argparse
import random
import time
from collections import Counter
from collections.abc import Sequence
from pathlib import Path

from code_as_room.pipeline.draft.prompt import values
from code_as_room.pipeline.draft.reading import Draft, read
from code_as_room.pipeline.draft.statements import Statement, split
from code_as_room.pipeline.draft.text import room_text
from code_as_room.pipeline.library import catalogue
from code_as_room.pipeline.program.evaluate import evaluate
from code_as_room.pipeline.program.limits import FINISHED_ROOM_LIMITS
from code_as_room.pipeline.prompting import fill_template, load_template

FORGIVEN = ("build", "import")


def spoilt(statements: Sequence[Statement], share: float, seed: int) -> tuple[list[Statement], int]:
    """The statements with so many of them spoilt, each in one of the ways in which models err; and how many those are."""
    chances = random.Random(seed)
    chosen = set(chances.sample(range(len(statements)), round(share * len(statements))))
    found = []
    for number, statement in enumerate(statements):
        text = statement.text
        if number in chosen:
            at = chances.randrange(len(text) // 3, max(len(text) // 3 + 1, len(text) - 1))
            ways = (
                text[:at],
                text[:at] + ")" + text[at:],
                text.replace("(", "(bpy.ops, ", 1),
                text.replace("=", "= lambda: ", 1),
            )
            text = chances.choice(ways)
        found.append(Statement(text, statement.first, statement.last))
    return found, len(chosen)


def main() -> None:
    """Measure and print."""
    options = argparse.ArgumentParser(description=__doc__)
    options.add_argument("folders", nargs="+", type=Path)
    catalogue.pieces()
    empty = dict.fromkeys(("width", "height"), "1024")
    prompt = fill_template(load_template("draft"), {**values_without_picture(), **empty})
    print(f"prompt {len(prompt.encode()) / 1000:.1f} kB")
    print(
        "draft, answer kB, objects, statements, in the language, mended, lost, read s, room s, again s; third spoilt: objects, told"
    )
    total: Counter[str] = Counter()
    for folder in options.parse_args().folders:
        for path in sorted(folder.glob("**/answer.txt")):
            total += measure(path)
    if total["statements"]:
        print(
            f"in all: {total['statements']} statements, {total['ok'] / total['statements']:.1%} in the language at the first try"
        )


def values_without_picture() -> dict[str, str]:
    """The prompt's values for a picture of no size."""

    class _NoPicture:
        width = height = 0

    return values(_NoPicture(), {})  # type: ignore[arg-type]


def measure(path: Path) -> Counter[str]:
    """One draft; its counts."""
    text = path.read_text(encoding="utf-8")
    began = time.process_time()
    statements = split(text).statements
    draft = read(statements)
    at_read = time.process_time()
    room = room_text(draft)
    at_room = time.process_time()
    record = evaluate(room + "\n", FINISHED_ROOM_LIMITS)
    at_end = time.process_time()
    judged = [s for s in draft.statements if s.kind not in FORGIVEN]
    counts = Counter(s.verdict.split()[0] for s in judged)
    bad, _ = spoilt(statements, 1 / 3, 1)
    broken = read(bad)
    stands = evaluate(room_text(broken), FINISHED_ROOM_LIMITS) if _has_room(broken) else None
    told = sum(bool(s.sentence) for s in broken.statements if s.verdict != "ok")
    print(
        f"{path.parent.name}, {len(text.encode()) / 1000:.1f}, {len(record.proxies)}, {len(judged)}, "
        f"{counts['ok'] / max(1, len(judged)):.1%}, {counts['mended']}, {counts['refused'] + counts['replaced']}, "
        f"{at_read - began:.1f}, {at_room - at_read:.1f}, {at_end - at_room:.1f}; "
        f"{len(stands.proxies) if stands else 0}, {told} of {sum(s.verdict != 'ok' for s in broken.statements)}"
    )
    for entry in judged:
        if entry.verdict != "ok":
            print(f"    line {entry.first} {entry.kind} {entry.id}: {entry.verdict}: {entry.sentence[:150]}")
    return Counter({"statements": len(judged), "ok": counts["ok"]})


def _has_room(draft: Draft) -> bool:
    return draft.room is not None or bool(draft.things)


if __name__ == "__main__":
    main()
