# SPDX-License-Identifier: GPL-3.0-or-later
"""A furnished room measured on its meshes, whatever its program says:
`python -m benchmark.furnished RUN_OR_BLEND... [--truth truth.json] [--json FILE]`.

RUN is what `code-as-room --out` wrote (room.blend, scene.json, memory.json); a .blend alone is measured without what
memory knows. Per object: how far it floats or sinks on what carries it, by rays; how well it fills its proxy; parts that
touch nothing; where it stands against the picture. Per room: things that run through each other, support, the ledger.
"""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Sequence
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

import bpy
import numpy as np
from code_as_room.pipeline.errors import RoomError
from code_as_room.pipeline.memory import Memory, load_memory

from .built.account import Ledger, ledger_of, shown_distances, true_distances
from .built.bodies import BuiltRoom, read_room
from .built.contact import TOLERANCE, contact_of
from .built.solids import crossings, filling_of, loose_parts

TARGETS = {"done": 0.95, "support": 0.98, "distance": 0.05}
LEAST_FILL, MOST_BEYOND = 0.98, 0.02
"""How far an object's geometry has to reach on every axis of its proxy, and may stick out of it, as shares of it."""


@dataclass(frozen=True)
class Row:
    """One object's figures, in metres.

    Attributes:
        gap: to what carries it, below zero where it sinks in. fills: share of its proxy on its worst axis.
        shown, true: from where the picture shows it, from where it truly is; None for what is no small object.
    """

    id: str
    placement: str
    on: str
    gap: float | None
    held: bool
    fills: float | None
    beyond: float
    parts: int
    loose: int
    shown: float | None = None
    true: float | None = None
    problems: tuple[str, ...] = ()


@dataclass(frozen=True)
class Sheet:
    """The figures of one room."""

    name: str
    rows: list[Row]
    crossings: list[tuple[str, str, float]]
    diagonal: float
    ledger: Ledger | None = None
    notes: list[str] = field(default_factory=list)

    @property
    def support(self) -> float:
        """Share of the objects that touch what they say they are on, and neither float nor sink."""
        return sum(row.held for row in self.rows) / len(self.rows) if self.rows else 1.0


def measure(path: Path, truth: Path | None = None) -> Sheet:
    """All figures of a run's folder or a .blend.

    Raises:
        ValueError: there is no room in it.
    """
    blend = path / "room.blend" if path.is_dir() else path
    bpy.ops.wm.open_mainfile(filepath=str(blend))
    room = read_room(bpy.context.scene)
    memory, notes = _memory(path)
    shown = shown_distances(memory, room) if memory is not None else {}
    true: dict[str, float] = {}
    if truth is not None and path.is_dir():
        true, _ = true_distances(path / "scene.json", truth, memory)
    extent = np.concatenate([b.points for b in [*room.floor, *room.things.values()]])[:, :2]
    floor = np.concatenate([b.points for b in room.floor])[:, :2] if room.floor else extent
    diagonal = float(np.hypot(*(floor.max(axis=0) - floor.min(axis=0))))
    rows = [_row(room, name, shown.get(name), true.get(name), diagonal) for name in room.things]
    ledger = ledger_of(memory, room) if memory is not None else None
    return Sheet(path.name, rows, crossings(room), diagonal, ledger, notes)


def _memory(path: Path) -> tuple[Memory | None, list[str]]:
    if not path.is_dir():
        return None, ["There is no memory beside it: no ledger, no places in the picture."]
    try:
        return load_memory((path / "memory.json").read_text(encoding="utf-8")), []
    except (OSError, RoomError) as error:
        return None, [f"memory.json: {error}"]


def _row(room: BuiltRoom, name: str, shown: float | None, true: float | None, diagonal: float) -> Row:
    body = room.things[name]
    contact, fit = contact_of(room, body), filling_of(body)
    loose, parts = loose_parts(body)
    problems = []
    if contact.gap is None:
        problems.append("nothing carries it")
    elif not contact.held:
        problems.append(f"{'floats' if contact.gap > 0 else 'sinks'} {abs(contact.gap) * 1000:.0f} mm on {contact.on}")
    elif not contact.named:
        problems.append(f"is on {contact.on}, not on {body.parent}")
    if fit is not None and fit.share < LEAST_FILL:
        problems.append(f"fills {fit.share:.0%} of its box")
    if fit is not None and fit.beyond > MOST_BEYOND * max(body.box[3:6]):
        problems.append(f"sticks out {fit.beyond * 1000:.0f} mm")
    if loose:
        problems.append(f"{loose} of {parts} pieces touch nothing")
    for distance, whence in ((shown, "its box in the picture"), (true, "its true place")):
        if distance is not None and distance > TARGETS["distance"] * diagonal:
            problems.append(f"{distance * 100:.0f} cm from {whence}")
    return Row(
        name,
        body.placement,
        contact.on,
        contact.gap,
        contact.held and contact.named,
        fit.share if fit is not None else None,
        fit.beyond if fit is not None else 0.0,
        parts,
        loose,
        shown,
        true,
        tuple(problems),
    )


def text(sheet: Sheet) -> str:
    """The table for a terminal."""
    heads = (
        f"{'object':<26}{'on':<20}{'gap mm':>8}{'fills %':>9}{'out mm':>8}{'loose':>9}{'shown cm':>10}{'true cm':>9}"
    )
    lines = [sheet.name, heads + "  what is wrong"]
    for row in sheet.rows:
        gap, fills = _number(row.gap, 1000), _number(row.fills, 100)
        cells = f"{row.id[:25]:<26}{row.on[:19]:<20}{gap:>8}{fills:>9}{row.beyond * 1000:>8.0f}{row.loose:>4}/{row.parts:<4}"
        lines.append(f"{cells}{_number(row.shown, 100):>10}{_number(row.true, 100):>9}  {'; '.join(row.problems)}")
    lines += [f"{a} and {b} run through each other by {deep * 1000:.0f} mm" for a, b, deep in sheet.crossings]
    lines += sheet.notes
    for name, value, reached in summary(sheet):
        lines.append(f"{name}: {value} {'reached' if reached else 'NOT REACHED'}")
    return "\n".join(lines)


def summary(sheet: Sheet) -> list[tuple[str, str, bool]]:
    """The issue's figures: what, how much of how much, and whether the target is reached."""
    gaps = [abs(r.gap) for r in sheet.rows if r.gap is not None]
    off = sum(r.gap is None or abs(r.gap) > TOLERANCE for r in sheet.rows)
    found = [
        (f"floats or sinks by more than {TOLERANCE * 1000:.0f} mm", f"{off} of {len(sheet.rows)}", off == 0),
        ("furthest from its carrier", f"{max(gaps, default=0.0) * 1000:.0f} mm", max(gaps, default=0.0) <= TOLERANCE),
        ("support accuracy on meshes", f"{sheet.support:.1%}", sheet.support >= TARGETS["support"]),
        ("pairs that run through each other", str(len(sheet.crossings)), not sheet.crossings),
    ]
    for name, values in (("the picture", [r.shown for r in sheet.rows]), ("the truth", [r.true for r in sheet.rows])):
        known = [v / sheet.diagonal for v in values if v is not None]
        if known:
            worst = f"{max(known):.1%} of the diagonal at most, {float(np.mean(known)):.1%} usually"
            found.append((f"small objects against {name}", worst, max(known) <= TARGETS["distance"]))
    if sheet.ledger is not None:
        book = sheet.ledger
        said = ", ".join(f"{n} {state}" for state, n in book.states.items())
        found.append(("detailed or placed", f"{book.share:.1%} of {book.detected}", book.share >= TARGETS["done"]))
        lost = ", ".join((*book.missing, *book.unaccounted))
        found.append(("the ledger closes", f"{said}{'; lost: ' + lost if lost else ''}", book.closes))
    return found


def _number(value: float | None, times: float) -> str:
    return "–" if value is None else f"{value * times:.0f}"


def main(arguments: Sequence[str] | None = None) -> int:
    """Print the tables; 1 when a file has no room."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("runs", type=Path, nargs="+")
    parser.add_argument("--truth", type=Path, help="truth.json of the picture")
    parser.add_argument("--json", type=Path, help="write all figures there")
    options = parser.parse_args(arguments)
    sheets: dict[str, Any] = {}
    for run in options.runs:
        try:
            sheet = measure(run, options.truth)
        except (ValueError, RuntimeError) as error:
            print(f"{run}: {error}", file=sys.stderr)
            return 1
        print(text(sheet), end="\n\n")
        sheets[str(run)] = asdict(sheet) | {"summary": summary(sheet)}
    if options.json:
        options.json.write_text(json.dumps(sheets, indent=1, ensure_ascii=False) + "\n", encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
