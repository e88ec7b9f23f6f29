# SPDX-License-Identifier: GPL-3.0-or-later
"""What two bodies share of space, and what stands in a door's way."""

from __future__ import annotations

from ..geometry.placement import penetration
from ..layout.keep_clear import Clear, door_areas
from .bodies import Body, Room
from .columns import shared_volume
from .faults import Knowledge

DEEP = 0.01
"""Metres that outlines and heights may run into each other."""
SHARED = 0.02
SHARED_SMALL = 0.1
SHARED_SOFT = 0.75
"""Part of the smaller one's solid that two things may share: books lean into each other, cushions are pressed together."""
IN_THE_WAY = 0.06
"""Metres that a thing may reach into where a door opens."""


def shared_part(a: Body, b: Body, knowledge: Knowledge) -> float:
    """Part of the smaller one's solid that two things share, 0 where that is no more than things may."""
    if min(a.high, b.high) - max(a.low, b.low) <= DEEP:
        return 0.0
    deep = penetration(a.rect, b.rect)
    if deep is None or deep[0] <= DEEP:
        return 0.0

    def part() -> float:
        one, two = a.columns, b.columns
        if one is None or two is None:
            return 0.0
        smaller = min(one.volume, two.volume)
        share = shared_volume(one, two) / smaller if smaller > 0 else 0.0
        if a.soft and b.soft:
            return share if share > SHARED_SOFT else 0.0
        most = SHARED_SMALL if "surface" in (a.line.placement, b.line.placement) else SHARED
        return share if share > most else 0.0

    found: float = knowledge.remember(("share", a.id, a.line.centre, b.id, b.line.centre), part)
    return found


def in_the_way(body: Body, clear: Clear) -> float:
    """Metres that a thing on the floor reaches into where a door opens, 0 where that is no more than things may."""
    if body.line.placement != "floor" or body.flat or body.high <= clear.above:
        return 0.0
    deep = penetration(body.rect, clear.rect)
    return deep[0] if deep is not None and deep[0] > IN_THE_WAY else 0.0


def clear_areas(room: Room, knowledge: Knowledge) -> list[Clear]:
    """Where the room's doors open and its passages lead."""
    opened = {door.id: "in" for door in room.layout.doors if door.open}
    found: list[Clear] = knowledge.remember("doors", lambda: door_areas(room.layout, {**opened, **knowledge.swings}))
    return found
