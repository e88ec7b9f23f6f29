# SPDX-License-Identifier: GPL-3.0-or-later
"""Layout IoU: how well the result covers the floor where the picture shows it covered.

Paper: "layout IoU", the headline of its table (17 % and 46 % for direct calls, 73 % with the method), no formula. Here:
IoU of the union of the footprints of all things that stand on the floor, exact areas, rugs and other flat things left
out. `aligned` lays the rooms' rectangles over one another first (a picture alone gives no scale); `in_metres` lays the
rectangles' centres over one another and keeps the result's own metres. `floor` is the IoU of the floors' outlines, aligned.

Edge cases: neither has anything on the floor: 1; only one has: 0. A truth without measured metres: `in_metres` is None.
True things that the picture does not show, and what is matched with them, are left out.
"""

from __future__ import annotations

from .areas import Polygon, union_iou
from .matching import Comparison
from .rooms import Thing


def aligned(comparison: Comparison) -> float:
    """With the rooms' rectangles laid over one another."""
    return union_iou(_true(comparison), _found(comparison, comparison.aligned.things))


def in_metres(comparison: Comparison) -> float | None:
    """With the rectangles' centres laid over one another."""
    if not comparison.truth.metric:
        return None
    return union_iou(_true(comparison), _found(comparison, comparison.own.things))


def floor(comparison: Comparison) -> float:
    """IoU of the floors' outlines, rectangles laid over one another."""
    return union_iou([comparison.truth.floor], [comparison.aligned.floor])


def _stands(thing: Thing) -> bool:
    return thing.placement == "floor" and not thing.flat


def _true(comparison: Comparison) -> list[Polygon]:
    return [comparison.footprint(thing) for thing in comparison.asked if _stands(thing)]


def _found(comparison: Comparison, things: tuple[Thing, ...]) -> list[Polygon]:
    unasked = {pair.own.id for pair in comparison.pairs.values() if not pair.true.shown}
    return [comparison.footprint(thing) for thing in things if _stands(thing) and thing.id not in unasked]
