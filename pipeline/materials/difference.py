# SPDX-License-Identifier: GPL-3.0-or-later
"""How different two colours look (CIEDE2000), and their places in CIELAB (D65)."""

from __future__ import annotations

import math

from ..objects.colours import from_code

_WHITE = (0.95047, 1.0, 1.08883)
_TO_XYZ = ((0.4124564, 0.3575761, 0.1804375), (0.2126729, 0.7151522, 0.0721750), (0.0193339, 0.1191920, 0.9503041))
Lab = tuple[float, float, float]


def lab_of(code: str) -> Lab:
    """Six sRGB digits as CIELAB: lightness 0..100, a to red, b to yellow."""
    red, green, blue = (float(v) for v in from_code(code))
    x, y, z = ((r * red + g * green + b * blue) / white for (r, g, b), white in zip(_TO_XYZ, _WHITE, strict=True))
    fx, fy, fz = (v ** (1 / 3) if v > (6 / 29) ** 3 else v * (29 / 6) ** 2 / 3 + 4 / 29 for v in (x, y, z))
    return 116 * fy - 16, 500 * (fx - fy), 200 * (fy - fz)


def difference(one: str, other: str) -> float:
    """CIEDE2000 of two colours of six sRGB digits: below 1 nobody sees it, black to white is 100."""
    return difference_of_labs(lab_of(one), lab_of(other))


def difference_of_labs(one: Lab, other: Lab) -> float:
    """CIEDE2000 (CIE 142-2001) of two places in CIELAB."""
    l1, a1, b1 = one
    l2, a2, b2 = other
    mean7 = ((math.hypot(a1, b1) + math.hypot(a2, b2)) / 2) ** 7
    stretch = 1.5 - 0.5 * math.sqrt(mean7 / (mean7 + 25.0**7))
    c1, c2 = math.hypot(stretch * a1, b1), math.hypot(stretch * a2, b2)
    h1, h2 = (math.degrees(math.atan2(b, stretch * a)) % 360 if a or b else 0.0 for a, b in ((a1, b1), (a2, b2)))
    turn = (h2 - h1 + 180) % 360 - 180 if c1 * c2 else 0.0
    light, chroma = l2 - l1, c2 - c1
    hue = 2 * math.sqrt(c1 * c2) * math.sin(math.radians(turn / 2))
    mean_l, mean_c = (l1 + l2) / 2, (c1 + c2) / 2
    mean_h = (h1 + turn / 2) % 360 if c1 * c2 else h1 + h2
    t = (1 - 0.17 * _cos(mean_h - 30) + 0.24 * _cos(2 * mean_h) + 0.32 * _cos(3 * mean_h + 6)
         - 0.20 * _cos(4 * mean_h - 63))  # fmt: skip
    rotation = (
        -math.sin(math.radians(60 * math.exp(-(((mean_h - 275) / 25) ** 2))))
        * 2
        * math.sqrt(mean_c**7 / (mean_c**7 + 25.0**7))
    )
    s_l = 1 + 0.015 * (mean_l - 50) ** 2 / math.sqrt(20 + (mean_l - 50) ** 2)
    x, y, z = light / s_l, chroma / (1 + 0.045 * mean_c), hue / (1 + 0.015 * mean_c * t)
    return math.sqrt(max(0.0, x * x + y * y + z * z + rotation * y * z))


def _cos(degrees: float) -> float:
    return math.cos(math.radians(degrees))
