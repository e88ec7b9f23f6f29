# SPDX-License-Identifier: GPL-3.0-or-later
"""Exposure: whatever brightness floor and walls have in the picture, the room gets it; the sun comes from where it shines."""

from __future__ import annotations

import io
import math

import numpy as np
import pytest
from code_as_room.pipeline.artifacts.layout import Layout
from code_as_room.pipeline.artifacts.light import LightReply
from code_as_room.pipeline.geometry.camera import Projector, camera_straight_down
from code_as_room.pipeline.light.decide import decide
from code_as_room.pipeline.light.exposure import LEAST, MOST, matched
from code_as_room.pipeline.light.lights import Sun, make_lights
from code_as_room.pipeline.light.measure import visible_places
from code_as_room.pipeline.light.space import Space, space_of
from code_as_room.pipeline.light.sunlight import SURE, fitted_sun
from code_as_room.pipeline.light.tone import AGX, MEDIUM_HIGH, scene_light, shown
from code_as_room.pipeline.picture import ReferencePicture, read_picture
from hypothesis import given, settings
from hypothesis import strategies as st
from PIL import Image

from .rooms_to_light import rectangle, thing

SIZE = (400, 340)


def camera_over(layout: Layout):
    """A camera high over the middle of the room that sees all of it, and the insides of its walls."""
    width, depth, height = layout.room.size
    return camera_straight_down("perspective", width, depth, SIZE, 35.0, top=height)


def picture_of(space: Space, camera, floor: float, wall: float, sun: Sun | None = None) -> ReferencePicture:
    """A picture with floor and walls of one grey each (0..1 on the screen), brighter where a sun falls."""
    lens = Projector.of(camera)
    x, y = np.meshgrid(np.arange(SIZE[0]) + 0.5, np.arange(SIZE[1]) + 0.5)
    origins, ways = lens.rays(np.stack([x.ravel(), y.ravel()], axis=1))
    distance, surface, _ = space.hit(origins, ways, boxes=False, ceiling=False)
    value = np.where(surface == 0, floor, np.where(surface > 0, wall, 1.0))
    if sun is not None:
        points = origins + ways * distance[:, None] + np.array((0, 0, 2e-3))
        lit = (surface == 0) & ~space.blocked(
            points, np.broadcast_to(sun.towards, points.shape), np.full(len(points), 1e6)
        )
        value[lit] = min(1.0, 1.5 * floor)
    buffer = io.BytesIO()
    grey = (255 * value).round().astype(np.uint8).reshape(SIZE[1], SIZE[0])
    Image.fromarray(grey).convert("RGB").save(buffer, "PNG")
    return read_picture(buffer.getvalue(), "room.png")


@settings(max_examples=12, deadline=None)
@given(st.floats(0.15, 0.85), st.floats(0.03, 0.5))
def test_floor_and_walls_become_as_bright_as_in_the_picture(screen: float, albedo: float) -> None:
    layout = rectangle(4.5, 4.0, windows=(2,))
    space = space_of(layout, {"floor": albedo, "walls": albedo})
    camera = camera_over(layout)
    picture = picture_of(space, camera, screen, screen)
    places = visible_places(space, camera, picture)
    assert places.is_floor.sum() > 20 and places.is_wall.sum() > 20
    lit = make_lights(space, "soft daylight", {}, [], layout.windows, None)
    exposure, report = matched(space, lit.lights, lit.world.strength, places, AGX, MEDIUM_HIGH)
    assert {b.about for b in report} == {"floor", "walls"}
    if LEAST < exposure < MOST:
        mean = sum(w * (b.after - b.picture) for b, w in zip(report, (0.75, 0.25), strict=True))
        assert abs(mean) < 0.06
    # With that exposure set, nothing is left to correct.
    again = matched(space, [x.model_copy(update={"energy": x.energy * 2**exposure}) for x in lit.lights],
                    lit.world.strength * 2**exposure, places, AGX, MEDIUM_HIGH)[0]  # fmt: skip
    assert exposure <= LEAST or exposure >= MOST or abs(again) < 0.01


def test_the_curves_are_inverse_and_rise() -> None:
    screen = np.linspace(0.03, 0.95, 40)
    for transform, look in ((AGX, ""), (AGX, MEDIUM_HIGH), ("Filmic", ""), ("Standard", "")):
        light = scene_light(screen, transform, look)
        assert np.all(np.diff(light) > 0)
        assert shown(light, transform, look) == pytest.approx(screen, abs=0.004)


@pytest.mark.parametrize(("azimuth", "elevation"), [(60.0, 38.0), (90.0, 30.0), (120.0, 46.0)])
def test_the_sun_is_found_where_it_shines_from(azimuth: float, elevation: float) -> None:
    layout = rectangle(4.8, 4.2, windows=(2,))
    space, camera = space_of(layout), camera_over(layout)
    picture = picture_of(space, camera, 0.5, 0.7, Sun(azimuth, elevation))
    found = fitted_sun(space, layout.windows, visible_places(space, camera, picture))
    assert found is not None and found.sure > SURE
    assert abs(found.azimuth - azimuth) <= 15 and abs(found.elevation - elevation) <= 16


def test_an_evenly_lit_picture_has_no_sure_sun() -> None:
    layout = rectangle(4.8, 4.2, windows=(2,))
    space, camera = space_of(layout), camera_over(layout)
    found = fitted_sun(space, layout.windows, visible_places(space, camera, picture_of(space, camera, 0.5, 0.7)))
    assert found is not None and found.sure < SURE
    assert math.sin(math.radians(found.azimuth)) > 0.5  # it still comes in by the window


def test_what_the_model_says_is_taken_where_it_can_be() -> None:
    layout = rectangle(4.8, 4.2, windows=(0, 1))
    lamps = [thing("lamp_1", "floor lamp", (0, 0), (0.3, 0.3, 1.5)), thing("lamp_2", "lamp", (1, 0), (0.3, 0.3, 0.5))]
    space = space_of(layout)
    reply = LightReply(
        style="Sunny!", sun_from="Right", windows=["window_1", "window_9"], lamps_on=["lamp_2", "sofa"], warmth="warm"
    )
    found = decide(space, None, layout.windows, lamps, [], reply)
    assert found.style == "sunny" and [w.id for w in found.windows] == ["window_1"]
    assert [lamp.id for lamp in found.lamps] == ["lamp_2"] and found.warmth < 1
    assert found.sun is not None and abs(found.sun.azimuth) < 1
    nonsense = LightReply(style="baroque", sun_from="below", windows=["x"], warmth="spicy")
    found = decide(space, None, layout.windows, lamps, [], nonsense)
    assert found.style == "soft daylight" and len(found.windows) == 2 and found.warmth == 1
    none = decide(space, None, [], lamps, [], LightReply(style="sunny", sun_from="left"))
    assert none.sun is None
