# SPDX-License-Identifier: GPL-3.0-or-later
"""The rows of `benchmark.ablations` as Markdown: ablations, noise, and the lead over the direct answer."""

from __future__ import annotations

import statistics
from collections.abc import Callable, Collection, Iterable, Sequence
from typing import TYPE_CHECKING, TypeVar

from .metrics import MAIN, Column, Figures, mean

if TYPE_CHECKING:
    from .ablations import Row

DIRECT, NOISELESS = "direct answer", "none"
SIMULATED, UNKNOWN = "°", "†"
T = TypeVar("T")
Pick = Callable[["Row"], Figures]


def tables(rows: Sequence[Row], unknown: Collection[str]) -> str:
    """All tables.

    Args:
        unknown: ablations by a setting that no stage of this version uses.
    """
    parts = [
        "# Ablations and noise",
        "",
        "Figures in per cent, means over rooms; ± is the standard deviation over seeds of that mean. "
        f"{SIMULATED}: some answers were never recorded and are simulated from what the recording's model saw, "
        f"without error. {UNKNOWN}: no stage of this version knows the setting, so nothing was changed.",
    ]
    for strength in _ordered(row.task.strength for row in rows):
        here = [row for row in rows if row.task.strength == strength]
        parts += ["", _title(strength, here), "", *_table(here, unknown)]
    parts += ["", "## Lead over the direct answer, in percentage points", "", *_leads(rows)]
    problems = [
        f"- {row.task.room}/{row.task.style}, {_name(row, unknown)}: {row.problem}" for row in rows if row.problem
    ]
    if problems:
        parts += ["", "## Runs that failed (they count with the worst figures)", "", *problems]
    return "\n".join(parts) + "\n"


def _title(strength: str, rows: Sequence[Row]) -> str:
    rooms = len({(row.task.room, row.task.style) for row in rows})
    seeds = len({row.task.seed for row in rows})
    what = "As recorded" if strength == NOISELESS else f"Noise: {strength}"
    return f"## {what} ({rooms} picture{'s' * (rooms != 1)}" + (f", {seeds} seeds)" if seeds > 1 else ")")


def _table(rows: Sequence[Row], unknown: Collection[str]) -> list[str]:
    """One line for the direct answer and one for each variant."""
    head = ["", *(column.title for column in MAIN), "calls", "kB"]
    lines = ["| " + " | ".join(head) + " |", "|" + " --- |" * len(head)]
    variants = _ordered(row.task.variant for row in rows)
    for variant in (DIRECT, *variants):
        chosen = [row for row in rows if row.task.variant == (variants[0] if variant == DIRECT else variant)]
        pick: Pick = (lambda row: row.direct) if variant == DIRECT else (lambda row: row.figures)
        cells = [_cell(column, chosen, pick) for column in MAIN]
        if variant == DIRECT:
            costs = ["1", ""]
        else:
            calls = statistics.fmean(row.calls for row in chosen)
            costs = [f"{calls:.1f}", f"{statistics.fmean(row.prompt_bytes for row in chosen) / 1000:.1f}"]
        name = variant if variant == DIRECT else _marked(variant, chosen, unknown)
        lines.append("| " + " | ".join([name, *cells, *costs]) + " |")
    return lines


def _marked(variant: str, rows: Sequence[Row], unknown: Collection[str]) -> str:
    simulated = SIMULATED if any(row.simulated for row in rows) else ""
    return variant + simulated + (UNKNOWN if variant in unknown else "")


def _name(row: Row, unknown: Collection[str]) -> str:
    return f"{_marked(row.task.variant, [row], unknown)}, {row.task.strength} noise, seed {row.task.seed}"


def _cell(column: Column, rows: Sequence[Row], pick: Pick) -> str:
    means = _by_seed(column, rows, pick)
    if not means:
        return "–"
    middle = f"{100 * statistics.fmean(means):.1f}"
    return middle if len(means) < 2 else f"{middle} ± {100 * statistics.stdev(means):.1f}"


def _by_seed(column: Column, rows: Sequence[Row], pick: Pick) -> list[float]:
    """For each seed the mean over the rooms that have the figure."""
    result = []
    for seed in _ordered(row.task.seed for row in rows):
        value = mean([pick(row) for row in rows if row.task.seed == seed])[column.name]
        if value is not None:
            result.append(value)
    return result


def _leads(rows: Sequence[Row]) -> list[str]:
    """How much better the whole method is than the direct answer, by strength; losses of the wrong sign are negative."""
    head = ["noise", *(column.title for column in MAIN), "mean"]
    lines = ["| " + " | ".join(head) + " |", "|" + " --- |" * len(head)]
    full = next(iter(_ordered(row.task.variant for row in rows)))
    for strength in _ordered(row.task.strength for row in rows):
        chosen = [row for row in rows if row.task.strength == strength and row.task.variant == full]
        leads = [lead(column, chosen) for column in MAIN]
        known = [value for value in leads if value is not None]
        cells = ["–" if value is None else f"{value:+.1f}" for value in leads]
        lines.append("| " + " | ".join([strength, *cells, f"{statistics.fmean(known):+.1f}" if known else "–"]) + " |")
    return lines


def lead(column: Column, rows: Sequence[Row]) -> float | None:
    """Percentage points by which the results are better than their direct answers in one column."""
    pairs = [
        (a, b)
        for row in rows
        if (a := row.figures[column.name]) is not None and (b := row.direct[column.name]) is not None
    ]
    if not pairs:
        return None
    gain = 100 * statistics.fmean(a - b for a, b in pairs)
    return gain if column.more_is_better else -gain


def _ordered(values: Iterable[T]) -> list[T]:
    return list(dict.fromkeys(values))
