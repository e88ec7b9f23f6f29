# SPDX-License-Identifier: GPL-3.0-or-later
"""Clothes in a wardrobe hang from its rail, down to what is below: seen from above, nobody can tell how long they are."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence

import numpy as np

from ..artifacts.layout import ProxyLine
from ..geometry.polygon import Floats
from ..program.prelude.shape import Shape
from .choose import Carriers, base_of, to_local
from .find import Surface

_CLOTHES = re.compile(
    r"\b(clothes|clothing|garments?|coats?|dress(es)?|shirts?|jackets?|suits?|blouses?)\b", re.IGNORECASE
)
_FOLDED = re.compile(r"\b(fold(ed)?|stack|pile|shoes?|hooks?)\b", re.IGNORECASE)
_RAIL = re.compile(r"\b(rails?|rods?|pole|bar)\b", re.IGNORECASE)
_THICK = 0.08
"""Metres that a rail may be high."""
_BESIDE, _OFF = 0.1, 0.35
"""Metres that the middle of a row may be past its rail's end, and before or behind it."""
_HOOK = 0.015
"""Metres by which a hanger's hook stands above its rail."""
_LEAST = 0.35
"""Metres that clothes are long at least."""


def is_hung(words: str) -> bool:
    """Whether a thing is clothes that hang, by what it is called."""
    said = words.replace("_", " ")
    return bool(_CLOTHES.search(said)) and not _FOLDED.search(said)


def under_rail(proxy: ProxyLine, carrier: ProxyLine, carriers: Carriers) -> ProxyLine | None:
    """A row of clothes hung from the rail over it, down to what is below; None for all else, and where that is no place.

    It keeps its place as seen from above. What stands below it (shoes) is not reached into.

    Args:
        carrier: what it is in; carriers: with all that stands there by now.
    """
    if not is_hung(f"{proxy.category} {proxy.label}"):
        return None
    x, y = to_local(carrier, proxy.centre[:2])
    tops = [
        base_of(carrier) + float(high[2]) + _HOOK
        for low, high in _rails(carriers.shapes.get(carrier.id, ()))
        if low[0] - _BESIDE <= x <= high[0] + _BESIDE and low[1] - _OFF <= y <= high[1] + _OFF
    ]
    if not tops:
        return None
    top = min(tops, key=lambda z: abs(z - base_of(proxy) - proxy.size[2]))
    levels = [base_of(carrier) + s.level for s in carriers.surfaces(carrier.id) if _is_over(s, x, y)]
    below = [level for level in levels if level < top - _LEAST]
    if not below:
        return None
    base = max([max(below), *(t for t in _tops_below(proxy, carrier, carriers) if max(below) < t < top - _LEAST)])
    return proxy.model_copy(
        update={
            "centre": (*proxy.centre[:2], (base + top) / 2),
            "size": (*proxy.size[:2], top - base),
            "parent": carrier.id,
            "placement": "surface",
        }
    )


def _is_over(surface: Surface, x: float, y: float) -> bool:
    """Whether there is some of a surface at a place, or right beside it."""
    column, row = surface.grid.index(x, y)
    near = surface.heights[max(0, column - 1) : column + 2, max(0, row - 1) : row + 2]
    return bool(column >= -1 and row >= -1 and np.isfinite(near).any())


def _tops_below(proxy: ProxyLine, carrier: ProxyLine, carriers: Carriers) -> list[float]:
    """Upper ends of what stands in the same carrier, where the outlines meet."""
    x, y = to_local(carrier, proxy.centre[:2])
    reach = min(proxy.size[:2]) / 2
    found = []
    for other in carriers.proxies.values():
        if other.parent == carrier.id and other.id != proxy.id and not is_hung(f"{other.category} {other.label}"):
            u, v = to_local(carrier, other.centre[:2])
            if math.hypot(u - x, v - y) < reach + max(other.size[:2]) / 2:
                found.append(base_of(other) + other.size[2])
    return found


def _rails(shapes: Sequence[Shape]) -> list[tuple[Floats, Floats]]:
    """The boxes of bars that lie level: lowest and highest corner."""
    named = [s for s in shapes if len(s.vertices) and _RAIL.search(s.part.replace("_", " "))]
    boxes = [(s.vertices.min(axis=0), s.vertices.max(axis=0)) for s in named]
    return [
        (low, high) for low, high in boxes if high[2] - low[2] <= _THICK and np.ptp([low, high], axis=0).max() > 0.2
    ]
