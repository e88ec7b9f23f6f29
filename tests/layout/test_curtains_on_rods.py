# SPDX-License-Identifier: GPL-3.0-or-later
"""Curtains reach up to the rod over them, whatever heights were guessed from above; all else stays."""

from __future__ import annotations

from code_as_room.pipeline.artifacts.layout import Layout, ProxyLine, RoomLine
from code_as_room.pipeline.layout.curtains import hung_from_rods

ROOM = RoomLine(size=(5, 4, 2.6), floor=[(-2.5, -2), (2.5, -2), (2.5, 2), (-2.5, 2)])


def thing(name: str, category: str, centre: tuple[float, ...], size: tuple[float, ...], yaw: float = 90) -> ProxyLine:
    return ProxyLine(id=name, category=category, centre=centre, size=size, yaw=yaw, placement="wall")  # type: ignore[arg-type]


ROD = thing("rod", "curtain rod", (-2.4, 0, 2.5), (3.0, 0.1, 0.05))


def ends(layout: Layout, name: str) -> tuple[float, float]:
    found = layout.proxy(name)
    assert found is not None
    return tuple(round(found.centre[2] + sign * found.size[2] / 2, 3) for sign in (-1, 1))  # type: ignore[return-value]


def test_curtains_below_and_above_their_rod_reach_its_middle_and_keep_their_hems() -> None:
    low = thing("low", "linen curtain", (-2.38, 1.2, 1.2), (0.6, 0.12, 2.3))
    high = thing("high", "white sheer curtain", (-2.4, -1.0, 1.3), (0.6, 0.12, 2.58))
    found = hung_from_rods(Layout(room=ROOM, proxies=[ROD, low, high]))
    assert ends(found, "low") == (0.05, 2.5) and ends(found, "high") == (0.01, 2.5)
    assert found.proxy("rod") == ROD
    assert hung_from_rods(found) == found


def test_what_is_elsewhere_held_or_no_curtain_stays() -> None:
    others = [
        thing("other_wall", "curtain", (0.5, 1.9, 1.2), (0.6, 0.12, 2.3), 0),
        thing("short", "cafe curtain", (-2.38, 0, 0.9), (0.6, 0.1, 0.6)),
        thing("picture", "picture", (-2.45, 0.2, 2.2), (0.5, 0.03, 0.4)),
        thing("held", "curtain", (-2.38, -0.5, 1.2), (0.6, 0.12, 2.3)),
    ]
    layout = Layout(room=ROOM, proxies=[ROD, *others])
    assert hung_from_rods(layout, {"held"}) == layout
