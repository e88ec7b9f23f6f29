# SPDX-License-Identifier: GPL-3.0-or-later
"""The report's rounds of layout: the scores as a plot, as numbers, and what was asked for after each round."""

from __future__ import annotations

import html
import math
from collections.abc import Sequence

from .artifacts.layout import Iteration, LayoutProgram
from .report_page import Column, Content, Markup, bar, element, table
from .report_words import PARTS, edit_words

_WIDTH, _HEIGHT = 560.0, 240.0
_LEFT, _RIGHT, _TOP, _BOTTOM = 40.0, 96.0, 18.0, 34.0
_LEAST_SPAN = 0.2


def rounds_section(program: LayoutProgram | None) -> list[Content]:
    """Plot, table and edits of a program that stage 3 wrote; [] where there was no round."""
    if program is None or not program.iterations:
        return []
    columns = [Column("Round"), Column("Score"), *(Column(title) for title in PARTS.values()), Column("Model says")]
    rows = [_row(item, item.number == program.best) for item in program.iterations]
    kept = ["kept" if item.number == program.best else "" for item in program.iterations]
    explained = (
        "Each round was built, drawn and measured; the best one was kept. Every part is between 0 and 1, and 1 is best."
    )
    return [element("p", explained), score_plots(program.iterations, program.best), table(columns, rows, kept),
            *(detail for item in program.iterations for detail in _details(item))]  # fmt: skip


def score_plots(rounds: Sequence[Iteration], best: int) -> Markup | None:
    """The total score over the rounds, large, and each measured part, small; None for one round, which is no course."""
    if len(rounds) < 2:
        return None
    small = element("div", *(_part(rounds, name, title) for name, title in PARTS.items()), of="small")
    return element("div", _total(rounds, best), small, of="plots")


def _total(rounds: Sequence[Iteration], best: int) -> Markup:
    judged = [item.score.model for item in rounds]
    values = [item.score.total for item in rounds]
    low, high, step = _scale([*values, *(v for v in judged if v is not None)])
    across = (_WIDTH - _LEFT - _RIGHT) / (len(rounds) - 1)

    def place(index: int, value: float) -> tuple[float, float]:
        return _LEFT + across * index, _TOP + (high - value) / (high - low) * (_HEIGHT - _TOP - _BOTTOM)

    drawn = []
    for number in range(round((high - low) / step) + 1):
        y = place(0, low + number * step)[1]
        drawn.append(f'<line class="grid" x1="{_LEFT:.0f}" x2="{_WIDTH - _RIGHT:.0f}" y1="{y:.1f}" y2="{y:.1f}"/>')
        drawn.append(_text(_LEFT - 8, y + 4, f"{low + number * step:.2f}", "end"))
    for index, item in enumerate(rounds):
        drawn.append(_text(place(index, low)[0], _HEIGHT - 12, f"Round {item.number + 1}", "middle"))
    seen = [(place(i, v)) for i, v in enumerate(judged) if v is not None]
    if len(seen) > 1:
        drawn.append(_line(seen, "other"))
    points = [place(i, v) for i, v in enumerate(values)]
    drawn.append(_line(points, "line"))
    for (x, y), item in zip(points, rounds, strict=True):
        kept = item.number == best
        drawn.append(f'<circle class="dot{" kept" if kept else ""}" cx="{x:.1f}" cy="{y:.1f}" r="{5 if kept else 4}"/>')
        said = f"{item.score.total:.2f}" + (", kept" if kept else "")
        drawn.append(_text(x, y - 11, said, "start" if x == _LEFT else "middle", "strong"))
    drawn += _names(points[-1], seen[-1] if len(seen) > 1 else None)
    return _svg(_WIDTH, _HEIGHT, drawn, "Score of the layout after each round")


def _names(total: tuple[float, float], judged: tuple[float, float] | None) -> list[str]:
    """Names at the ends of the lines, kept apart where they end side by side."""
    x, y = total[0] + 14, total[1] + 4
    if judged is None:
        return [_text(x, y, "measured", "start", "accent")]
    other = judged[1] + 4
    if abs(other - y) < 16:
        other = y + 16 if other >= y else y - 16
    return [_text(x, y, "measured", "start", "accent"), _text(x, other, "model says", "start", "second")]


def _part(rounds: Sequence[Iteration], name: str, title: str) -> Markup:
    """One part's course between 0 and 1 in a small picture, with its first and last number."""
    values = [float(getattr(item.score, name)) for item in rounds]
    width, height = 62.0, 26.0
    points = [(3 + (width - 6) * i / (len(values) - 1), 3 + (height - 6) * (1 - v)) for i, v in enumerate(values)]
    drawn = [
        f'<line class="grid" x1="0" x2="{width:.0f}" y1="{height - 3:.0f}" y2="{height - 3:.0f}"/>',
        _line(points, "line"),
    ]
    first, last = f"{values[0]:.2f}", f"{values[-1]:.2f}"
    same = "throughout" if max(values) - min(values) < 0.005 else "at both ends"
    course = f"{first} {same}" if first == last else f"{first} to {last}"
    return element("div", _svg(width, height, drawn, title), element("div", title, element("small", course)))


def _scale(values: Sequence[float]) -> tuple[float, float, float]:
    """Lowest and highest value of an axis that begins near the lowest score, and its step; all are round numbers."""
    for step in (0.05, 0.1, 0.2):
        high = min(1.0, math.ceil(max(values) / step - 1e-6) * step)
        low = max(0.0, min(math.floor(min(values) / step + 1e-6) * step, high - _LEAST_SPAN))
        if (high - low) / step < 5.5:
            return low, high, step
    return 0.0, 1.0, 0.2


def _text(x: float, y: float, said: str, anchor: str, of: str = "") -> str:
    return f'<text x="{x:.1f}" y="{y:.1f}" text-anchor="{anchor}" class="{of}">{html.escape(said)}</text>'


def _line(points: Sequence[tuple[float, float]], of: str) -> str:
    return f'<polyline class="{of}" points="{" ".join(f"{x:.1f},{y:.1f}" for x, y in points)}"/>'


def _svg(width: float, height: float, drawn: Sequence[str], about: str) -> Markup:
    head = f'<svg viewBox="0 0 {width:.0f} {height:.0f}" role="img" aria-label="{html.escape(about)}">'
    return Markup(head + "".join(part.replace(' class=""', "") for part in drawn) + "</svg>")


def _row(item: Iteration, kept: bool) -> list[Content]:
    score = item.score
    judged: Content = bar(score.model) if score.model is not None else "–"
    name = f"{item.number + 1}, kept" if kept else str(item.number + 1)
    return [name, bar(score.total), *(bar(getattr(score, part)) for part in PARTS), judged]


def _details(item: Iteration) -> list[Content]:
    """What was asked for after a round, and what of it was refused."""
    if not (item.edits or item.refused or item.remarks):
        return []
    lines = [element("li", element("code", edit.id), " ", edit_words(edit)) for edit in item.edits]
    lines += [element("li", element("code", f.about), " ", f.message, " (refused)", of="quiet") for f in item.refused]
    remark = element("p", "“", item.remarks, "”", of="quiet") if item.remarks else None
    return [element("h3", f"After round {item.number + 1}"), remark, element("ul", *lines) if lines else None]
