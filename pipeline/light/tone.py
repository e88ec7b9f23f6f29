# SPDX-License-Identifier: GPL-3.0-or-later
"""From a pixel's brightness back to the light that made it, for the view transforms that Blender has.

The curves are of greys, measured in Blender 5.0 every half stop from 10 stops under middle grey (0.18) on; they are the
same in 4.5 and 5.2.
"""

from __future__ import annotations

import numpy as np

from ..geometry.polygon import Floats

AGX = "AgX"
MEDIUM_HIGH = "AgX - Medium High Contrast"
NEUTRAL = "Khronos PBR Neutral"
TRANSFORM, LOOK = NEUTRAL, ""
"""What finished rooms are shown with, where the picture was not shown through another one (`developed.tone_of`)."""
_FIRST, _STEP, _GREY = -10.0, 0.5, 0.18
_CURVES: dict[tuple[str, str], tuple[float, ...]] = {
    (AGX, ""): (
        0.0, 0.0, 0.0002, 0.0007, 0.0016, 0.0033, 0.0059, 0.01, 0.0163, 0.0258, 0.0402, 0.0588, 0.0805, 0.1059, 0.1357,
        0.171, 0.2126, 0.262, 0.3204, 0.3875, 0.4613, 0.5359, 0.6055, 0.6683, 0.7242, 0.7735, 0.8162, 0.8536, 0.8863,
        0.9151, 0.9404, 0.9627, 0.9824, 0.9994),
    (AGX, MEDIUM_HIGH): (
        0.0, 0.0, 0.0, 0.0, 0.0, 0.0002, 0.0009, 0.0022, 0.0047, 0.009, 0.0163, 0.0284, 0.0474, 0.0711, 0.1004, 0.1357,
        0.1785, 0.232, 0.2964, 0.373, 0.4613, 0.5505, 0.6318, 0.7024, 0.7638, 0.8162, 0.8603, 0.8984, 0.9308, 0.9584,
        0.9824, 1.0),
    ("Filmic", ""): (
        0.0, 0.0019, 0.0043, 0.0074, 0.0112, 0.0161, 0.0224, 0.0302, 0.04, 0.0522, 0.0675, 0.0864, 0.1095, 0.1376,
        0.1713, 0.2113, 0.2577, 0.3105, 0.3694, 0.4331, 0.5002, 0.5677, 0.6344, 0.6982, 0.7571, 0.8098, 0.8556, 0.8941,
        0.9256, 0.9505, 0.9697, 0.9838, 0.9937, 1.0),
    (NEUTRAL, ""): (
        0.0003, 0.0003, 0.0003, 0.0003, 0.0003, 0.0003, 0.0003, 0.0003, 0.0007, 0.0013, 0.0026, 0.0051, 0.0105, 0.0206,
        0.042, 0.0736, 0.1177, 0.1745, 0.2491, 0.328, 0.4113, 0.5021, 0.6026, 0.7167, 0.8432, 0.9391, 0.9705, 0.9823),
}  # fmt: skip
_GLOSS = 0.04
_BEFORE = np.linalg.inv(np.array(((0.6974, 0.2464, 0.0562), (0.0841, 0.8020, 0.1139), (0.0611, 0.1302, 0.8087))))
_AFTER = np.linalg.inv(np.array(((1.3893, -0.3213, -0.0680), (-0.1045, 1.1396, -0.0351), (-0.1016, -0.1571, 1.2587))))
"""What AgX does to linear light before its curve, and to what the curve gives, the other way round.

The matrices were fitted to 1500 random colours as Blender 5.0 shows them (AgX, Medium High Contrast): the colours come back to
within 3 % for nine of ten.
"""
_BRIGHTEST = 0.97
"""Brighter pixels are taken for this: what is burnt out could be of any brightness."""


def scene_light(screen: Floats, transform: str, look: str = "") -> Floats:
    """Linear light of grey pixels (0..1, as on the screen) under a view transform at exposure 0."""
    value = np.clip(np.asarray(screen, dtype=float), 0.0, _BRIGHTEST)
    curve = _CURVES.get((transform, look)) or _CURVES.get((transform, ""))
    if curve is None:
        return linear(value)
    stops = _FIRST + _STEP * np.arange(len(curve))
    start = next(i for i, v in enumerate(curve) if v > 0.0)
    result: Floats = _GREY * 2.0 ** np.interp(value, curve[start:], stops[start:])
    return result


def shown(light: Floats, transform: str, look: str = "") -> Floats:
    """The inverse: how bright grey light is on the screen, 0..1, at exposure 0."""
    curve = _CURVES.get((transform, look)) or _CURVES.get((transform, ""))
    value = np.maximum(np.asarray(light, dtype=float), 1e-6)
    if curve is None:
        clipped = np.clip(value, 0.0, 1.0)
        result: Floats = np.where(clipped <= 0.0031308, clipped * 12.92, 1.055 * clipped ** (1 / 2.4) - 0.055)
        return result
    result = np.interp(np.log2(value / _GREY), _FIRST + _STEP * np.arange(len(curve)), curve)
    return result


def coloured_light(seen: Floats, transform: str) -> Floats:
    """Linear light (N, 3) whose colours a view transform shows as these linear ones, but for the brightest.

    Khronos PBR Neutral takes away what a surface's gloss adds: up to 0.04 of every colour (its specification, 2024).
    AgX is led back with its Medium High Contrast; of the others only the hue is kept.
    """
    if transform == AGX:
        return led_back(shown(seen, "Standard"))
    least = np.maximum(seen.min(axis=-1, keepdims=True), 0.0)
    if transform != NEUTRAL:
        return seen
    before = np.where(least < _GLOSS, np.sqrt(least * _GLOSS) * 2.0, least + _GLOSS)
    result: Floats = seen + (before - least)
    return result


def led_back(screen: Floats) -> Floats:
    """The linear light (..., 3) that AgX with Medium High Contrast shows as these screen values (0..1)."""
    curve = np.clip(screen @ _AFTER.T, 0.0, 1.0)
    light: Floats = np.maximum(scene_light(curve, AGX, MEDIUM_HIGH) @ _BEFORE.T, 0.0)
    return light


def linear(screen: Floats) -> Floats:
    """sRGB screen values (0..1) as linear light."""
    value = np.asarray(screen, dtype=float)
    result: Floats = np.where(value <= 0.04045, value / 12.92, ((value + 0.055) / 1.055) ** 2.4)
    return result


def luminance(colours: Floats) -> Floats:
    """Of linear colours (..., 3)."""
    result: Floats = colours @ np.array((0.2126, 0.7152, 0.0722))
    return result
