# SPDX-License-Identifier: GPL-3.0-or-later
"""The correction pass: finds every kind of fault, mends one at a time, and keeps a mend only if nothing got worse by it.

A mend has to take its fault away, may not bring a new one and may not make another worse, whether or not that one's kind
is switched on. So the number of faults falls with every mend, and the pass ends; what is left then was tried in the room
as it is now, in vain. That makes a second pass do nothing.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass, field

from ..artifacts.analysis import Finding
from ..artifacts.correction import FAULT_KINDS, CorrectionReport, FaultKind, Fix
from ..artifacts.layout import Layout, LayoutEdit
from ..errors import ProgramError
from ..program.evaluate import evaluate
from ..program.limits import FINISHED_ROOM_LIMITS
from ..program.lines import parse_layout, print_line
from ..program.parse_safe import uncollected
from ..program.patch import patch_text
from ..program.prelude.record import Record
from . import blocked, cameras, coincident, lights, looks, outside, overlap, support
from .bodies import Room, room_of
from .faults import Fault, Find, Knowledge, Mend
from .faults import Fix as FixFunction

PLACED: dict[FaultKind, tuple[Find, FixFunction]] = {
    "light": (lights.find, lights.fix),
    "outside": (outside.find, outside.fix),
    "blocked": (blocked.find, blocked.fix),
    "overlap": (overlap.find, overlap.fix),
    "support": (support.find, support.fix),
    "coincident": (coincident.find, coincident.fix),
    "camera": (cameras.find, cameras.fix),
}
"""How each kind that lies in the layout lines is found and mended."""
MOST_TRIALS = 20
"""Mends of one fault that are tried."""
_WORSE = 1e-3  # that a fault may grow by when another is mended: numbers are rounded


@dataclass(frozen=True)
class Options:
    """What the pass may do.

    Attributes:
        off: kinds that are found and reported but not mended. locked: ids that are never changed.
        spared: (kind, id) of single things that are not changed for a fault of that kind.
        pictures: names of the images that exist, None where that is not known.
        swings: for doors, "in" where the leaf comes into the room. reference: cameras that show the picture's own view.
    """

    off: frozenset[FaultKind] = frozenset()
    locked: frozenset[str] = frozenset()
    spared: frozenset[tuple[str, str]] = frozenset()
    pictures: frozenset[str] | None = None
    swings: Mapping[str, str] = field(default_factory=dict)
    reference: frozenset[str] = frozenset({"reference"})

    def leaves(self, fault: Fault) -> bool:
        """Whether a fault is not to be mended."""
        return fault.kind in self.off or (fault.kind, fault.id) in self.spared


@dataclass(frozen=True)
class Corrected:
    """A corrected room: its text, the edits of layout lines that lead there, and what was done."""

    text: str
    edits: list[LayoutEdit]
    report: CorrectionReport


def find_faults(text: str, options: Options | None = None, record: Record | None = None) -> list[Fault]:
    """Everything that is wrong with a room, in the order of `FAULT_KINDS`.

    Args:
        text: room program after the prelude. record: what it evaluates to, worked out if not given.

    Raises:
        ProgramError: the text cannot be evaluated.
    """
    options = options or Options()
    record = record or evaluate(text, FINISHED_ROOM_LIMITS)
    room = room_of(parse_layout(text), record, options.pictures)
    return [*_look_faults(record, options), *_placed_faults(room, _knowledge(options))]


def correct(text: str, options: Options | None = None, record: Record | None = None) -> Corrected:
    """The room without the faults that can be mended. Pure, and always the same for the same input.

    Args, Raises: as `find_faults`.
    """
    options = options or Options()
    record = record or evaluate(text, FINISHED_ROOM_LIMITS)
    report = CorrectionReport(off=[kind for kind in FAULT_KINDS if kind in options.off])
    text, record = _mend_looks(text, record, options, report)
    before = parse_layout(text)
    with uncollected():
        room = _mend_places(room_of(before, record, options.pictures), options, report)
    edits = edits_between(before, room.layout)
    if edits:
        text, _ = patch_text(text, edits)
    return Corrected(text, edits, report)


def _knowledge(options: Options) -> Knowledge:
    return Knowledge(options.swings, options.reference, options.locked)


def _look_faults(record: Record, options: Options) -> list[Fault]:
    return [*looks.find_bare_parts(record), *looks.find_lost_pictures(record, options.pictures)]


def _placed_faults(room: Room, knowledge: Knowledge) -> list[Fault]:
    return [fault for find, _ in PLACED.values() for fault in find(room, knowledge)]


def _mend_looks(text: str, record: Record, options: Options, report: CorrectionReport) -> tuple[str, Record]:
    """Materials and images, in the text: all at once where that goes well, else one by one."""
    faults = _look_faults(record, options)
    wanted = [f for f in faults if not options.leaves(f) and f.id not in options.locked]
    for fault in faults:
        if fault not in wanted:
            report.left.append(_left(fault, options))
    done = _with_looks(text, record, wanted, options)
    if done is None:
        done = text, record, []
        for fault in wanted:
            done = _more_looks(done, fault, options)
    text, record, fixes = done
    report.fixes += fixes
    mended = {(fix.kind, fix.id, fix.other) for fix in fixes}
    report.left += [_left(f, options) for f in wanted if f.key not in mended]
    return text, record


_Looked = tuple[str, Record, list[Fix]]


def _more_looks(done: _Looked, fault: Fault, options: Options) -> _Looked:
    more = _with_looks(done[0], done[1], [fault], options)
    return (more[0], more[1], [*done[2], *more[2]]) if more is not None else done


def _with_looks(text: str, record: Record, faults: list[Fault], options: Options) -> _Looked | None:
    """The text with these faults mended, None where one of them could not be, or something locked would change."""
    if not faults:
        return text, record, []
    fixes: list[Fix] = []
    new = text
    try:
        for fault in faults:
            material = fault.kind == "material"
            made = (looks.mend_bare_part if material else looks.mend_lost_picture)(new, record, fault)
            if made is None:
                # An image that two things show goes with the first of them.
                if any(fix.kind == fault.kind and fix.other == fault.other for fix in fixes):
                    fixes.append(fixes[-1].model_copy(update={"id": fault.id, "message": "As above."}))
                    continue
                return None
            new, look = made
            said = "Given a material." if material else "A plain colour stands for the image."
            before = "" if material else fault.other
            fixes.append(
                Fix(
                    kind=fault.kind, id=fault.id, other=fault.other, before=before, after=look, amount=1.0, message=said
                )
            )
        after = evaluate(new, FINISHED_ROOM_LIMITS)
    except ProgramError:
        return None
    if {f.key for f in _look_faults(after, options)} - {f.key for f in _look_faults(record, options)}:
        return None
    if {f.key for f in _look_faults(after, options)} & {f.key for f in faults}:
        return None
    if any(record.finishes.get(name) != after.finishes.get(name) for name in options.locked):
        return None
    return new, after, fixes


def _mend_places(room: Room, options: Options, report: CorrectionReport) -> Room:
    """One mend after the other until none helps any more."""
    knowledge = _knowledge(options)
    faults = _placed_faults(room, knowledge)
    vain: set[tuple[str, str, str]] = set()
    since = False
    while True:
        fault = next((f for f in faults if not options.leaves(f) and f.key not in vain), None)
        if fault is None:
            if not since:
                break
            vain, since = set(), False
            continue
        found = _first_good(room, fault, faults, knowledge, options)
        if found is None:
            vain.add(fault.key)
            continue
        mend, faults = found
        room, since = mend.room, bool(vain)
        report.fixes.append(_fix(fault, mend))
    report.left += [_left(fault, options) for fault in faults]
    return room


def _first_good(
    room: Room, fault: Fault, faults: list[Fault], knowledge: Knowledge, options: Options
) -> tuple[Mend, list[Fault]] | None:
    """The first mend that takes its fault away, leaves what is locked and makes nothing worse; and the faults after it."""
    known = {f.key: f.amount for f in faults}
    for number, mend in enumerate(PLACED[fault.kind][1](room, fault, knowledge)):
        if number >= MOST_TRIALS:
            break
        if _changed_ids(room.layout, mend.room.layout) & knowledge.locked or (fault.kind, mend.id) in options.spared:
            continue
        after = _placed_faults(mend.room, knowledge)
        if any(f.key == fault.key or f.amount > known.get(f.key, 0.0) + _WORSE for f in after):
            continue
        if all(f.key in known for f in after):
            return mend, after
    return None


def _changed_ids(before: Layout, after: Layout) -> set[str]:
    groups = ("proxies", "lights", "worlds", "views", "cameras")
    return {
        new.id
        for name in groups
        if getattr(before, name) is not getattr(after, name)
        for old, new in zip(getattr(before, name), getattr(after, name), strict=True)
        if old is not new and old != new
    }


def edits_between(before: Layout, after: Layout) -> list[LayoutEdit]:
    """The edits that lead from one layout to another one with the same ids."""
    edits = [
        LayoutEdit(op="move", id=new.id, centre=new.centre, reason="correction", origin="solver")
        for old, new in zip(before.proxies, after.proxies, strict=True)
        if old.centre != new.centre
    ]
    for name in ("lights", "worlds", "views", "cameras"):
        for old, new in zip(getattr(before, name), getattr(after, name), strict=True):
            if old != new:
                line = print_line(new)
                edits.append(LayoutEdit(op="line", id=new.id, line=line, reason="correction", origin="solver"))
    return edits


def _fix(fault: Fault, mend: Mend) -> Fix:
    other = fault.other if mend.id == fault.id else fault.id
    return Fix(
        kind=fault.kind,
        id=mend.id,
        other=other,
        before=mend.before,
        after=mend.after,
        amount=mend.amount,
        message=f"{fault.means} {mend.means}",
    )


def _left(fault: Fault, options: Options) -> Finding:
    """Why a fault stays, in a sentence."""
    if fault.kind in options.off:
        why = "This kind of correction is switched off."
    elif options.leaves(fault):
        why = "You keep it as it is."
    elif _held(fault, options.locked):
        why = "It is locked, so it was left."
    else:
        why = "Nothing near by was better; move it by hand."
    return Finding(about=fault.id, message=f"{fault.means} {why}", severity="warning")


def _held(fault: Fault, locked: Collection[str]) -> bool:
    return fault.id in locked
