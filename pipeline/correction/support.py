# SPDX-License-Identifier: GPL-3.0-or-later
"""Objects that float over, or are sunken into, what carries them."""

from __future__ import annotations

from collections.abc import Iterator

from .bodies import Room
from .faults import Fault, Knowledge, Mend, moved
from .held import gaps_of, is_held, wall_places
from .places import places_for


def find(room: Room, knowledge: Knowledge) -> list[Fault]:
    """Objects that are not held, and by how many metres."""
    found = []
    for body in room.bodies.values():
        if body.cloth:
            continue
        gaps = gaps_of(room, body, knowledge)
        if gaps is None:
            continue
        if not gaps:
            found.append(Fault("support", body.id, "", 10.0, "Nothing is below it that could carry it."))
            continue
        gap = min(gaps, key=abs)
        if not is_held(body, gap):
            how = "floats" if gap > 0 else "is sunken by"
            found.append(Fault("support", body.id, "", abs(gap), f"It {how} {100 * abs(gap):.1f} cm."))
    return found


def fix(room: Room, fault: Fault, knowledge: Knowledge) -> Iterator[Mend]:
    """Let down, lifted or drawn to its wall; where nothing is below it, a seat on what carries it."""
    body = room.bodies[fault.id]
    x, y, z = body.line.centre
    gaps = gaps_of(room, body, knowledge) or []
    if body.line.placement == "wall":
        for centre in wall_places(room, body):
            yield moved(room, fault.id, centre, "Put flush at its wall.")
        return
    for gap in sorted(set(gaps), key=abs):
        down = -gap if body.line.placement != "ceiling" else gap
        said = "Let down onto what carries it." if down < 0 else "Lifted out of what carries it."
        yield moved(room, fault.id, (x, y, z + down), said)
    if body.line.placement == "surface":
        for centre in places_for(room, body, knowledge):
            yield moved(room, fault.id, centre, "Put back onto what carries it.")
