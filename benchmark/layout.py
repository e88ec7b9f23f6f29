# SPDX-License-Identifier: GPL-3.0-or-later
"""How well one room matches its ground truth: `python -m benchmark.layout scene.json truth.json [memory.json]`.

With a memory, the direct answer is scored beside the result: the metres of the model's first reply as it gave them,
without camera, fusing, loop or solver. `benchmark/table.py` does the same for many runs.
"""

from __future__ import annotations

import argparse
import json
from pathlib import Path

from code_as_room.pipeline.memory import load_memory

from .metrics import COLUMNS, compare, footprints, load_result, load_truth, score_comparison
from .metrics.direct import direct_answer
from .metrics.runs import shapes_of


def main() -> None:
    """Print the figures as a table, and as JSON with --json."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("scene", type=Path)
    parser.add_argument("truth", type=Path)
    parser.add_argument("memory", type=Path, nargs="?")
    parser.add_argument("--style", default="", help="which of the truth's pictures was shown")
    parser.add_argument("--json", action="store_true")
    options = parser.parse_args()
    memory = load_memory(options.memory.read_text(encoding="utf-8")) if options.memory else None
    truth = load_truth(options.truth, options.style)
    rooms = {"result": load_result(options.scene, shapes_of(memory))}
    direct = direct_answer(memory) if memory is not None else None
    if direct is not None:
        rooms["direct"] = direct
    comparisons = {name: compare(truth, room) for name, room in rooms.items()}
    figures = {name: score_comparison(comparison) for name, comparison in comparisons.items()}
    if options.json:
        print(json.dumps(figures, indent=1))
        return
    print(f"{'':<24}" + "".join(f"{name:>12}" for name in figures))
    for column in COLUMNS:
        values = [f[column.name] for f in figures.values()]
        print(f"{column.name:<24}" + "".join(f"{'–' if v is None else f'{v:.3f}':>12}" for v in values))
    for name, comparison in comparisons.items():
        missed = [t.id for t in comparison.asked if t.id not in comparison.pairs]
        other = [f"{p.true.id} as {p.own.category}" for p in comparison.asked_pairs if not p.strict]
        print(f"{name}: missed {missed}, called otherwise {other}, extra {[t.id for t in comparison.extra]}")
        print(f"  footprints { ({k: round(v, 2) for k, v in footprints.per_thing(comparison).items()}) }")


if __name__ == "__main__":
    main()
