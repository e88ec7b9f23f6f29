# SPDX-License-Identifier: GPL-3.0-or-later
"""How well a room matches its ground truth, one small module a metric: definition, edge cases and source in its docstring.

Typical use: `score(load_truth(truth_path, style), load_result(scene_path))`; `direct_answer(memory_path)` is the room that the
model's first reply described. The paper (Code-as-Room) names its metrics and gives no formulas, so these definitions are
the project's own and the figures are not comparable with its tables.
"""

from .direct import direct_answer, room_from_reply
from .matching import Comparison, Pair, compare
from .rooms import Room, Thing, Zone, load_result, load_truth, room_of
from .score import BY_NAME, COLUMNS, MAIN, Column, Figures, failed, is_worse, mean, score, score_comparison

__all__ = [
    "BY_NAME",
    "COLUMNS",
    "MAIN",
    "Column",
    "Comparison",
    "Figures",
    "Pair",
    "Room",
    "Thing",
    "Zone",
    "compare",
    "direct_answer",
    "failed",
    "is_worse",
    "load_result",
    "load_truth",
    "mean",
    "room_from_reply",
    "room_of",
    "score",
    "score_comparison",
]
