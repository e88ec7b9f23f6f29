# SPDX-License-Identifier: GPL-3.0-or-later
"""Clothes in a wardrobe reach up to the rail that they hang from: seen from above, nobody can tell how long they are."""

from __future__ import annotations

import re
from collections.abc import Sequence

import numpy as np

from ..artifacts.layout import ProxyLine
from ..geometry.polygon import Floats
from ..program.prelude.shape import Shape
from .choose import base_of, to_local

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
_LONGER = 1.7
"""Times as long as they were made."""


def reaching_rail(proxy: ProxyLine, carrier: ProxyLine, shapes: Sequence[Shape]) -> ProxyLine:
    """A row of clothes as long as it takes to hang from the rail above it; all else, and where there is no rail, as it is.

    Args:
        proxy: where it stands by now; carrier: what it is in, whose parts are `shapes`, in its own frame.
    """
    said = f"{proxy.category} {proxy.label}".replace("_", " ")
    if not _CLOTHES.search(said) or _FOLDED.search(said):
        return proxy
    x, y = to_local(carrier, proxy.centre[:2])
    base = base_of(proxy) - base_of(carrier)
    tops = [
        float(high[2]) + _HOOK
        for low, high in _rails(shapes)
        if low[0] - _BESIDE <= x <= high[0] + _BESIDE and low[1] - _OFF <= y <= high[1] + _OFF
    ]
    height = min((top - base for top in tops if top - base > proxy.size[2]), default=0.0)
    if not 0.0 < height <= _LONGER * proxy.size[2]:
        return proxy
    centre = (*proxy.centre[:2], base_of(proxy) + height / 2)
    return proxy.model_copy(update={"centre": centre, "size": (*proxy.size[:2], height)})


def _rails(shapes: Sequence[Shape]) -> list[tuple[Floats, Floats]]:
    """The boxes of bars that lie level: lowest and highest corner."""
    named = [s for s in shapes if len(s.vertices) and _RAIL.search(s.part.replace("_", " "))]
    boxes = [(s.vertices.min(axis=0), s.vertices.max(axis=0)) for s in named]
    return [
        (low, high) for low, high in boxes if high[2] - low[2] <= _THICK and np.ptp([low, high], axis=0).max() > 0.2
    ]
