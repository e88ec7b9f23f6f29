# SPDX-License-Identifier: GPL-3.0-or-later
"""Points and things in the frame of a thing: origin at the middle of its base, turned as it is.

Frame of the room: metres, z up; yaw in degrees counter-clockwise.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

from ..artifacts.layout import ProxyLine


def base_of(proxy: ProxyLine) -> float:
    """Height of a proxy's underside."""
    return proxy.centre[2] - proxy.size[2] / 2


def to_local(carrier: ProxyLine, point: Sequence[float]) -> tuple[float, float]:
    """A point of the room in the frame of a thing (origin at the middle of its base)."""
    angle = math.radians(-carrier.yaw)
    dx, dy = point[0] - carrier.centre[0], point[1] - carrier.centre[1]
    return dx * math.cos(angle) - dy * math.sin(angle), dx * math.sin(angle) + dy * math.cos(angle)


def to_room(carrier: ProxyLine, point: Sequence[float]) -> tuple[float, float]:
    """The inverse of `to_local`."""
    angle = math.radians(carrier.yaw)
    x = carrier.centre[0] + point[0] * math.cos(angle) - point[1] * math.sin(angle)
    return x, carrier.centre[1] + point[0] * math.sin(angle) + point[1] * math.cos(angle)


def moved_along(proxy: ProxyLine, axis: int, shift: float) -> ProxyLine:
    """A thing moved by so many metres along its width (axis 0) or its depth (1)."""
    way = math.radians(proxy.yaw) + axis * math.pi / 2
    centre = proxy.centre[0] + shift * math.cos(way), proxy.centre[1] + shift * math.sin(way), proxy.centre[2]
    return proxy.model_copy(update={"centre": centre})
