# SPDX-License-Identifier: GPL-3.0-or-later
"""The layout's boxes drawn over the picture, for the critic, the report and the panel."""

from __future__ import annotations

import io
from collections.abc import Sequence

from PIL import Image, ImageDraw, ImageFont

from ..artifacts.camera import CameraModel
from ..artifacts.layout import ProxyLine
from ..geometry.camera import project
from ..geometry.footprint import box_corners
from ..picture import encode_for_model

COLOURS = ("#e6194b", "#0082c8", "#2aa02a", "#f58231", "#911eb4", "#008080", "#c71585", "#7a5c00")
_BOTTOM, _TOP = (0, 1, 3, 2), (4, 5, 7, 6)


def draw_outlines(picture: bytes, camera: CameraModel, proxies: Sequence[ProxyLine], labels: bool = True) -> bytes:
    """The picture with each proxy's foot (thin) and top (thick) outline and its id, encoded."""
    with Image.open(io.BytesIO(picture)) as opened:
        image = opened.convert("RGB")
    draw = ImageDraw.Draw(image)
    unit = max(image.size) / 1000.0
    font = ImageFont.load_default(size=max(10.0, 13.0 * unit))
    for index, proxy in enumerate(proxies):
        colour = COLOURS[index % len(COLOURS)]
        points = project(camera, box_corners(proxy.centre, proxy.size, proxy.yaw))
        if not bool((points == points).all()):
            continue
        pixels = [(float(x) * image.width / 1000.0, float(y) * image.height / 1000.0) for x, y in points]
        for ring, width in ((_BOTTOM, 1), (_TOP, max(2, round(2 * unit)))):
            line = [pixels[i] for i in ring]
            draw.line([*line, line[0]], fill=colour, width=width, joint="curve")
        if labels:
            x, y = (sum(pixels[i][k] for i in _TOP) / 4 for k in (0, 1))
            draw.text((x, y), proxy.id, fill=colour, font=font, anchor="mm", stroke_width=2, stroke_fill="white")
    return encode_for_model(image)
