# SPDX-License-Identifier: GPL-3.0-or-later
"""CIEDE2000 of many pairs of colours at once (CIE 142-2001; Sharma, Wu, Dalal 2005), for D65 and the 2 degree observer."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

Floats = NDArray[np.float64]
_TO_XYZ = np.array(
    ((0.4124564, 0.3575761, 0.1804375), (0.2126729, 0.7151522, 0.0721750), (0.0193339, 0.1191920, 0.9503041))
)
_WHITE = np.array((0.95047, 1.0, 1.08883))
_ROUNDING = 1e-9  # degrees


def linear(encoded: ArrayLike) -> Floats:
    """sRGB values 0..1 as they are displayed, as light."""
    values = np.asarray(encoded, dtype=float)
    found: Floats = np.where(values <= 0.04045, values / 12.92, ((values + 0.055) / 1.055) ** 2.4)
    return found


def encoded(light: ArrayLike) -> Floats:
    """The inverse of `linear`, held to 0..1."""
    values = np.clip(np.asarray(light, dtype=float), 0.0, 1.0)
    found: Floats = np.where(values <= 0.0031308, values * 12.92, 1.055 * values ** (1 / 2.4) - 0.055)
    return found


def lab(light: ArrayLike) -> Floats:
    """Linear sRGB (..., 3) as CIELAB: lightness 0..100, a to red, b to yellow. Values above white are held to white."""
    xyz = np.clip(np.asarray(light, dtype=float), 0.0, 1.0) @ _TO_XYZ.T / _WHITE
    f = np.where(xyz > (6 / 29) ** 3, np.cbrt(xyz), xyz * (29 / 6) ** 2 / 3 + 4 / 29)
    x, y, z = f[..., 0], f[..., 1], f[..., 2]
    return np.stack((116 * y - 16, 500 * (x - y), 200 * (y - z)), axis=-1)


def ciede2000(one: ArrayLike, other: ArrayLike) -> Any:
    """The difference of places in CIELAB (..., 3): below 1 nobody sees it, black to white is 100."""
    l1, a1, b1 = np.moveaxis(np.asarray(one, dtype=float), -1, 0)
    l2, a2, b2 = np.moveaxis(np.asarray(other, dtype=float), -1, 0)
    stretch = 1.5 - 0.5 * _saturation((np.hypot(a1, b1) + np.hypot(a2, b2)) / 2)
    a1, a2 = stretch * a1, stretch * a2
    c1, c2 = np.hypot(a1, b1), np.hypot(a2, b2)
    h1, h2 = np.degrees(np.arctan2(b1, a1)) % 360, np.degrees(np.arctan2(b2, a2)) % 360
    grey = c1 * c2 == 0
    turn = np.where(grey, 0.0, (h2 - h1 + 180) % 360 - 180)
    # Of two hues opposite each other the definition takes the difference as it is; rounding must not decide.
    opposite = np.abs(np.abs(h2 - h1) - 180) < _ROUNDING
    turn = np.where(~grey & opposite, h2 - h1, turn)
    hue = 2 * np.sqrt(c1 * c2) * np.sin(np.radians(turn) / 2)
    mean_c = (c1 + c2) / 2
    far = np.abs(h1 - h2) > 180 + _ROUNDING
    mean_h = np.where(grey, h1 + h2, np.where(far, (h1 + h2 + np.where(h1 + h2 < 360, 360, -360)) / 2, (h1 + h2) / 2))
    t = (1 - 0.17 * _cos(mean_h - 30) + 0.24 * _cos(2 * mean_h) + 0.32 * _cos(3 * mean_h + 6)
         - 0.20 * _cos(4 * mean_h - 63))  # fmt: skip
    from_50 = ((l1 + l2) / 2 - 50) ** 2
    light = (l2 - l1) / (1 + 0.015 * from_50 / np.sqrt(20 + from_50))
    chroma, hue = (c2 - c1) / (1 + 0.045 * mean_c), hue / (1 + 0.015 * mean_c * t)
    turned = -2 * _saturation(mean_c) * np.sin(np.radians(60 * np.exp(-(((mean_h - 275) / 25) ** 2))))
    return np.sqrt(np.maximum(light**2 + chroma**2 + hue**2 + turned * chroma * hue, 0.0))


def _saturation(chroma: Any) -> Any:
    return np.sqrt(chroma**7 / (chroma**7 + 25.0**7))


def _cos(degrees: Any) -> Any:
    return np.cos(np.radians(degrees))
