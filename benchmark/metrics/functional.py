# SPDX-License-Identifier: GPL-3.0-or-later
"""Functional accuracy: how many parts of the room can be used for what they are for.

Paper: "functional accuracy", no formula. Here: share of the truth's zones (sleeping, desk work, ...) whose main thing and
at least half of whose members have a pair (strict or functional) that stands within the zone's box grown by 0.5 m.
`functional_soft` is the mean share of members found, 0 for a zone without its main thing.

Edge cases: a truth without zones: every thing on the floor larger than 0.5 m2 that is not a rug is a zone of its own.
None of those either: 1. Things that the picture does not show are no members.
"""

from __future__ import annotations

from code_as_room.pipeline.geometry.polygon import area, bounding_rectangle

from .matching import Comparison
from .rooms import Thing, Zone

MARGIN = 0.5
SMALLEST = 0.5


def functional_accuracy(comparison: Comparison) -> float:
    """Share of the zones that work."""
    shares = _shares(comparison)
    return sum(share >= 0.5 for share in shares) / len(shares) if shares else 1.0


def functional_soft(comparison: Comparison) -> float:
    """Mean share of the zones' members that were found."""
    shares = _shares(comparison)
    return sum(shares) / len(shares) if shares else 1.0


def _zones(comparison: Comparison) -> list[Zone]:
    asked = {thing.id for thing in comparison.asked}
    stated = [Zone(z.anchor, tuple(m for m in z.members if m in asked)) for z in comparison.truth.zones]
    stated = [zone for zone in stated if zone.anchor in asked]
    if stated:
        return stated
    large = [t for t in comparison.asked if t.placement == "floor" and not t.flat and area(t.rectangle) > SMALLEST]
    return [Zone(thing.id, (thing.id,)) for thing in large]


def _shares(comparison: Comparison) -> list[float]:
    shares = []
    for zone in _zones(comparison):
        members = [comparison.truth.by_id[m] for m in dict.fromkeys([zone.anchor, *zone.members])]
        corners = [corner for member in members for corner in member.rectangle]
        box = bounding_rectangle(corners)
        found = [m for m in members if _inside(comparison, m, box)]
        anchored = any(m.id == zone.anchor for m in found)
        shares.append(len(found) / len(members) if anchored else 0.0)
    return shares


def _inside(comparison: Comparison, thing: Thing, box: tuple[float, float, float, float]) -> bool:
    pair = comparison.pairs.get(thing.id)
    if pair is None:
        return False
    x, y = pair.found.centre
    return box[0] - MARGIN <= x <= box[2] + MARGIN and box[1] - MARGIN <= y <= box[3] + MARGIN
