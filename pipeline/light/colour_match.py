# SPDX-License-Identifier: GPL-3.0-or-later
"""The colour of the light with which a render's floor and walls have the picture's colours.

What a picture's surfaces show is their paint, the light's colour, and the colour that floor and furniture throw on everything. The
paints were measured with all of that in them, so a light of the picture's own colour would count it twice: it is followed
for red, green and blue, as the exposure is for brightness, and what is too much is taken out of the daylight.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from ..artifacts.common import Metres3
from ..artifacts.layout import LightLine, WorldLine
from ..geometry.polygon import Floats
from ..program.prelude.kelvin import light_colour
from .albedo import LUMINANCE
from .bulk import Bools
from .estimate import irradiance
from .exposure import GLOSS
from .measure import LEAST_PLACES, Places
from .space import FLOOR, Space
from .tone import TRANSFORM, coloured_light

MOST = 0.3
"""The daylight's colour beside its temperature keeps within this of white."""
_FLOOR_WEIGHT = 0.5
_ROUNDS = 3
_BURNT, _BLACK = 0.9, 0.004  # linear; what is beyond has lost its hue


def matched_tint(
    spaces: Sequence[Space],
    lights: Sequence[LightLine],
    world: WorldLine,
    tinted: frozenset[str],
    places: Places | None,
    tint: Metres3,
    transform: str = TRANSFORM,
) -> Metres3:
    """The tint, luminance 1, that the tinted lights and the sky should have instead of `tint`, which they have now.

    Args:
        spaces: the room, giving back red, green and blue light. tinted: ids of the lights that have it.
        places: of the picture; `tint` is what comes back without enough of them. transform: that the room is shown with.
    """
    seen = places.only(_in_range(places)) if places is not None else None
    if seen is None or len(seen.points) < LEAST_PLACES:
        return tint
    wanted = np.log(np.maximum(coloured_light(seen.colours, transform), 1e-4))
    groups = _groups(seen)
    own, rest = _arriving(spaces, lights, world, tinted, seen, tint)
    now = np.array(tint, dtype=float)
    for _ in range(_ROUNDS):
        gives = np.log(np.maximum(own * now + rest, 1e-9))
        off = np.array([np.median((wanted - gives)[mask], axis=0) for mask in groups.values()])
        weights = [_FLOOR_WEIGHT if name == "floor" else 1.0 - _FLOOR_WEIGHT for name in groups]
        now = _held(now * np.exp(np.average(off, axis=0, weights=weights)))
    red, green, blue = (round(float(v), 4) for v in now)
    return (red, green, blue)


def _in_range(places: Places) -> Bools:
    """Places on floor and walls whose pixels are neither burnt out nor black in any colour."""
    in_range = (places.colours < _BURNT).all(axis=1) & (places.colours > _BLACK).all(axis=1)
    result: Bools = (places.is_floor | places.is_wall) & in_range
    return result


def _groups(seen: Places) -> dict[str, Bools]:
    """Floor and walls, those of which there are enough places."""
    floor: Bools = seen.surface == FLOOR
    kept = {name: mask for name, mask in (("floor", floor), ("walls", ~floor)) if mask.sum() >= LEAST_PLACES}
    return kept or {"walls": np.ones(len(floor), dtype=bool)}


def _arriving(
    spaces: Sequence[Space],
    lights: Sequence[LightLine],
    world: WorldLine,
    tinted: frozenset[str],
    seen: Places,
    tint: Metres3,
) -> tuple[Floats, Floats]:
    """What places give back (N, 3) of the lights that are tinted, for a white tint, and of all others."""
    own, rest = np.zeros((2, len(seen.points), 3))
    is_own = np.array([light.id in tinted for light in lights], dtype=bool)
    # What a light's temperature alone makes of it; the tint is multiplied on.
    untinted = [
        light_colour((1.0, 1.0, 1.0) if o else li.color, li.kelvin) for o, li in zip(is_own, lights, strict=True)
    ]
    colours = np.array(untinted).reshape(-1, 3)
    sky = light_colour((1.0, 1.0, 1.0) if world.color == tint else world.color, world.kelvin)
    for channel, space in enumerate(spaces):
        arriving = irradiance(space, lights, world.strength, seen.points, seen.normals)
        gives = (space.albedo_of(np.asarray(seen.surface).astype(np.int64)) + GLOSS) / math.pi
        each = arriving.lights * colours[:, channel, None]
        (own if world.color == tint else rest)[:, channel] += arriving.sky * sky[channel] * gives
        own[:, channel] += each[is_own].sum(axis=0) * gives
        rest[:, channel] += each[~is_own].sum(axis=0) * gives
    return own, rest


def _held(colour: Floats) -> Floats:
    """Of luminance 1, and near white."""
    for _ in range(2):
        colour = np.clip(colour / float(colour @ np.array(LUMINANCE)), 1.0 - MOST, 1.0 + MOST)
    result: Floats = colour
    return result
