# SPDX-License-Identifier: GPL-3.0-or-later
"""The report's table of stages: time, calls, tokens and cost of each, and what was noted on the way."""

from __future__ import annotations

from collections.abc import Sequence

from .memory import Entry, Memory
from .report_page import Column, Content, Markup, element, folded, table, together
from .report_words import seconds as words_of
from .run import StageReport
from .stages import all_stages

_FEW = 3


def stages_table(memory: Memory, reports: Sequence[StageReport]) -> Markup:
    """A row for each stage, and their sum.

    Args:
        reports: what the stages of this run took; stages of earlier runs are told from memory.
    """
    latest = {report.stage: report for report in reports}
    columns = [Column("Stage"), *(Column(t, number=True) for t in ("Time", "Own work", "Calls", "Tokens in", "out"))]
    columns += [Column("Cost", number=True), Column("Prompt text", number=True), Column("Notes", prose=True)]
    found = []
    for stage in all_stages():
        entry = memory.latest_entry(stage.writes[0].__name__, (stage.id,))
        answers = [e for e in memory.entries if e.type == "Answer" and e.stage == stage.id]
        found.append((stage, entry, _figures(entry, answers) if entry is not None or answers else None))
    longest = max((figures[0] for _, _, figures in found if figures), default=0.0)
    rows: list[list[Content]] = []
    totals = [0.0, 0, 0, 0, 0.0]
    for stage, entry, figures in found:
        if figures is None:
            rows.append([stage.title, *("–" for _ in range(7)), element("span", "not run", of="quiet")])
            continue
        totals = [a + b for a, b in zip(totals, figures, strict=True)]
        rows.append(_row(stage.title, entry, figures, latest.get(stage.id), longest))
    seconds, calls, told, said, cost = totals
    total: list[Content] = ["All", words_of(seconds), "", int(calls), int(told) or "–", int(said) or "–"]
    rows.append([*total, f"${cost:.4f}" if cost else "–", "", ""])
    return table(columns, rows, [*[""] * (len(rows) - 1), "sum"])


def _row(
    title: str, entry: Entry | None, figures: Sequence[float], report: StageReport | None, longest: float
) -> list[Content]:
    seconds, calls, told, said, cost = figures
    return [
        title,
        together([_share(seconds / longest if longest else 0.0), words_of(seconds)], "") if entry else "–",
        words_of(report.own_seconds) if report else "–",
        int(calls),
        int(told) or "–",
        int(said) or "–",
        f"${cost:.4f}" if cost else "–",
        f"{report.prompt_bytes / 1000:.1f} kB" if report and report.prompt_bytes else "–",
        _notes(entry, report),
    ]


def _share(value: float) -> Markup:
    """A bar without its number, which stands beside it in its own unit."""
    return Markup(f'<span class="bar"><i style="width:{max(0.0, min(1.0, value)) * 100:.0f}%"></i></span>')


def _figures(entry: Entry | None, answers: Sequence[Entry]) -> list[float]:
    """Seconds of the latest run; calls, tokens in and out and known cost of all answers that memory keeps."""
    return [
        entry.meta.seconds if entry else 0.0,
        len(answers),
        sum(a.meta.prompt_tokens for a in answers),
        sum(a.meta.completion_tokens for a in answers),
        sum(a.meta.cost or 0.0 for a in answers),
    ]


def _notes(entry: Entry | None, report: StageReport | None) -> Content:
    notes = list(dict.fromkeys([*(entry.meta.notes if entry else []), *(report.notes if report else ())]))
    if entry is None:
        notes.insert(0, "answered, but not finished")
    if not notes:
        return None
    lines: list[Content] = [element("div", note) for note in notes[:_FEW]]
    if len(notes) > _FEW:
        lines.append(folded(f"and {len(notes) - _FEW} more", *(element("div", note) for note in notes[_FEW:])))
    return together(lines)
