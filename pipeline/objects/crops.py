# SPDX-License-Identifier: GPL-3.0-or-later
"""Crops of objects, and sheets on which a crop and renders of the same object stand side by side."""

from __future__ import annotations

import io
from collections.abc import Sequence

import numpy as np
from PIL import Image, ImageDraw, ImageFont

from ..artifacts.common import ImageBox
from ..picture import ReferencePicture, encode_for_model

CROP = 512
"""Longest side of a crop, pixels."""
SMALLEST = 320
"""Crops whose longest side is shorter are enlarged to it."""
TILE = 384
"""Side of one picture of a sheet."""
_NARROW, _WIDE = 0.12, 0.45
_LARGE, _TINY = 180.0, 30.0
_MARK = (255, 0, 200)
_BAR = 22


def margin_of(long_side: float) -> float:
    """How much of what is round an object its crop shows, as a part of its longer side in pixels: more for tiny things."""
    share = min(1.0, max(0.0, (_LARGE - long_side) / (_LARGE - _TINY)))
    return _NARROW + (_WIDE - _NARROW) * share


def marked_crop(picture: ReferencePicture, box: ImageBox) -> bytes:
    """An object's part of the picture with what is round it, corners of its box marked; enlarged where it is small."""
    width, height = picture.width, picture.height
    left, right = (float(np.clip(x, 0, 1000)) * width / 1000 for x in (box.x_min - 4, box.x_max + 4))
    top, bottom = (float(np.clip(y, 0, 1000)) * height / 1000 for y in (box.y_min - 4, box.y_max + 4))
    extra = margin_of(max(right - left, bottom - top)) * max(right - left, bottom - top)
    corners = (
        max(0, int(left - extra)), max(0, int(top - extra)), min(width, int(np.ceil(right + extra))),
        min(height, int(np.ceil(bottom + extra))),
    )  # fmt: skip
    wide = ImageBox(
        x_min=corners[0] * 1000 / width, y_min=corners[1] * 1000 / height, x_max=corners[2] * 1000 / width,
        y_max=corners[3] * 1000 / height,
    )  # fmt: skip
    image = Image.open(io.BytesIO(picture.crop(wide, 0.0, CROP))).convert("RGB")
    long_side = max(image.size)
    if long_side < SMALLEST:
        size = (round(image.width * SMALLEST / long_side), round(image.height * SMALLEST / long_side))
        image = image.resize((max(1, size[0]), max(1, size[1])), Image.Resampling.LANCZOS)
    factor = image.width / max(1, corners[2] - corners[0])
    _mark(image, [(v - o) * factor for v, o in zip((left, top, right, bottom), corners[:2] * 2, strict=True)])
    return encode_for_model(image)


def _mark(image: Image.Image, box: Sequence[float]) -> None:
    """Short strokes at the corners of a box, so that nothing of what is in it is hidden."""
    draw = ImageDraw.Draw(image)
    left, top, right, bottom = box
    long = 0.08 * max(right - left, bottom - top) + 4
    for x, way in ((left, 1), (right, -1)):
        for y, up in ((top, 1), (bottom, -1)):
            draw.line((x, y, x + way * long, y), fill=_MARK, width=2)
            draw.line((x, y, x, y + up * long), fill=_MARK, width=2)


def sheet(tiles: Sequence[tuple[str, bytes]], side: int = TILE) -> bytes:
    """Pictures side by side in squares of the same size, each with its title above; PNG or JPEG bytes."""
    page = Image.new("RGB", (max(1, len(tiles)) * (side + 4), side + _BAR), "white")
    draw = ImageDraw.Draw(page)
    font = ImageFont.load_default(15)
    for number, (title, data) in enumerate(tiles):
        image = Image.open(io.BytesIO(data)).convert("RGB")
        factor = side / max(image.size)
        size = (max(1, round(image.width * factor)), max(1, round(image.height * factor)))
        at = number * (side + 4)
        spot = (at + (side - size[0]) // 2, _BAR + (side - size[1]) // 2)
        page.paste(image.resize(size, Image.Resampling.LANCZOS), spot)
        draw.text((at + 4, 2), title, font=font, fill=(0, 0, 0))
    return encode_for_model(page)


def side_by_side(page: bytes, count: int) -> list[bytes]:
    """The pictures of a page that holds so many of one width beside each other, PNG."""
    image = Image.open(io.BytesIO(page)).convert("RGB")
    found = []
    for number in range(count):
        buffer = io.BytesIO()
        left, right = image.width * number // count, image.width * (number + 1) // count
        image.crop((left, 0, right, image.height)).save(buffer, "PNG", compress_level=1)
        found.append(buffer.getvalue())
    return found
