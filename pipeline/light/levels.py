# SPDX-License-Identifier: GPL-3.0-or-later
"""How bright each part of a room is: the light under a part's ceiling, so that no part is darker than the picture shows it."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from ..artifacts.common import Metres2
from ..artifacts.layout import LightLine
from ..geometry.polygon import Floats
from .estimate import irradiance
from .exposure import GLOSS, on_screen
from .measure import LEAST_PLACES, Places
from .space import Bools, Space
from .tone import scene_light

_LEAST, _MOST = 0.5, 3.0
"""Times the light that all parts would have alike."""
_ROUNDS = 2
_BESIDE = 0.3  # metres round a panel that are lit by it as what is under it


def levelled(
    space: Space, lights: Sequence[LightLine], sky: float, places: Places | None, transform: str, look: str
) -> list[LightLine]:
    """The lights, those under the ceiling stronger or weaker where the picture's floor and walls are.

    Where there are those of one part of the room only, they stay as they are: how bright the whole room is is the exposure's.
    """
    fills: dict[Metres2, list[int]] = {}
    for n, light in enumerate(lights):
        if is_fill(light):
            fills.setdefault(light.at[:2], []).append(n)
    seen = places.only(places.is_floor | places.is_wall) if places is not None else None
    if len(fills) < 2 or seen is None or len(seen.points) < LEAST_PLACES:
        return list(lights)
    arriving = irradiance(space, lights, sky, seen.points, seen.normals)
    albedo = space.albedo_of(np.asarray(seen.surface).astype(np.int64))
    wanted = scene_light(on_screen(seen.light), transform, look) * math.pi / (albedo + GLOSS)
    factors = dict.fromkeys(fills, 1.0)
    under = {at: below(lights[max(of, key=lambda n: lights[n].size)], seen.points) for at, of in fills.items()}
    for _ in range(_ROUNDS):
        changed = arriving.lights.copy()
        for at, factor in factors.items():
            changed[fills[at]] *= factor
        total = changed.sum(axis=0) + arriving.sky
        whole = float(np.median(wanted / np.maximum(total, 1e-6)))
        for at, mask in under.items():
            if mask.sum() >= LEAST_PLACES:
                needed = float(np.median(wanted[mask] / whole))
                rest = float(np.median((total - changed[fills[at]].sum(axis=0))[mask]))
                own = max(float(np.median(arriving.lights[fills[at]].sum(axis=0)[mask])), 1e-6)
                factors[at] = min(_MOST, max(_LEAST, (needed - rest) / own))
    return [
        light.model_copy(update={"energy": round(light.energy * factors[light.at[:2]], 2)}) if is_fill(light) else light
        for light in lights
    ]


def is_fill(light: LightLine) -> bool:
    """Whether a light is what a bright ceiling gives back: a panel that looks straight down and is part of nothing."""
    return light.kind == "area" and light.target is None and not light.parent


def below(light: LightLine, points: Floats) -> Bools:
    """Which places (N, 3) lie under a panel that looks down."""
    wide, deep = light.size / 2 + _BESIDE, (light.size_y or light.size) / 2 + _BESIDE
    found: Bools = (np.abs(points[:, 0] - light.at[0]) < wide) & (np.abs(points[:, 1] - light.at[1]) < deep)
    return found
