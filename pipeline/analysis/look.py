# SPDX-License-Identifier: GPL-3.0-or-later
"""The pictures of the second look: found things drawn in and numbered, and enlarged parts."""

from __future__ import annotations

import io
from collections.abc import Sequence

from PIL import Image

from ..artifacts.analysis import DetectedObject, SceneAnalysis
from ..artifacts.common import ImageBox
from ..picture import ReferencePicture, encode_for_model

OVERLAP = 0.12
ENLARGED = 1100
"""Longer side in pixels that a part of the picture is enlarged to, at most three times."""


def numbered_boxes(picture: ReferencePicture, objects: Sequence[DetectedObject]) -> bytes:
    """The picture with each object's box and its number in the list, counted from 1."""
    return picture.with_boxes_drawn([(str(n), o.box) for n, o in enumerate(objects, 1) if o.box is not None])


def quarters(analysis: SceneAnalysis) -> list[ImageBox]:
    """Four overlapping parts that cover the room, in 0-1000 of the picture: top left, top right, bottom left, bottom right."""
    points = [*analysis.floor_polygon, *(analysis.wall_top_polygon or [])]
    boxes = [o.box for o in analysis.objects if o.box is not None]
    xs = [p.x for p in points] + [v for b in boxes for v in (b.x_min, b.x_max)]
    ys = [p.y for p in points] + [v for b in boxes for v in (b.y_min, b.y_max)]
    left, right = max(0.0, min(xs) - 10), min(1000.0, max(xs) + 10)
    top, bottom = max(0.0, min(ys) - 10), min(1000.0, max(ys) + 10)
    half_x, half_y = (right - left) * (0.5 + OVERLAP / 2), (bottom - top) * (0.5 + OVERLAP / 2)
    return [
        ImageBox(x_min=x, y_min=y, x_max=x + half_x, y_max=y + half_y)
        for y in (top, bottom - half_y)
        for x in (left, right - half_x)
    ]


def enlarged(picture: ReferencePicture, part: ImageBox) -> bytes:
    """A part of the picture, enlarged for the model when it is small."""
    data = picture.crop(part, margin=0.0)
    with Image.open(io.BytesIO(data)) as opened:
        image = opened.convert("RGB")
    factor = min(3.0, ENLARGED / max(image.size))
    if factor <= 1.0:
        return data
    size = (max(1, round(image.width * factor)), max(1, round(image.height * factor)))
    return encode_for_model(image.resize(size, Image.Resampling.LANCZOS))
