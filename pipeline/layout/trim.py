# SPDX-License-Identifier: GPL-3.0-or-later
"""Small overlaps are measuring errors, or soft things that hang over: both sides give way where they meet.

Pushing a bench off a bed by the width of a duvet's overhang puts it visibly elsewhere than in the picture; trimming
the facing edges does not. Each side gives in proportion to the square of its extent, as its size is that much less sure.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Sequence
from itertools import combinations

from ..geometry.placement import Rect, penetration

MOST = 0.06
"""At most this part of an extent is trimmed; what still overlaps is for the solver to move."""


def trim(rects: Sequence[Rect], fixed: Collection[int], allowed: Collection[tuple[int, int]]) -> list[Rect]:
    """The rectangles with facing edges trimmed where they overlap a little.

    Args:
        fixed: indices that stay as they are; allowed: pairs of indices (a < b) that may overlap.
    """
    result = list(rects)
    free = set(allowed)
    for a, b in combinations(range(len(result)), 2):
        if (a, b) in free or (a in fixed and b in fixed):
            continue
        overlap = penetration(result[a], result[b])
        if overlap is None:
            continue
        depth, (nx, ny) = overlap
        sides = ((a, -nx, -ny), (b, nx, ny))
        give = [0.0 if i in fixed else _extent(result[i], x, y) ** 2 for i, x, y in sides]
        for (i, x, y), share in zip(sides, give, strict=True):
            limit = MOST * _extent(rects[i], x, y) - (_extent(rects[i], x, y) - _extent(result[i], x, y))
            result[i] = _cut(result[i], x, y, max(0.0, min(depth * share / sum(give), limit)))
    return result


def _axis(rect: Rect, x: float, y: float) -> tuple[bool, float]:
    """Which own axis runs most along a direction (True for its width), and the cosine between the two."""
    angle = math.radians(rect.yaw)
    along_x = math.cos(angle) * x + math.sin(angle) * y
    along_y = -math.sin(angle) * x + math.cos(angle) * y
    return (True, along_x) if abs(along_x) >= abs(along_y) else (False, along_y)


def _extent(rect: Rect, x: float, y: float) -> float:
    return rect.width if _axis(rect, x, y)[0] else rect.depth


def _cut(rect: Rect, x: float, y: float, amount: float) -> Rect:
    """The rectangle with the edge that faces (x, y) drawn in by `amount` metres."""
    if amount <= 0:
        return rect
    is_width, cosine = _axis(rect, x, y)
    sign = math.copysign(1.0, cosine)
    angle = math.radians(rect.yaw)
    ux, uy = (math.cos(angle), math.sin(angle)) if is_width else (-math.sin(angle), math.cos(angle))
    moved = rect.moved(-sign * ux * amount / 2, -sign * uy * amount / 2)
    return moved._replace(width=rect.width - amount) if is_width else moved._replace(depth=rect.depth - amount)
