# SPDX-License-Identifier: GPL-3.0-or-later
"""The colour of light of a temperature: candles are orange, noon is white, a northern sky is blue."""

from __future__ import annotations

NEUTRAL = 6500.0  # kelvin; what a screen's white is


def kelvin_colour(kelvin: float) -> tuple[float, float, float]:
    """Linear Rec.709 colour of a black body of luminance 1, (1, 1, 1) for 0 or less; held between 1000 and 20000 K.

    The locus is Kim et al.'s cubic spline in CIE xy (2002, US 7024034), moved so that 6500 K is white.
    """
    if kelvin <= 0.0:
        return (1.0, 1.0, 1.0)
    colour = _black_body(min(max(kelvin, 1667.0), 20_000.0))
    white = _black_body(NEUTRAL)
    scaled = [max(c, 0.0) / w for c, w in zip(colour, white, strict=True)]
    if kelvin < 1667.0:  # redder than the spline goes
        fade = max(kelvin, 1000.0) / 1667.0
        scaled = [scaled[0], scaled[1] * fade, scaled[2] * fade**2]
    luminance = 0.2126 * scaled[0] + 0.7152 * scaled[1] + 0.0722 * scaled[2]
    red, green, blue = (c / luminance for c in scaled)
    return (red, green, blue)


def light_colour(color: tuple[float, float, float], kelvin: float) -> tuple[float, float, float]:
    """A light's colour: its own times that of its temperature."""
    red, green, blue = (a * b for a, b in zip(color, kelvin_colour(kelvin), strict=True))
    return (red, green, blue)


def _black_body(kelvin: float) -> list[float]:
    """Linear Rec.709 at Y = 1."""
    t = 1000.0 / kelvin
    if kelvin <= 4000.0:
        x = ((-0.2661239 * t - 0.2343589) * t + 0.8776956) * t + 0.179910
    else:
        x = ((-3.0258469 * t + 2.1070379) * t + 0.2226347) * t + 0.240390
    if kelvin <= 2222.0:
        y = ((-1.1063814 * x - 1.34811020) * x + 2.18555832) * x - 0.20219683
    elif kelvin <= 4000.0:
        y = ((-0.9549476 * x - 1.37418593) * x + 2.09137015) * x - 0.16748867
    else:
        y = ((3.0817580 * x - 5.87338670) * x + 3.75112997) * x - 0.37001483
    big_x, big_z = x / y, (1.0 - x - y) / y
    rows = ((3.2404542, -1.5371385, -0.4985314), (-0.9692660, 1.8760108, 0.0415560), (0.0556434, -0.2040259, 1.0572252))
    return [a * big_x + b + c * big_z for a, b, c in rows]
