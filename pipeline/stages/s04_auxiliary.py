# SPDX-License-Identifier: GPL-3.0-or-later
"""Stage 4, auxiliary layout: everything but the majors, which are frozen; and the ledger of all that was detected."""

from __future__ import annotations

from dataclasses import dataclass, field

from ..analysis.look import numbered_boxes
from ..artifacts.analysis import Calibration, DetectedObject, Finding, SceneAnalysis
from ..artifacts.layout import Layout, LayoutProgram, LedgerEntry, ProxyLine
from ..artifacts.replies import AuxiliaryPlacementReply, AuxiliaryReply
from ..layout import auxiliary as place
from ..layout.hand import apply_hand_edits
from ..layout.initial import is_major
from ..layout.solve import settle_minor
from ..program.lines import parse_layout, print_layout
from .base import Reads, Stage, View
from .wishes import Ask, Build, Picture, Request, StageRun, Tell

ID = "s04_auxiliary"


@dataclass
class _Placing:
    """The layout as it grows, and what became of each object."""

    layout: Layout
    calibration: Calibration
    locked: frozenset[str]
    ledger: dict[str, LedgerEntry] = field(default_factory=dict)
    findings: list[Finding] = field(default_factory=list)

    def add(self, item: DetectedObject) -> bool:
        """Place one object; False when what it stands on or hangs from is not known."""
        result = self._proxy(item)
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
        self.layout = self.layout.model_copy(update={"proxies": [*self.layout.proxies, proxy]})
        self.note(item, "placed", "")
        return True

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
            return place.on_surface(item, place.parents_of(self.layout), self.calibration)
        return place.on_floor(item, self.calibration)


def run(view: View) -> StageRun:
    """Write the `LayoutProgram` with everything placed, and its ledger; one request, and only when something is open."""
    analysis, calibration = view.need(SceneAnalysis), view.need(Calibration)
    before = view.need(LayoutProgram)
    layout = parse_layout(before.text)
    placing = _Placing(layout, calibration, view.locked)
    present = {p.id for p in layout.proxies}
    for item in analysis.objects:
        if item.id in present:
            placing.note(item, "placed", "")
    waiting = [o for o in place.order_by_depth(analysis.objects) if o.id not in present]
    yield Tell("Placing what stands on, hangs from or lies on something", 1, 2)
    opened = [o for o in waiting if is_major(o) or not placing.add(o)]
    asked = [o for o in opened if not is_major(o)]
    for item in opened:
        if is_major(item):
            placing.note(item, "dropped", "the layout loop took it out")
    if asked:
        [reply] = yield Ask((_request(view, asked, placing.layout),))
        _place_answered(placing, asked, reply)
    layout = apply_hand_edits(placing.layout, view.hand_edits)[0]
    text = print_layout(layout)
    yield Tell("Building the room", 2, 2)
    yield Build(text)
    ledger = [placing.ledger[o.id] for o in analysis.objects]
    program = before.model_copy(
        update={"text": text, "stage": ID, "ledger": ledger, "findings": placing.findings, "iterations": []}
    )
    return [program]


def _place_answered(placing: _Placing, asked: list[DetectedObject], reply: AuxiliaryReply) -> None:
    """Place what the model decided; what stays open is deferred to the stage that finds surfaces."""
    answers = {a.id: a for a in reply.placements}
    for item in asked:
        answer = answers.get(item.id)
        if answer is None:
            placing.note(item, "deferred", "what carries it is not known yet")
        elif answer.drop and item.confidence < 0.9:
            placing.note(item, "dropped", answer.reason[:160] or "the second look saw nothing there")
        elif not placing.add(_answered(item, answer)):
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
        values={"questions": questions, "furniture": furniture},
        images=(Picture("boxes", numbered_boxes(view.reference, asked)),),
    )


STAGE = Stage(
    id=ID,
    title="Auxiliary layout",
    reads=(Reads(SceneAnalysis), Reads(Calibration), Reads(LayoutProgram, ("s03_layout",))),
    writes=(LayoutProgram,),
    run=run,
)
