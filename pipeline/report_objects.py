# SPDX-License-Identifier: GPL-3.0-or-later
"""What became of each object, for people: one row for everything that was detected, drawn in, or placed later."""

from __future__ import annotations

import re
from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Literal

from .artifacts.analysis import Calibration, DetectedObject, SceneAnalysis
from .artifacts.common import Metres3
from .artifacts.corrections import Corrections
from .artifacts.layout import Layout, LayoutEdit, LayoutProgram, LedgerEntry, ProxyLine
from .errors import RoomError
from .layout.hand import apply_hand_edits, name_now
from .program.lines import parse_layout

State = Literal["detected", "placed", "detailed", "deferred", "dropped", "left out"]
GOOD_FIT, FAIR_FIT = 0.75, 0.5
_FURNISHED = re.compile(r'^furnish\(\s*"([^"]+)"', re.MULTILINE)
_STATES: dict[State, str] = {
    "detected": "Detected, not placed yet",
    "placed": "Placed",
    "detailed": "Placed and detailed",
    "deferred": "Put off",
    "dropped": "Dropped",
    "left out": "Left out by you",
}


@dataclass(frozen=True)
class ObjectRow:
    """One object as a list shows it.

    Attributes:
        id: under which it was detected (corrections speak of it so); for what was added later, its id in the layout.
        name: its id in the layout, "" while it is not there.
        origin: "seen" (detected), "drawn" (added by the artist as a box), "later" (by hand or by the layout loop).
        edited: moved, turned or changed by hand; locked: no automatic step may change it.
        confidence: 0..1 of the detection, None for what was not detected.
        fit: how well its metres cover its picture box, 0..1, None where that was not measured.
    """

    id: str
    name: str
    category: str
    label: str = ""
    placement: str = "floor"
    parent: str = ""
    major: bool = True
    origin: Literal["seen", "drawn", "later"] = "seen"
    state: State = "detected"
    reason: str = ""
    edited: bool = False
    locked: bool = False
    included: bool = True
    note: str = ""
    size: Metres3 | None = None
    confidence: float | None = None
    fit: float | None = None

    @property
    def title(self) -> str:
        """What it is called: by its id in the layout where that tells more than its category."""
        return self.name or self.id

    @property
    def sentence(self) -> str:
        """Its state in words."""
        said = _STATES[self.state]
        return f"{said}: {self.reason}" if self.reason and self.state != "left out" else said

    @property
    def stands(self) -> str:
        """Where it is, in words."""
        if self.parent:
            return f"On {self.parent}"
        return {"floor": "On the floor", "wall": "On a wall", "ceiling": "On the ceiling"}.get(self.placement, "On top")

    @property
    def seen_well(self) -> str:
        """How sure its place is, in words; "" when nothing is known."""
        said = []
        if self.confidence is not None:
            said.append(f"{self.confidence:.0%} sure")
        if self.fit is not None:
            judged = "good" if self.fit >= GOOD_FIT else "fair" if self.fit >= FAIR_FIT else "poor"
            said.append(f"{judged} fit to its box")
        return ", ".join(said)


def object_rows(
    found: SceneAnalysis | None,
    analysis: SceneAnalysis | None,
    calibration: Calibration | None,
    program: LayoutProgram | None,
    corrections: Corrections,
    edits: Sequence[LayoutEdit] = (),
    locked: Collection[str] = (),
) -> tuple[ObjectRow, ...]:
    """A row for each object: the detected ones in the analysis's order, then what was added.

    Args:
        found: what stage 1 found; what the artist left out is in it.
        analysis: the same with the artist's corrections.
        edits: all edits by hand, oldest first.
        locked: ids of locked objects, as `View.locked`.
    """
    proxies = placed_proxies(program, edits)
    ledger = {entry.id: entry for entry in program.ledger} if program is not None else {}
    fits = {r.id: r.iou for r in calibration.residuals} if calibration is not None else {}
    detailed = frozenset(_FURNISHED.findall(program.text)) if program is not None else frozenset()
    drawn = {added.id for added in corrections.added}
    rows = []
    for item in _detected(found, analysis):
        name = name_now(edits, item.id)
        row = _seen(item, proxies.pop(name, None) if name is not None else None, ledger.get(item.id), detailed)
        if name is None:
            row = replace(row, state="dropped", reason="removed by hand")
        rows.append(replace(row, origin="drawn" if item.id in drawn else "seen", fit=fits.get(item.id)))
    known = {row.id for row in rows}
    rows += [
        ObjectRow(id=added.id, name="", category=added.category, origin="drawn", confidence=1.0)
        for added in corrections.added
        if added.id not in known
    ]
    rows += [_later(proxy, detailed) for proxy in proxies.values()]
    touched = {edit.new_id or edit.id for edit in edits if edit.origin != "parent"}
    return tuple(_corrected(row, corrections, row.title in touched, locked) for row in rows)


def _detected(found: SceneAnalysis | None, analysis: SceneAnalysis | None) -> list[DetectedObject]:
    """Everything detected, in the order in which it was found, so that leaving a thing out does not move its row."""
    first = {item.id: item for item in found.objects} if found is not None else {}
    now = {item.id: item for item in analysis.objects} if analysis is not None else {}
    return list({**first, **now}.values())


def _seen(
    item: DetectedObject, proxy: ProxyLine | None, entry: LedgerEntry | None, detailed: Collection[str]
) -> ObjectRow:
    """The row of something that was detected."""
    row = ObjectRow(
        id=item.id,
        name="",
        category=item.category,
        label=item.label,
        placement=item.placement,
        parent=item.parent or "",
        major=item.salience == "major",
        size=item.size,
        confidence=item.confidence,
    )
    if entry is not None:
        row = replace(row, state=entry.state, reason=entry.reason)
    if proxy is None:
        # A ledger that says "placed" of what is not in the program is out of date.
        return replace(row, state="detected") if row.state == "placed" else row
    return replace(_later(proxy, detailed), id=item.id, confidence=item.confidence)


def _later(proxy: ProxyLine, detailed: Collection[str]) -> ObjectRow:
    """The row of something that stands in the layout."""
    return ObjectRow(
        id=proxy.id,
        name=proxy.id,
        category=proxy.category,
        label=proxy.label,
        placement=proxy.placement,
        parent=proxy.parent or "",
        major=proxy.salience == "major",
        origin="later",
        state="detailed" if proxy.id in detailed else "placed",
        size=proxy.size,
    )


def _corrected(row: ObjectRow, corrections: Corrections, edited: bool, locked: Collection[str]) -> ObjectRow:
    """The row with what the artist says of its object."""
    said = corrections.of(row.id)
    included = said.include is not False
    return replace(
        row,
        state=row.state if included else "left out",
        category=said.category or row.category,
        note=said.note,
        included=included,
        edited=edited,
        locked=row.title in locked or row.id in locked,
    )


def placed_proxies(program: LayoutProgram | None, edits: Sequence[LayoutEdit] = ()) -> dict[str, ProxyLine]:
    """The proxies of a program by id, with the edits by hand that it does not hold yet.

    There are none when an artist wrote more than layout lines into it.
    """
    layout = _parsed(program.text) if program is not None else None
    if program is None or layout is None:
        return {}
    if len(edits) > program.hand_edits:
        layout, _ = apply_hand_edits(layout, edits, program.hand_edits)
    return {proxy.id: proxy for proxy in layout.proxies}


@lru_cache(maxsize=8)
def _parsed(text: str) -> Layout | None:
    """Parsing takes milliseconds, and the same program is asked for on every look at the room."""
    try:
        return parse_layout(text)
    except RoomError:
        return None
