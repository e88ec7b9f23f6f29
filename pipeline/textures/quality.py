# SPDX-License-Identifier: GPL-3.0-or-later
"""How good a texture is: how sharp it stayed, and how much its seams show."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .pixels import Mask, Pixels, blurred, blurred_inside, brightness, grown

_LEAST = 24
_STEPS, _JOINTS = 90, 99.5


def sharpness(made: Pixels, source: Pixels, seen: Mask) -> float:
    """Fine detail of what was made over that of what it was made from; 1 when nothing was lost."""
    core = ~grown(~seen, 2)
    light = brightness(source)
    before = np.abs(light - blurred_inside(light, seen, 1.5))[core]
    whole = brightness(made)
    after = np.abs(whole - blurred(whole, 1.5, wrap=True))
    return float(after.mean() / max(1e-6, float(before.mean()))) if before.size else 0.0


def seam_error(made: Pixels, owners: NDArray[np.int64]) -> float:
    """How much neighbouring pixels differ across seams, over the surface's own steps (joints, grain); below 1 none shows.

    The tile's own edges count as well: it is compared to itself beyond them.
    """
    light = brightness(made)
    worst = 0.0
    for axis in (0, 1):
        step = np.abs(light - np.roll(light, -1, axis=axis))
        seam = owners != np.roll(owners, -1, axis=axis)
        edge = np.zeros_like(seam)
        edge[(-1, slice(None)) if axis == 0 else (slice(None), -1)] = True
        own = step[~seam & ~edge]
        usual, joints = np.percentile(own, (_STEPS, _JOINTS)) if own.size else (0.0, 0.0)
        # What looks like one of the surface's own joints is no seam. Finer grain than the last is not seen at all.
        floor = max(float(usual), 0.5 * float(joints), 0.01)
        for places in (seam, edge):
            if places.sum() >= _LEAST:
                worst = max(worst, float(step[places].mean()) / floor)
    return worst
