# SPDX-License-Identifier: GPL-3.0-or-later
"""Draws labelled boxes into a picture, for the second look and for overlays in the report."""

from __future__ import annotations

from collections.abc import Sequence

from PIL import Image, ImageDraw, ImageFont

from .artifacts.common import ImageBox

_COLOURS = ((255, 64, 64), (64, 160, 255), (255, 176, 0), (48, 200, 96), (232, 96, 255), (0, 208, 208))
_Rect = tuple[float, float, float, float]


def draw_boxes(image: Image.Image, boxes: Sequence[tuple[str, ImageBox]]) -> None:
    """Draw thin boxes with their labels into an RGB image, in place.

    Labels stand on dark plates; each takes the corner of its box where it covers the fewest other labels.

    Args:
        boxes: (label, box) pairs, boxes in 0-1000 of the image's width and height; what lies outside is cut off.
    """
    draw = ImageDraw.Draw(image)
    size = max(13, round(max(image.size) / 80))
    line = max(2, round(max(image.size) / 700))
    font = ImageFont.load_default(size)
    rects = [_pixels(box, image.size) for _, box in boxes]
    for index, rect in enumerate(rects):
        # Thin dark edges on both sides of the coloured line keep it visible on any ground.
        draw.rectangle((rect[0] - 1, rect[1] - 1, rect[2] + 1, rect[3] + 1), outline=(0, 0, 0), width=line + 2)
        draw.rectangle(rect, outline=_COLOURS[index % len(_COLOURS)], width=line)
    taken: list[_Rect] = []
    for index, (label, _) in enumerate(boxes):
        text = label[:24]
        left, top, right, bottom = draw.textbbox((0, 0), text, font=font)
        plate = (right - left + 6.0, bottom - top + 5.0)
        place = _free_place(rects[index], plate, image.size, taken)
        taken.append(place)
        draw.rectangle(place, fill=(0, 0, 0))
        draw.text((place[0] + 3 - left, place[1] + 2 - top), text, font=font, fill=_light(index))


def draw_grid(image: Image.Image) -> None:
    """Draw a coarse grid over an RGB image, in place: a thin line every 100 units of 0-1000, with its number at the edges.

    A model that reads coordinates off lines errs less than one that has to guess them.
    """
    over = Image.new("RGBA", image.size, (0, 0, 0, 0))
    draw = ImageDraw.Draw(over)
    font = ImageFont.load_default(max(11, round(max(image.size) / 95)))
    width, height = image.size
    for step in range(100, 1000, 100):
        x, y = step * width / 1000, step * height / 1000
        for offset, colour in ((0, (255, 255, 255, 120)), (1, (0, 0, 0, 120))):
            draw.line((x + offset, 0, x + offset, height), fill=colour)
            draw.line((0, y + offset, width, y + offset), fill=colour)
    for step in range(100, 1000, 100):
        x, y = step * width / 1000, step * height / 1000
        for place, anchor in (((x, 2), "ma"), ((x, height - 2), "md"), ((2, y), "lm"), ((width - 2, y), "rm")):
            plate = draw.textbbox(place, str(step), font=font, anchor=anchor)
            draw.rectangle((plate[0] - 2, plate[1] - 1, plate[2] + 2, plate[3] + 1), fill=(0, 0, 0, 200))
            draw.text(place, str(step), font=font, fill=(255, 255, 160, 255), anchor=anchor)
    image.paste(over, (0, 0), over)


def _light(index: int) -> tuple[int, int, int]:
    """The box's colour, lightened so that small text stays legible on black."""
    red, green, blue = _COLOURS[index % len(_COLOURS)]
    return (red + 255) // 2, (green + 255) // 2, (blue + 255) // 2


def _pixels(box: ImageBox, size: tuple[int, int]) -> _Rect:
    """The box in pixels, ordered and inside the image."""
    width, height = size[0] - 1, size[1] - 1
    xs = sorted(min(max(x * size[0] / 1000, 0.0), width) for x in (box.x_min, box.x_max))
    ys = sorted(min(max(y * size[1] / 1000, 0.0), height) for y in (box.y_min, box.y_max))
    return xs[0], ys[0], xs[1], ys[1]


def _free_place(rect: _Rect, plate: tuple[float, float], size: tuple[int, int], taken: Sequence[_Rect]) -> _Rect:
    """Where a label's plate goes: inside a corner of the box or beside it, with the least overlap."""
    left, top, right, bottom = rect
    wide, high = plate
    middle = (left + right - wide) / 2
    corners = [
        (left, top), (right - wide, top), (left, bottom - high), (right - wide, bottom - high),
        (left, top - high), (left, bottom), (middle, top), (middle, (top + bottom - high) / 2),
    ]  # fmt: skip
    best: tuple[float, _Rect] | None = None
    for x, y in corners:
        x = min(max(x, 0.0), max(0.0, size[0] - 1 - wide))
        y = min(max(y, 0.0), max(0.0, size[1] - 1 - high))
        place = (x, y, x + wide, y + high)
        covered = sum(_overlap(place, other) for other in taken)
        if best is None or covered < best[0]:
            best = (covered, place)
    assert best is not None
    return best[1]


def _overlap(a: _Rect, b: _Rect) -> float:
    width = min(a[2], b[2]) - max(a[0], b[0])
    height = min(a[3], b[3]) - max(a[1], b[1])
    return width * height if width > 0 and height > 0 else 0.0
