# SPDX-License-Identifier: GPL-3.0-or-later
"""Objects that stand where a door opens or a passage leads."""

from __future__ import annotations

from collections.abc import Iterator

from .bodies import Room
from .faults import Fault, Knowledge, Mend, moved
from .meeting import clear_areas, in_the_way
from .places import places_for


def find(room: Room, knowledge: Knowledge) -> list[Fault]:
    """Objects on the floor in the way of doors."""
    found = {}
    for area in clear_areas(room, knowledge):
        for body in room.bodies.values():
            deep = in_the_way(body, area)
            if deep:
                said = f"It stands {100 * deep:.0f} cm into where {area.id} opens."
                found[body.id, area.id] = Fault("blocked", body.id, area.id, deep, said)
    return list(found.values())


def fix(room: Room, fault: Fault, knowledge: Knowledge) -> Iterator[Mend]:
    """The nearest places out of the way."""
    for centre in places_for(room, room.bodies[fault.id], knowledge):
        yield moved(room, fault.id, centre, f"Moved out of the way of {fault.other}.")
