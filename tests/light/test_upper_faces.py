# SPDX-License-Identifier: GPL-3.0-or-later
"""The walls' upper faces show the picture's colour under any sky, sun and exposure."""

from __future__ import annotations

import math

import numpy as np
import pytest
from code_as_room.pipeline.artifacts.layout import LightLine, ViewLine, WorldLine
from code_as_room.pipeline.light.exposure import GLOSS
from code_as_room.pipeline.light.tone import coloured_light
from code_as_room.pipeline.light.upper_faces import paint_that_shows, with_upper_faces
from code_as_room.pipeline.program.prelude.kelvin import light_colour
from hypothesis import given
from hypothesis import strategies as st

from .rooms_to_light import rectangle

TEXT = """wall_tops_1 = plaster("#605E5F", rough=0.2)
finish("wall_tops", {"": wall_tops_1})
finish("walls", {"": plaster("#FFFFFF")})
build()
"""


def room(exposure: float, sun: float, kelvin: float = 6800.0):
    layout = rectangle(4, 3)
    layout.worlds = [WorldLine(id="sky", strength=1.3, kelvin=kelvin)]
    layout.views = [ViewLine(id="view", exposure=exposure, transform="Khronos PBR Neutral", look="")]
    if sun:
        layout.lights = [LightLine(id="sun", kind="sun", at=(3, 0, 3), target=(0, 0, 0), energy=sun, kelvin=5600)]
    return layout


@given(st.floats(-1.2, 0.5), st.floats(0, 4), st.tuples(*[st.floats(0.05, 0.35)] * 3))
def test_the_paint_shows_the_colour(exposure: float, sun: float, seen: tuple[float, float, float]) -> None:
    layout = room(exposure, sun)
    paint = paint_that_shows(layout, np.array(seen))
    light = math.pi * 1.3 * np.array(light_colour((1, 1, 1), 6800.0))
    light += sun * math.sqrt(0.5) * np.array(light_colour((1, 1, 1), 5600.0))
    shows = (paint + GLOSS) * light / math.pi * 2**exposure
    wanted = coloured_light(np.array([seen]), "Khronos PBR Neutral")[0]
    free = (paint > 0.0201) & (paint < 0.8999)
    assert shows[free] == pytest.approx(wanted[free], rel=1e-3)


def test_only_a_plain_look_of_the_upper_faces_changes() -> None:
    layout = room(-1.0, 2.0)
    made = with_upper_faces(TEXT, layout, np.array((0.6, 0.6, 0.6)))
    assert 'plaster("#605E5F"' not in made and ", rough=0.2)" in made and '"#FFFFFF"' in made
    assert with_upper_faces(made, layout, np.array((0.6, 0.6, 0.6))) == made
    assert with_upper_faces(TEXT, layout, None) == TEXT
    own = TEXT.replace('plaster("#605E5F", rough=0.2)', 'wood("#605E5F")')
    assert with_upper_faces(own, layout, np.array((0.6, 0.6, 0.6))) == own
