# SPDX-License-Identifier: GPL-3.0-or-later
"""The colour of the light: floor and walls come out in the picture's colours, whatever paint and light are."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from code_as_room.pipeline.artifacts.common import Metres3
from code_as_room.pipeline.geometry.camera import camera_straight_down
from code_as_room.pipeline.light.albedo import LUMINANCE
from code_as_room.pipeline.light.colour_match import MOST, matched_tint
from code_as_room.pipeline.light.estimate import irradiance
from code_as_room.pipeline.light.exposure import GLOSS
from code_as_room.pipeline.light.lights import Lit, make_lights
from code_as_room.pipeline.light.measure import Places, visible_places
from code_as_room.pipeline.light.space import Space, space_of
from code_as_room.pipeline.light.tone import NEUTRAL, coloured_light
from code_as_room.pipeline.picture import ReferencePicture
from code_as_room.pipeline.program.prelude.kelvin import light_colour
from hypothesis import given, settings
from hypothesis import strategies as st

from .rooms_to_light import rectangle
from .test_exposure_of_pictures import SIZE, picture_of

LAYOUT = rectangle(4.5, 4.0, windows=(2,))
CAMERA = camera_straight_down("perspective", 4.5, 4.0, SIZE, 35.0, top=2.6)


def spaces_of(floor: Metres3, walls: Metres3) -> list[Space]:
    return [space_of(LAYOUT, {"floor": f, "walls": w, "ceiling": 0.8}) for f, w in zip(floor, walls, strict=True)]


def lit_with(tint: Metres3) -> Lit:
    return make_lights(space_of(LAYOUT), "soft daylight", {}, [], LAYOUT.windows, None, tint)


def shown_by(spaces: list[Space], lit: Lit, places: Places) -> Places:
    """The places in the colours that these lights give them."""
    colours = np.zeros((len(places.points), 3))
    for channel, space in enumerate(spaces):
        arriving = irradiance(space, lit.lights, lit.world.strength, places.points, places.normals)
        each = np.array([light_colour(li.color, li.kelvin)[channel] for li in lit.lights])
        sky = light_colour(lit.world.color, lit.world.kelvin)[channel]
        albedo = space.albedo_of(np.asarray(places.surface).astype(np.int64)) + GLOSS
        colours[:, channel] = (each @ arriving.lights + sky * arriving.sky) * albedo / math.pi
    return replace(places, colours=np.clip(0.5 * colours, 0.006, 0.89))


def grey_picture() -> ReferencePicture:
    return picture_of(space_of(LAYOUT), CAMERA, 0.5, 0.6)


def tinted(lit: Lit, tint: Metres3) -> frozenset[str]:
    return frozenset(light.id for light in lit.lights if light.color == tint)


tints = st.tuples(st.floats(0.85, 1.15), st.floats(0.85, 1.15)).map(
    lambda rb: (rb[0], (1 - LUMINANCE[0] * rb[0] - LUMINANCE[2] * rb[1]) / LUMINANCE[1], rb[1])
)
paints = st.tuples(*[st.floats(0.15, 0.6)] * 3)


@settings(max_examples=15, deadline=None)
@given(tints, tints, paints, paints)
def test_the_colour_that_made_a_picture_is_found(true: Metres3, start: Metres3, floor: Metres3, walls: Metres3) -> None:
    spaces = spaces_of(floor, walls)
    places = shown_by(spaces, lit_with(true), visible_places(spaces[1], CAMERA, grey_picture()))
    lit = lit_with(start)
    found = matched_tint(spaces, lit.lights, lit.world, tinted(lit, start), places, start, "Standard")
    assert found == pytest.approx(true, abs=0.02)


def test_colour_that_an_orange_floor_throws_is_not_counted_twice() -> None:
    # The picture's walls are grey, and so are their paints: beside an orange floor the same light would make them orange.
    grey, white = (0.5, 0.5, 0.5), (1.0, 1.0, 1.0)
    found = []
    for floor in (grey, (0.5, 0.25, 0.1)):
        spaces, lit = spaces_of(floor, grey), lit_with(white)
        places = visible_places(spaces[1], CAMERA, grey_picture())
        walls = replace(places.only(places.is_wall), colours=np.tile(grey, (int(places.is_wall.sum()), 1)))
        found.append(matched_tint(spaces, lit.lights, lit.world, tinted(lit, white), walls, white, "Standard"))
    beside_grey, beside_orange = found
    assert beside_orange[2] > beside_grey[2] + 0.05 and beside_orange[0] < beside_grey[0] - 0.02


def test_a_picture_without_enough_places_changes_nothing_and_none_goes_far() -> None:
    white = (1.0, 1.0, 1.0)
    spaces, lit = spaces_of((0.3,) * 3, (0.6,) * 3), lit_with(white)
    places = visible_places(spaces[1], CAMERA, grey_picture())
    for few in (
        None,
        places.only(np.arange(len(places.points)) < 3),
        replace(places, colours=np.ones_like(places.colours)),
    ):
        assert matched_tint(spaces, lit.lights, lit.world, tinted(lit, white), few, white) == white
    red = replace(places, colours=np.tile((0.8, 0.1, 0.01), (len(places.points), 1)))
    found = matched_tint(spaces, lit.lights, lit.world, tinted(lit, white), red, white)
    assert all(1 - MOST - 1e-6 <= v <= 1 + MOST + 1e-6 for v in found)


@given(st.tuples(*[st.floats(0.0, 0.7)] * 3))
def test_light_is_led_back_through_pbr_neutral(light: Metres3) -> None:
    # The forward way as the specification has it, below its highlights.
    least = min(light)
    shown = np.array(light) - (least - 6.25 * least**2 if least < 0.08 else 0.04)
    assert coloured_light(np.array([shown]), NEUTRAL)[0] == pytest.approx(light, abs=1e-6)
