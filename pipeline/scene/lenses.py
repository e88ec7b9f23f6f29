# SPDX-License-Identifier: GPL-3.0-or-later
"""Camera and light lines written to Blender's camera and light datablocks."""

from __future__ import annotations

import math
from typing import Any

from ..program.prelude.kelvin import light_colour


def write_camera(data: Any, line: dict[str, Any]) -> None:
    """Give a Blender camera the lens of a camera line (fields as `CameraModel`, `principal` as a pair).

    The sensor is fitted to the height, so that the field of view does not depend on the scene's resolution: the
    picture's aspect is set when it is captured, not on the artist's scene. Shift is in picture heights (Blender's
    unit with a vertical fit) and moves the picture's centre away from the optical axis.
    """
    width, height = line["image_size"]
    x, y = line["principal"]
    data.sensor_fit = "VERTICAL"
    data.shift_x = (500.0 - x) / 1000.0 * width / height
    data.shift_y = (y - 500.0) / 1000.0
    data.clip_start, data.clip_end = line.get("near", 0.02), 500.0
    if line["kind"] == "orthographic":
        data.type = "ORTHO"
        data.ortho_scale = line["ortho_height"]
    else:
        data.type = "PERSP"
        data.lens = data.sensor_height / (2.0 * math.tan(line["fov_y"] / 2.0))


def write_light(data: Any, line: dict[str, Any]) -> None:
    """Give a Blender light the values of a light line; `size` is a sun's angular diameter in radians, else metres.

    Colours above 1 are kept by the energy: Blender's colour field shows them, but its picker does not.
    """
    kind = line["kind"].upper()
    if data.type != kind:
        data.type = kind
        data = data.type_recast()  # the fields of the new kind appear only on a new Python type
    data.energy = line["energy"]
    data.color = light_colour(line["color"], line["kelvin"])
    if kind == "SUN":
        data.angle = min(line["size"], math.pi)
    elif kind == "AREA":
        data.size = max(line["size"], 1e-3)
        data.shape = "RECTANGLE" if line["size_y"] else "SQUARE"
        if line["size_y"]:
            data.size_y = max(line["size_y"], 1e-3)
    else:
        data.shadow_soft_size = line["size"]
