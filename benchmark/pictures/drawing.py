# SPDX-License-Identifier: GPL-3.0-or-later
"""Draws a scene as an architect's plan: filled walls, door swings, furniture symbols, dimensions. Black on white."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from code_as_room.pipeline.geometry.camera import Projector
from PIL import Image, ImageDraw, ImageFont

from .model import Item, Opening, Point, Scene, outset
from .symbols import SYMBOLS, Stroke
from .truth import Sight, box_of

_FINE = 4  # the plan is drawn so many times larger, then reduced
_THICK, _THIN = 2.2, 1.1  # widths of lines in pixels of the picture
_INK, _GREY = 0, 120


class Sheet:
    """A white page in metres."""

    def __init__(self, scene: Scene, mode: str = "L", fine: int = _FINE) -> None:
        self.lens, self.fine = Projector.of(scene.camera), fine
        width, height = scene.camera.image_size
        self.image = Image.new(mode, (width * fine, height * fine), 255 if mode == "L" else 0)
        self.pen = ImageDraw.Draw(self.image)

    def pixels(self, points: Sequence[Point]) -> list[tuple[float, float]]:
        """Where points of the floor are on the fine page."""
        found = self.lens.pixels(np.array([(x, y, 0.0) for x, y in points])) * self.fine
        return [(float(x), float(y)) for x, y in found]

    def fill(self, points: Sequence[Point], grey: int) -> None:
        """A filled outline."""
        self.pen.polygon(self.pixels(points), fill=grey)

    def line(self, points: Sequence[Point], width: float = _THICK, grey: int = _INK, closed: bool = False) -> None:
        """A line through points, with round joints."""
        places = self.pixels([*points, points[0]] if closed else points)
        wide = max(1, round(width * self.fine))
        self.pen.line(places, fill=grey, width=wide)
        for x, y in places:
            self.pen.ellipse((x - wide / 2, y - wide / 2, x + wide / 2, y + wide / 2), fill=grey)

    def text(self, at: Point, words: str, height: float, turned: bool = False) -> None:
        """Words around a point, `height` pixels of the picture high; turned: to be read from the right."""
        font = ImageFont.load_default(size=height * self.fine)
        left, top, right, bottom = (round(v) for v in font.getbbox(words))
        label = Image.new("L", (right - left + 8, bottom - top + 8), 0)
        ImageDraw.Draw(label).text((4 - left, 4 - top), words, fill=255, font=font)
        label = label.rotate(90, expand=True) if turned else label
        ((x, y),) = self.pixels([at])
        self.image.paste(60, (round(x - label.width / 2), round(y - label.height / 2)), label)


def draw(scene: Scene) -> Image.Image:
    """The plan."""
    sheet = Sheet(scene)
    outer = outset(scene.floor, scene.thickness)
    sheet.fill(outer, _INK)
    sheet.fill(scene.floor, 255)
    for opening in scene.openings:
        _opening(sheet, scene, opening)
    for item in _upwards(scene):
        _symbol(sheet, item)
    _dimensions(sheet, scene)
    size = scene.camera.image_size
    return sheet.image.resize(size, Image.Resampling.BOX).quantize(32).convert("L")


def _upwards(scene: Scene) -> list[Item]:
    """What is lower first; a thing always after what it lies on, a chair's seat before the table that it is pushed under."""
    tops: dict[str, float] = {}
    for item in scene.items:
        top = (item.base or 0.0) + item.size[2]
        top = max(top, tops[item.parent] + 0.01) if item.parent else top
        tops[item.id] = min(top, tops[item.under] - 0.01) if item.under else top
    return sorted(scene.items, key=lambda item: tops[item.id])


def _symbol(sheet: Sheet, item: Item) -> None:
    width, depth = item.size[:2]
    strokes: list[Stroke] = SYMBOLS[item.piece](width, depth)
    for stroke in strokes:
        points = item.to_room(stroke.points)
        if stroke.filled:
            sheet.fill(points, 255)
        sheet.line(points, _THIN if stroke.thin else _THICK, _INK, stroke.closed)


def _opening(sheet: Sheet, scene: Scene, o: Opening) -> None:
    a, b = scene.floor[o.wall], scene.floor[(o.wall + 1) % len(scene.floor)]
    length = math.dist(a, b)
    along = ((b[0] - a[0]) / length, (b[1] - a[1]) / length)
    out = (along[1], -along[0])

    def at(t: float, away: float) -> Point:
        return a[0] + along[0] * t + out[0] * away, a[1] + along[1] * t + out[1] * away

    deep = scene.thickness
    over = 0.01  # so that no hairline of the wall remains
    hole = [at(o.start, -over), at(o.end, -over), at(o.end, deep + over), at(o.start, deep + over)]
    sheet.fill(hole, 255)
    for t in (o.start, o.end):
        sheet.line([at(t, 0), at(t, deep)])
    if o.kind == "window":
        for away, width in ((0.0, _THICK), (deep * 0.42, _THIN), (deep * 0.58, _THIN), (deep, _THICK)):
            sheet.line([at(o.start, away), at(o.end, away)], width)
        return
    if o.kind != "door":
        for away in (0.0, deep):
            sheet.line([at(o.start, away), at(o.end, away)], _THIN, _GREY)
        return
    hinge, wide = (o.start if o.hinge == "start" else o.end), o.end - o.start
    side = 1 if o.hinge == "start" else -1
    turns = [math.radians(o.degrees) * i / 24 for i in range(25)]
    swing = [at(hinge + side * wide * math.cos(t), -wide * math.sin(t)) for t in turns]
    sheet.line(swing, _THIN)
    sheet.line([at(hinge, 0), swing[-1]], _THICK + 1)
    sheet.line([at(o.start, deep), at(o.end, deep)], _THIN, _GREY)


def _dimensions(sheet: Sheet, scene: Scene) -> None:
    """Inner width below and inner depth at the left, with ticks; the room's name in the middle of free floor."""
    xs, ys = [p[0] for p in scene.floor], [p[1] for p in scene.floor]
    y = min(ys) - scene.thickness - 0.28
    x = min(xs) - scene.thickness - 0.28
    sheet.line([(min(xs) - 0.1, y), (max(xs) + 0.1, y)], _THIN)
    sheet.line([(x, min(ys) - 0.1), (x, max(ys) + 0.1)], _THIN)
    for end in (min(xs), max(xs)):
        sheet.line([(end - 0.06, y - 0.06), (end + 0.06, y + 0.06)])
    for end in (min(ys), max(ys)):
        sheet.line([(x - 0.06, end - 0.06), (x + 0.06, end + 0.06)])
    sheet.text(((min(xs) + max(xs)) / 2, y - 0.14), f"{max(xs) - min(xs):.2f}", 17)
    sheet.text((x - 0.14, (min(ys) + max(ys)) / 2), f"{max(ys) - min(ys):.2f}", 17, turned=True)


def sights(scene: Scene) -> dict[str, Sight]:
    """How the plan shows every item: the box of its footprint, and how much of it is covered by what is higher."""
    lens = Projector.of(scene.camera)
    fine = 2
    sheet = Sheet(scene, "I", fine)
    alone: dict[str, int] = {}
    order = _upwards(scene)
    for number, item in enumerate(order, 1):
        sheet.fill(footprint(item), number)
        single = Sheet(scene, "1", fine)
        single.fill(footprint(item), 1)
        alone[item.id] = int(np.asarray(single.image).sum())
    pixels = np.asarray(sheet.image)
    found = {}
    for number, item in enumerate(order, 1):
        points = lens.pixels(np.array([(x, y, 0.0) for x, y in footprint(item)]))
        rows, columns = np.nonzero(pixels == number)
        if not len(rows):
            found[item.id] = Sight(box_of(points, scene.camera.image_size), 0.0)
            continue
        corners = np.array([[columns.min(), rows.min()], [columns.max() + 1, rows.max() + 1]]) / fine
        share = round(min(1.0, len(rows) / alone[item.id]), 3)
        size = scene.camera.image_size
        found[item.id] = Sight(box_of(points, size), share, box_of(corners, size))
    return found


def footprint(item: Item) -> list[Point]:
    """An item's outline on the floor."""
    x, y = item.size[0] / 2, item.size[1] / 2
    if item.outline:
        return item.to_room(item.outline)
    if item.shape == "round":
        turns = [2 * math.pi * i / 64 for i in range(64)]
        return item.to_room([(x * math.cos(t), y * math.sin(t)) for t in turns])
    return item.to_room([(-x, -y), (x, -y), (x, y), (-x, y)])
