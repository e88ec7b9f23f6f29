# SPDX-License-Identifier: GPL-3.0-or-later
"""Footprint IoU: how exactly the large things lie, one by one.

Not in the paper, whose layout IoU hides small errors of many things in one large area. Here: mean over the truth's major
things of the IoU of their footprint with that of what they are matched with, rooms' rectangles laid over one another; a
thing that was not found counts 0. Major: as the truth says, else what stands on the floor, is no rug and is wider than
35 cm. `per_thing` has them one by one, `in_metres` uses the result's own metres.

Edge cases: no majors: 1. Shapes (circles, L) count where truth and result both state them, else the rectangles around
them; a truth annotated with boxes only is compared with the boxes around the result's footprints.
"""

from __future__ import annotations

from code_as_room.pipeline.geometry.polygon import footprint_iou

from .matching import Comparison


def per_thing(comparison: Comparison) -> dict[str, float]:
    """IoU by the true thing's id."""
    return {t.id: comparison.pairs[t.id].iou if t.id in comparison.pairs else 0.0 for t in comparison.asked if t.major}


def footprint_iou_of_majors(comparison: Comparison) -> float:
    """Mean over the majors, misses as 0."""
    return _mean(list(per_thing(comparison).values()))


def in_metres(comparison: Comparison) -> float | None:
    """The same in the result's own metres; None when the truth's are only an estimate."""
    if not comparison.truth.metric:
        return None
    values = []
    for thing in comparison.asked:
        if thing.major:
            pair = comparison.pairs.get(thing.id)
            own = comparison.footprint(pair.own) if pair else []
            values.append(footprint_iou(comparison.footprint(thing), own) if own else 0.0)
    return _mean(values)


def _mean(values: list[float]) -> float:
    return sum(values) / len(values) if values else 1.0
