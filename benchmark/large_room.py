# SPDX-License-Identifier: GPL-3.0-or-later
"""A furnished room of 100 objects with its picture: what stages 8 to 10 begin with, made of numbers, always the same.

The picture is drawn by rays on boxes: boards on the floor, patterned rugs, plain walls, furniture in one colour a thing.
"""

from __future__ import annotations

import io
import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from code_as_room.pipeline.artifacts.analysis import Calibration, SceneAnalysis
from code_as_room.pipeline.artifacts.layout import (
    DoorLine,
    Layout,
    LayoutProgram,
    ProxyLine,
    RoomLine,
    Score,
    WallLine,
    WindowLine,
)
from code_as_room.pipeline.artifacts.objects import Descriptions, MeasuredColour, ObjectDescription, RoomStyle
from code_as_room.pipeline.geometry.camera import Projector, camera_straight_down
from code_as_room.pipeline.geometry.placement import Rect, is_inside, penetration
from code_as_room.pipeline.library import catalogue
from code_as_room.pipeline.light.space import SKY, WALLS, space_of
from code_as_room.pipeline.objects.colours import from_code
from code_as_room.pipeline.picture import ReferencePicture, read_picture
from code_as_room.pipeline.program.lines import print_layout
from code_as_room.pipeline.stages.base import View
from PIL import Image

SIZE, HEIGHT = (1280, 960), 2.7
FLOOR = [(-5.6, -4.2), (5.6, -4.2), (5.6, 4.2), (-5.6, 4.2)]
RUGS = ("floor_rug", "floor_rug", "floor_rug")
AT_WALLS = ("wardrobe", "bookcase", "sideboard", "desk", "chest_of_drawers", "double_bed", "tv_stand", "console_table",
            "bookcase", "sideboard", "chest_of_drawers", "cabinet", "desk", "sideboard", "wardrobe")  # fmt: skip
FREE = ("sofa", "dining_table", "coffee_table", "armchair", "armchair", "round_table", "floor_lamp", "chair", "chair",
        "chair", "chair", "chair", "ottoman", "potted_plant", "side_table", "nightstand", "side_table", "floor_lamp",
        "wing_chair", "ottoman", "stool", "stool", "office_chair", "armchair")  # fmt: skip
HUNG = ("picture_frame", "picture_frame", "picture_frame", "wall_mirror", "wall_clock", "curtain_pair")
OVERHEAD = ("pendant", "chandelier", "ceiling_lamp")
SMALL = ("table_lamp", "book_stack", "empty_vase", "mug", "plate", "bowl", "bottle", "candle", "laptop", "monitor",
         "small_plant", "photo_frame", "tray", "teapot", "speaker", "candle_holder")  # fmt: skip
CARRIERS = frozenset({"sideboard", "desk", "chest_of_drawers", "tv_stand", "console_table", "dining_table", "coffee_table",
                      "round_table", "side_table", "nightstand"})  # fmt: skip
COLOURS = ("8A5F3C", "C7B299", "3E4A56", "E8E2D6", "7A8B6F", "A8553F", "2E2B28", "B9A27E", "5C6F82", "D9C7A8")


@dataclass
class LargeRoom:
    """The room's layout and program text, its picture, and what earlier stages said of it."""

    layout: Layout
    text: str
    picture: ReferencePicture
    artifacts: dict[type, Any]

    def view(self, text: str, stage: str, recalled: dict[type, Any]) -> View:
        """What a stage sees when this text of an earlier stage stands."""
        program = LayoutProgram(text=text, stage=stage, score=_SCORE)
        return View(self.picture, {**self.artifacts, LayoutProgram: program}, recalled=recalled)


_SCORE = Score(total=1, measured=1, coverage=1, overlap=1, bounds=1, relations=1, boxes=1)


def make_room(count: int = 100, seed: int = 3) -> LargeRoom:
    """The room with so many objects, the last of which are small things on furniture."""
    rng = np.random.default_rng(seed)
    layout = _shell()
    pieces = _Placing(layout, rng)
    pieces.furnish(count)
    camera = camera_straight_down("perspective", 11.2, 8.4, SIZE, 38.0, top=HEIGHT)
    layout = layout.model_copy(update={"proxies": pieces.proxies})
    colours = {p.id: str(rng.choice(COLOURS)) for p in layout.proxies}
    picture = _picture(layout, camera, colours)
    described = [_described(p, colours[p.id], rng) for p in layout.proxies]
    calibration = Calibration(camera=camera, floor=FLOOR, height=HEIGHT, error_px=0, scale_source="truth")
    artifacts: dict[type, Any] = {
        SceneAnalysis: SceneAnalysis(
            image_size=SIZE, view="perspective", room_size=(11.2, 8.4, HEIGHT), floor=FLOOR, floor_polygon=[]
        ),
        Calibration: calibration,
        Descriptions: Descriptions(objects=described),
        RoomStyle: RoomStyle(style="warm and plain", gains=(1.1, 1.15, 1.25)),
    }
    return LargeRoom(layout, _text(layout, pieces.made), picture, artifacts)


def _shell() -> Layout:
    walls = [
        WallLine(id=f"wall_{i + 1}", start=a, end=b, height=HEIGHT)
        for i, (a, b) in enumerate(zip(FLOOR, FLOOR[1:] + FLOOR[:1], strict=True))
    ]
    doors = [DoorLine(id="door_1", wall="wall_1", start=(3.9, -4.2), end=(4.8, -4.2), open=60.0)]
    windows = [
        WindowLine(id="window_1", wall="wall_3", start=(1.0, 4.2), end=(-0.8, 4.2)),
        WindowLine(id="window_2", wall="wall_4", start=(-5.6, 1.2), end=(-5.6, -0.4)),
    ]
    room = RoomLine(size=(11.2, 8.4, HEIGHT), floor=FLOOR)
    return Layout(room=room, walls=walls, doors=doors, windows=windows)


class _Placing:
    """Puts library pieces into the room, none through another."""

    def __init__(self, layout: Layout, rng: np.random.Generator) -> None:
        self.layout, self.rng = layout, rng
        self.known = catalogue.pieces()
        self.proxies: list[ProxyLine] = []
        self.made: dict[str, str] = {}
        self.taken = [Rect(4.35, -3.75, 0.95, 0.95)]

    def furnish(self, count: int) -> None:
        """Rugs, furniture, what hangs, then small things until there are `count`."""
        for name in RUGS:
            self._try(name, lambda s: (*self._anywhere(), s[2] / 2), rug=True)
        for name in AT_WALLS:
            self._try(name, self._at_wall)
        for name in FREE:
            self._try(name, lambda s: (*self._anywhere(), s[2] / 2))
        for n, name in enumerate(HUNG):
            w, d, h = self.known[name].typical
            z = h / 2 + 0.02 if name == "curtain_pair" else 1.7
            self._put(name, (-4.6 + 1.7 * n, 4.2 - d / 2, z), (w, d, h), 0.0, placement="wall", salience="minor")
        for n, name in enumerate(OVERHEAD):
            w, d, h = self.known[name].typical
            self._put(name, (-3.0 + 3.0 * n, 0.0, HEIGHT - h / 2), (w, d, h), 0.0, placement="ceiling")
        carriers = [p for p in self.proxies if self._piece(p) in CARRIERS]
        n = 0
        while len(self.proxies) < count and n < 40 * count:
            self._load(carriers[n % len(carriers)], SMALL[n % len(SMALL)], n)
            n += 1

    def _piece(self, proxy: ProxyLine) -> str:
        return self.made[proxy.id].partition("(")[0]

    def _put(
        self, name: str, centre: tuple[float, ...], size: tuple[float, float, float], yaw: float, **more: Any
    ) -> None:
        identifier = f"{name}_{len(self.proxies) + 1}"
        at = tuple(round(v, 4) for v in centre)
        values = {"id": identifier, "category": name.replace("_", " "), "centre": at, "size": size, "yaw": yaw, **more}
        self.proxies.append(ProxyLine.model_validate(values))
        self.made[identifier] = name

    def _anywhere(self) -> tuple[float, float]:
        return float(self.rng.uniform(-5.4, 5.4)), float(self.rng.uniform(-4.0, 4.0))

    def _at_wall(self, size: tuple[float, float, float]) -> tuple[float, ...]:
        """Centre and yaw flush at a wall."""
        w, d, h = size
        side = int(self.rng.integers(4))
        x, y = self._anywhere()
        at = ((x, 4.2 - d / 2), (x, d / 2 - 4.2), (5.6 - d / 2, y), (d / 2 - 5.6, y))[side]
        yaw = (0.0, 180.0, 270.0, 90.0)[side]
        return (*at, h / 2, yaw)

    def _try(self, name: str, place: Any, rug: bool = False) -> None:
        size = self.known[name].typical
        for _ in range(400):
            found = place(size)
            yaw = found[3] if len(found) > 3 else float(self.rng.choice([0, 90, 180, 270, self.rng.integers(360)]))
            rect = Rect(found[0], found[1], size[0], size[1], yaw)
            wide = Rect(found[0], found[1], size[0] + 0.06, size[1] + 0.06, yaw)
            free = rug or not any((deep := penetration(wide, o)) and deep[0] > 0.01 for o in self.taken)
            if free and is_inside(rect, FLOOR):
                if not rug:
                    self.taken.append(rect)
                self._put(name, found[:3], size, yaw)
                return

    def _load(self, carrier: ProxyLine, name: str, number: int) -> None:
        """A small thing on a carrier, off those that stand there."""
        size = self.known[name].typical
        angle = math.radians(carrier.yaw)
        beside = [Rect(p.centre[0], p.centre[1], p.size[0] + 0.02, p.size[1] + 0.02, p.yaw)
                  for p in self.proxies if p.parent == carrier.id]  # fmt: skip
        for _ in range(30):
            u, v = (float(self.rng.uniform(-0.5, 0.5)) * max(0.0, carrier.size[k] - size[k] - 0.06) for k in (0, 1))
            x = carrier.centre[0] + u * math.cos(angle) - v * math.sin(angle)
            y = carrier.centre[1] + u * math.sin(angle) + v * math.cos(angle)
            rect = Rect(x, y, size[0], size[1], carrier.yaw)
            if all(penetration(rect, other) is None for other in beside):
                top = carrier.centre[2] + carrier.size[2] / 2
                self._put(name, (x, y, top + size[2] / 2), size, carrier.yaw, placement="surface", parent=carrier.id,
                          salience="minor")  # fmt: skip
                return


def _text(layout: Layout, made: dict[str, str]) -> str:
    """The program as stage 6 writes it: one def a kind of thing, furnished by name."""
    names = sorted(set(made.values()))
    lines = print_layout(layout).removesuffix("build()\n")
    furnish = [f'furnish("{identifier}", {name})' for identifier, name in made.items()]
    return "\n".join([lines, catalogue.source(names), *furnish, "", "build()", ""])


def _described(proxy: ProxyLine, code: str, rng: np.random.Generator) -> ObjectDescription:
    other = str(rng.choice(COLOURS))
    measured = [MeasuredColour(code=code, share=0.6), MeasuredColour(code=other, share=0.3)]
    words = str(rng.choice(["oak", "painted wood", "linen", "brushed metal", "glazed ceramic", ""]))
    return ObjectDescription(id=proxy.id, material=words, measured=measured, seen=float(rng.uniform(0.2, 1.0)))


def _picture(layout: Layout, camera: Any, colours: dict[str, str]) -> ReferencePicture:
    """What the camera sees of the room's boxes, in plain light."""
    space = space_of(layout)
    lens = Projector.of(camera)
    x, y = np.meshgrid(np.arange(SIZE[0]) + 0.5, np.arange(SIZE[1]) + 0.5)
    origins, ways = lens.rays(np.stack([x.ravel(), y.ravel()], axis=1))
    distance, surface, normal = space.hit(origins, ways, ceiling=False)
    points = origins + ways * distance[:, None]
    tint = np.full((len(points), 3), 0.75)
    floor = surface == 0
    tint[floor] = _boards(points[floor])
    for proxy in layout.proxies:
        if proxy.category == "floor rug":
            _rug(tint, points, floor, proxy, from_code(colours[proxy.id]))
    tint[(surface >= WALLS) & (surface < WALLS + len(space.walls))] = (0.72, 0.68, 0.6)
    for number, owner in enumerate(space.boxes.owners):
        tint[surface == WALLS + len(space.walls) + number] = from_code(colours[owner])
    light = 0.55 + 0.35 * np.abs(normal[:, 2]) + 0.1 * normal[:, 0]
    tint *= np.where(surface == SKY, 1.0, light)[:, None]
    tint += np.random.default_rng(4).normal(0, 0.004, tint.shape)
    screen = np.clip(tint, 0.0, 1.0) ** (1 / 2.2)
    buffer = io.BytesIO()
    Image.fromarray((255 * screen.reshape(SIZE[1], SIZE[0], 3)).astype(np.uint8)).save(buffer, "PNG")
    return read_picture(buffer.getvalue(), "room.png")


def _boards(points: np.ndarray) -> np.ndarray:
    row = np.floor(points[:, 1] / 0.14).astype(int)
    board = np.floor(points[:, 0] / 1.3 + (row * 0.37) % 1.0).astype(int)
    tone = np.random.default_rng(2).random(4000)[(row * 37 + board * 11) % 4000]
    grain = 0.03 * np.sin(points[:, 1] * 160 + 2 * np.sin(points[:, 0] * 3 + tone * 40))
    light = np.where(np.abs((points[:, 1] / 0.14) % 1.0 - 0.5) > 0.46, 0.1, 0.3 + 0.12 * tone + grain)
    result: np.ndarray = light[:, None] * np.array((1.25, 1.0, 0.7))
    return result


def _rug(tint: np.ndarray, points: np.ndarray, floor: np.ndarray, rug: ProxyLine, colour: Any) -> None:
    c, s = math.cos(math.radians(rug.yaw)), math.sin(math.radians(rug.yaw))
    dx, dy = points[:, 0] - rug.centre[0], points[:, 1] - rug.centre[1]
    u, v = c * dx + s * dy, c * dy - s * dx
    on = floor & (np.abs(u) < rug.size[0] / 2) & (np.abs(v) < rug.size[1] / 2)
    stripes = 0.75 + 0.25 * np.sign(np.sin(14 * u[on]) * np.sin(14 * v[on]))
    tint[on] = colour * stripes[:, None]
