# SPDX-License-Identifier: GPL-3.0-or-later
"""How bright a room's floor and walls would be, without rendering: light followed from lamp to surface to surface.

Units are Blender's: an area light of W watts has the radiance W / (pi A), a point light the intensity W / (4 pi), a sun
of strength S gives S watts a square metre, a world of strength S the radiance S. Light is grey here.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ..artifacts.layout import LightLine
from ..geometry.polygon import Floats
from .room_parts import part_of
from .space import SKY, Space

RAYS = 24
"""Directions that are followed from each place; few, since hundreds of places are averaged."""
_ON_LIGHT = (3, 2)  # places along and across each light that are looked at from a place
_OFF = 2e-3  # metres above a surface
_MOST_GIVEN_BACK = 0.85
_SPREAD = 1.6
"""Metres round a place from which the light that bounces on there comes."""
_BOUNCES = 4
"""From one surface to another, that renders follow (`scene/shoot.py`): in a white room more would add half as much again."""


@dataclass(frozen=True)
class Arriving:
    """Irradiance at places (N): (lights, N) from each light and (N,) from the sky, bounces included."""

    lights: Floats
    sky: Floats
    direct: Floats


def irradiance(space: Space, lights: Sequence[LightLine], sky: float, places: Floats, normals: Floats) -> Arriving:
    """What arrives at places (N, 3) with normals (N, 3), watts a square metre.

    Args:
        sky: strength of the world.
    """
    chance = np.random.default_rng(7)
    origins = places + _OFF * normals
    direct = np.stack([_direct(space, light, origins, normals, chance, *_ON_LIGHT) for light in lights]) if lights else (
        np.zeros((0, len(places)))
    )  # fmt: skip
    count = len(places)
    ways = _hemisphere(np.repeat(normals, RAYS, axis=0), chance)
    starts = np.repeat(origins, RAYS, axis=0)
    distance, surface, facing = space.hit(starts, ways)
    met = surface != SKY
    albedo = space.albedo_of(surface)
    spots = starts[met] + ways[met] * distance[met, None] + _OFF * facing[met]
    bounced = np.zeros((len(lights), count * RAYS))
    for index, light in enumerate(lights):
        bounced[index, met] = albedo[met] * _direct(space, light, spots, facing[met], chance)
    once = bounced.reshape(len(lights), count, RAYS).mean(axis=2)
    passed = np.where(met, 0.0, space.let_through(starts, ways, np.full(len(ways), 1e6)))
    seen = passed.reshape(count, RAYS).mean(axis=1)
    from_sky = math.pi * sky * seen
    further, spread = np.zeros_like(once), np.zeros(count)
    # What bounces on keeps to a part of the room, and to where it is.
    parts = part_of(space, places)
    for part in np.unique(parts):
        here = parts == part
        given_back = min(_MOST_GIVEN_BACK, float(albedo.reshape(count, RAYS)[here].mean()))
        near = _nearness(places[here])
        further[:, here] = once[:, here] @ near * _series(given_back, _BOUNCES - 1)
        spread[here] = from_sky[here] @ near * _series(given_back, _BOUNCES)
    return Arriving(direct + once + further, from_sky + spread, direct)


def _nearness(places: Floats) -> Floats:
    """How much each place (N, 3) has of what bounces at the others, (N, N): columns add up to 1."""
    apart = ((places[:, None] - places[None]) ** 2).sum(axis=2)
    weights = np.exp(-apart / (2 * _SPREAD**2))
    result: Floats = weights / weights.sum(axis=0)
    return result


def _series(given_back: float, bounces: int) -> float:
    """What some bounces add to light of which this part is given back each time."""
    return sum(given_back**n for n in range(1, bounces + 1))


def _direct(
    space: Space, light: LightLine, origins: Floats, normals: Floats, chance: np.random.Generator, columns: int = 1,
    rows: int = 1,
) -> Floats:  # fmt: skip
    """What arrives straight from a light, (N,), by a place in each cell of it."""
    total = np.zeros(len(origins))
    if not len(origins):
        return total
    if light.kind == "sun":
        way = -aim(light)
        facing = normals @ way
        lit = facing > 0
        ways = np.broadcast_to(way, (int(lit.sum()), 3))
        far = np.full(len(ways), 1e6)
        free = ~space.blocked(origins[lit], ways, far) * space.let_through(origins[lit], ways, far)
        total[lit] = light.energy * facing[lit] * free
        return total
    for cell in np.ndindex(columns, rows):
        spots, spread = _on_light(
            light, (np.array(cell)[:, None] + chance.random((2, len(origins)))) / [[columns], [rows]]
        )
        towards = spots - origins
        length = np.maximum(np.linalg.norm(towards, axis=1), 1e-3)
        ways = towards / length[:, None]
        facing = np.maximum((ways * normals).sum(axis=1), 0.0)
        if light.kind == "area":
            radiance = light.energy / (math.pi * spread)
            value = radiance * spread * facing * np.maximum(-ways @ aim(light), 0.0) / length**2
            # However near a light is, no more can arrive than if it filled all that a place sees.
            value = np.minimum(value, math.pi * radiance)
        else:
            value = light.energy / (4 * math.pi) * facing / np.maximum(length, 0.05) ** 2
        lit = value > 0
        value[lit] *= ~space.blocked(origins[lit], ways[lit], length[lit] - 0.01, boxes=light.kind != "point")
        value[lit] *= space.let_through(origins[lit], ways[lit], length[lit])
        total += value / (columns * rows)
    return total


def _on_light(light: LightLine, where: Floats) -> tuple[Floats, float]:
    """Places on a light (N, 3), given along and across it (2, N), 0..1, and its area."""
    at = np.array(light.at, dtype=float)
    if light.kind != "area":
        return np.broadcast_to(at, (where.shape[1], 3)), 1.0
    forward = aim(light)
    side = np.cross((0.0, 1.0, 0.0) if abs(forward[2]) > 0.999 else (0.0, 0.0, 1.0), -forward)
    side /= np.linalg.norm(side)
    up = np.cross(-forward, side)
    width, height = max(light.size, 1e-3), max(light.size_y or light.size, 1e-3)
    a, b = where - 0.5
    return at + a[:, None] * width * side + b[:, None] * height * up, width * height


def aim(light: LightLine) -> Floats:
    """The way a light shines, a unit vector; straight down without a target."""
    if light.target is None:
        return np.array((0.0, 0.0, -1.0))
    way = np.array(light.target, dtype=float) - np.array(light.at, dtype=float)
    length = float(np.linalg.norm(way))
    result: Floats = way / length if length > 1e-9 else np.array((0.0, 0.0, -1.0))
    return result


def _hemisphere(normals: Floats, chance: np.random.Generator) -> Floats:
    """One direction for each normal (N, 3), as often as light arrives from there (cosine)."""
    count = len(normals)
    points = chance.normal(size=(count, 3))
    points /= np.linalg.norm(points, axis=1, keepdims=True)
    ways = normals + points * 0.999
    result: Floats = ways / np.linalg.norm(ways, axis=1, keepdims=True)
    return result
