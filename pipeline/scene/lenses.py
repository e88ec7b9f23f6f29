# SPDX-License-Identifier: GPL-3.0-or-later
"""Camera and light lines written to Blender's camera and light datablocks."""

from __future__ import annotations

import math
from typing import Any


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
    data.clip_start, data.clip_end = 0.02, 500.0
    if line["kind"] == "orthographic":
        data.type = "ORTHO"
        data.ortho_scale = line["ortho_height"]
    else:
        data.type = "PERSP"
        data.lens = data.sensor_height / (2.0 * math.tan(line["fov_y"] / 2.0))


def write_light(data: Any, line: dict[str, Any]) -> None:
    """Give a Blender light the values of a light line; `size` is a sun's angular diameter in radians, else metres."""
    kind = line["kind"].upper()
    if data.type != kind:
        data.type = kind
        data = data.type_recast()  # the fields of the new kind appear only on a new Python type
    data.energy = line["energy"]
    data.color = line["color"]
    if kind == "SUN":
        data.angle = min(line["size"], math.pi)
    elif kind == "AREA":
        data.size = max(line["size"], 1e-3)
    else:
        data.shadow_soft_size = line["size"]
