# SPDX-License-Identifier: GPL-3.0-or-later
"""The table of the benchmark: `python -m benchmark.table RUNS_DIR TRUTH_DIR [--json FILE] [--markdown FILE]`.

RUNS_DIR/<picture>/<style>/ holds what `code-as-room --out` wrote, TRUTH_DIR/<picture>/truth.json (or
TRUTH_DIR/<picture>.truth.json) the ground truth. Every cell is "result / direct answer of the same run"; a star marks
results that are worse than the direct answer by what is shown. Figures are per cent, from `benchmark/metrics`. A run that
brought no room counts with the worst figure of each column.
"""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

from .metrics import MAIN, Column, Figures, compare, failed, footprints, is_worse, mean, score_comparison
from .metrics.rooms import Room, load_truth
from .metrics.runs import Costs, Outcome, read_run

COSTS = (("calls", "calls"), ("rounds", "rounds"), ("rounds_before_critique", "rounds before critique"))
_SIDE_BY_SIDE = 6


@dataclass(frozen=True)
class Row:
    """The figures of one run."""

    picture: str
    style: str
    result: Figures
    direct: Figures | None
    costs: Costs | None
    problem: str = ""
    details: Mapping[str, Any] = field(default_factory=dict)

    @property
    def name(self) -> str:
        """Picture and style."""
        return f"{self.picture} {self.style}".strip()


def find_runs(folder: Path) -> list[tuple[str, str, Path]]:
    """(picture, style, folder) of every run; a picture's folder that is itself a run has no style."""
    found = []
    for picture in sorted(p for p in folder.iterdir() if p.is_dir()):
        if (picture / "memory.json").exists() or (picture / "scene.json").exists():
            found.append((picture.name, "", picture))
            continue
        found += [(picture.name, style.name, style) for style in sorted(p for p in picture.iterdir() if p.is_dir())]
    return found


def find_truth(folder: Path, picture: str) -> Path | None:
    """The ground truth of a picture."""
    places = (folder / picture / "truth.json", folder / f"{picture}.truth.json")
    return next((place for place in places if place.exists()), None)


def row_of(picture: str, style: str, outcome: Outcome, truth: Room) -> Row:
    """Score one run."""
    direct = score_comparison(compare(truth, outcome.direct)) if outcome.direct is not None else None
    if outcome.result is None:
        return Row(picture, style, failed(), direct, outcome.costs, outcome.problem or "no room")
    comparison = compare(truth, outcome.result)
    details = {
        "missed": [t.id for t in comparison.asked if t.id not in comparison.pairs],
        "called_otherwise": {
            p.true.id: f"{p.true.category} / {p.own.category}" for p in comparison.asked_pairs if not p.strict
        },
        "extra": [t.id for t in comparison.extra],
        "footprints": {k: round(v, 3) for k, v in footprints.per_thing(comparison).items()},
    }
    return Row(picture, style, score_comparison(comparison), direct, outcome.costs, outcome.problem, details)


def make_rows(runs: Path, truths: Path) -> tuple[list[Row], list[str]]:
    """All rows, and sentences on what was left out."""
    rows, notes = [], []
    for picture, style, folder in find_runs(runs):
        truth = find_truth(truths, picture)
        if truth is None:
            notes.append(f"{picture}: there is no ground truth in {truths.name}.")
            continue
        row = row_of(picture, style, read_run(folder), load_truth(truth, style))
        rows.append(row)
        if row.problem:
            notes.append(f"{row.name}: {row.problem}")
    return rows, notes


def cell(column: Column, result: float | None, direct: float | None, with_direct: bool) -> str:
    """ "97.1* / 98.0": the star where the result is worse."""
    star = "*" if is_worse(column, result, direct) else ""
    shown = _percent(result) + star
    return f"{shown} / {_percent(direct)}" if with_direct else shown


def _percent(value: float | None) -> str:
    return "–" if value is None else f"{100 * value:.1f}"


def mean_row(rows: Sequence[Row]) -> Row:
    """Means over all runs; the direct answer's over those that have one."""
    given = [row.direct for row in rows if row.direct is not None]
    return Row("mean", "", mean([row.result for row in rows]), mean(list(given)) if given else None, None)


def cells(row: Row) -> list[str]:
    """One row's cells, the costs last."""
    direct = row.direct or {}
    shown = [cell(c, row.result[c.name], direct.get(c.name), row.direct is not None) for c in MAIN]
    if row.costs is None:
        return [*shown, *("–" for _ in COSTS), "–"]
    counted = [str(getattr(row.costs, name)) for name, _ in COSTS]
    return [*shown, *counted, f"{row.costs.prompt_bytes / 1000:.1f}"]


def titles() -> list[str]:
    """What the cells are called; those where less is better say so."""
    figures = [c.title if c.more_is_better else f"{c.title} (less is better)" for c in MAIN]
    return [*figures, *(title for _, title in COSTS), "prompt kB"]


def markdown(rows: Sequence[Row]) -> str:
    """The table in Markdown, one run a line."""
    heads = ["picture", *titles()]
    lines = [heads, ["---"] + ["---:"] * (len(heads) - 1)]
    lines += [[row.name, *cells(row)] for row in [*rows, mean_row(rows)]]
    explained = (
        "Every figure in per cent: result / direct answer of the same run; * marks results below the direct answer. "
        "Costs are those of stages 1 to 4."
    )
    return "\n".join("| " + " | ".join(line) + " |" for line in lines) + f"\n\n{explained}\n"


def text(rows: Sequence[Row]) -> str:
    """The table for a terminal, one figure a line, a few runs side by side."""
    names, blocks = titles(), []
    shown = [*rows, mean_row(rows)]
    for start in range(0, len(shown), _SIDE_BY_SIDE):
        part = shown[start : start + _SIDE_BY_SIDE]
        columns = [[row.name, *cells(row)] for row in part]
        widths = [max(len(value) for value in column) + 2 for column in columns]
        lines = []
        for index, name in enumerate(["", *names]):
            values = "".join(c[index].rjust(w) for c, w in zip(columns, widths, strict=True))
            lines.append(f"{name:<30}{values}")
        blocks.append("\n".join(lines))
    return "\n\n".join(blocks)


def as_json(rows: Sequence[Row]) -> dict[str, Any]:
    """All figures, also those that tables leave out."""
    total = mean_row(rows)
    return {"runs": [asdict(row) for row in rows], "mean": {"result": total.result, "direct": total.direct}}


def main(arguments: Sequence[str] | None = None) -> int:
    """Print the table; 1 when there was nothing to score."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("runs", type=Path)
    parser.add_argument("truths", type=Path)
    parser.add_argument("--json", type=Path)
    parser.add_argument("--markdown", type=Path)
    options = parser.parse_args(arguments)
    rows, notes = make_rows(options.runs, options.truths)
    for note in notes:
        print(note, file=sys.stderr)
    if not rows:
        print("There are no runs with a ground truth.", file=sys.stderr)
        return 1
    print(text(rows))
    stars = sum(is_worse(c, r.result[c.name], (r.direct or {}).get(c.name)) for r in rows for c in MAIN)
    print(f"\nresult / direct answer, per cent; * worse than the direct answer: {stars} cells of {len(rows)} runs")
    if options.json:
        options.json.write_text(json.dumps(as_json(rows), indent=1, ensure_ascii=False) + "\n", encoding="utf-8")
    if options.markdown:
        options.markdown.write_text(markdown(rows), encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
