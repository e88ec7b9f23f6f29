# SPDX-License-Identifier: GPL-3.0-or-later
"""One colour for what is of one material: an entry of the palette has the colour that the picture shows of it.

Whoever names one oak for four things means one oak. Measured, each has a colour of its own, by the light where it stands, and what
is hidden has the one that was guessed. What is seen best of all of them decides.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ..objects.colours import from_code, to_code
from .difference import difference

SPREAD = 11.0
"""CIEDE2000 within which measured colours are of one material in more and less light."""
_OTHER = 30.0
"""CIEDE2000 from the palette's own colour, beyond which something else was measured."""


@dataclass(frozen=True)
class Sight:
    """One part of one thing: the colour measured on it, and how much of the room's picture it is, in square metres."""

    code: str
    weight: float


def seen_colour(said: str, sights: Sequence[Sight]) -> str:
    """The colour, six sRGB digits, of a palette's entry; the one that was said where the picture does not agree with itself.

    Args:
        said: six sRGB digits. sights: of the parts that are of this material.
    """
    near = [s for s in sights if s.weight > 0.0 and difference(s.code, said) < _OTHER]
    if not near:
        return said
    # The colour with which most of what is seen agrees.
    best = max(near, key=lambda s: sum(o.weight for o in near if difference(o.code, s.code) < SPREAD))
    agreeing = [s for s in near if difference(s.code, best.code) < SPREAD]
    weights = np.array([s.weight for s in agreeing])
    if weights.sum() < 0.5 * sum(s.weight for s in sights):
        return said
    return to_code(np.average([from_code(s.code) for s in agreeing], axis=0, weights=weights))
