# SPDX-License-Identifier: GPL-3.0-or-later
"""Which predicted thing is which true one: the assignment that everything else is scored on.

Definition: similarity = 0.5 category + 0.25 footprint IoU + 0.25 max(0, 1 - d / D) for every pair whose names are not
foreign to each other (`categories.similarity` > 0) and whose centres are within D = max(0.5 m, 15 % of the room's
diagonal, half the true thing's own diagonal); the assignment with the largest sum (Hungarian method). Both rooms lie over
one another by their floors' rectangles, so a wrong scale alone loses nobody.

Each pair is *strict* (names mean the same, `categories.STRICT`) or *functional* (another name of the same group: it does
the same work in the right place). Recall counts strict pairs only; all other figures use both.

Source: the project's page of definitions; the paper gives none. SceneEval asks a vision model which object is which.
Edge cases: no things on either side: no pairs. Duplicates: the one that fits better is taken, the others stay unmatched.
An L whose hand nobody stated takes the one that fits better, as in the overlap and outside the room. Things that the
truth's picture does not show are matched too, but asked for by nobody; what they are matched with is not held against
the precision.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from code_as_room.pipeline.geometry.polygon import bounding_rectangle, footprint_iou
from numpy.typing import NDArray
from scipy.optimize import linear_sum_assignment  # type: ignore[import-untyped]

from .areas import Polygon
from .categories import STRICT, similarity
from .rooms import Room, Thing, boxed, laid_over


@dataclass(frozen=True)
class Pair:
    """A true thing and what stands for it: `found` with the rooms laid over one another, `own` in its own metres."""

    true: Thing
    found: Thing
    own: Thing
    kind: float
    iou: float

    @property
    def strict(self) -> bool:
        """Whether both names mean the same."""
        return self.kind >= STRICT


@dataclass(frozen=True)
class Comparison:
    """A truth, a result in its own metres and laid over the truth, and the pairs by the true thing's id."""

    truth: Room
    own: Room
    aligned: Room
    pairs: dict[str, Pair]
    exact: bool
    """Whether footprints are compared by their shapes (circles, L), since both rooms know them."""

    def footprint(self, thing: Thing) -> Polygon:
        """The polygon that stands for a thing when places and sizes are compared."""
        if self.truth.boxes_only:
            return boxed(thing.rectangle)
        return thing.outline if self.exact else thing.rectangle

    @property
    def asked(self) -> list[Thing]:
        """The true things that the picture shows."""
        return [thing for thing in self.truth.things if thing.shown]

    @property
    def asked_pairs(self) -> list[Pair]:
        """Their pairs."""
        return [self.pairs[thing.id] for thing in self.asked if thing.id in self.pairs]

    @property
    def extra(self) -> list[Thing]:
        """What the result has, and nothing in the truth is."""
        taken = {pair.own.id for pair in self.pairs.values()}
        return [thing for thing in self.own.things if thing.id not in taken]

    def rests_on(self, thing: Thing, target: Thing) -> bool:
        """Whether a thing of the result stands on another of it, also by way of things that the truth does not list (a throw on
        a duvet on the bed, where the truth's bed has its bedding)."""
        between, seen = {extra.id for extra in self.extra}, set()
        parent = thing.parent
        while parent is not None and parent != target.id and parent in between and parent not in seen:
            seen.add(parent)
            parent = self.own.by_id[parent].parent
        return parent == target.id


def compare(truth: Room, result: Room) -> Comparison:
    """Match a result with its truth."""
    exact = truth.shapes_known and result.shapes_known and not truth.boxes_only
    comparison = Comparison(truth, result, laid_over(result, truth.size), {}, exact)
    gain, kind, iou = _gains(comparison)
    rows, columns = linear_sum_assignment(-gain)
    matched = [(i, j) for i, j in zip(rows.tolist(), columns.tolist(), strict=True) if gain[i, j] > 0]
    comparison = _with_hands(comparison, matched)
    for i, j in matched:
        true, found, own = truth.things[i], comparison.aligned.things[j], comparison.own.things[j]
        comparison.pairs[true.id] = Pair(true, found, own, float(kind[i, j]), float(iou[i, j]))
    return comparison


def _with_hands(comparison: Comparison, matched: list[tuple[int, int]]) -> Comparison:
    """Each L whose hand nobody stated takes the one that fits the true thing better."""
    own, aligned = list(comparison.own.things), list(comparison.aligned.things)
    for i, j in matched:
        outline = comparison.footprint(comparison.truth.things[i])
        ious = [footprint_iou(outline, hand) for hand in aligned[j].hands]
        if len(ious) == 2 and ious[1] > ious[0]:
            own[j], aligned[j] = own[j].with_other_hand(), aligned[j].with_other_hand()
    rooms = [replace(r, things=tuple(t)) for r, t in ((comparison.own, own), (comparison.aligned, aligned))]
    return replace(comparison, own=rooms[0], aligned=rooms[1])


def reach(thing: Thing, room: Room) -> float:
    """How far off a thing may be and still be the one, metres."""
    x0, y0, x1, y1 = bounding_rectangle(thing.rectangle)
    return max(0.5, 0.15 * math.hypot(*room.size), math.hypot(x1 - x0, y1 - y0) / 2)


def _gains(comparison: Comparison) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    truth, aligned = comparison.truth, comparison.aligned
    shape = (len(truth.things), len(aligned.things))
    gain, kind, iou = np.zeros(shape), np.zeros(shape), np.zeros(shape)
    found = [thing.hands if comparison.exact else [comparison.footprint(thing)] for thing in aligned.things]
    for i, true in enumerate(truth.things):
        outline, limit = comparison.footprint(true), reach(true, truth)
        for j, other in enumerate(aligned.things):
            alike = similarity(true.category, other.category)
            distance = math.dist(true.centre, other.centre)
            if alike == 0 or distance > limit:
                continue
            kind[i, j], iou[i, j] = alike, max(footprint_iou(outline, hand) for hand in found[j])
            gain[i, j] = 0.5 * alike + 0.25 * iou[i, j] + 0.25 * (1 - distance / limit)
    return gain, kind, iou
