# SPDX-License-Identifier: GPL-3.0-or-later
"""Paints rooms of known content with Pillow, for the built-in picture analysis."""

from __future__ import annotations

import io
import json
import threading
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import pytest
from code_as_room.pipeline.artifacts.replies import AnalysisReply
from code_as_room.pipeline.models.base import Prompt
from code_as_room.pipeline.models.builtin.client import BuiltinClient
from PIL import Image, ImageDraw, ImageFilter

Box = tuple[float, float, float, float]
SCALE = 2  # painted twice as large and brought down, so that edges are smooth


@dataclass
class Painted:
    """A picture and what was painted: boxes and floor corners in 0-1000, x right, y down."""

    image: Image.Image
    floor: list[tuple[float, float]]
    boxes: dict[str, Box] = field(default_factory=dict)

    def png(self) -> bytes:
        return encode(self.image, "PNG")

    def jpeg(self, quality: int) -> bytes:
        return encode(self.image, "JPEG", quality=quality)


def encode(image: Image.Image, kind: str, **options: int) -> bytes:
    stream = io.BytesIO()
    image.save(stream, kind, **options)
    return stream.getvalue()


@dataclass(frozen=True)
class Style:
    """How a room is painted. Colours are RGB; `wood` is the plank contrast, `shrink` below 1 is a perspective view."""

    surround: tuple[int, int, int] = (245, 245, 245)
    wall: tuple[int, int, int] = (120, 122, 125)
    face: tuple[int, int, int] = (225, 222, 215)
    floor: tuple[int, int, int] = (190, 150, 110)
    wood: float = 6.0
    noise: float = 2.0
    shadow: float = 0.45
    shrink: float = 1.0
    notch: bool = False


class Painter:
    """Paints one room in metres; the room's centre is the picture's centre, y down here as in the picture."""

    def __init__(self, width: float, depth: float, style: Style, long_side: int, seed: int) -> None:
        self.rng = np.random.default_rng(seed)
        self.style = style
        self.width, self.depth = width, depth
        margin = 0.35
        span = max(width, depth) / style.shrink + 2 * margin
        self.px = long_side * SCALE / span
        size = [int((v / style.shrink + 2 * margin) * self.px) for v in (width, depth)]
        self.size = (size[0] // SCALE * SCALE, size[1] // SCALE * SCALE)
        self.image = Image.new("RGB", self.size, style.surround)
        self.boxes: dict[str, Box] = {}
        self.corners = self._corners()
        self._shell()

    def _corners(self) -> list[tuple[float, float]]:
        w, d = self.width / 2, self.depth / 2
        if not self.style.notch:
            return [(-w, -d), (w, -d), (w, d), (-w, d)]
        return [(-w, -d), (0.2 * w, -d), (0.2 * w, -0.2 * d), (w, -0.2 * d), (w, d), (-w, d)]

    def at(self, x: float, y: float, lift: float = 0.0) -> tuple[float, float]:
        """Pixels of a point; `lift` 0 is the floor, 1 the wall tops."""
        grow = 1.0 / (1.0 - lift * (1.0 - self.style.shrink))
        return self.size[0] / 2 + x * grow * self.px, self.size[1] / 2 + y * grow * self.px

    def _shell(self) -> None:
        style, draw = self.style, ImageDraw.Draw(self.image)
        top = [self.at(x, y, 1.0) for x, y in self.corners]
        thick = 0.13 * self.px
        draw.polygon(top, fill=style.wall)
        draw.line([*top, top[0], top[1]], fill=style.wall, width=int(2 * thick), joint="curve")
        floor = [self.at(x, y) for x, y in self.corners]
        if style.shrink < 1:
            for i in range(len(top)):
                j = (i + 1) % len(top)
                shade = (1.0, 0.94, 0.9, 0.96)[i % 4]
                draw.polygon([top[i], top[j], floor[j], floor[i]], fill=tuple(int(c * shade) for c in style.face))
        mask = Image.new("L", self.size, 0)
        ImageDraw.Draw(mask).polygon(floor, fill=255)
        self.image.paste(self._floor(), (0, 0), mask)

    def _floor(self) -> Image.Image:
        height, width = self.size[1], self.size[0]
        base = np.ones((height, width, 3)) * np.array(self.style.floor)
        if self.style.wood:
            rows = (np.arange(height) / (0.14 * self.px)).astype(int)
            shift = self.rng.uniform(0, 3, rows.max() + 1)[rows]
            planks = (np.arange(width)[None] / (1.1 * self.px) + shift[:, None]).astype(int)
            tone = self.rng.normal(0, self.style.wood, (rows.max() + 1, planks.max() + 1))
            base *= 1 + tone[rows[:, None], planks][..., None] / 255 * 1.5
            seam = (np.diff(rows, prepend=0) > 0)[:, None] | (np.diff(planks, axis=1, prepend=planks[:, :1]) > 0)
            base[seam] *= 0.93
        return Image.fromarray(np.clip(base, 0, 255).astype(np.uint8))

    def thing(
        self,
        name: str,
        x: float,
        y: float,
        w: float,
        d: float,
        colour: tuple[int, int, int],
        height: float = 0.3,
        turn: float = 0.0,
        round_: bool = False,
        record: bool = True,
    ) -> None:
        """A box or cylinder with a soft shadow and, in perspective, visible sides. `height` 1 reaches the wall tops."""
        angle = np.radians(turn)
        c, s = np.cos(angle), np.sin(angle)
        if round_:
            t = np.linspace(0, 2 * np.pi, 40, endpoint=False)
            local = np.stack([w / 2 * np.cos(t), d / 2 * np.sin(t)], 1)
        else:
            local = np.array([(-w, -d), (w, -d), (w, d), (-w, d)]) / 2
        ring = [(x + c * u - s * v, y + s * u + c * v) for u, v in local]
        if height > 0.02 and self.style.shadow:
            self._shadow([self.at(px + 0.05, py + 0.05) for px, py in ring])
        draw = ImageDraw.Draw(self.image)
        low, high = [self.at(*p) for p in ring], [self.at(*p, height) for p in ring]
        if self.style.shrink < 1:
            for i in range(len(ring)):
                j = (i + 1) % len(ring)
                draw.polygon([low[i], low[j], high[j], high[i]], fill=tuple(int(v * 0.8) for v in colour))
        draw.polygon(high, fill=colour, outline=tuple(int(v * 0.8) for v in colour))
        points = np.array(low + high) / np.array(self.size) * 1000
        if record:
            self.boxes[name] = (*points.min(0).tolist(), *points.max(0).tolist())

    def _shadow(self, polygon: list[tuple[float, float]]) -> None:
        mask = Image.new("L", self.size, 0)
        ImageDraw.Draw(mask).polygon(polygon, fill=int(255 * self.style.shadow))
        soft = mask.filter(ImageFilter.GaussianBlur(0.06 * self.px))
        self.image = Image.composite(Image.new("RGB", self.size, (0, 0, 0)), self.image, soft.point(lambda v: v * 0.8))

    def bed(
        self, x: float, y: float, w: float, d: float, linen: tuple[int, int, int], blanket: tuple[int, int, int]
    ) -> None:
        """A bed with its head at the top of the picture: linen, two pillows, a blanket over the lower part."""
        self.thing("bed", x, y, w, d, linen, 0.2)
        light = tuple(min(255, int(v * 1.04)) for v in linen)
        for side in (-1, 1):
            self.thing("pillow", x + side * w / 4, y - d / 2 + 0.3, w / 2.6, 0.4, light, 0.22, record=False)
        self.thing("blanket", x, y + 0.17 * d, w, 0.66 * d, blanket, 0.2, record=False)

    def finish(self) -> Painted:
        small = self.image.resize((self.size[0] // SCALE, self.size[1] // SCALE), Image.Resampling.LANCZOS)
        if self.style.noise:
            values = np.asarray(small, dtype=np.float64)
            values = values + self.rng.normal(0, self.style.noise, values.shape)
            small = Image.fromarray(np.clip(values, 0, 255).astype(np.uint8))
        floor = [
            (px / self.size[0] * 1000, py / self.size[1] * 1000) for px, py in (self.at(x, y) for x, y in self.corners)
        ]
        return Painted(small, floor, dict(self.boxes))


def paint_bedroom(style: Style = Style(), seed: int = 1, long_side: int = 700) -> Painted:
    """Bed on a rug between nightstands, wardrobe at the right wall, a turned armchair and a plant."""
    painter = Painter(4.2, 3.8, style, long_side, seed)
    down = 0.55 if style.notch else 0.0
    left = -0.9 if style.notch else -0.3
    painter.thing("rug", left, -0.25, 2.6, 1.5, (150, 160, 140), 0.0)
    painter.bed(left, -0.83, 1.6, 2.05, (238, 236, 232), (70, 100, 140))
    painter.thing(
        "nightstand_left", left - 1.08 if not style.notch else left + 1.08, -1.68, 0.45, 0.4, (110, 75, 50), 0.2
    )
    if not style.notch:
        painter.thing("nightstand_right", left + 1.08, -1.68, 0.45, 0.4, (110, 75, 50), 0.2)
    painter.thing("wardrobe", 1.78, 0.25 + down, 0.6, 1.6, (235, 232, 228), 0.55)
    painter.thing("armchair", -1.35, 1.15, 0.8, 0.75, (170, 80, 60), 0.3, turn=32)
    painter.thing("plant", 0.5, 1.45, 0.5, 0.5, (70, 130, 60), 0.3, round_=True)
    return painter.finish()


def paint_office(style: Style = Style(), seed: int = 1, long_side: int = 700) -> Painted:
    """A desk with a chair and a laptop, a sofa, shelves, a round table."""
    painter = Painter(4.6, 3.4, style, long_side, seed)
    painter.thing("desk", -0.9, -1.33, 1.5, 0.7, (225, 205, 175), 0.28)
    painter.thing("laptop", -0.9, -1.3, 0.36, 0.26, (40, 40, 45), 0.29)
    painter.thing("chair", -0.85, -0.68, 0.5, 0.5, (55, 60, 75), 0.3)
    painter.thing("sofa", 0.3, 1.22, 2.0, 0.9, (120, 130, 150), 0.3)
    painter.thing("shelf", 2.13, -0.5, 0.34, 1.7, (245, 243, 240), 0.6)
    painter.thing("round_table", -1.4, 0.7, 0.9, 0.9, (235, 225, 210), 0.27, round_=True)
    return painter.finish()


def ask(data: bytes, **facts: Any) -> tuple[AnalysisReply, tuple[str, ...]]:
    """The built-in client's validated answer to one picture, and its notes."""
    prompt = Prompt("s01_analysis", "01_analysis", "", (data,), "AnalysisReply", {}, "", facts)
    reply = BuiltinClient().answer(prompt, threading.Event())
    return AnalysisReply.model_validate(json.loads(reply.text)), reply.notes


def iou(a: Box, b: Box) -> float:
    width, height = min(a[2], b[2]) - max(a[0], b[0]), min(a[3], b[3]) - max(a[1], b[1])
    shared = max(width, 0) * max(height, 0)
    return shared / ((a[2] - a[0]) * (a[3] - a[1]) + (b[2] - b[0]) * (b[3] - b[1]) - shared)


@dataclass(frozen=True)
class Match:
    """Which painted things were found, and which found things were painted (majors only)."""

    found: dict[str, float]
    phantoms: list[str]
    majors: int
    outline_error: float

    @property
    def recall(self) -> float:
        return sum(v >= 0.5 for v in self.found.values()) / max(len(self.found), 1)

    @property
    def precision(self) -> float:
        return 1 - len(self.phantoms) / max(self.majors, 1)


def compare(painted: Painted, reply: AnalysisReply) -> Match:
    """Match by IoU; the outline's error is the worst corner's distance to its nearest found corner, 0-1000."""

    def box_of(item: Any) -> Box:
        return item.box.x_min, item.box.y_min, item.box.x_max, item.box.y_max

    boxes = [box_of(o) for o in reply.objects]
    found = {name: max((iou(box, b) for b in boxes), default=0.0) for name, box in painted.boxes.items()}
    majors = [o for o in reply.objects if o.salience == "major"]
    phantoms = [o.id for o in majors if max((iou(box_of(o), b) for b in painted.boxes.values()), default=0.0) < 0.4]
    corners = [(p.x, p.y) for p in reply.floor_polygon]
    errors = [min(max(abs(x - u), abs(y - v)) for u, v in corners) for x, y in painted.floor]
    return Match(found, phantoms, len(majors), max(errors))


@dataclass(frozen=True)
class Studio:
    """What the tests use."""

    style: type[Style]
    painter: type[Painter]
    bedroom: Callable[..., Painted]
    office: Callable[..., Painted]
    ask: Callable[..., tuple[AnalysisReply, tuple[str, ...]]]
    compare: Callable[[Painted, AnalysisReply], Match]
    encode: Callable[..., bytes]


@pytest.fixture(scope="session")
def studio() -> Studio:
    """Painters of rooms, the client, and the comparison."""
    return Studio(Style, Painter, paint_bedroom, paint_office, ask, compare, encode)
