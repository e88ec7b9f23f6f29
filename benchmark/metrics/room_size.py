# SPDX-License-Identifier: GPL-3.0-or-later
"""Errors of the room itself. Lower is better.

Not in the paper. `aspect_error`: |a / b - 1| of width / depth of the floors' rectangles. `size_error`: mean of |a / b - 1| of
width and depth, in metres. Both are errors of the frame that the aligned figures forgive.

Edge cases: a truth without measured metres: the size error is None. A room without area is off by 1.
"""

from __future__ import annotations

from .matching import Comparison


def aspect_error(comparison: Comparison) -> float:
    """Relative error of width / depth."""
    (a, b), (c, d) = comparison.own.size, comparison.truth.size
    if min(a, b, c, d) <= 0:
        return 1.0
    return abs((a / b) / (c / d) - 1)


def size_error(comparison: Comparison) -> float | None:
    """Mean relative error of width and depth."""
    if not comparison.truth.metric:
        return None
    pairs = list(zip(comparison.own.size, comparison.truth.size, strict=True))
    return sum(abs(a / b - 1) if b > 0 else 1.0 for a, b in pairs) / 2
