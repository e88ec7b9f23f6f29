# SPDX-License-Identifier: GPL-3.0-or-later
"""The lights that a room gets: windows shine in, lamps from inside their shades, watts fit the room."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from code_as_room.pipeline.artifacts.light import STYLES
from code_as_room.pipeline.library import catalogue
from code_as_room.pipeline.light.estimate import irradiance
from code_as_room.pipeline.light.lamps import bulbs, is_lamp
from code_as_room.pipeline.light.lights import EVEN, Sun, floor_grid, make_lights
from code_as_room.pipeline.light.space import inside, space_of
from code_as_room.pipeline.program.evaluate import evaluate
from code_as_room.pipeline.program.lines import print_layout
from hypothesis import given, settings
from hypothesis import strategies as st

from .rooms_to_light import rectangle, thing


@settings(max_examples=25, deadline=None)
@given(st.floats(0, 360), st.integers(0, 3), st.booleans(), st.floats(2.2, 9.0), st.floats(2.2, 9.0))
def test_a_windows_light_faces_into_the_room(turn: float, wall: int, against: bool, width: float, depth: float) -> None:
    layout = rectangle(width, depth, turn, (wall,), against)
    space = space_of(layout)
    lit = make_lights(space, "soft daylight", {}, [], layout.windows, None)
    light = next(line for line in lit.lights if line.parent == f"window_{wall}")
    assert light.target is not None
    way = np.array(light.target) - np.array(light.at)
    normal = np.array((*space.walls[wall].normal, 0.0))
    assert way @ normal == pytest.approx(1.0, abs=1e-6)
    assert inside(space.floor, np.array([light.at[:2], light.target[:2]])).all()
    window = layout.windows[0]
    assert light.size == pytest.approx(math.dist(window.start, window.end), rel=0.1)
    assert light.size_y == pytest.approx(window.height, rel=0.1)
    assert abs(light.at[2] - (window.sill + window.height / 2)) < 0.1


@pytest.mark.parametrize("style", STYLES)
@pytest.mark.parametrize(("width", "depth"), [(2.0, 1.8), (4.5, 4.0), (14.0, 9.0)])
def test_every_size_of_room_gets_the_light_of_its_style(style: Any, width: float, depth: float) -> None:
    layout = rectangle(width, depth, windows=(0, 2))
    space = space_of(layout)
    lit = make_lights(space, style, {}, [], layout.windows, Sun(-70, 40))
    points, normals = floor_grid(space)
    steady = [line for line in lit.lights if line.kind == "area"]
    arrives = irradiance(space, steady, 0.0, points, normals).lights.sum(axis=0).mean()
    wanted = {"evening": 0.57, "night": 0.27}.get(style, 1.0) * EVEN
    assert arrives == pytest.approx(wanted, rel=0.25)
    assert all(0 < line.energy < 5000 for line in lit.lights)


def test_a_room_without_windows_is_lit_all_the_same() -> None:
    space = space_of(rectangle(3, 3))
    lit = make_lights(space, "sunny", {}, [], [], None)
    points, normals = floor_grid(space)
    assert irradiance(space, lit.lights, 0.0, points, normals).lights.sum(axis=0).mean() > 0.8 * EVEN
    assert lit.sun is None and lit.windows == []


def built_lamp(piece: str, size: tuple[float, float, float], placement: str, yaw: float) -> Any:
    """A lamp of the library in a room, and its parts."""
    layout = rectangle(5, 5)
    z = 2.6 - size[2] / 2 if placement == "ceiling" else size[2] / 2
    lamp = thing("lamp_1", "lamp", (0.7, -0.4), size, yaw=yaw, placement=placement).model_copy(
        update={"centre": (0.7, -0.4, z)}
    )
    layout.proxies.append(lamp)
    text = print_layout(layout).replace("build()", f'{catalogue.source([piece])}\nfurnish("lamp_1", {piece})\nbuild()')
    return lamp, evaluate(text).furnished["lamp_1"]


@pytest.mark.parametrize(
    ("piece", "size", "placement"),
    [
        ("floor_lamp", (0.42, 0.42, 1.6), "floor"),
        ("table_lamp", (0.3, 0.3, 0.5), "surface"),
        ("arc_lamp", (1.25, 0.4, 2.0), "floor"),
        ("pendant", (0.4, 0.4, 0.9), "ceiling"),
        ("chandelier", (0.8, 0.8, 0.9), "ceiling"),
        ("wall_sconce", (0.2, 0.2, 0.35), "surface"),
    ],
)
@pytest.mark.parametrize("yaw", [0.0, 130.0])
def test_lamps_shine_from_inside_their_shades(
    piece: str, size: tuple[float, float, float], placement: str, yaw: float
) -> None:
    lamp, shapes = built_lamp(piece, size, placement, yaw)
    assert is_lamp(lamp)
    found = bulbs(lamp, shapes)
    assert found
    for bulb in found:
        low, high = (np.array(p) for p in bulb.inside)
        assert np.all(np.array(bulb.at) > low - 1e-6) and np.all(np.array(bulb.at) < high + 1e-6)
        offset = np.array(bulb.at[:2]) - np.array(lamp.centre[:2])
        assert np.abs(offset).max() <= max(lamp.size[:2]) / 2 + 1e-6
        assert abs(bulb.at[2] - lamp.centre[2]) < lamp.size[2] / 2
        assert bulb.open > 0.05  # its light gets out, or it is as large as the globe


def test_a_bare_box_of_a_lamp_gets_light_round_it() -> None:
    lamp = thing("lamp_1", "floor lamp", (0, 0), (0.4, 0.4, 1.6))
    (bulb,) = bulbs(lamp, [])
    assert bulb.at[2] > 1.0 and bulb.radius >= 0.2
    assert not is_lamp(thing("switch_1", "light switch", (0, 0), (0.1, 0.1, 0.1)))


def test_no_two_panels_lie_in_one_plane() -> None:
    # Of lights that a ray meets at once Cycles counts one: rooms came out a third of a stop too dark.
    layout = rectangle(4.5, 4.0, windows=(2,))
    lit = make_lights(space_of(layout), "soft daylight", {}, [], layout.windows, None)
    heights = [light.at[2] for light in lit.lights if light.kind == "area" and light.target is None]
    assert len(heights) == 2 and abs(heights[0] - heights[1]) > 0.005
