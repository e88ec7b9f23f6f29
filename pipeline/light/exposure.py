# SPDX-License-Identifier: GPL-3.0-or-later
"""The exposure with which a render's floor and walls are as bright as the picture's.

Both are compared on the screen: what the light would look like under the view transform, with what the picture shows at the
same places. Middle values decide, so that a sunny patch or a dark corner does not.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from ..artifacts.layout import LightLine
from ..artifacts.light import Brightness
from ..geometry.polygon import Floats
from .bulk import Bools, Ints
from .estimate import irradiance
from .measure import LEAST_PLACES, Places, floor_and_walls
from .space import FLOOR, Space
from .tone import scene_light, shown

LEAST, MOST = -4.0, 4.0
"""Stops; lights that need more are wrong themselves."""
_FLOOR_WEIGHT = 0.75
GLOSS = 0.03
"""What surfaces give back beside their colour: the gloss that everything has."""
_GREY = 0.36
"""Linear light on the screen that floor and walls have together where there is no picture to go by."""


def matched(
    space: Space, lights: Sequence[LightLine], sky: float, places: Places | None, transform: str, look: str
) -> tuple[float, list[Brightness]]:
    """The exposure in stops, and how bright floor and walls are with it and without.

    Without enough places of the picture, floor and walls are made as bright as they usually are.
    """
    seen = places.only(places.is_floor | places.is_wall) if places is not None else None
    if seen is not None and len(seen.points) < LEAST_PLACES:
        seen = None
    points, normals, surface = (seen.points, seen.normals, seen.surface) if seen is not None else floor_and_walls(space)
    arriving = irradiance(space, lights, sky, points, normals)
    light = arriving.lights.sum(axis=0) + arriving.sky
    gives = light * (space.albedo_of(np.asarray(surface).astype(np.int64)) + GLOSS) / math.pi
    if seen is None:
        target = scene_light(on_screen(np.array([_GREY])), transform, look)[0]
        return _held(math.log2(target / max(float(np.median(gives)), 1e-6))), []
    groups = _groups(np.asarray(surface).astype(np.int64))
    wanted = scene_light(on_screen(seen.light), transform, look)
    stops, weights = [], []
    for about, mask in groups.items():
        stops.append(float(np.median(np.log2(wanted[mask] / np.maximum(gives[mask], 1e-6)))))
        weights.append(_FLOOR_WEIGHT if about == "floor" else 1.0 - _FLOOR_WEIGHT)
    exposure = _held(float(np.average(stops, weights=weights)))
    report = []
    for about, mask in groups.items():
        now = [float(np.median(shown(gives[mask] * 2.0**ev, transform, look))) for ev in (0.0, exposure)]
        picture = float(np.median(on_screen(seen.light[mask])))
        kind = "floor" if about == "floor" else "walls"
        report.append(
            Brightness(about=kind, picture=round(picture, 3), before=round(now[0], 3), after=round(now[1], 3),
                       places=int(mask.sum()))
        )  # fmt: skip
    return exposure, report


def _groups(surface: Ints) -> dict[str, Bools]:
    """Floor and walls, those of which there are enough places."""
    found = {"floor": surface == FLOOR, "walls": surface != FLOOR}
    kept = {name: mask for name, mask in found.items() if mask.sum() >= LEAST_PLACES}
    return kept or {"floor" if found["floor"].sum() >= found["walls"].sum() else "walls": np.ones(len(surface), bool)}


def _held(stops: float) -> float:
    return round(min(MOST, max(LEAST, stops)), 3)


def on_screen(light: Floats) -> Floats:
    """Linear screen light as the screen's values, 0..1."""
    return shown(light, "Standard")
