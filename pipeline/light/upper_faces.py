# SPDX-License-Identifier: GPL-3.0-or-later
"""The walls' upper faces in the picture's colour: the sky and the sun fall on them, whatever light the room has.

They frame a picture from above, and what the exposure makes of the room's light says nothing of theirs.
"""

from __future__ import annotations

import math
import re

import numpy as np

from ..artifacts.layout import Layout
from ..errors import ProgramError
from ..geometry.polygon import Floats
from ..objects.colours import to_code
from ..program import finishes
from ..program.prelude.enclosure import TOPS
from ..program.prelude.kelvin import light_colour
from .estimate import aim
from .exposure import GLOSS
from .tone import coloured_light

_LEAST, _MOST = 0.02, 0.9
_PLAIN = re.compile(r'^plaster\("#[0-9A-Fa-f]{6}"')


def with_upper_faces(text: str, layout: Layout, seen: Floats | None) -> str:
    """The room text with the look of the walls' upper faces such that they show a colour; text that has no such look stays.

    Args:
        layout: with its lights, sky and exposure. seen: linear colour (3,) in the picture, None where it does not show them.
    """
    if seen is None or not layout.worlds or not layout.views:
        return text
    code = to_code(paint_that_shows(layout, seen))
    try:
        found = finishes.read_materials(text)
        name = found.finishes.get(TOPS, {}).get("", "")
        written = found.looks.get(name, "")
        if not _PLAIN.match(written):
            return text
        changed = finishes.Materials({**found.looks, name: f'plaster("#{code}"' + written[17:]}, found.finishes)
        return finishes.with_materials(text, changed)
    except ProgramError:
        return text


def paint_that_shows(layout: Layout, seen: Floats) -> Floats:
    """The linear paint (3,) of a face that looks up under this sky, sun and exposure, and is to show this linear colour."""
    world, view = layout.worlds[0], layout.views[0]
    arrives = math.pi * world.strength * np.array(light_colour(world.color, world.kelvin))
    for light in layout.lights:
        if light.kind == "sun":
            slope = max(0.0, -float(aim(light)[2]))
            arrives += light.energy * slope * np.array(light_colour(light.color, light.kelvin))
    wanted = coloured_light(np.asarray(seen, dtype=float)[None], view.transform)[0] / 2.0**view.exposure
    result: Floats = np.clip(wanted * math.pi / arrives - GLOSS, _LEAST, _MOST)
    return result
