# SPDX-License-Identifier: GPL-3.0-or-later
"""Where the sun stands: the direction whose light through the windows falls on the picture's bright floor."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from ..artifacts.layout import WindowLine
from ..geometry.polygon import Floats
from .bulk import Bools
from .lights import Sun, window_face
from .measure import Places
from .space import Space

SURE = 0.25
"""Correlation above which the picture is believed."""
_TURNS = (-60, -45, -30, -15, 0, 15, 30, 45, 60)  # degrees off the window's axis
_ELEVATIONS = (22, 30, 38, 46, 54, 62)
_LEAST = 4  # places that must lie in the light, and in the shade
USUAL_ELEVATION = 42.0
_USUAL_TURN = 22.0


def fitted_sun(space: Space, windows: Sequence[WindowLine], places: Places) -> Sun | None:
    """The sun that explains where the floor is bright, with how much brighter it is there; None without windows.

    Not sure (`Sun.sure` below `SURE`) where the picture's floor is lit evenly: then it comes through the largest window.
    """
    usual = usual_sun(space, windows)
    floor = places.only(~places.is_wall)
    if usual is None or len(floor.points) < 4 * _LEAST:
        return usual
    points = floor.points + np.array((0.0, 0.0, 2e-3))
    light = np.log(np.maximum(floor.light, 1e-3))
    for surface in np.unique(floor.surface):  # a rug is darker or brighter than the floor, sun or no sun
        own = floor.surface == surface
        light[own] -= np.median(light[own])
    best = usual
    suns = _suns(space, windows)
    if not suns:
        return usual
    ways = np.repeat(np.stack([sun.towards for sun in suns]), len(points), axis=0)
    lit = ~space.blocked(np.tile(points, (len(suns), 1)), ways, np.full(len(ways), 1e6))
    for sun, mask in zip(suns, lit.reshape(len(suns), -1), strict=True):
        found = _agreement(mask, light)
        if found is not None and found[0] > best.sure:
            best = Sun(sun.azimuth, sun.elevation, found[1], found[0])
    return best


def _suns(space: Space, windows: Sequence[WindowLine]) -> list[Sun]:
    """Every place of the sun that is tried out."""
    tried: dict[tuple[int, int], Sun] = {}
    for window in windows:
        face = window_face(space, window)
        if face is None:
            continue
        outwards = math.degrees(math.atan2(-face[0].normal[1], -face[0].normal[0]))
        for turn in _TURNS:
            for elevation in _ELEVATIONS:
                azimuth = round(outwards + turn) % 360
                tried[azimuth, elevation] = Sun(float(azimuth), float(elevation))
    return list(tried.values())


def usual_sun(space: Space, windows: Sequence[WindowLine]) -> Sun | None:
    """A sun that comes in by the largest window, from a little beside its axis; None without windows."""
    faces = [face for w in windows if (face := window_face(space, w)) is not None]
    if not faces:
        return None
    wall, _ = max(faces, key=lambda f: (f[1][1] - f[1][0]) * (f[1][3] - f[1][2]))
    outwards = math.degrees(math.atan2(-wall.normal[1], -wall.normal[0]))
    return Sun(round(outwards + _USUAL_TURN) % 360, USUAL_ELEVATION)


def sun_from(space: Space, windows: Sequence[WindowLine], degrees: float) -> Sun | None:
    """The sun in a direction that the model named, if it shines in by a window from there; else None."""
    for window in windows:
        face = window_face(space, window)
        if face is None:
            continue
        a = math.radians(degrees)
        if -face[0].normal[0] * math.cos(a) - face[0].normal[1] * math.sin(a) > 0.25:
            return Sun(degrees % 360, USUAL_ELEVATION)
    return None


def _agreement(lit: Bools, light: Floats) -> tuple[float, float] | None:
    """Correlation of lit places with bright ones, and how much brighter they are (0: not at all)."""
    if lit.sum() < _LEAST or (~lit).sum() < _LEAST:
        return None
    mask = lit.astype(float) - lit.mean()
    spread = float(np.sqrt((mask**2).sum() * (light**2).sum()))
    if spread < 1e-9:
        return None
    brighter = math.exp(float(np.median(light[lit]) - np.median(light[~lit]))) - 1.0
    return float((mask * (light - light.mean())).sum()) / spread, max(0.0, brighter)
