# SPDX-License-Identifier: GPL-3.0-or-later
"""Rooms broken on purpose, and what the correction makes of them:
`python -m benchmark.corrected [--rooms 200] [--seed 1] [--json FILE]`.

Every room is generated from its number, is without a fault, and has one fault of every kind put in, a few of them into
objects that are locked. A fault is found when the pass names the object and the kind; fixed when it is gone afterwards.
"""

from __future__ import annotations

import argparse
import json
import sys
import time
from collections import Counter
from collections.abc import Sequence
from pathlib import Path

from code_as_room.pipeline.artifacts.correction import FAULT_KINDS
from code_as_room.pipeline.correction.correct import Options, correct, find_faults
from code_as_room.pipeline.program.evaluate import evaluate
from code_as_room.pipeline.program.lines import parse_layout

from .broken_rooms import PICTURES, break_room, make_room


def measure(rooms: int, seed: int = 1) -> dict[str, Counter[str]]:
    """By kind: injected, found, fixed, left (found, nothing helped), locked (found, held back), introduced, touched."""
    table: dict[str, Counter[str]] = {kind: Counter() for kind in FAULT_KINDS}
    total = Counter[str]()
    table["all"] = total
    for number in range(rooms):
        made = make_room(number, seed)
        text, injected, locked = break_room(made, number, seed)
        options = Options(locked=locked, pictures=PICTURES)
        start = time.perf_counter()
        before = find_faults(text, options)
        after = correct(text, options)
        seconds = time.perf_counter() - start
        remaining = find_faults(after.text, options)
        again = correct(after.text, options)
        known = {fault.key for fault in before}
        for fault in remaining:
            if fault.key not in known:
                table[fault.kind]["introduced"] += 1
        left = {(fault.kind, i) for fault in remaining for i in (fault.id, fault.other)}
        named = {(fault.kind, i) for fault in before for i in (fault.id, fault.other)}
        for fault in injected:
            row = table[fault.kind]
            found = any((fault.kind, i) in named for i in fault.ids)
            stays = any((fault.kind, i) in left for i in fault.ids)
            row["injected"] += 1
            row["found"] += found
            row["locked" if fault.locked else "left" if stays else "fixed"] += 1
        total["rooms"] += 1
        total["touched"] += _touched(text, after.text, locked)
        total["second pass"] += again.text != after.text
        total["milliseconds"] += round(1000 * seconds)
        total["slowest"] = max(total["slowest"], round(1000 * seconds))
    return table


def _touched(before: str, after: str, locked: frozenset[str]) -> int:
    """How many locked things differ."""
    old, new = parse_layout(before), parse_layout(after)
    count = 0
    for name in ("proxies", "lights", "cameras"):
        now = {line.id: line for line in getattr(new, name)}
        count += sum(line.id in locked and now.get(line.id) != line for line in getattr(old, name))
    looks, made = evaluate(before).finishes, evaluate(after).finishes
    return count + sum(looks.get(i) != made.get(i) for i in locked)


def text_of(table: dict[str, Counter[str]]) -> str:
    """The table for a terminal."""
    heads = ("injected", "found", "fixed", "locked", "left", "introduced")
    lines = [f"{'kind':<12}" + "".join(f"{h:>12}" for h in heads)]
    for kind in FAULT_KINDS:
        lines.append(f"{kind:<12}" + "".join(f"{table[kind][h]:>12}" for h in heads))
    sums = {h: sum(table[kind][h] for kind in FAULT_KINDS) for h in heads}
    lines.append(f"{'all':<12}" + "".join(f"{sums[h]:>12}" for h in heads))
    total = table["all"]
    lines.append(f"rooms {total['rooms']}; locked things touched {total['touched']}; "
                 f"rooms that a second pass changes {total['second pass']}; "
                 f"{total['milliseconds'] / max(1, total['rooms']):.0f} ms a room, {total['slowest']} ms the slowest")  # fmt: skip
    return "\n".join(lines)


def main(arguments: Sequence[str] | None = None) -> int:
    """Print the table; 1 when a fault was not found, one was introduced, or something locked was touched."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--rooms", type=int, default=200)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--json", type=Path, help="write all figures there")
    options = parser.parse_args(arguments)
    table = measure(options.rooms, options.seed)
    print(text_of(table))
    if options.json:
        options.json.write_text(json.dumps(table, indent=1) + "\n", encoding="utf-8")
    rows = [table[kind] for kind in FAULT_KINDS]
    good = all(r["found"] == r["injected"] and not r["introduced"] for r in rows)
    return 0 if good and not table["all"]["touched"] and not table["all"]["second pass"] else 1


if __name__ == "__main__":
    sys.exit(main())
