# SPDX-License-Identifier: GPL-3.0-or-later
"""Share of the things that lie (partly) outside of the room. Lower is better.

Not in the paper; SceneEval and SceneWeaver count it. Here: things with more than 5 % of their footprint outside of the
result's own floor, in its own metres; for what hangs on a wall, which may be let into it, more than 90 %. The direct
answer's floor is the one that it drew, scaled to its metres.

Edge cases: no things: 0. An L whose hand was not stated: of the hand that fits better.
"""

from __future__ import annotations

from code_as_room.pipeline.geometry.polygon import outside_fraction

from .rooms import Room

MOST = 0.05
MOST_ON_WALL = 0.90


def out_of_room(room: Room) -> list[str]:
    """Ids of the things that lie outside."""
    return [
        thing.id
        for thing in room.things
        if min(outside_fraction(hand, room.floor) for hand in thing.hands)
        > (MOST_ON_WALL if thing.placement == "wall" else MOST)
    ]


def out_of_bounds(room: Room) -> float:
    """Their share."""
    return len(out_of_room(room)) / len(room.things) if room.things else 0.0
