# SPDX-License-Identifier: GPL-3.0-or-later
"""Looks of what light goes through, comes back from or comes out of: glass, mirror, water, screens, lamp shades."""

from __future__ import annotations

from typing import Any

from .checks import number
from .looks import Look, family, own_colour, share, toned
from .looks_cloth import threads
from .looks_grown import shades
from .maps import bump, colour_code, linear, noise_map


def glass(color: Any = "#EEF4F3", frost: Any = 0) -> Look:
    """Clear glass, thin enough that light goes straight through; `frost` 1 is milky."""
    code, colour = own_colour("glass", color)
    milky = share("glass", "frost", frost)
    return family("glass", code, {"frost": (milky, 0)}, base=colour, transmission=1.0, roughness=0.01 + 0.5 * milky, ior=1.2,
                  clear=1 - 0.75 * milky)  # fmt: skip


def mirror_glass(color: Any = "#E9EEEE") -> Look:
    """A mirror."""
    code, colour = own_colour("mirror_glass", color)
    return family("mirror_glass", code, {}, base=colour, metallic=1.0, roughness=0.0)


def water(color: Any = "#CFE3E8") -> Look:
    """Still water with faint ripples."""
    code, colour = own_colour("water", color)
    return family("water", code, {}, base=colour, transmission=1.0, roughness=0.02, ior=1.33, clear=0.8,
                  bump=bump(noise_map(0.12, 2), 0.002, 0.4))  # fmt: skip


def screen(color: Any = "#1D2127", strength: Any = 0) -> Look:
    """A dark glossy screen; with a `strength` it is on and shines in its colour."""
    code, colour = own_colour("screen", color)
    light = number("screen", "strength", strength, 0, 1000)
    lit = {"emission": colour, "strength": light} if light else {}
    base = toned(colour, 0.2) if light else colour
    return family("screen", code, {"strength": (light, 0)}, base=base, roughness=0.12, specular=0.5, coat=0.3, **lit)


def shade(color: Any = "#F3E5C4", strength: Any = 0.8, warm: Any = "#FFC890") -> Look:
    """A lamp shade of cloth or paper that glows; `strength` 0 is switched off, `warm` the colour of its light."""
    code, colour = own_colour("shade", color)
    light, lamp = number("shade", "strength", strength, 0, 1000), colour_code("shade", "warm", warm)
    glow_of = linear(lamp)
    tinted = (colour[0] * glow_of[0], colour[1] * glow_of[1], colour[2] * glow_of[2])
    lit = {"emission": tinted, "strength": light} if light else {}
    yarn = threads(0.0025, 10)
    return family("shade", code, {"strength": (light, 0.8), "warm": (lamp, "#FFC890")}, base=shades(yarn, colour, 0.1),
                  roughness=0.9, specular=0.2, through=0.6, **lit)  # fmt: skip


def glow(color: Any = "#FFE3B8", strength: Any = 6) -> Look:
    """What shines by itself: bulbs, candles' flames, light strips."""
    code, colour = own_colour("glow", color)
    light = number("glow", "strength", strength, 0, 1000)
    return family("glow", code, {"strength": (light, 6)}, base=colour, emission=colour, strength=light)
