# SPDX-License-Identifier: GPL-3.0-or-later
"""What kind of light the picture has: in the model's words where it answered, else as far as pixels tell."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ..artifacts.analysis import Finding
from ..artifacts.layout import ProxyLine, WindowLine
from ..artifacts.light import STYLES, LightReply, LightStyle
from .lights import Sun
from .measure import Places
from .space import Space
from .sunlight import SURE, fitted_sun, sun_from, usual_sun

WARMTHS = {"warm": 0.86, "neutral": 1.0, "cool": 1.12}
"""What daylight's kelvin are multiplied by."""
_SIDES = {"right": 0.0, "top right": 45.0, "top": 90.0, "top left": 135.0, "left": 180.0, "bottom left": 225.0,
          "bottom": 270.0, "bottom right": 315.0}  # fmt: skip
_DARK = 0.10
"""Linear light of the floor and the walls on the screen below which a picture is one of the night."""
_DIM = 0.2
_SUNNY = 0.45
"""Correlation of bright places with the sun's above which the picture is called sunny."""


@dataclass(frozen=True)
class Decision:
    """The light of the picture.

    Attributes:
        warmth: what daylight's kelvin are multiplied by; sun: where it stands, None without one.
        asked: whether the model said it.
    """

    style: LightStyle
    windows: list[WindowLine]
    lamps: list[ProxyLine]
    sun: Sun | None
    warmth: float
    asked: bool
    findings: list[Finding]


def decide(
    space: Space,
    places: Places | None,
    windows: Sequence[WindowLine],
    lamps: Sequence[ProxyLine],
    shining: Sequence[str],
    reply: LightReply | None,
) -> Decision:
    """What the light is.

    Args:
        windows, lamps: those that the room has. shining: ids of lamps that the picture shows as bright spots.
        reply: what the model said, None without an answer; unknown words and ids in it are passed over.
    """
    findings: list[Finding] = []
    fitted = fitted_sun(space, windows, places) if places is not None else usual_sun(space, windows)
    said = _known_style(reply.style) if reply is not None else None
    style = said or measured_style(places, fitted, bool(windows), bool(shining))
    lit = list(windows)
    on = {lamp.id for lamp in lamps if lamp.id in shining} if places is not None else {lamp.id for lamp in lamps}
    warmth, sun = 1.0, fitted
    if reply is not None:
        known = {w.id for w in windows} & set(reply.windows)
        lit = [w for w in windows if w.id in known] or lit
        on = {lamp.id for lamp in lamps} & set(reply.lamps_on)
        warmth = WARMTHS.get(reply.warmth.strip().lower(), 1.0)
        sun, more = _directed(space, lit, fitted, reply.sun_from)
        findings += more
    if style in ("evening", "night") and not on and lamps:
        on = {lamp.id for lamp in lamps}
    return Decision(style, lit, [lamp for lamp in lamps if lamp.id in on], sun, warmth, reply is not None, findings)


def measured_style(places: Places | None, sun: Sun | None, windows: bool, lamps: bool) -> LightStyle:
    """The style that the picture's brightness speaks for."""
    if places is None or not len(places.points):
        return "soft daylight" if windows else "studio"
    light = float(np.median(places.light))
    if light < _DARK and lamps:
        return "night"
    if light < _DIM and lamps and not _even(places):
        return "evening"
    if not windows:
        return "studio"
    return "sunny" if sun is not None and sun.sure > _SUNNY else "soft daylight"


def _even(places: Places) -> bool:
    """Whether the walls are lit alike, as they are by day."""
    walls = places.light[places.is_wall]
    return bool(len(walls) < 8 or np.percentile(walls, 80) < 2.5 * np.percentile(walls, 20))


def _known_style(words: str) -> LightStyle | None:
    plain = " ".join(words.lower().replace("_", " ").replace("-", " ").split())
    exact = next((style for style in STYLES if style == plain), None)
    if exact is not None or not plain:
        return exact
    return next((style for style in STYLES if style.split()[-1] in plain.split() or style in plain), None)


def _directed(
    space: Space, windows: Sequence[WindowLine], fitted: Sun | None, side: str
) -> tuple[Sun | None, list[Finding]]:
    """The sun on the side that the model named, unless the picture's bright places say better where it is."""
    plain = " ".join(side.lower().replace("-", " ").replace("upper", "top").replace("lower", "bottom").split())
    if plain not in _SIDES or fitted is None:
        return fitted, []
    named = _SIDES[plain]
    apart = abs((fitted.azimuth - named + 180.0) % 360.0 - 180.0)
    if fitted.sure >= SURE and apart <= 70.0:
        return fitted, []
    sun = sun_from(space, windows, named)
    if sun is None:
        message = f"The light was said to come from the {plain}, but no window lies there; it comes in by a window."
        return fitted, [Finding(about="light", message=message)]
    return sun, []
