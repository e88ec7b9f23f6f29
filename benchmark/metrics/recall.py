# SPDX-License-Identifier: GPL-3.0-or-later
"""Object recall: how many of the true things were found.

Paper: "object recall", the share of annotated objects that the result has; no formula, so probably by name only. Here:
`object_recall` = true things with a strict pair (same kind by name, in its place, see `matching`) / true things that the
picture shows. Beside it, since recall alone rewards guessing: `precision` = strict pairs / predicted things (those that
are matched with a thing that the picture does not show are left out) and `f1`. `lenient` counts functional pairs too,
`category_only` ignores places.

Edge cases: nothing to find: 1. Nothing predicted: precision is 1 when there was nothing to find, else 0.
"""

from __future__ import annotations

import numpy as np
from scipy.optimize import linear_sum_assignment  # type: ignore[import-untyped]

from .categories import STRICT, similarity
from .matching import Comparison


def object_recall(comparison: Comparison) -> float:
    """Strict pairs / things asked for."""
    return _share(sum(pair.strict for pair in comparison.asked_pairs), len(comparison.asked))


def lenient(comparison: Comparison) -> float:
    """All pairs / things asked for."""
    return _share(len(comparison.asked_pairs), len(comparison.asked))


def precision(comparison: Comparison) -> float:
    """Strict pairs / predicted things."""
    unasked = len(comparison.pairs) - len(comparison.asked_pairs)
    predicted = len(comparison.own.things) - unasked
    if predicted <= 0:
        return 0.0 if comparison.asked else 1.0
    return sum(pair.strict for pair in comparison.asked_pairs) / predicted


def f1(comparison: Comparison) -> float:
    """Harmonic mean of recall and precision."""
    a, b = object_recall(comparison), precision(comparison)
    return 2 * a * b / (a + b) if a + b > 0 else 0.0


def category_only(comparison: Comparison) -> float:
    """Share of the true things for which there is a predicted thing of the same kind, wherever it is; each counts once."""
    asked, found = comparison.asked, comparison.own.things
    same = np.array([[similarity(t.category, p.category) >= STRICT for p in found] for t in asked], dtype=float)
    if not same.size:
        return _share(0, len(asked))
    rows, columns = linear_sum_assignment(-same)
    return _share(int(same[rows, columns].sum()), len(asked))


def _share(part: int, whole: int) -> float:
    return part / whole if whole else 1.0
