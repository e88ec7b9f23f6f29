# SPDX-License-Identifier: GPL-3.0-or-later
"""Rooms to light: any rectangle, turned any way, with a window in any wall."""

from __future__ import annotations

import math

from code_as_room.pipeline.artifacts.layout import Layout, ProxyLine, RoomLine, WallLine, WindowLine


def rectangle(
    width: float,
    depth: float,
    turn: float = 0.0,
    windows: tuple[int, ...] = (),
    against: bool = False,
    height: float = 2.6,
) -> Layout:
    """A room whose walls are turned by degrees, with a window in the middle of each wall that is named by its number."""
    c, s = math.cos(math.radians(turn)), math.sin(math.radians(turn))
    corners = [(x * width / 2, y * depth / 2) for x, y in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
    floor = [(c * x - s * y, s * x + c * y) for x, y in corners]
    layout = Layout(room=RoomLine(size=(width, depth, height), floor=floor))
    for number, (a, b) in enumerate(zip(floor, floor[1:] + floor[:1], strict=True)):
        layout.walls.append(WallLine(id=f"wall_{number}", start=a, end=b, height=height))
        if number in windows:
            start, end = (tuple(p + t * (q - p) for p, q in zip(a, b, strict=True)) for t in (0.35, 0.65))
            start, end = (end, start) if against else (start, end)
            layout.windows.append(WindowLine(id=f"window_{number}", wall=f"wall_{number}", start=start, end=end))
    return layout


def thing(
    name: str, category: str, at: tuple[float, float], size: tuple[float, float, float], **more: object
) -> ProxyLine:
    """Something that stands on the floor."""
    return ProxyLine.model_validate(
        {"id": name, "category": category, "centre": (*at, size[2] / 2), "size": size} | more
    )
