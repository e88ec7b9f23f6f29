# SPDX-License-Identifier: GPL-3.0-or-later
"""Objects that reach out of the room."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial

import numpy as np

from ..geometry.placement import is_inside
from ..geometry.polygon import ensure_ccw
from ..light.space import inside
from .bodies import Body, Room
from .columns import Floats
from .faults import Fault, Knowledge, Mend, moved
from .places import places_for

OUT = 0.03
"""Metres that vertices may be outside of the floor's outline: plaster, skirting, an askew corner."""
IN_WALL = 0.2
"""The same for what hangs on a wall."""


def find(room: Room, knowledge: Knowledge) -> list[Fault]:
    """Objects whose vertices are outside of the floor's outline, and by how much."""
    found = []
    for body in room.bodies.values():
        if body.line.placement == "surface" and body.line.parent not in room.bodies and body.line.parent is not None:
            continue  # what stands on a window's sill is in the wall
        out = knowledge.remember(("out", body.id, body.line.centre), partial(_beyond, room, body))
        if out > (IN_WALL if body.line.placement == "wall" else OUT):
            found.append(Fault("outside", body.id, "", out, f"It reaches {100 * out:.0f} cm out of the room."))
    return found


def fix(room: Room, fault: Fault, knowledge: Knowledge) -> Iterator[Mend]:
    """The nearest places inside of the room; where its carrier is outside as well, that goes first."""
    body = room.bodies[fault.id]
    if any(_beyond(room, room.bodies[above]) > OUT for above in room.above(fault.id)):
        return
    for centre in places_for(room, body, knowledge):
        yield moved(room, fault.id, centre, "Brought back into the room.")


def _beyond(room: Room, body: Body) -> float:
    """Metres that an object's outermost vertex is out of the floor's outline, 0 inside."""
    if is_inside(body.rect, room.layout.room.floor):
        return 0.0
    points = np.concatenate([s.vertices for s in body.shapes])[:, :2]
    outline = np.array(ensure_ccw(room.layout.room.floor))
    out = points[~inside(outline, points)]
    return float(_to_edges(out, outline).max()) if len(out) else 0.0


def _to_edges(points: Floats, outline: Floats) -> Floats:
    """Distance of points (N, 2) to the nearest edge of an outline."""
    best = np.full(len(points), np.inf)
    for a, b in zip(outline, np.roll(outline, -1, axis=0), strict=True):
        along = b - a
        t = np.clip((points - a) @ along / max(float(along @ along), 1e-12), 0.0, 1.0)
        best = np.minimum(best, np.linalg.norm(points - (a + t[:, None] * along), axis=1))
    return best
