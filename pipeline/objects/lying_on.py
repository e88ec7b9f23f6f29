# SPDX-License-Identifier: GPL-3.0-or-later
"""What stands and lies on an object, as boxes in the object's own frame: the picture shows nothing of what is below."""

from __future__ import annotations

import math

from ..artifacts.layout import Layout, ProxyLine
from ..program.prelude.operations import material, move, turn
from ..program.prelude.shape import Shape, flat_shapes
from ..program.prelude.solids import box

COVER = "marker"
"""The material role of these boxes, which has no colour of a picture."""


def covers_of(proxy: ProxyLine, layout: Layout) -> list[Shape]:
    """A box for each thing that an object carries; none for what hangs on a wall or from the ceiling."""
    if proxy.placement in ("wall", "ceiling"):
        return []
    found: list[Shape] = []
    turned = math.radians(-proxy.yaw)
    floor = proxy.centre[2] - proxy.size[2] / 2
    for other in layout.proxies:
        if other.parent != proxy.id:
            continue
        x, y = other.centre[0] - proxy.centre[0], other.centre[1] - proxy.centre[1]
        at = (
            x * math.cos(turned) - y * math.sin(turned),
            x * math.sin(turned) + y * math.cos(turned),
            other.centre[2] - floor,
        )
        size = tuple(max(float(v), 0.002) for v in other.size)
        found += flat_shapes("covers", material(COVER, move(turn(box(size), other.yaw - proxy.yaw), at)))
    return found
