# SPDX-License-Identifier: GPL-3.0-or-later
"""Support accuracy: whether things stand, lie and hang on what they should.

Paper: "support accuracy", no formula. Here: share of the matched things that have the same placement (floor, wall,
ceiling, surface) as the truth, whose parent is matched with the true parent (things that the truth does not list may lie
between), and that are physically held within 6 cm: on the floor by the floor, on a wall by the room's outline or a
partition, on a surface by the parent's upper side under its centre, or anywhere inside the parent's height where the
parent can hold things (beds and seats, whose box is higher than where one lies; shelves, cabinets, boxes). Things on the
ceiling count as held. SceneEval uses 1 cm, on meshes.
`label` leaves out the physical part; `all_asked` counts misses as wrong.

Edge cases: nothing matched: 1 when nothing was asked for, else 0. A true parent that was not found: wrong. Results without
heights are not physically judged.
"""

from __future__ import annotations

from code_as_room.pipeline.geometry.polygon import edges, point_in_polygon

from .areas import outline_gap, wall_gap
from .categories import kinds
from .matching import Comparison, Pair
from .rooms import Room, Thing

TOLERANCE = 0.06
_HOLDS_INSIDE = {
    "sleeping",
    "sofas",
    "seats",
    "shelves",
    "cabinets",
    "boxes",
    "clothing",
    "bins",
    "kitchens",
    "toys",
    "vessels",
}


def support_accuracy(comparison: Comparison) -> float:
    """Share of the matched things."""
    right = [_labelled(comparison, p) and held(comparison.own, p.own) for p in comparison.asked_pairs]
    return _share(right, comparison)


def label(comparison: Comparison) -> float:
    """Share of the matched things with the right placement and parent."""
    return _share([_labelled(comparison, p) for p in comparison.asked_pairs], comparison)


def all_asked(comparison: Comparison) -> float:
    """Share of all true things, misses counting as wrong."""
    right = sum(_labelled(comparison, p) and held(comparison.own, p.own) for p in comparison.asked_pairs)
    return right / len(comparison.asked) if comparison.asked else 1.0


def _share(right: list[bool], comparison: Comparison) -> float:
    if not right:
        return 0.0 if comparison.asked else 1.0
    return sum(right) / len(right)


def _labelled(comparison: Comparison, pair: Pair) -> bool:
    if pair.true.placement != pair.own.placement:
        return False
    if pair.true.placement != "surface" or pair.true.parent is None:
        return True
    parent = comparison.pairs.get(pair.true.parent)
    return parent is not None and comparison.rests_on(pair.own, parent.own)


def held(room: Room, thing: Thing) -> bool:
    """Whether a thing is held by what it says it is on, in the room's own metres."""
    if thing.base is None or thing.top is None or thing.placement == "ceiling":
        return True
    if thing.placement == "floor":
        return abs(thing.base) <= TOLERANCE
    if thing.placement == "wall":
        walls = [*edges(room.floor), *room.partitions]
        return any(wall_gap(thing.rectangle, *wall) <= TOLERANCE for wall in walls)
    parent = room.by_id.get(thing.parent or "")
    if parent is None or parent.base is None or parent.top is None or not _above(thing, parent):
        return False
    if kinds(parent.category) & _HOLDS_INSIDE and parent.base - TOLERANCE <= thing.base <= parent.top:
        return True
    return abs(thing.base - parent.top) <= TOLERANCE


def _above(thing: Thing, parent: Thing) -> bool:
    inside = point_in_polygon(thing.centre, parent.rectangle)
    return inside or outline_gap([thing.centre, thing.centre, thing.centre], parent.rectangle) <= TOLERANCE
