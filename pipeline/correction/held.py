# SPDX-License-Identifier: GPL-3.0-or-later
"""How far an object is from what carries it: floor, rugs, ceiling, a wall, or another object's mesh."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from functools import partial

from ..artifacts.common import Metres3
from ..geometry.placement import support
from ..layout.faces import Face, face_gap, face_inward, wall_faces
from .bodies import Body, Room
from .columns import clearance
from .faults import Knowledge

TOLERANCE = 0.005
"""Metres that a thing may float or be sunken."""
SOFT_ABOVE, SOFT_IN = 0.01, 0.045
"""Metres that a soft thing may float over what carries it, and be pressed into it."""
_ALONG = 0.1  # metres between places along a wall


def is_held(body: Body, gap: float) -> bool:
    """Whether a body at this distance from what carries it rests on it; soft things may be pressed in."""
    if body.soft:
        return -SOFT_IN <= gap <= SOFT_ABOVE
    return abs(gap) <= TOLERANCE


def settled(room: Room, body: Body, knowledge: Knowledge) -> Metres3:
    """The centre of a body after it was let down or lifted, by little, onto what carries it."""
    x, y, z = body.line.centre
    gaps = gaps_of(room, body, knowledge) or []
    gap = min(gaps, key=abs, default=0.0)
    if body.line.placement in ("wall", "ceiling") or is_held(body, gap):
        return body.line.centre
    return x, y, z - gap


def gaps_of(room: Room, body: Body, knowledge: Knowledge) -> list[float] | None:
    """Distances in metres to all that may hold a body, below zero where it is sunken in; None where that is not judged."""
    placement, parent = body.line.placement, body.line.parent
    if placement == "ceiling":
        return None if parent in room.bodies else [room.height - body.high]
    if placement == "wall":
        return None if parent in room.bodies or not room.layout.walls else [gap for gap, _ in wall_gaps(room, body)[:1]]
    if placement == "floor":
        return [body.low, *_onto(body, [b for b in room.flat if b.id != body.id], knowledge)]
    if parent is not None and parent not in room.bodies:
        return None
    return _on_surface(room, body, knowledge)


def _on_surface(room: Room, body: Body, knowledge: Knowledge) -> list[float]:
    """To its parent; where it does not touch that, to what else lies there."""
    parent = room.bodies.get(body.line.parent or "")
    first = _onto(body, [parent], knowledge) if parent is not None else []
    if first and is_held(body, first[0]):
        return first
    below = {body.id, *room.below(body.id)}
    others = [o for i, o in room.bodies.items() if i not in below and o is not parent]
    if parent is not None:
        family = {parent.id, *room.above(parent.id)}
        others = [o for o in others if o.line.parent in family or o.id in family]
    rest = _onto(body, others, knowledge)
    held = [gap for gap in rest if is_held(body, gap)]
    if held or parent is not None:
        return held or first
    return [body.low, *rest]


def _onto(body: Body, carriers: Sequence[Body], knowledge: Knowledge) -> list[float]:
    """Distances to carriers' meshes, of those that are below it."""
    found = []
    for carrier in carriers:
        apart = math.dist(body.rect[:2], carrier.rect[:2])
        if apart > (math.hypot(*body.rect[2:4]) + math.hypot(*carrier.rect[2:4])) / 2:
            continue
        key = ("gap", body.id, body.line.centre, carrier.id, carrier.line.centre)
        gap = knowledge.remember(key, partial(_gap, body, carrier))
        if gap is not None:
            found.append(gap)
    return found


def _gap(body: Body, carrier: Body) -> float | None:
    own, other = body.columns, carrier.columns
    return clearance(own, [other]) if own is not None and other is not None else None


def wall_gaps(room: Room, body: Body) -> list[tuple[float, Face]]:
    """Free space between a body and each wall that it hangs beside, nearest first."""
    found = []
    for _, face in wall_faces(room.layout.walls, body.rect[:2]):
        (ax, ay), (bx, by) = face
        length = max(1e-9, math.dist(*face))
        way = (bx - ax) / length, (by - ay) / length
        at = (body.rect.x - ax) * way[0] + (body.rect.y - ay) * way[1]
        if -1e-6 <= at <= length + 1e-6:
            found.append((face_gap(body.rect, face), face))
    # In a corner, the wall at its side does not hold it.
    behind = [g for g in found if _faces_into_room(body, g[1])]
    return sorted(behind or found, key=lambda g: abs(g[0]))


def _faces_into_room(body: Body, face: Face) -> bool:
    """Whether a body's back is to a wall's face."""
    inward, angle = face_inward(face), math.radians(body.line.yaw)
    return inward[0] * math.sin(angle) - inward[1] * math.cos(angle) > 0.9


def wall_places(room: Room, body: Body) -> Iterator[Metres3]:
    """Where a body would hang flush at the walls that it is turned to, nearest first."""
    x, y, z = body.line.centre
    found = []
    for _, face in wall_faces(room.layout.walls, body.rect[:2]):
        inward = face_inward(face)
        if not _faces_into_room(body, face):
            continue
        length = math.dist(*face)
        way = inward[1], -inward[0]
        half = support(body.rect, way)
        gap = face_gap(body.rect, face)
        at = (body.rect.x - face[0][0]) * way[0] + (body.rect.y - face[0][1]) * way[1]
        spots = {min(max(at + k * _ALONG, half), max(half, length - half)) for k in range(-12, 13)}
        for spot in spots:
            dx, dy = -inward[0] * gap + way[0] * (spot - at), -inward[1] * gap + way[1] * (spot - at)
            found.append((round(math.hypot(dx, dy), 6), (x + dx, y + dy, z)))
    yield from (centre for _, centre in sorted(found) if math.dist(centre, (x, y, z)) > 1e-5)
