# SPDX-License-Identifier: GPL-3.0-or-later
"""Spatial-relation consistency: do things stand to each other as in the truth?

Paper: "spatial relation", no formula. Here: the true relations are read off the truth's geometry and counted again in the
result, rooms' rectangles laid over one another. `consistency` is the share of the true relations between matched things
that hold there; `all_asked` counts those of things that were not found as broken.

Relations (thresholds as used when reading the truth; when testing the result they are 25 % looser, so that no relation
breaks by a centimetre):
- `left_of`, `below`: between a thing on floor or wall and its 5 nearest neighbours of those, when the centres are apart by
  at least max(0.2 m, half the smaller extent) in that direction (x right, y up in the picture);
- `near`: floor things with a gap of at most 0.4 m;
- `against_wall`: a floor or wall thing within 0.18 m of a wall of the true room; `in_corner`: of two walls that meet;
- `facing`: a seat looks at a floor thing within 2.5 m, its front within 30 degrees of the direction (SceneEval's angle);
- `on`: stands on the thing that is its parent.
Rugs take part in none but `on`.

Edge cases: no relations: 1. None between matched things: 0 where the truth has some, else 1. A thing related to a
partition: partitions are no walls here. A truth annotated with boxes: the gaps are those of the boxes.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import NamedTuple

from code_as_room.pipeline.geometry.polygon import bounding_rectangle, edges

from .areas import outline_gap, wall_gap
from .categories import kinds
from .matching import Comparison
from .rooms import Thing

NEIGHBOURS = 5
NEAR = 0.40
AT_WALL = 0.18
LOOSER = 1.25
FACING_DEGREES = 30.0
FACING_REACH = 2.5
OFFSET = 0.20


class Relation(NamedTuple):
    """`source kind target`; the target is a thing's id, or a wall's (or corner's) number."""

    kind: str
    source: str
    target: str


def consistency(comparison: Comparison) -> float:
    """Share of the true relations between matched things that hold in the result."""
    relations = true_relations(comparison)
    judged = [r for r in relations if _is_matched(comparison, r)]
    if not judged:
        return 0.0 if relations else 1.0
    return sum(_holds(comparison, r) for r in judged) / len(judged)


def all_asked(comparison: Comparison) -> float:
    """Share of all true relations, those of missed things counting as broken."""
    relations = true_relations(comparison)
    right = sum(_is_matched(comparison, r) and _holds(comparison, r) for r in relations)
    return right / len(relations) if relations else 1.0


def broken(comparison: Comparison) -> list[Relation]:
    """The true relations between matched things that do not hold in the result."""
    return [r for r in true_relations(comparison) if _is_matched(comparison, r) and not _holds(comparison, r)]


def true_relations(comparison: Comparison) -> list[Relation]:
    """All relations of the things that the picture shows, read off the truth's geometry."""
    things = comparison.asked
    standing = [t for t in things if t.placement == "floor" and not t.flat]
    around = [*standing, *(t for t in things if t.placement == "wall")]
    found = [*_sides(around), *_nearness(standing), *_facings(standing)]
    for thing in things:
        if thing.placement in ("floor", "wall") and not thing.flat:
            found += _walls(comparison, thing)
        if thing.placement == "surface" and any(t.id == thing.parent for t in things):
            found.append(Relation("on", thing.id, str(thing.parent)))
    return found


def _sides(around: list[Thing]) -> Iterator[Relation]:
    """Each pair once, whichever of the two is among the other's nearest."""
    said: set[tuple[str, str, int]] = set()
    for thing in around:
        others = [other for other in around if other is not thing]
        for other in sorted(others, key=lambda o: math.dist(thing.centre, o.centre))[:NEIGHBOURS]:
            for axis, kind in ((0, "left_of"), (1, "below")):
                first, second = (thing, other) if thing.centre[axis] < other.centre[axis] else (other, thing)
                if _is_apart(first, second, first, second, axis) and (first.id, second.id, axis) not in said:
                    said.add((first.id, second.id, axis))
                    yield Relation(kind, first.id, second.id)


def _is_apart(a: Thing, b: Thing, true_a: Thing, true_b: Thing, axis: int, looser: float = 1.0) -> bool:
    """Whether a lies before b along an axis; how far it must be is measured on the true things."""
    extents = []
    for thing in (true_a, true_b):
        box = bounding_rectangle(thing.rectangle)
        extents.append(box[axis + 2] - box[axis])
    return b.centre[axis] - a.centre[axis] >= max(OFFSET, min(extents) / 2) / looser


def _nearness(standing: list[Thing]) -> Iterator[Relation]:
    for i, a in enumerate(standing):
        for b in standing[i + 1 :]:
            if outline_gap(a.rectangle, b.rectangle) <= NEAR:
                yield Relation("near", a.id, b.id)


def _facings(standing: list[Thing]) -> Iterator[Relation]:
    for a in standing:
        if a.yaw is not None and a.symmetry == 1 and kinds(a.category) & {"seats", "sofas"}:
            for b in standing:
                if a is not b and _faces(a, b):
                    yield Relation("facing", a.id, b.id)


def _faces(a: Thing, b: Thing, looser: float = 1.0) -> bool:
    if a.yaw is None or math.dist(a.centre, b.centre) > FACING_REACH * looser:
        return False
    direction = math.degrees(math.atan2(b.centre[1] - a.centre[1], b.centre[0] - a.centre[0]))
    front = a.yaw - 90.0  # at yaw 0 the front looks to -Y
    return abs((direction - front + 180) % 360 - 180) <= FACING_DEGREES * looser


def _walls(comparison: Comparison, thing: Thing) -> Iterator[Relation]:
    walls = edges(comparison.truth.floor)
    at = [i for i, wall in enumerate(walls) if wall_gap(thing.rectangle, *wall) <= AT_WALL]
    yield from (Relation("against_wall", thing.id, str(i)) for i in at)
    yield from (Relation("in_corner", thing.id, str(i)) for i in at if (i + 1) % len(walls) in at)


def _is_matched(comparison: Comparison, relation: Relation) -> bool:
    needed = [relation.source] if relation.kind in ("against_wall", "in_corner") else [relation.source, relation.target]
    return all(name in comparison.pairs for name in needed)


def _holds(comparison: Comparison, relation: Relation) -> bool:
    pair = comparison.pairs[relation.source]
    a = pair.found
    if relation.kind in ("against_wall", "in_corner"):
        walls = edges(comparison.truth.floor)
        first = int(relation.target)
        needed = [first] if relation.kind == "against_wall" else [first, (first + 1) % len(walls)]
        return all(wall_gap(a.rectangle, *walls[i]) <= AT_WALL * LOOSER for i in needed)
    other = comparison.pairs[relation.target]
    b = other.found
    if relation.kind == "near":
        return outline_gap(a.rectangle, b.rectangle) <= NEAR * LOOSER
    if relation.kind == "facing":
        return _faces(a, b, LOOSER)
    if relation.kind == "on":
        return pair.own.placement == "surface" and comparison.rests_on(pair.own, other.own)
    return _is_apart(a, b, pair.true, other.true, 0 if relation.kind == "left_of" else 1, LOOSER)
