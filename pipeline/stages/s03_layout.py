# SPDX-License-Identifier: GPL-3.0-or-later
"""Stage 3, major layout: fuse, then render, critique, sanitise and revise until it is good enough. (Paper, stage 3.)

Every layout that is critiqued or kept was rendered and measured. The best iteration is kept, whatever came after it.
"""

from __future__ import annotations

from collections.abc import Generator
from dataclasses import dataclass, field
from typing import Any

from ..artifacts.analysis import Calibration, Finding, SceneAnalysis
from ..artifacts.graph import SceneGraph
from ..artifacts.layout import Iteration, Layout, LayoutProgram, Score
from ..artifacts.replies import CritiqueReply
from ..layout.hand import apply_hand_edits
from ..layout.initial import Evidence, first_layout, is_major
from ..layout.overlay import draw_outlines
from ..layout.placed import tucked_pairs
from ..layout.revise import Sanitised, revise, sanitise
from ..layout.score import Expected, measure, with_model
from ..layout.solve import solve
from ..program.lines import print_layout
from .base import Reads, Stage, View
from .wishes import Ask, Build, Picture, Render, Request, StageRun, Tell, Wish

ID = "s03_layout"
T_MAX = 5
TARGET = 0.97
GAIN = 0.002
"""A revision that brings less than this is no better."""


@dataclass(frozen=True)
class _State:
    """One layout with what it is made from and how it measured."""

    number: int
    layout: Layout
    evidence: Evidence
    score: Score


@dataclass
class _Loop:
    """What the loop has tried so far, and the best of it."""

    view: View
    calibration: Calibration
    graph: SceneGraph
    t_max: int
    target: float
    iterations: list[Iteration] = field(default_factory=list)
    findings: list[Finding] = field(default_factory=list)
    best: _State | None = None

    def run(self, layout: Layout, evidence: Evidence) -> Generator[Wish, Any, _State]:
        """Render, measure, critique and revise; returns the best state."""
        for number in range(self.t_max + 1):
            layout = self._solved(layout, evidence)
            text = print_layout(layout)
            yield Tell(f"Layout, round {number + 1}", number + 1, self.t_max + 1)
            yield Build(text)
            score, problems = measure(layout, self.calibration.camera, self._expected(layout, evidence))
            state = _State(number, layout, evidence, score)
            better = self._better(state)
            if better:
                self.best = state
            if not better or number == self.t_max:
                self._note(state, text, None, None)
                break
            rendered = yield Render(self.calibration.camera, labels=True)
            [reply] = yield Ask((self._request(state, rendered, problems),))
            wanted = sanitise(reply, layout, evidence, self.calibration, self.view.locked)
            state = _State(number, layout, evidence, with_model(score, reply.score))
            self.best = state
            self._note(state, text, reply, wanted)
            if not wanted.edits or state.score.total >= self.target:
                break
            layout, evidence = revise(layout, wanted, self.calibration), wanted.evidence
        assert self.best is not None
        return self.best

    def _better(self, state: _State) -> bool:
        """Whether a layout is better than the best so far, both measured against what is known by now."""
        if self.best is None:
            return True
        before, _ = measure(self.best.layout, self.calibration.camera, self._expected(self.best.layout, state.evidence))
        return state.score.measured > before.measured + GAIN

    def _solved(self, layout: Layout, evidence: Evidence) -> Layout:
        layout = apply_hand_edits(layout, self.view.hand_edits)[0]
        confidence = {i: o.confidence for i, o in evidence.objects.items()}
        solved, notes = solve(layout, tucked_pairs(self.graph.edges, layout.proxies), self.view.locked, confidence)
        self.findings = [*(f for f in self.findings if f.severity != "note"), *notes]
        return solved

    def _expected(self, layout: Layout, evidence: Evidence) -> Expected:
        ids = [o.id for o in evidence.objects.values() if is_major(o)]
        gone = {e.id for e in self.view.hand_edits if e.op == "remove"}
        boxes = {i: b for i in ids if (b := evidence.box(i)) is not None and i not in self.view.locked}
        tucked = tucked_pairs(self.graph.edges, layout.proxies)
        return Expected(tuple(i for i in ids if i not in gone), boxes, self.graph.edges, tucked)

    def _request(self, state: _State, rendered: bytes, problems: list[str]) -> Request:
        picture = self.view.reference.for_model()
        overlay = draw_outlines(picture, self.calibration.camera, state.layout.proxies)
        lines = [
            f"{p.id}, {p.category}, {p.centre[0]:.2f} {p.centre[1]:.2f}, "
            f"{p.size[0]:.2f} {p.size[1]:.2f} {p.size[2]:.2f}, {p.yaw:.0f}"
            for p in state.layout.proxies
        ]
        return Request(
            key=f"03_critique/{state.number}",
            prompt="03_critique",
            reply=CritiqueReply,
            values={"layout": "\n".join(lines), "problems": "; ".join(problems[:20]) or "none"},
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
    target = view.number("target") or TARGET
    loop = _Loop(view, calibration, graph, _rounds(view), target)
    best = yield from loop.run(layout, evidence)
    program = LayoutProgram(
        text=print_layout(best.layout),
        stage=ID,
        score=best.score,
        best=best.number,
        iterations=loop.iterations,
        findings=[*findings, *loop.findings],
    )
    return [program]


def _rounds(view: View) -> int:
    """The most critiques that the artist allows, 0 to T_MAX."""
    text = view.settings.get("iterations", "").strip()
    return min(T_MAX, int(text)) if text.isdigit() else T_MAX


STAGE = Stage(
    id=ID,
    title="Major layout",
    reads=(Reads(SceneAnalysis), Reads(Calibration), Reads(SceneGraph)),
    writes=(LayoutProgram,),
    run=run,
)
