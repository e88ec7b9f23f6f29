# SPDX-License-Identifier: GPL-3.0-or-later
"""What floor, walls and ceiling are made of: their colours in the picture, beside what stands on and before them."""

from __future__ import annotations

import re
from dataclasses import dataclass, field

import numpy as np

from ..artifacts.camera import CameraModel
from ..artifacts.layout import Layout
from ..light.measure import LEAST_PLACES, small, visible_places
from ..light.space import WALLS, space_of
from ..objects.colours import BRIGHTEST, Floats, as_paint, from_code, to_code
from ..objects.tinting import calm
from ..picture import ReferencePicture
from ..program.prelude.enclosure import TOPS
from .choice import Choice
from .difference import lab_of
from .tops import top_colour

_WET = re.compile(r"bath|toilet|shower|washbasin|\bsink\b|stove|\boven\b|dishwasher", re.IGNORECASE)
_TINTED = 7.0
"""Distance in CIELAB's a and b by which a wall's paint differs from the other walls'."""


@dataclass
class ShellColours:
    """Six sRGB digits in neutral light; "" where the picture does not show it.

    Attributes:
        own: those of walls with another paint than the rest, by their id. tops: of the walls' upper faces.
    """

    floor: str = ""
    walls: str = ""
    tops: str = ""
    own: dict[str, str] = field(default_factory=dict)


def shell_colours(layout: Layout, camera: CameraModel, picture: ReferencePicture, gains: Floats) -> ShellColours:
    """The colours of floor and walls in the picture.

    Args:
        gains: on linear red, green and blue, which take the light's colour and strength out.
    """
    space = space_of(layout, {})
    places = visible_places(space, camera, picture)
    found = ShellColours()
    floor = places.colours[places.is_floor]
    if len(floor) >= LEAST_PLACES:
        found.floor = calm(to_code(_in_neutral_light(_paint(floor), gains)))
    seen: dict[str, tuple[str, int]] = {}
    for number, wall in enumerate(space.walls):
        here = places.colours[places.surface == WALLS + number]
        if len(here) >= 5 and wall.id not in seen:
            seen[wall.id] = (calm(to_code(_in_neutral_light(_paint(here), gains))), len(here))
    _walls(found, seen)
    tops = top_colour(layout, camera, small(picture, meant=True))
    if tops is not None:
        found.tops = to_code(np.minimum(tops * gains, 0.9))
    return found


def _paint(colours: Floats) -> Floats:
    """A surface's own colour of what is seen of it: neither its shadows nor where light falls on it straight."""
    light = colours.mean(axis=1)
    low, high = np.percentile(light, (40, 85))
    middle: Floats = colours[(light >= low) & (light <= high)].mean(axis=0)
    return middle


def _in_neutral_light(colour: Floats, gains: Floats) -> Floats:
    paint: Floats = np.minimum(as_paint(colour, gains), BRIGHTEST)
    return paint


def _walls(found: ShellColours, seen: dict[str, tuple[str, int]]) -> None:
    """Walls of one hue have one paint, that of the brightest: the others are in its shadow."""
    if not seen:
        return
    labs = {name: lab_of(_evened(code)) for name, (code, _) in seen.items()}
    bright = {name: lab_of(code)[0] for name, (code, _) in seen.items()}

    def apart(a: str, b: str) -> float:
        return float(np.hypot(labs[a][1] - labs[b][1], labs[a][2] - labs[b][2]))

    # The wall that is most like all others has the room's usual paint; of two walls the brighter one.
    common = min(seen, key=lambda name: (round(sum(min(apart(name, o), 15.0) for o in seen), 1), -bright[name]))
    members = [name for name in seen if apart(common, name) < _TINTED]
    found.walls = seen[max(members, key=lambda name: bright[name])][0]
    found.own = {name: code for name, (code, _) in seen.items() if name not in members}


def _evened(code: str) -> str:
    """The colour at a medium brightness: paint in the shade has less of a hue in numbers."""
    colour = from_code(code)
    return to_code(colour * 0.45 / max(float(colour.mean()), 0.02))


def shell_choices(layout: Layout, colours: ShellColours) -> dict[str, Choice]:
    """What the shell's surfaces are made of without an answer, by the names that `finish` has for them."""
    found: dict[str, Choice] = {}
    if colours.floor:
        found["floor"] = _floor(layout, colours.floor)
    walls = colours.walls or "F1EEE8"
    source = "the colour that the picture shows"
    found["walls"] = Choice("plaster", walls, word="wall_paint", why=source if colours.walls else "usual walls",
                            source="measured" if colours.walls else "usual")  # fmt: skip
    found |= {name: Choice("plaster", code, word="wall_paint", why=source) for name, code in colours.own.items()}
    if colours.tops:
        found[TOPS] = Choice("plaster", colours.tops, word="wall_tops", why=source)
    found["ceiling"] = Choice(
        "plaster", "F7F5F1", word="ceiling_paint", why="the picture does not show it", source="usual"
    )
    if layout.doors:
        found["doors"] = Choice("painted_wood", "EBE7DF", word="door_paint", why="usual doors", source="usual")
    return found


def _floor(layout: Layout, code: str) -> Choice:
    light, a, b = lab_of(code)
    brown = np.hypot(a, b) > 9 and b > abs(a) * 0.6 and light > 15
    if brown:
        return Choice("planks", code, word="floor_boards", why="a floor of this colour is usually of wood")
    if any(_WET.search(p.category) for p in layout.proxies):
        return Choice(
            "tile", code, (("size", "(0.6, 0.6)"),), word="floor_tile", why="a wet room's floor is usually tiled"
        )
    if light > 80:
        return Choice("planks", code, word="floor_boards", why="a light floor in a living room is usually of wood")
    return Choice("concrete", code, (("gloss", "0.4"),), word="floor", why="a grey floor without a pattern")
