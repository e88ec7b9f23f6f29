# SPDX-License-Identifier: GPL-3.0-or-later
"""How much of the light is the windows', the sun's and the ceiling's is what the picture's floor and walls show."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

import numpy as np
import pytest
from code_as_room.pipeline.artifacts.layout import Layout, LightLine
from code_as_room.pipeline.light.estimate import irradiance
from code_as_room.pipeline.light.exposure import GLOSS
from code_as_room.pipeline.light.levels import is_fill, levelled
from code_as_room.pipeline.light.lights import Lit, make_lights
from code_as_room.pipeline.light.measure import Places, floor_and_walls
from code_as_room.pipeline.light.photograph import stops_for
from code_as_room.pipeline.light.space import Space, space_of
from code_as_room.pipeline.light.tone import NEUTRAL, linear, shown
from code_as_room.pipeline.light.views import eye_cameras

from .rooms_to_light import rectangle, thing
from .test_exposed_views import VIEW, eye, panel


def daylight(layout: Layout) -> tuple[Space, Lit]:
    space = space_of(layout)
    return space, make_lights(space, "soft daylight", {}, [], layout.windows, None)


def as_seen(space: Space, lights: Sequence[LightLine], sky: float, grain: float = 0.0) -> Places:
    """Floor and walls as a picture shows them that these lights made, with patterns on them."""
    points, normals, surface = floor_and_walls(space, 90)
    arriving = irradiance(space, lights, sky, points, normals)
    gives = (arriving.lights.sum(axis=0) + arriving.sky) * (space.albedo_of(surface.astype(np.int64)) + GLOSS) / math.pi
    gives *= np.exp(grain * np.random.default_rng(3).normal(size=len(gives)))
    light = linear(shown(0.4 * gives / np.median(gives), NEUTRAL))
    return Places(points, normals, surface, np.repeat(light[:, None], 3, axis=1))


def times(before: Sequence[LightLine], after: Sequence[LightLine], which: Callable[[LightLine], bool]) -> float:
    changed = [a.energy / b.energy for b, a in zip(before, after, strict=True) if which(b)]
    return float(np.mean(changed))


@pytest.mark.parametrize("stronger", [0.5, 1.0, 2.0])
def test_the_windows_get_the_part_that_the_picture_gives_them(stronger: float) -> None:
    space, lit = daylight(rectangle(7.0, 3.6, windows=(3,)))
    there = [x if is_fill(x) else x.model_copy(update={"energy": stronger * x.energy}) for x in lit.lights]
    places = as_seen(space, there, lit.world.strength, grain=0.1)
    found = levelled(space, lit.lights, lit.world.strength, places, NEUTRAL, "")
    windows = times(lit.lights, found, lambda x: not is_fill(x))
    ratio = windows / times(lit.lights, found, is_fill)
    assert 0.75 * stronger < ratio < 1.35 * stronger


def test_a_few_odd_places_change_little() -> None:
    space, lit = daylight(rectangle(7.0, 3.6, windows=(3,)))
    places = as_seen(space, lit.lights, lit.world.strength)
    colours = places.colours.copy()
    colours[::12] *= 0.1  # a rug that nobody said, a shadow
    found = levelled(
        space,
        lit.lights,
        lit.world.strength,
        Places(places.points, places.normals, places.surface, colours),
        NEUTRAL,
        "",
    )
    assert all(0.7 < b.energy / a.energy < 1.35 for a, b in zip(lit.lights, found, strict=True))


def test_what_the_artist_lit_stays_and_so_does_all_without_a_picture() -> None:
    space, lit = daylight(rectangle(7.0, 3.6, windows=(3,)))
    places = as_seen(space, [x for x in lit.lights if not is_fill(x)], lit.world.strength)
    held = levelled(space, lit.lights, lit.world.strength, places, NEUTRAL, "", held=len(lit.lights))
    assert held == list(lit.lights)
    assert levelled(space, lit.lights, lit.world.strength, None, NEUTRAL, "") == list(lit.lights)


def test_curtains_before_a_window_take_its_light() -> None:
    def floor_light(category: str | None) -> float:
        layout = rectangle(5.0, 4.0, windows=(2,))
        if category:
            high = 0.1 if "rod" in category else 2.5
            centre = (0.0, 1.9, 2.5 - high / 2)
            layout.proxies.append(thing("curtain_1", category, (0.0, 1.9), (2.4, 0.12, high), centre=centre))
        space = space_of(layout)
        window = make_lights(space_of(rectangle(5.0, 4.0, windows=(2,))), "soft daylight", {}, [], layout.windows, None)
        points, normals, surface = floor_and_walls(space)
        floor = surface == 0
        arriving = irradiance(space, [x for x in window.lights if not is_fill(x)], 0.0, points[floor], normals[floor])
        return float(arriving.lights.sum(axis=0).mean())

    bare, sheer, heavy = (floor_light(category) for category in (None, "sheer curtain", "curtain"))
    assert 0.35 * bare < sheer < 0.7 * bare and heavy < 0.2 * bare
    assert floor_light("curtain rod") == pytest.approx(bare, rel=0.05)  # what holds curtains hides nothing


def test_light_passes_over_a_bed_before_its_headboard() -> None:
    layout = rectangle(4.0, 4.0)
    layout.proxies.append(thing("bed_1", "double bed", (0.0, 0.9), (1.8, 2.2, 1.3)))
    space = space_of(layout)
    over, through = (np.array([[-1.5, y, 0.9]]) for y in (0.0, 1.93))
    ways = np.array([[1.0, 0.0, 0.0]])
    assert not space.blocked(over, ways, np.array([2.5])).any()
    assert space.blocked(through, ways, np.array([2.5])).all()


def test_a_patch_of_sun_does_not_darken_a_view() -> None:
    layout: Layout = rectangle(4, 3)
    layout.proxies.append(thing("wardrobe_1", "wardrobe", (1.7, 0), (0.6, 2.4, 2.3)))
    space = space_of(layout.model_copy(update={"walls": [*layout.walls[:3]]}), {"wardrobe_1": 0.6, "floor": 0.6})
    sun = LightLine(id="sun", kind="sun", at=(-5, 0, 3), energy=6.0, target=(0, 0, 0))
    with_sun, without = (stops_for(space, lights, 0.0, eye(), VIEW) for lights in ([panel(72.0), sun], [panel(72.0)]))
    assert with_sun > without - 0.35


def test_a_bed_is_shown_before_curtains() -> None:
    layout = rectangle(7.0, 3.8, windows=(3,))
    layout.proxies += [
        thing("bed_1", "double bed", (1.2, 0.7), (1.9, 2.2, 1.2)),
        *(thing(f"curtain_{n}", "curtain", (-3.4, y), (0.8, 0.15, 2.5), yaw=90) for n, y in enumerate((-1.4, -0.6, 0.6, 1.4))),
    ]  # fmt: skip
    space = space_of(layout)
    lines, _ = eye_cameras(space)
    towards = []
    for line in lines:
        matrix = np.array(line.matrix).reshape(4, 4)
        way = np.array((1.2, 0.7, 0.5)) - matrix[:3, 3]
        towards.append(float(-matrix[:3, 2] @ way / np.linalg.norm(way)))
    assert max(towards) > math.cos(math.radians(35))
