# SPDX-License-Identifier: GPL-3.0-or-later
"""Stage 4, auxiliary layout: everything but the majors, which are frozen; and the ledger of all that was detected."""

from __future__ import annotations

from dataclasses import dataclass, field

from ..analysis.look import numbered_boxes
from ..artifacts.analysis import Calibration, DetectedObject, Finding, SceneAnalysis
from ..artifacts.layout import Layout, LayoutEdit, LayoutProgram, LedgerEntry, ProxyLine
from ..artifacts.objects import Furnishing
from ..artifacts.replies import AuxiliaryPlacementReply, AuxiliaryReply
from ..errors import RoomError
from ..layout import auxiliary as place
from ..layout.curtains import hung_from_rods
from ..layout.hand import apply_hand_edits, name_now, place_edited
from ..layout.initial import is_major
from ..layout.pins import pinned, with_known_parent
from ..layout.score import with_support
from ..layout.solve import settle_minor
from ..program.lines import parse_layout
from .base import Reads, Stage, View
from .carrying import FURNISHING, furnished
from .wishes import Ask, Build, Picture, Request, StageRun, Tell

ID = "s04_auxiliary"
LEFT_OUT = "left out by the artist"


@dataclass
class _Placing:
    """The layout as it grows, and what became of each object.

    Attributes:
        standing: what this stage made the last time, with all hand edits since; None the first time.
        kept: ids that stay as they stand, where nothing that carries them moved. `locked` ones stay in any case.
        freed: ids that the artist unlocked: the solver may move them from where they were put by hand.
        tops: how high things end by the analysis, by id, metres.
    """

    layout: Layout
    calibration: Calibration
    locked: frozenset[str]
    edits: tuple[LayoutEdit, ...] = ()
    standing: Layout | None = None
    kept: frozenset[str] = frozenset()
    freed: frozenset[str] = frozenset()
    tops: dict[str, float] = field(default_factory=dict)
    ledger: dict[str, LedgerEntry] = field(default_factory=dict)
    findings: list[Finding] = field(default_factory=list)

    def add(self, item: DetectedObject) -> bool:
        """Place one object; False when what it stands on or hangs from is not known."""
        name = name_now(self.edits, item.id)
        if name is None or self._pin(name):
            self.note_placed(item)
            return True
        result = self._proxy(item.model_copy(update={"parent": self._parent(item.parent)}))
        if result is None:
            return False
        proxy, notes = result
        self.findings += notes
        if item.placement == "floor" and not place.rug_like(item):
            proxy = settle_minor(proxy, self.layout, self.locked)
        cover = place.crowded(proxy, self.layout.proxies)
        if cover is not None:
            self.findings.append(
                Finding(about=item.id, message=f"It shares its place with {cover}.", severity="warning")
            )
        self.layout, notes = place_edited(self.layout, proxy, self.edits)
        self.findings += notes
        if name in self.freed:
            self._settle(name)
        self.note_placed(item)
        return True

    def _pin(self, name: str) -> bool:
        """Put an object where it stands, when it is to stay there."""
        there = None if self.standing is None else self.standing.proxy(name)
        if there is None or self.standing is None or self.layout.proxy(name) is not None:
            return False
        carrier = there.parent and self.standing.proxy(there.parent)
        carried = not carrier or self.layout.proxy(carrier.id) == carrier
        if name not in self.locked and not (name in self.kept and carried):
            return False
        proxy = with_known_parent(there, self.layout)
        self.layout = self.layout.model_copy(update={"proxies": [*self.layout.proxies, proxy]})
        return True

    def _settle(self, name: str) -> None:
        """What was unlocked is settled like anything else, from where the artist had put it."""
        proxy = self.layout.proxy(name)
        if proxy is not None and proxy.placement == "floor" and proxy.size[2] >= place.RUG:
            others = [p for p in self.layout.proxies if p.id != name]
            settled = settle_minor(proxy, self.layout.model_copy(update={"proxies": others}), self.locked)
            proxies = [settled if p.id == name else p for p in self.layout.proxies]
            self.layout = self.layout.model_copy(update={"proxies": proxies})

    def _parent(self, identifier: str | None) -> str | None:
        """What a detected parent is called by now."""
        return identifier if identifier is None else name_now(self.edits, identifier)

    def note_placed(self, item: DetectedObject) -> None:
        """Write the line of an object that is placed, unless the artist or the layout loop took it out."""
        name = name_now(self.edits, item.id)
        if name is None:
            self.note(item, "dropped", "removed by hand")
        elif self.layout.proxy(name) is None:
            self.note(item, "dropped", "the layout loop took it out" if is_major(item) else "its id was taken by hand")
        else:
            self.note(item, "placed", "")

    def note(self, item: DetectedObject, state: str, reason: str) -> None:
        """Write one line of the ledger."""
        entry = {"id": item.id, "category": item.category, "state": state, "reason": reason}
        self.ledger[item.id] = LedgerEntry.model_validate(entry)

    def _proxy(self, item: DetectedObject) -> tuple[ProxyLine, list[Finding]] | None:
        if item.placement == "ceiling":
            return place.on_ceiling(item, self.calibration)
        if item.placement == "wall":
            return place.on_wall(item, self.layout.walls, self.calibration)
        if item.placement == "surface":
            return place.on_surface(item, place.parents_of(self.layout), self.calibration, self.tops)
        return place.on_floor(item, self.calibration)


def run(view: View) -> StageRun:
    """Write the `LayoutProgram` with everything placed, and its ledger; one request, and only when something is open."""
    analysis, calibration = view.need(SceneAnalysis), view.need(Calibration)
    before = view.need(LayoutProgram)
    layout, early = apply_hand_edits(parse_layout(before.text), view.hand_edits, before.hand_edits)
    standing, ledger_before = _standing(view)
    names = view.names(analysis)
    kept = frozenset[str]()
    if view.only is not None:
        if standing is None:
            raise RoomError(
                "There is no layout yet in which single objects could be redone.", "Run the whole stage first."
            )
        kept = frozenset(n for o in analysis.objects if not view.chosen(o.id) and (n := names[o.id]) is not None)
    tops = {name: o.centre[2] + o.size[2] / 2 for o in analysis.objects if (name := names[o.id]) is not None}
    placing = _Placing(layout, calibration, view.locked, view.hand_edits, standing, kept, view.freed, tops)
    for item in analysis.left_out:
        placing.note(item, "dropped", LEFT_OUT)
    for item in analysis.objects:
        if is_major(item):
            placing.note_placed(item)
    yield Tell("Placing what stands on, hangs from or lies on something", 1, 2)
    asked = []
    for item in place.order_by_depth(analysis.objects):
        if is_major(item) or placing.add(item):
            continue
        earlier = ledger_before.get(item.id)
        if names[item.id] in kept and earlier is not None and earlier.state != "placed":
            placing.ledger[item.id] = earlier
        else:
            asked.append(item)
    if asked:
        [reply] = yield Ask((_request(view, asked, placing.layout),))
        _place_answered(placing, asked, reply)
    # What the artist put on something that was placed only now could not be added before.
    layout, late = apply_hand_edits(placing.layout, view.hand_edits, len(view.hand_edits))
    if standing is not None:
        layout = pinned(layout, standing, view.locked - {p.id for p in layout.proxies}, names.values())
    layout = hung_from_rods(layout, {*view.locked, *kept, *(edit.id for edit in view.hand_edits)})
    unusable = [f for f in early if f.severity != "warning" or layout.proxy(f.about) is None]
    text = furnished(view, layout)
    yield Tell("Building the room", 2, 2)
    yield Build(text)
    ledger = [placing.ledger[o.id] for o in [*analysis.objects, *analysis.left_out]]
    program = before.model_copy(
        update={
            "text": text,
            "stage": ID,
            "score": with_support(before.score, layout),
            "ledger": ledger,
            "findings": [*placing.findings, *unusable, *(f for f in late if f not in unusable)],
            "iterations": [],
            "hand_edits": len(view.hand_edits),
        }
    )
    return [program]


def _standing(view: View) -> tuple[Layout | None, dict[str, LedgerEntry]]:
    """The layout that this stage made the last time, with all hand edits since, and what became of each object then."""
    program = view.recall(LayoutProgram)
    if program is None:
        return None, {}
    layout, _ = apply_hand_edits(parse_layout(program.text), view.hand_edits, program.hand_edits)
    return layout, {entry.id: entry for entry in program.ledger}


def _place_answered(placing: _Placing, asked: list[DetectedObject], reply: AuxiliaryReply) -> None:
    """Place what the model decided; what stays open is deferred to the stage that finds surfaces."""
    answers = {a.id: a for a in reply.placements}
    # An answer may name another open thing as parent, so that one comes first.
    for item in place.order_by_depth([_answered(o, answers[o.id]) if o.id in answers else o for o in asked]):
        answer = answers.get(item.id)
        if answer is not None and answer.drop and item.confidence < 0.9:
            placing.note(item, "dropped", answer.reason[:160] or "the second look saw nothing there")
        elif not placing.add(item):
            placing.note(item, "deferred", "what carries it is not known yet")


def _answered(item: DetectedObject, answer: AuxiliaryPlacementReply) -> DetectedObject:
    height = answer.height_m if answer.height_m is not None and 0.002 < answer.height_m < 5 else item.size[2]
    base = max(0.0, min(6.0, answer.base_m))
    return item.model_copy(
        update={
            "placement": answer.placement,
            "parent": answer.parent or None,
            "size": (item.size[0], item.size[1], height),
            "centre": (item.centre[0], item.centre[1], base + height / 2),
        }
    )


def _request(view: View, asked: list[DetectedObject], layout: Layout) -> Request:
    questions = "\n".join(
        f"{n}, {o.id}, {o.category}, said to be on {o.placement}"
        f"{' of ' + o.parent if o.parent else ''}; what carries it is not known"
        for n, o in enumerate(asked, 1)
    )
    furniture = "\n".join(f"{p.id}, {p.category}, {place.top_of(p):.2f}" for p in layout.proxies)
    return Request(
        key="04_auxiliary",
        prompt="04_auxiliary",
        reply=AuxiliaryReply,
        values={"questions": questions + view.noted(o.id for o in asked), "furniture": furniture},
        images=(Picture("boxes", numbered_boxes(view.reference, asked)),),
    )


STAGE = Stage(
    id=ID,
    title="Auxiliary layout",
    reads=(Reads(SceneAnalysis), Reads(Calibration), Reads(LayoutProgram, ("s03_layout",))),
    writes=(LayoutProgram,),
    run=run,
    notes=True,
    partial=True,
    recalls=(Reads(LayoutProgram, (ID,)), Reads(Furnishing, FURNISHING)),
)
