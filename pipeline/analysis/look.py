# SPDX-License-Identifier: GPL-3.0-or-later
"""The pictures of the second look: found things drawn in and numbered, and enlarged parts."""

from __future__ import annotations

import io
from collections.abc import Sequence

from PIL import Image

from ..artifacts.analysis import DetectedObject, SceneAnalysis
from ..artifacts.common import ImageBox
from ..picture import ReferencePicture, encode_for_model
from ..picture_boxes import draw_grid

OVERLAP = 0.12
MOST_SURFACES = 3
LEAST_ENLARGED = 1.6
"""A surface is shown by itself when it comes out so much larger than in its quarter of the picture."""
AROUND = 0.08
"""How much is shown around a surface, as a part of its longer side."""
TOP = (0.3, 1.4)
"""Heights in metres between which a top is looked at for small things."""
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


def dense_surfaces(objects: Sequence[DetectedObject], part: ImageBox) -> list[tuple[str, ImageBox]]:
    """Up to three things that carry many small ones, or could: id, and the part of the picture that shows it.

    What carries two or more things comes first, then the largest tops at the height of tables and beds.

    Args:
        part: a quarter as the model sees it besides; what is shown not much larger than there is left out.
    """
    carried: dict[str, int] = {}
    for item in objects:
        if item.placement == "surface" and item.parent:
            carried[item.parent] = carried.get(item.parent, 0) + 1
    longest = max(part.x_max - part.x_min, part.y_max - part.y_min)
    ranked = []
    for item in objects:
        count = carried.get(item.id, 0)
        flat_top = TOP[0] <= item.centre[2] + item.size[2] / 2 <= TOP[1] and item.placement in ("floor", "wall")
        if item.box is None or not (count >= 2 or flat_top):
            continue
        crop = _around(item.box)
        if max(crop.x_max - crop.x_min, crop.y_max - crop.y_min) * LEAST_ENLARGED <= longest:
            ranked.append((-min(count, 9) if count >= 2 else 0, -item.box.area, item.id, crop))
    chosen: list[tuple[str, ImageBox]] = []
    for _, _, name, crop in sorted(ranked, key=lambda r: r[:3]):
        if len(chosen) < MOST_SURFACES and all(crop.iou(other) < 0.5 for _, other in chosen):
            chosen.append((name, crop))
    return chosen


def _around(box: ImageBox) -> ImageBox:
    margin = max(8.0, AROUND * max(box.x_max - box.x_min, box.y_max - box.y_min))
    return ImageBox(
        x_min=max(0.0, box.x_min - margin),
        y_min=max(0.0, box.y_min - margin),
        x_max=min(1000.0, box.x_max + margin),
        y_max=min(1000.0, box.y_max + margin),
    )


def enlarged(picture: ReferencePicture, part: ImageBox, grid: bool = True) -> bytes:
    """A part of the picture with its own 0-1000 grid, enlarged for the model when it is small."""
    with Image.open(io.BytesIO(picture.crop(part, margin=0.0))) as opened:
        image = opened.convert("RGB")
    factor = min(3.0, ENLARGED / max(image.size))
    if factor > 1.0:
        size = (max(1, round(image.width * factor)), max(1, round(image.height * factor)))
        image = image.resize(size, Image.Resampling.LANCZOS)
    if grid:
        draw_grid(image)
    return encode_for_model(image)
