# SPDX-License-Identifier: GPL-3.0-or-later
"""Rotation accuracy: how many things look the right way.

Paper: "rotation accuracy", no formula. Here: share of the matched things on floor and wall whose yaw is off by at most
15 degrees, modulo their symmetry (class 1: full turn, 2: half, 4: quarter; class 0 and things without a front do not
count). `all_asked` counts things that were not found as wrong: a system that finds little looks good on the first one.

Class 2 compares long axes, so that (width, depth, yaw) = (depth, width, yaw + 90); a nearly square thing of class 2 is
class 4. Edge cases: nothing to judge: 1. A found thing whose yaw is unknown is wrong.
"""

from __future__ import annotations

import math

from .areas import Polygon
from .matching import Comparison, Pair
from .rooms import Thing

WITHIN = 15.0


def rotation_accuracy(comparison: Comparison) -> float:
    """Share of the matched things."""
    judged = [error(p) <= WITHIN for p in comparison.asked_pairs if _counts(p.true)]
    return sum(judged) / len(judged) if judged else 1.0


def all_asked(comparison: Comparison) -> float:
    """Share of all true things that have a front, misses counting as wrong."""
    asked = [thing for thing in comparison.asked if _counts(thing)]
    right = sum(thing.id in comparison.pairs and error(comparison.pairs[thing.id]) <= WITHIN for thing in asked)
    return right / len(asked) if asked else 1.0


def _counts(thing: Thing) -> bool:
    return thing.placement in ("floor", "wall") and thing.symmetry > 0 and thing.yaw is not None


def error(pair: Pair) -> float:
    """Degrees off, modulo the true thing's symmetry, at most 180."""
    true, found = pair.true, pair.own
    if true.symmetry == 0 or true.yaw is None:
        return 0.0
    if found.yaw is None:
        return 180.0
    if true.symmetry == 2:
        return _apart(_long_axis(true.rectangle), _long_axis(found.rectangle), 180.0)
    return _apart(true.yaw, found.yaw, 360.0 / true.symmetry)


def _apart(a: float, b: float, period: float) -> float:
    return abs((a - b + period / 2) % period - period / 2)


def _long_axis(rectangle: Polygon) -> float:
    (ax, ay), (bx, by), (cx, cy) = rectangle[:3]
    first, second = (bx - ax, by - ay), (cx - bx, cy - by)
    x, y = first if math.hypot(*first) >= math.hypot(*second) else second
    return math.degrees(math.atan2(y, x))
