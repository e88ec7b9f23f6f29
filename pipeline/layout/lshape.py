# SPDX-License-Identifier: GPL-3.0-or-later
"""What an L really covers: two arms, so that something may stand in its missing corner."""

from __future__ import annotations

import math
from collections.abc import Sequence

from ..artifacts.common import Shape
from ..geometry.placement import Rect
from ..geometry.polygon import intersection_area

ARM = 0.45
"""Part of the depth (of the width) that the arm along the back (along a side) takes."""


def arms(rect: Rect, hand: float) -> tuple[Rect, Rect]:
    """The arm along the back, and the one that comes forward on the side of -X (hand -1) or +X (hand 1)."""
    back, forward = ARM * rect.depth, rect.depth * (1 - ARM)
    return (
        _part(rect, 0.0, (rect.depth - back) / 2, rect.width, back),
        _part(rect, hand * rect.width * (1 - ARM) / 2, -(rect.depth - forward) / 2, ARM * rect.width, forward),
    )


def _part(rect: Rect, x: float, y: float, width: float, depth: float) -> Rect:
    angle = math.radians(rect.yaw)
    dx, dy = x * math.cos(angle) - y * math.sin(angle), x * math.sin(angle) + y * math.cos(angle)
    return Rect(rect.x + dx, rect.y + dy, width, depth, rect.yaw)


def parts_of(rect: Rect, shape: Shape, others: Sequence[Rect]) -> tuple[Rect, ...]:
    """The arms of an L with its hand as fits best among other things; nothing for what covers its whole rectangle."""
    if shape != "l_shape":
        return ()

    def shared(hand: float) -> float:
        return sum(intersection_area(a.corners(), o.corners()) for a in arms(rect, hand) for o in others)

    return arms(rect, min((-1.0, 1.0), key=shared))
