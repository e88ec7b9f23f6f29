# SPDX-License-Identifier: GPL-3.0-or-later
"""The colour that the picture's light has beside its brightness."""

from __future__ import annotations

import numpy as np

from ..artifacts.common import Metres3
from ..artifacts.light import LightStyle
from ..geometry.polygon import Floats
from .tone import scene_light, shown

_MOST = 0.12
"""A room's light is hardly ever off white by more, once the eye has got used to it."""
_OUTSIDE: dict[LightStyle, tuple[float, float, float]] = {
    "evening": (0.30, 0.36, 0.50),
    "night": (0.03, 0.04, 0.07),
}
"""What is seen through a window when the sun is down, on the screen; by day it is what lies round the picture."""
_DAY = (0.93, 0.95, 0.97)
_LEAST_DAY = 0.8


def light_tint(gains: tuple[float, float, float] | None) -> Metres3:
    """The light's colour, luminance 1, from the gains on linear red, green and blue that take it out of the picture."""
    if gains is None or not all(np.isfinite(g) and g > 0 for g in gains):
        return (1.0, 1.0, 1.0)
    colour = 1.0 / np.array(gains, dtype=float)
    colour /= float(colour @ np.array((0.2126, 0.7152, 0.0722)))
    colour = np.clip(colour, 1.0 - _MOST, 1.0 + _MOST)
    red, green, blue = (round(float(v), 4) for v in colour)
    return (red, green, blue)


def background_light(seen: Floats | None, style: LightStyle, exposure: float, transform: str, look: str) -> Metres3:
    """The linear light of what a camera sees round the room and through its windows, so that it shows as wanted.

    Args:
        seen: linear colour of the picture's margin; None for a picture that tells nothing.
    """
    wanted = np.array(_OUTSIDE.get(style, _DAY))
    if seen is not None and style not in _OUTSIDE:
        margin = shown(np.asarray(seen, dtype=float), "Standard")
        if float(margin.mean()) > _LEAST_DAY:  # through a window, a dark margin would be the night
            wanted = margin
    red, green, blue = (round(float(v), 4) for v in scene_light(wanted, transform, look) / 2.0**exposure)
    return (red, green, blue)
