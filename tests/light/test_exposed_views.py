# SPDX-License-Identifier: GPL-3.0-or-later
"""Views at eye level are exposed for what they show."""

from __future__ import annotations

import pytest
from code_as_room.pipeline.artifacts.layout import CameraLine, Layout, LightLine, ViewLine
from code_as_room.pipeline.light.photograph import stops_for
from code_as_room.pipeline.light.space import Space, space_of
from code_as_room.pipeline.light.tone import NEUTRAL

from .rooms_to_light import rectangle, thing

VIEW = ViewLine(id="view", transform=NEUTRAL)
EAST = (0, 0, -1, -1.5, -1, 0, 0, 0, 0, 1, 0, 1.5, 0, 0, 0, 1)


def eye() -> CameraLine:
    return CameraLine(
        id="eye_1", kind="perspective", matrix=EAST, fov_y=0.93, image_size=(1536, 1024), principal=(500, 280)
    )


def panel(watts: float) -> LightLine:
    return LightLine(id="ceiling_light", kind="area", at=(0, 0, 2.55), energy=watts, size=3.4, size_y=2.4)


def room(albedo: float) -> Space:
    layout: Layout = rectangle(4, 3)
    layout.proxies.append(thing("wardrobe_1", "wardrobe", (1.7, 0), (0.6, 2.4, 2.3)))
    return space_of(layout, {"wardrobe_1": albedo, "walls": albedo, "floor": albedo, "ceiling": 0.8})


def test_half_the_light_is_made_up_for_by_a_stop() -> None:
    space = room(0.6)
    one, half = (stops_for(space, [panel(w)], 0.0, eye(), VIEW) for w in (72.0, 36.0))
    assert -0.5 < one < half < 1.0 and half - one == pytest.approx(1.0, abs=0.02)


def test_a_dark_alcove_is_exposed_for_longer_and_nothing_without_end() -> None:
    light, dark = (stops_for(room(albedo), [panel(90.0)], 0.0, eye(), VIEW) for albedo in (0.7, 0.15))
    assert dark > light and dark <= 1.0
    assert stops_for(room(0.02), [panel(0.001)], 0.0, eye(), VIEW) == 1.0
    assert stops_for(room(0.9), [panel(5000.0)], 0.0, eye(), VIEW) == -0.5


def test_the_rooms_own_exposure_counts() -> None:
    space, brighter = room(0.6), VIEW.model_copy(update={"exposure": 0.5})
    assert stops_for(space, [panel(55.0)], 0.0, eye(), VIEW) - stops_for(
        space, [panel(55.0)], 0.0, eye(), brighter
    ) == pytest.approx(0.5, abs=0.02)


def test_a_white_wall_at_the_side_of_a_dark_alcove_does_not_burn_out() -> None:
    def alcove(side: float) -> Space:
        layout: Layout = rectangle(4, 3)
        layout.proxies += [
            thing("wardrobe_1", "wardrobe", (1.7, -0.15), (0.6, 2.7, 2.55)),
            thing("panel_1", "panel", (0.9, 1.38), (0.6, 0.24, 2.5)),
        ]
        dark = dict.fromkeys(("wardrobe_1", "walls", "floor", "ceiling"), 0.12)
        return space_of(layout, {**dark, "panel_1": side})

    dark, beside_white = (stops_for(alcove(side), [panel(300.0)], 0.0, eye(), VIEW) for side in (0.12, 0.85))
    assert dark < 1.0 and beside_white < dark - 0.6
