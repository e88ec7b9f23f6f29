# SPDX-License-Identifier: GPL-3.0-or-later
"""The lights of a room: a sun, the sky in its windows, what the ceiling gives back, its lamps.

Every light is given the watts with which it lights the room as its part of the style says, by following it to the floor
(`estimate.py`): so a hall and a cupboard come out alike, and nothing is tuned to one room's size. `EVEN` is the irradiance
that an evenly lit floor has in all of them; what the picture shows beyond that is the exposure's.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from ..artifacts.common import Metres3
from ..artifacts.layout import LightLine, ProxyLine, WindowLine, WorldLine
from ..artifacts.light import LightStyle
from ..geometry.polygon import Floats
from ..program.prelude.shape import Shape
from .estimate import irradiance
from .lamps import bulbs
from .room_parts import rectangles
from .space import Space, Wall, inside

EVEN = 3.0
"""Watts a square metre on the floor."""
_INTO_ROOM = 0.03  # metres that a window's light stands off the wall's inner face, so that no frame swallows it
_UNDER_CEILING, _APART = 0.015, 0.01  # metres
_MARGINS = ((0.03, 0.01), (0.5, 0.16))
"""Between the light under the ceiling and the walls: metres, and of a narrow room's side. Two panels, one within the other, so
that it is softer towards the walls: one alone burns a rim into them where it is near, and leaves a dark one where it is not."""
_REACH = 0.6  # metres from a lamp at which its irradiance is what its style says
_GLASS = 0.92  # of a window's width and height that is not frame
_SUN_HEIGHT = 6.0  # metres; where the sun is drawn
_MOST_WATTS = 5000.0


@dataclass(frozen=True)
class Style:
    """How much of the light comes from where, in parts of `EVEN`.

    Attributes:
        fill: from under the ceiling; windows: through all of them; sun: where it falls, above the rest;
            lamps: at an arm's length from each; world: strength of the sky outside, in watts a square metre.
        sun_angle: degrees; its shadows are the softer the larger it is.
        kelvin: of the windows; fill_kelvin: of the fill; lamp_kelvin: of the lamps.
    """

    fill: float
    windows: float
    sun: float
    lamps: float
    world: float
    sun_angle: float
    kelvin: float
    fill_kelvin: float
    lamp_kelvin: float


STYLES: dict[LightStyle, Style] = {
    "soft daylight": Style(0.62, 0.38, 0.5, 0.45, 1.3, 12.0, 6800.0, 6500.0, 4000.0),
    "sunny": Style(0.55, 0.35, 1.6, 0.35, 1.3, 2.5, 6800.0, 6500.0, 4000.0),
    "overcast": Style(0.6, 0.4, 0.0, 0.4, 1.3, 20.0, 7000.0, 6600.0, 4000.0),
    "evening": Style(0.45, 0.12, 0.0, 1.1, 0.12, 10.0, 9000.0, 4600.0, 3000.0),
    "night": Style(0.25, 0.02, 0.0, 1.8, 0.02, 10.0, 11000.0, 3900.0, 2900.0),
    "studio": Style(0.9, 0.1, 0.0, 0.4, 1.3, 20.0, 6500.0, 6500.0, 4000.0),
}


@dataclass(frozen=True)
class Sun:
    """Where the sun stands: degrees counter-clockwise from +X, and above the horizon.

    Attributes:
        strength: how much brighter than the rest it makes what it falls on, 0 when only the style says.
        sure: how well the picture's bright places agree with it, -1..1.
    """

    azimuth: float
    elevation: float
    strength: float = 0.0
    sure: float = 0.0

    @property
    def towards(self) -> Floats:
        """Unit vector to the sun."""
        a, e = math.radians(self.azimuth), math.radians(self.elevation)
        return np.array((math.cos(a) * math.cos(e), math.sin(a) * math.cos(e), math.sin(e)))


@dataclass(frozen=True)
class Lit:
    """A room's lights.

    Attributes:
        lights: with their watts; world: the sky; sun: where it stands, None without one.
        windows, lamps: ids of what shines.
    """

    lights: list[LightLine]
    world: WorldLine
    sun: Sun | None
    windows: list[str]
    lamps: list[str]


def make_lights(
    space: Space,
    style: LightStyle,
    shapes: Mapping[str, Sequence[Shape]],
    lamps: Sequence[ProxyLine],
    windows: Sequence[WindowLine],
    sun: Sun | None,
    tint: Metres3 = (1.0, 1.0, 1.0),
    warmth: float = 1.0,
) -> Lit:
    """The lights of a room in a style.

    Args:
        shapes: parts of each lamp in its own frame, by id. lamps: those that are on. windows: those that bring light.
        tint: colour of the daylight beside its temperature, luminance 1. warmth: what its kelvin are multiplied by.
    """
    how = STYLES[style]
    how = replace(how, kelvin=round(how.kelvin * warmth), fill_kelvin=round(how.fill_kelvin * warmth))
    faces = {w.id: face for w in windows if (face := window_face(space, w)) is not None}
    fill_part, window_part = (how.fill, how.windows) if faces else (how.fill + how.windows, 0.0)
    taken = {
        line.id for name in ("walls", "doors", "windows", "openings", "proxies") for line in getattr(space.layout, name)
    }
    made: list[LightLine] = []
    fills = [light.model_copy(update={"kelvin": how.fill_kelvin, "color": tint}) for light in _fills(space, taken)]
    made += _scaled(space, fills, fill_part * EVEN)
    panes = [_window_light(w, faces[w.id], how, tint, taken) for w in windows if w.id in faces]
    made += _scaled(space, panes, window_part * EVEN)
    shining = sun if how.sun > 0.0 and faces else None
    if shining is not None:
        made.append(_sun_light(shining, how, taken))
    lit: list[str] = []
    for lamp in lamps:
        found = lamp_lights(lamp, shapes.get(lamp.id, ()), style, taken)
        made += found
        lit += [lamp.id] if found else []
    # The world's radiance S gives pi S; its part reaches the room through windows only.
    world = WorldLine(id=_free("sky", taken), color=tint, strength=how.world, kelvin=how.kelvin)
    return Lit(made, world, shining, list(faces), lit)


def window_face(space: Space, window: WindowLine) -> tuple[Wall, tuple[float, float, float, float]] | None:
    """The wall's face that a window lies in, and its hole (from, to, lower, upper); None when it has none.

    A window in a partition brings no daylight.
    """
    outer = [w for w in space.walls if sum(other.id == w.id for other in space.walls) == 1]
    mid = ((window.start[0] + window.end[0]) / 2, (window.start[1] + window.end[1]) / 2)
    for wall in outer:
        along = (mid[0] - wall.start[0]) * wall.along[0] + (mid[1] - wall.start[1]) * wall.along[1]
        off = abs((mid[0] - wall.start[0]) * wall.normal[0] + (mid[1] - wall.start[1]) * wall.normal[1])
        for hole in wall.glazed:
            named = window.wall == wall.id or off < 0.3
            if named and hole[0] - 1e-3 <= along <= hole[1] + 1e-3 and hole[2] <= window.sill + window.height:
                return wall, hole
    return None


def _window_light(
    window: WindowLine, face: tuple[Wall, tuple[float, float, float, float]], how: Style, tint: Metres3, taken: set[str]
) -> LightLine:
    """A panel as large as the glazing, on the room's side of the wall, shining into the room."""
    wall, (low, high, bottom, top) = face
    along = (low + high) / 2
    x = wall.start[0] + along * wall.along[0] + _INTO_ROOM * wall.normal[0]
    y = wall.start[1] + along * wall.along[1] + _INTO_ROOM * wall.normal[1]
    z = (bottom + top) / 2
    return LightLine(
        id=_free(f"{window.id}_light", taken),
        kind="area",
        at=(x, y, z),
        energy=1.0,
        color=tint,
        size=_GLASS * (high - low),
        size_y=_GLASS * (top - bottom),
        kelvin=how.kelvin,
        target=(x + wall.normal[0], y + wall.normal[1], z),
        parent=window.id,
    )


def _fills(space: Space, taken: set[str]) -> list[LightLine]:
    """What a bright ceiling gives back: panels under it that keep within the room, none of it through a partition."""
    low, high = space.floor.min(axis=0), space.floor.max(axis=0)
    z = space.height - _UNDER_CEILING
    panels = []
    for x0, x1, y0, y1 in rectangles(space):
        for number, (metres, share) in enumerate(_MARGINS):
            width, depth = (max(side - 2 * min(metres, share * side), 0.3) for side in (x1 - x0, y1 - y0))
            # Not in one plane: of lights that a ray meets at once, Cycles counts one.
            at = ((x0 + x1) / 2, (y0 + y1) / 2, z - number * _APART)
            panels.append(
                LightLine(id=_free("ceiling_light", taken), kind="area", at=at, energy=1.0, size=width, size_y=depth)
            )
    if not panels:
        at = (float(low[0] + high[0]) / 2, float(low[1] + high[1]) / 2, z)
        panels.append(LightLine(id=_free("ceiling_light", taken), kind="area", at=at, energy=1.0, size=0.5, size_y=0.5))
    return panels


def _scaled(space: Space, lights: list[LightLine], wanted: float) -> list[LightLine]:
    """Lights of equal radiance that together light the floor this much on average, watts a square metre."""
    if not lights or wanted <= 0.0:
        return []
    areas = [max(light.size * (light.size_y or light.size), 1e-4) for light in lights]
    unit = [light.model_copy(update={"energy": a}) for light, a in zip(lights, areas, strict=True)]
    points, normals = floor_grid(space)
    arrives = float(irradiance(space, unit, 0.0, points, normals).lights.sum(axis=0).mean()) if len(points) else 0.0
    factor = wanted / max(arrives, 1e-6)
    watts = [round(min(light.energy * factor, _MOST_WATTS), 2) for light in unit]
    return [light.model_copy(update={"energy": w}) for light, w in zip(unit, watts, strict=True)]


def floor_grid(space: Space, count: int = 48) -> tuple[Floats, Floats]:
    """Places spread over the floor that furniture leaves free, and their normals."""
    low, high = space.floor.min(axis=0), space.floor.max(axis=0)
    step = float(np.sqrt(np.prod(high - low) / (3 * count)))
    xs, ys = (np.arange(low[i] + step / 2, high[i], step) for i in (0, 1))
    grid = np.stack(np.meshgrid(xs, ys), axis=-1).reshape(-1, 2)
    grid = grid[inside(space.floor, grid)]
    points = np.concatenate([grid, np.zeros((len(grid), 1))], axis=1)
    up = np.tile((0.0, 0.0, 1.0), (len(points), 1))
    free = (
        ~space.blocked(points + 1e-3 * up, up, np.full(len(points), 0.9 * space.height))
        if len(points)
        else np.zeros(0, bool)
    )
    if free.sum() >= 8:
        points, up = points[free], up[free]
    return points[:: max(1, len(points) // count)], up[:: max(1, len(points) // count)]


def _sun_light(sun: Sun, how: Style, taken: set[str]) -> LightLine:
    part = min(max(sun.strength, 0.6 * how.sun), 1.6 * how.sun) if sun.strength else how.sun
    slope = max(math.sin(math.radians(sun.elevation)), 0.2)
    x, y, z = (float(v) for v in sun.towards * _SUN_HEIGHT)
    return LightLine(
        id=_free("sun", taken),
        kind="sun",
        at=(x, y, z),
        energy=round(part * EVEN / slope, 3),
        size=round(math.radians(how.sun_angle), 4),
        target=(0.0, 0.0, 0.0),
        kelvin=5600.0,
    )


def lamp_lights(lamp: ProxyLine, shapes: Sequence[Shape], style: LightStyle, taken: set[str]) -> list[LightLine]:
    """The lights of a lamp in a style; hanging and standing lamps are stronger than those on a table.

    Args:
        taken: ids that are not free; those of the lights are added.
    """
    places, how = bulbs(lamp, shapes), STYLES[style]
    kind = 2.5 if lamp.placement == "ceiling" else 1.4 if lamp.size[2] > 1.0 else 1.0
    watts = how.lamps * EVEN * 4 * math.pi * _REACH**2 * kind / math.sqrt(len(places) or 1) / max(1, len(places)) ** 0.5
    result = []
    for place in places:
        result.append(
            LightLine(
                id=_free(f"{lamp.id}_light", taken),
                kind="point",
                at=place.at,
                energy=round(watts, 2),
                size=round(place.radius, 4),
                kelvin=how.lamp_kelvin,
                parent=lamp.id,
            )
        )
    return result


def _free(name: str, taken: set[str]) -> str:
    """An id that no line has, and that is now taken."""
    number, free = 1, name
    while free in taken:
        number += 1
        free = f"{name}_{number}"
    taken.add(free)
    return free
