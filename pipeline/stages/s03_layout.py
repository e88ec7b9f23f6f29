# SPDX-License-Identifier: GPL-3.0-or-later
"""Stage 3, major layout: fuse, then render, critique, sanitise and revise until it is good enough. (Paper, stage 3.)

Every layout that is critiqued or kept was rendered and measured. The best iteration is kept, whatever came after it.
"""

from __future__ import annotations

from collections.abc import Generator, Mapping
from dataclasses import dataclass, field
from typing import Any

from ..artifacts.analysis import Calibration, Finding, SceneAnalysis
from ..artifacts.graph import SceneGraph
from ..artifacts.layout import Iteration, Layout, LayoutEdit, LayoutProgram, Score
from ..artifacts.objects import Furnishing
from ..artifacts.replies import CritiqueReply
from ..errors import RoomError
from ..layout.hand import apply_hand_edits, name_now, place_edited
from ..layout.initial import Evidence, first_layout, is_major
from ..layout.open_tops import with_open_tops
from ..layout.overlay import draw_outlines
from ..layout.past import Past
from ..layout.pins import pinned
from ..layout.placed import companions, tucked_pairs
from ..layout.revise import revise
from ..layout.sanitise import Sanitised, sanitise
from ..layout.score import WEIGHTS, Expected, measure, with_model
from ..layout.solve import Ties, solve
from ..layout.spread import placement_spread
from ..light.measure import small
from ..program.lines import parse_layout, print_layout
from .base import Reads, Stage, View
from .carrying import FURNISHING, furnished
from .wishes import Ask, Build, Picture, Render, Request, StageRun, Tell, Wish

ID = "s03_layout"
T_MAX = 5
TARGET = 0.97
GAIN = 0.013
"""A round is better when what it brings is worth one thing that covers its place in the picture by so much more."""
HARM = 0.25
"""An edit that alone loses more than this part of such a gain is not made."""
UNMEASURED = frozenset({"turn", "recategorise", "remove"})
"""Boxes look the same from above whichever way they face and whatever they are called: here the critic's word counts."""


@dataclass(frozen=True)
class _State:
    """One layout with what it is made from and how it measured."""

    number: int
    layout: Layout
    evidence: Evidence
    score: Score
    notes: list[Finding] = field(default_factory=list)


@dataclass
class _Loop:
    """What the loop has tried so far, and the best of it.

    Attributes:
        frozen: ids that stay as they are; chosen: ids that are done anew, None for all.
        swings: how doors open, by id; fronted: ids of what has a front that was recognised.
        past: what the critic asked for so far; None where it is not to know of it.
    """

    view: View
    calibration: Calibration
    graph: SceneGraph
    t_max: int
    target: float
    frozen: frozenset[str]
    chosen: frozenset[str] | None
    swings: Mapping[str, str]
    fronted: frozenset[str]
    iterations: list[Iteration] = field(default_factory=list)
    best: _State | None = None
    past: Past = field(default_factory=Past)

    def run(self, layout: Layout, evidence: Evidence) -> Generator[Wish, Any, _State]:
        """Render, measure, critique and revise; returns the best state."""
        asked: list[LayoutEdit] = []
        last = False
        for number in range(self.t_max + 1):
            layout, notes = self._solved(layout, evidence)
            text = print_layout(layout)
            yield Tell(f"Layout, round {number + 1}", number + 1, self.t_max + 1)
            yield Build(text)
            score, problems = measure(layout, self.calibration.camera, self._expected(layout, evidence))
            state = _State(number, layout, evidence, score, notes)
            gain, least = self._gain(state), self._least(layout, evidence)
            better = gain > least
            if better or (gain >= -least and any(e.op in UNMEASURED for e in asked)):
                self.best = state
            if not better or last or number == self.t_max:
                self._note(state, text, None, None)
                break
            rendered = yield Render(self.calibration.camera, labels=True)
            [reply] = yield Ask((self._request(state, rendered, problems),))
            wanted = self._wanted(reply, layout, evidence)
            state = _State(number, layout, evidence, with_model(score, reply.score), notes)
            self.best = state
            self._note(state, text, reply, wanted)
            if not wanted.edits:
                break
            # Good enough: what was asked for is still done and measured, but nothing more is asked.
            last = state.score.total >= self.target
            layout, evidence, asked = self._revised(layout, wanted), wanted.evidence, wanted.edits
        assert self.best is not None
        best_text = print_layout(self.best.layout)
        if best_text != text:
            # The last round was no better: the scene shows what is kept.
            yield Build(best_text)
        return self.best

    def _least(self, layout: Layout, evidence: Evidence) -> float:
        """The gain from which on a layout counts as better; one thing weighs less where there are many."""
        return GAIN * WEIGHTS["boxes"] / max(1, len(self._expected(layout, evidence).boxes))

    def _gain(self, state: _State) -> float:
        """How much better a layout is than the best so far, both measured against what is known by now."""
        if self.best is None:
            return 1.0
        return state.score.measured - self._measured(self.best.layout, state.evidence)

    def _measured(self, layout: Layout, evidence: Evidence) -> float:
        return measure(layout, self.calibration.camera, self._expected(layout, evidence))[0].measured

    def _wanted(self, reply: CritiqueReply, layout: Layout, evidence: Evidence) -> Sanitised:
        """What of the critic's wishes is done: not against evidence, and not to the measured harm of the rest."""
        past = self.past if self._remembers else Past()
        wanted = sanitise(reply, layout, evidence, self.calibration, self.view.locked, self.chosen, past)
        edits, refused = list(wanted.edits), list(wanted.refused)
        kept = evidence
        for identifier in dict.fromkeys(e.id for e in wanted.edits):
            own = [e for e in edits if e.id == identifier]
            item = wanted.evidence.objects.get(identifier)
            alone = evidence.without(identifier) if item is None else evidence.with_object(item)
            if all(e.op == "move" for e in own) and self._harms(layout, Sanitised(own, alone, [])):
                edits = [e for e in edits if e.id != identifier]
                refused.append(Finding(about=identifier, message="Moved so, the room measured worse; left as it is."))
            else:
                kept = kept.without(identifier) if item is None else kept.with_object(item)
        self.past.note(edits, refused)
        return Sanitised(edits, kept, refused)

    def _harms(self, layout: Layout, alone: Sanitised) -> bool:
        """Whether one thing's edits alone make the layout measurably worse, against what is known with them."""
        trial, _ = self._solved(self._revised(layout, alone), alone.evidence)
        least = HARM * self._least(layout, alone.evidence)
        return self._measured(trial, alone.evidence) < self._measured(layout, alone.evidence) - least

    @property
    def _remembers(self) -> bool:
        return self.view.settings.get("memory", "on") != "off"

    def _revised(self, layout: Layout, wanted: Sanitised) -> Layout:
        """The layout after the critic's edits; what the critic adds again is edited again as the artist edited it."""
        revised = revise(layout, wanted, self.calibration)
        before = {p.id for p in layout.proxies}
        result = revised.model_copy(update={"proxies": [p for p in revised.proxies if p.id in before]})
        for proxy in revised.proxies:
            if proxy.id not in before:
                result = place_edited(result, proxy, self.view.hand_edits)[0]
        return result

    def _solved(self, layout: Layout, evidence: Evidence) -> tuple[Layout, list[Finding]]:
        confidence = {i: o.confidence for i, o in evidence.objects.items()}
        edges = self.graph.edges
        ties = Ties(
            spread=placement_spread(evidence.objects.values(), self.calibration),
            leaning=frozenset(
                (e.source, e.target) for e in edges if e.relation == "against_wall" and e.origin == "model"
            ),
            companions=companions(edges, layout.proxies),
            swings=self.swings,
        )
        return solve(layout, tucked_pairs(edges, layout.proxies), self.frozen, confidence, ties)

    def _expected(self, layout: Layout, evidence: Evidence) -> Expected:
        ids = [o.id for o in evidence.objects.values() if is_major(o)]
        boxes = {i: b for i in ids if (b := evidence.box(i)) is not None and i not in self.view.locked}
        tucked = tucked_pairs(self.graph.edges, layout.proxies)
        names = (name_now(self.view.hand_edits, i) for i in ids)
        there = tuple(name for name in names if name is not None)
        return Expected(there, boxes, self.graph.edges, tucked, self.swings, self.fronted)

    def _request(self, state: _State, rendered: bytes, problems: list[str]) -> Request:
        picture = self.view.reference.for_model()
        told = [p for p in state.layout.proxies if self.chosen is None or p.id in self.chosen]
        overlay = draw_outlines(picture, self.calibration.camera, told)
        lines = [
            f"{p.id}, {p.category}, {p.centre[0]:.2f} {p.centre[1]:.2f}, "
            f"{p.size[0]:.2f} {p.size[1]:.2f} {p.size[2]:.2f}, {p.yaw:.0f}"
            for p in told
        ]
        said = self.view.noted(p.id for p in told)
        if self.chosen is not None:
            chosen = self.chosen
            problems = [p for p in problems if not chosen.isdisjoint(p.split())]
            said = "\n\nOnly these are judged now; everything else stays as it is." + said
        known = f"Measured problems: {'; '.join(problems[:20]) or 'none'}\n{self.past.told()}".rstrip()
        return Request(
            key=f"03_critique/{state.number}",
            prompt="03_critique",
            reply=CritiqueReply,
            values={"layout": "\n".join(lines) + said, "known": known + "\n\n" if self._remembers else ""},
            images=(Picture("reference", picture), Picture("layout", rendered), Picture("overlay", overlay)),
        )

    def _note(self, state: _State, text: str, reply: CritiqueReply | None, wanted: Sanitised | None) -> None:
        self.iterations.append(
            Iteration(
                number=state.number,
                program=text,
                score=state.score,
                edits=[] if wanted is None else wanted.edits,
                refused=[] if wanted is None else wanted.refused,
                remarks="" if reply is None else reply.remarks[:500],
            )
        )


def run(view: View) -> StageRun:
    """Write the `LayoutProgram` of the major objects; at most T_max requests."""
    analysis, calibration, graph = view.need(SceneAnalysis), view.need(Calibration), view.need(SceneGraph)
    evidence = Evidence({o.id: o for o in analysis.objects})
    layout, findings = first_layout(analysis, calibration, evidence)
    if analysis.view != "plan":
        layout = with_open_tops(layout, calibration.camera, small(view.reference))
    layout = apply_hand_edits(layout, view.hand_edits)[0]
    standing = _standing(view)
    frozen, chosen = view.locked, None
    if view.only is not None:
        layout, chosen = _renewed(view, analysis, layout, standing)
        if not chosen:
            return [_kept(view, layout)]
        frozen |= {p.id for p in layout.proxies} - chosen
    elif standing is not None:
        layout = pinned(layout, standing, view.locked, view.names(analysis).values())
    target = view.number("target") or TARGET
    swings = {a.id: a.swing for a in analysis.architecture if a.kind == "door"}
    fronted = frozenset(o.id for o in analysis.objects if o.front)
    loop = _Loop(view, calibration, graph, _rounds(view), target, frozen, chosen, swings, fronted)
    best = yield from loop.run(layout, evidence)
    text = furnished(view, best.layout)
    if text != print_layout(best.layout):
        yield Build(text)
    program = LayoutProgram(
        text=text,
        stage=ID,
        score=best.score,
        best=best.number,
        iterations=loop.iterations,
        findings=[*findings, *best.notes],
        hand_edits=len(view.hand_edits),
    )
    return [program]


def _standing(view: View) -> Layout | None:
    """The layout that this stage made the last time, with all hand edits since."""
    program = view.recall(LayoutProgram)
    if program is None:
        return None
    return apply_hand_edits(parse_layout(program.text), view.hand_edits, program.hand_edits)[0]


def _renewed(
    view: View, analysis: SceneAnalysis, fresh: Layout, standing: Layout | None
) -> tuple[Layout, frozenset[str]]:
    """The standing layout with the chosen objects as they are measured now, and which those are.

    Raises:
        RoomError: there is no layout yet that the others could be kept from.
    """
    if standing is None:
        raise RoomError("There is no layout yet in which single objects could be redone.", "Run the whole stage first.")
    names = view.names(analysis)
    majors = [o.id for o in analysis.objects if is_major(o) and view.chosen(o.id)]
    chosen = frozenset(name for i in majors if (name := names[i]) is not None) - view.locked
    gone = {names[o.id] for o in analysis.left_out if view.chosen(o.id)}
    proxies = [(fresh.proxy(p.id) if p.id in chosen else None) or p for p in standing.proxies if p.id not in gone]
    present = {p.id for p in proxies}
    proxies += [p for p in fresh.proxies if p.id in chosen and p.id not in present]
    return standing.model_copy(update={"proxies": proxies}), chosen


def _kept(view: View, layout: Layout) -> LayoutProgram:
    """What this stage wrote before, where nothing of what is chosen is placed by it."""
    before = view.recall(LayoutProgram)
    assert before is not None
    message = "Nothing that was chosen is placed by this stage; it was left as it is."
    update = {"text": furnished(view, layout), "findings": [Finding(about="layout", message=message)]}
    return before.model_copy(update={**update, "hand_edits": len(view.hand_edits)})


def _rounds(view: View) -> int:
    """The most critiques that the artist allows, 0 to T_MAX."""
    for name in ("rounds", "iterations"):
        text = view.settings.get(name, "").strip()
        if text.isdigit():
            return min(T_MAX, int(text))
    return T_MAX


STAGE = Stage(
    id=ID,
    title="Major layout",
    reads=(Reads(SceneAnalysis), Reads(Calibration), Reads(SceneGraph)),
    writes=(LayoutProgram,),
    run=run,
    settings=("iterations", "target", "rounds", "memory"),
    notes=True,
    partial=True,
    recalls=(Reads(LayoutProgram, (ID,)), Reads(Furnishing, FURNISHING)),
)
