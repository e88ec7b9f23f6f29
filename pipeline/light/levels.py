# SPDX-License-Identifier: GPL-3.0-or-later
"""How much of the light comes from where: from under each part's ceiling, in by the windows, from the sun.

A room's style says how it usually is (`lights.STYLES`). Here it is moved to what the picture shows: where floor and walls are
brighter near the windows, more of the light is the windows'; where one part of the room is darker, there is less under its
ceiling. What each light brings to each place is followed (`estimate.py`), and the strengths are found by least squares.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from ..artifacts.layout import LightLine
from ..geometry.polygon import Floats
from .bulk import Bools
from .estimate import irradiance
from .exposure import GLOSS, on_screen
from .measure import LEAST_PLACES, Places
from .space import Space
from .tone import scene_light

_BOUNDS = {"fill": (0.3, 3.0), "window": (0.4, 3.0), "sun": (0.3, 2.5)}
"""Least and most times what the style says."""
_FLOOR_WEIGHT = 0.7
"""Walls are seen at a slant, and much hangs on them."""
_STAY = 0.005
"""How much staying as the style says counts, beside all places together."""
_FAR_OFF = 0.25
"""Places that are farther off than this part of their light count less: rugs that nobody said, shadows of what is not there."""
_ROUNDS, _STEPS = 8, 12


def levelled(
    space: Space, lights: Sequence[LightLine], sky: float, places: Places | None, transform: str, look: str,
    held: int = 0,
) -> list[LightLine]:  # fmt: skip
    """The lights, each group stronger or weaker as the picture's floor and walls show it.

    With one group only, or too few places, they stay as they are: how bright the whole room is is the exposure's.

    Args:
        held: how many of the first lights are the artist's, and stay.
    """
    groups: dict[tuple[str, float, float], list[int]] = {}
    for n, light in enumerate(lights):
        kind = _kind(light)
        if kind and n >= held:
            groups.setdefault((kind, *(light.at[:2] if kind == "fill" else (0.0, 0.0))), []).append(n)
    seen = places.only(places.is_floor | places.is_wall) if places is not None else None
    if len(groups) < 2 or seen is None or len(seen.points) < LEAST_PLACES:
        return list(lights)
    arriving = irradiance(space, lights, sky, seen.points, seen.normals)
    albedo = space.albedo_of(np.asarray(seen.surface).astype(np.int64))
    wanted = scene_light(on_screen(seen.light), transform, look) * math.pi / (albedo + GLOSS)
    brought = np.stack([arriving.lights[of].sum(axis=0) for of in groups.values()], axis=1)
    rest = arriving.lights.sum(axis=0) + arriving.sky - brought.sum(axis=1)
    bounds = np.array([_BOUNDS[kind] for kind, *_ in groups])
    strengths = _fitted(brought, rest, wanted, seen.is_floor, bounds)
    times = {n: float(s) for of, s in zip(groups.values(), strengths, strict=True) for n in of}
    return [
        light.model_copy(update={"energy": round(light.energy * times[n], 3)}) if n in times else light
        for n, light in enumerate(lights)
    ]


def _fitted(brought: Floats, rest: Floats, wanted: Floats, floor: Bools, bounds: Floats) -> Floats:
    """Strengths (G,) with which groups bring (N, G) what is wanted (N,) beside the rest, floor and walls each as a whole."""
    total = brought.sum(axis=1) + rest
    wanted, weights = wanted.copy(), np.zeros(len(wanted))
    for mask, weight in ((floor, _FLOOR_WEIGHT), (~floor, 1.0 - _FLOOR_WEIGHT)):
        if mask.any():  # what floor and walls give back is known less well than where each is brighter
            wanted[mask] *= float(np.median(total[mask] / np.maximum(wanted[mask], 1e-9)))
            weights[mask] = weight / mask.sum()
    shares, missing = brought / wanted[:, None], 1.0 - rest / wanted
    found = np.ones(brought.shape[1])
    for _ in range(_ROUNDS):
        counts = weights / np.maximum(1.0, np.abs(missing - shares @ found) / _FAR_OFF)
        matrix = shares.T @ (shares * counts[:, None]) + _STAY * np.eye(len(found))
        aim = shares.T @ (missing * counts) + _STAY
        for _ in range(_STEPS):
            for k in range(len(found)):
                best = (aim[k] - matrix[k] @ found + matrix[k, k] * found[k]) / matrix[k, k]
                found[k] = np.clip(best, *bounds[k])
    return found


def _kind(light: LightLine) -> str:
    """What kind of group a light belongs to; empty for lamps, which are as strong as lamps are."""
    if is_fill(light):
        return "fill"
    if light.kind == "sun":
        return "sun"
    return "window" if light.kind == "area" and light.target is not None and light.parent else ""


def is_fill(light: LightLine) -> bool:
    """Whether a light is what a bright ceiling gives back: a panel that looks straight down and is part of nothing."""
    return light.kind == "area" and light.target is None and not light.parent
