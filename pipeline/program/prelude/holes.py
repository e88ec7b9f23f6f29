# SPDX-License-Identifier: GPL-3.0-or-later
"""Where the holes of doors, windows and openings are: put in their wall, cut to it, and kept clear of each other."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

from .pieces import Hole, WallRun
from .record import Record
from .walls import SMALLEST_HOLE

_JAMB = 0.02  # metres of wall that stay beside a hole where the mitre leans into the wall (inner corners of the room)


def wall_holes(record: Record, runs: list[WallRun], notes: list[str]) -> dict[str, list[Hole]]:
    """The holes of every wall, clamped to it and clear of each other."""
    holes: dict[str, list[Hole]] = {run.id: [] for run in runs}
    groups = (("door", record.doors), ("window", record.windows), ("opening", record.openings))
    for kind, lines in groups:
        for line in lines:
            run = _wall_of(line, kind, runs, notes)
            hole = _clamped(line, kind, run, notes) if run is not None else None
            if run is not None and hole is not None:
                free = _clear_of(hole, holes[run.id], notes)
                if free is not None:
                    holes[run.id].append(free)
    return holes


def _wall_of(line: dict[str, Any], kind: str, runs: list[WallRun], notes: list[str]) -> WallRun | None:
    """The wall a line names, else the wall nearest to it."""
    for run in runs:
        if run.id == line.get("wall"):
            return run
    if not runs:
        notes.append(f"There is no wall for {kind} {line['id']}, so it was left out.")
        return None
    middle = tuple((float(a) + float(b)) / 2 for a, b in zip(line["start"], line["end"], strict=True))

    def distance(run: WallRun) -> float:
        x = min(max(run.along((middle[0], middle[1])), 0.0), run.length)
        dx, dy = run.direction
        return math.dist((run.start[0] + dx * x, run.start[1] + dy * x), middle)

    nearest = min(runs, key=distance)
    notes.append(f"{kind.capitalize()} {line['id']} names no wall that is there; it was put in {nearest.id}.")
    return nearest


def _clamped(line: dict[str, Any], kind: str, run: WallRun, notes: list[str]) -> Hole | None:
    """A line's hole within its wall, or None when nothing of it is in the wall."""
    name = f"{kind.capitalize()} {line['id']}"
    first, last = (run.along((float(line[key][0]), float(line[key][1]))) for key in ("start", "end"))
    low, high = min(first, last), max(first, last)
    begin, finish = max(run.ends[0]), min(run.ends[1])
    left = begin + _JAMB if begin > 0 else 0.0
    right = finish - _JAMB if finish < run.length else run.length
    bottom = 0.0 if kind == "door" else float(line.get("sill", 0.0))
    top = bottom + float(line["height"])
    x = (_snapped(max(low, left), run.length), _snapped(min(high, right), run.length))
    z = (max(bottom, 0.0), _snapped(min(top, run.height), run.height))
    if x[1] - x[0] < SMALLEST_HOLE or z[1] - z[0] < SMALLEST_HOLE:
        notes.append(f"{name} is not within wall {run.id}, so it was left out.")
        return None
    if low < left - 1e-3 or high > right + 1e-3:
        notes.append(f"{name} reached past the end of wall {run.id} and was cut to it.")
    if top > run.height + 1e-3 or bottom < -1e-3:
        notes.append(f"{name} was higher than wall {run.id} and was cut to it.")
    return Hole(line, kind, x, z, first > last)


def _snapped(x: float, length: float) -> float:
    """A position on the wall, put exactly on an end that it is within a tenth of a millimetre of."""
    if abs(x) < 1e-4:
        return 0.0
    return length if abs(x - length) < 1e-4 else x


def _clear_of(hole: Hole, others: list[Hole], notes: list[str]) -> Hole | None:
    """The hole cut back so that it overlaps none of the others, or None when nothing is left of it."""
    low, high = hole.x
    for other in others:
        crosses = low < other.x[1] - 1e-6 and high > other.x[0] + 1e-6
        if not crosses or hole.z[0] >= other.z[1] or hole.z[1] <= other.z[0]:
            continue
        name, about = f"{hole.kind.capitalize()} {hole.line['id']}", f"{other.kind} {other.line['id']}"
        before, after = other.x[0] - low, high - other.x[1]
        if max(before, after) < SMALLEST_HOLE:
            notes.append(f"{name} lies over {about}, so it was left out.")
            return None
        low, high = (low, other.x[0]) if before >= after else (other.x[1], high)
        notes.append(f"{name} overlapped {about} and was cut back.")
    return replace(hole, x=(low, high))
