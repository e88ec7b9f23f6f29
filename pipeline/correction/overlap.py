# SPDX-License-Identifier: GPL-3.0-or-later
"""Objects that run through each other, by what their meshes share of space."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from .bodies import Body, Room
from .faults import Fault, Knowledge, Mend, moved
from .meeting import shared_part
from .places import places_for


def find(room: Room, knowledge: Knowledge) -> list[Fault]:
    """Pairs that run through each other; a thing and what carries it do not count, nor do cloths and rugs."""
    bodies = [b for b in room.bodies.values() if not b.cloth and not b.flat]
    found = []
    for a, b in _near(bodies, room):
        if b.id in room.bodies and (b.id in room.above(a.id) or a.id in room.above(b.id)):
            continue
        part = shared_part(a, b, knowledge)
        if part > 0.0:
            said = f"It runs through {b.id} with {100 * part:.0f} % of the smaller of the two."
            found.append(Fault("overlap", a.id, b.id, part, said))
    return found


def _near(bodies: list[Body], room: Room) -> Iterator[tuple[Body, Body]]:
    """Pairs, also of bodies and partitions, whose outlines' circles and heights meet."""
    everything = [*bodies, *room.partitions]
    if not everything:
        return
    rects = np.array([b.rect[:4] for b in everything])
    spans = np.array([(b.low, b.high) for b in everything])
    reach = np.hypot(rects[:, 2], rects[:, 3]) / 2
    near = np.hypot(*(rects[:, None, :2] - rects[None, :, :2]).T) < reach[:, None] + reach
    near &= (spans[:, 0] < spans[:, None, 1]) & (spans[:, 1] > spans[:, None, 0])
    for i, j in np.argwhere(np.triu(near, 1)[: len(bodies)]).tolist():
        yield everything[i], everything[j]


def fix(room: Room, fault: Fault, knowledge: Knowledge) -> Iterator[Mend]:
    """The smaller of the two at its nearest free places, then the larger one."""
    pair = [room.bodies[i] for i in (fault.id, fault.other) if i in room.bodies]
    for body in sorted(pair, key=lambda b: b.rect.width * b.rect.depth):
        other = fault.other if body.id == fault.id else fault.id
        for centre in places_for(room, body, knowledge):
            yield moved(room, body.id, centre, f"Moved off {other}.")
