# SPDX-License-Identifier: GPL-3.0-or-later
"""How far a thing is from what carries it: rays from its underside (or its back) to the carrier's mesh.

The figure is a signed distance in metres: above zero the thing floats, below it sinks in. It is that of the nearest
place; a few single vertices do not count.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from mathutils import Vector

from .bodies import NUDGE, Body, BuiltRoom, Floats, cast, scattered

TOLERANCE = 0.005
"""Metres that a thing may float or sink."""
REACH = 3.0
_SAMPLES = 500
_NEAR = 0.05
_DOWN = np.array((0.0, 0.0, -1.0))


@dataclass(frozen=True)
class Contact:
    """How a thing is held.

    Attributes:
        gap: metres to the carrier, below zero it sinks; None when nothing is there at all.
        on: what carries it: an id, "floor", "wall", "ceiling", "" for nothing.
        named: whether that is what the room's program says.
    """

    gap: float | None
    on: str
    named: bool

    @property
    def held(self) -> bool:
        """Whether it touches, and does not sink in."""
        return self.gap is not None and abs(self.gap) <= TOLERANCE


def contact_of(room: BuiltRoom, body: Body) -> Contact:
    """What holds a thing, and how well."""
    if body.placement == "ceiling":
        return Contact(room.height - float(body.high[2]), "ceiling", True)
    if body.placement == "wall":
        gap = gap_between(body, room.walls, body.direction((0.0, 1.0, 0.0)))
        return Contact(gap, "wall" if gap is not None else "", True)
    if body.placement == "surface" and body.parent in room.things:
        return _on_surface(room, body)
    flat = [other for other in room.things.values() if other.flat and other.id != body.id]
    return _best(body, [("floor", room.floor, True), *((o.id, [o], True) for o in flat)])


def _on_surface(room: BuiltRoom, body: Body) -> Contact:
    """On its parent; where it does not touch that, on what lies on the parent beside it, on anything else, on the floor."""
    first = _best(body, [(body.parent, [room.things[body.parent]], True)])
    if first.held or (first.gap is not None and first.gap < 0):
        return first
    below = {body.id, body.parent, *room.below(body.id)}
    beside = [o for o in room.children(body.parent) if o.id not in below]
    second = _best(body, [(o.id, [o], True) for o in beside])
    if second.held or (second.gap is not None and second.gap < 0):
        return second
    others = [o for o in room.things.values() if o.id not in below and o not in beside]
    third = _best(body, [("floor", room.floor, False), *((o.id, [o], False) for o in others)])
    return third if third.held else first


def _best(body: Body, carriers: Sequence[tuple[str, Sequence[Body], bool]]) -> Contact:
    """The carrier that is nearest to touching."""
    found = []
    for name, meshes, named in carriers:
        gap = gap_between(body, meshes, _DOWN)
        if gap is not None:
            found.append(Contact(gap, name, named))
    return min(found, key=lambda c: abs(c.gap or 0.0), default=Contact(None, "", False))


def gap_between(body: Body, carriers: Sequence[Body], way: Floats) -> float | None:
    """Metres from a thing to its carrier along a direction; below zero where it sinks in; None where it never meets it."""
    starts = samples(body, way)
    along = (np.concatenate([b.points for b in carriers]) if carriers else np.zeros((0, 3))) @ way
    if not len(along) or float((starts @ way).min()) > float(along.max()) + NUDGE:
        return None
    found = []
    for carrier in carriers:
        if _beside(body, carrier, way):
            continue
        found += [g for start in starts if (g := _gap_at(start, carrier, way)) is not None]
    if not found:
        return None
    gaps = np.sort(np.array(found))
    near = int((gaps < _NEAR).sum())
    return float(gaps[min(len(gaps) - 1, max(2, near // 50))])


def _beside(body: Body, carrier: Body, way: Floats) -> bool:
    """Whether no ray along the direction can meet the carrier: their boxes do not overlap across it."""
    across = np.abs(way) < 0.5
    if across.sum() != 2:
        return False
    return bool(((body.low - NUDGE > carrier.high) | (body.high + NUDGE < carrier.low))[across].any())


def _gap_at(start: Floats, carrier: Body, way: Floats) -> float | None:
    point = start - way * NUDGE
    back = cast(carrier.tree, point, -way, REACH)
    ahead = cast(carrier.tree, point, way, REACH)
    if back is not None and back[1] and ahead is not None and ahead[1]:
        # Solid on both sides: the point is inside. What leans into a backrest is as deep as the way out is short.
        _, _, _, out = carrier.tree.find_nearest(Vector(point))
        return -(min(back[0], out if out is not None else back[0]) + NUDGE)
    if ahead is None or ahead[1]:
        return None
    return ahead[0] - NUDGE


def samples(body: Body, way: Floats) -> Floats:
    """Points on the faces that look along a direction, evenly by area, and the foremost vertices. Always the same."""
    corners = body.points[body.triangles]
    cross = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    size = np.linalg.norm(cross, axis=1)
    weight = np.where(cross @ way > 0.3 * size, size, 0.0)
    along = body.points @ way
    foremost = np.flatnonzero(along > along.max() - 0.003)
    dice = np.random.default_rng(7)
    if len(foremost) > _SAMPLES // 2:
        foremost = dice.choice(foremost, _SAMPLES // 2, replace=False)
    found = [body.points[foremost]]
    if weight.sum() > 0:
        found.append(scattered(corners, weight, _SAMPLES))
    return np.concatenate(found)
