# SPDX-License-Identifier: GPL-3.0-or-later
"""Self-overlap: how much of the things' volume lies inside other things. Lower is better.

Paper: "self-overlap", in per cent, no formula. Here: sum over all pairs of the volume that both prisms (footprint times
height, shrunk by 1 cm) fill / sum of all volumes, at most 1, in the result's own metres. Beside it `colliding`: share of
things that share more than 3 % of the smaller one's volume with another, as LayoutVLM and SceneEval count (by meshes).

Not counted: a thing and what it stands on, at any number of steps; rugs; cloth on cloth (a throw over a pillow), which is
soft. Tables and desks count with their top 6 cm only, so that chairs, bins and pedestals may stand under them. An L is
its two arms; where its hand was not stated, of the hand that collides least.

Edge cases: fewer than two things: 0. Things without heights (annotated by hand) do not count.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import combinations

from code_as_room.pipeline.geometry.polygon import area, intersection_area

from .areas import Polygon
from .categories import kinds
from .rooms import Room, Thing

SHRINK = 0.01
TABLE_TOP = 0.06
COLLISION = 0.03
_TABLES, _SOLID, _SOFT = {"tables", "desks"}, {"kitchens", "cabinets"}, {"bedding", "textiles", "clothing"}


@dataclass(frozen=True)
class _Prism:
    thing: Thing
    outline: Polygon
    base: float
    top: float

    @property
    def volume(self) -> float:
        return area(self.outline) * (self.top - self.base)


def self_overlap(room: Room) -> float:
    """Shared volume / volume of all things."""
    prisms = _prisms(room)
    whole = sum(prism.volume for prism in prisms)
    return min(1.0, sum(shared for _, _, shared in _shared(room, prisms)) / whole) if whole > 0 else 0.0


def colliding(room: Room) -> float:
    """Share of the things that lie inside another by more than 3 % of the smaller one's volume."""
    prisms = _prisms(room)
    hit: set[str] = set()
    for a, b, shared in _shared(room, prisms):
        if shared > COLLISION * min(a.volume, b.volume):
            hit |= {a.thing.id, b.thing.id}
    return len(hit) / len(prisms) if prisms else 0.0


def collisions(room: Room) -> list[tuple[str, str, float]]:
    """Pairs of ids and the volume that they share, m3, largest first."""
    found = [(a.thing.id, b.thing.id, shared) for a, b, shared in _shared(room, _prisms(room))]
    return sorted(found, key=lambda item: -item[2])


def _prisms(room: Room) -> list[_Prism]:
    found = []
    for thing in room.things:
        if thing.base is None or thing.top is None or thing.flat:
            continue
        outline = _shrunk(thing, _hand(room, thing))
        base, top = thing.base + SHRINK, thing.top - SHRINK
        if outline and top > base:
            found.append(_Prism(thing, outline, base, top))
    return found


def _hand(room: Room, thing: Thing) -> Polygon:
    """Its outline, of an L the one that shares less floor with others."""
    others = [t for t in room.things if t is not thing and not t.flat and t.placement == "floor"]
    if thing.mirrored is None:
        return thing.outline
    return min(thing.hands, key=lambda hand: sum(intersection_area(hand, other.outline) for other in others))


def _shrunk(thing: Thing, outline: Polygon) -> Polygon:
    """The outline with each side about 1 cm further in; empty when nothing is left."""
    (ax, ay), (bx, by), (cx, cy) = thing.rectangle[:3]
    width, depth = math.hypot(bx - ax, by - ay), math.hypot(cx - bx, cy - by)
    if min(width, depth) <= 2 * SHRINK:
        return []
    ux, uy = (bx - ax) / width, (by - ay) / width
    x, y = thing.centre
    across, along = 1 - 2 * SHRINK / width, 1 - 2 * SHRINK / depth
    points = []
    for px, py in outline:
        u, v = (px - x) * ux + (py - y) * uy, (py - y) * ux - (px - x) * uy
        points.append((x + u * across * ux - v * along * uy, y + u * across * uy + v * along * ux))
    return points


def _shared(room: Room, prisms: list[_Prism]) -> list[tuple[_Prism, _Prism, float]]:
    found = []
    ancestors = {prism.thing.id: _ancestors(room, prism.thing) for prism in prisms}
    for a, b in combinations(prisms, 2):
        one, other = a.thing, b.thing
        if other.id in ancestors[one.id] or one.id in ancestors[other.id]:
            continue
        if kinds(one.category) & _SOFT and kinds(other.category) & _SOFT:
            continue
        height = min(a.top, b.top) - max(_lower_end(a), _lower_end(b))
        if height > 0 and (shared := height * intersection_area(a.outline, b.outline)) > 1e-9:
            found.append((a, b, shared))
    return found


def _lower_end(prism: _Prism) -> float:
    """Where a thing begins to be in others' way: a table with the underside of its top."""
    said = kinds(prism.thing.category)
    return max(prism.base, prism.top + SHRINK - TABLE_TOP) if said & _TABLES and not said & _SOLID else prism.base


def _ancestors(room: Room, thing: Thing) -> set[str]:
    found: set[str] = set()
    parent = thing.parent
    while parent is not None and parent not in found:
        found.add(parent)
        parent = room.by_id[parent].parent if parent in room.by_id else None
    return found
