# SPDX-License-Identifier: GPL-3.0-or-later
"""Rooms made of numbers without a fault, and faults of every kind put into them; always the same for the same number."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np
from code_as_room.pipeline.artifacts.correction import FAULT_KINDS, FaultKind
from code_as_room.pipeline.artifacts.layout import (
    CameraLine,
    DoorLine,
    Layout,
    LightLine,
    ProxyLine,
    RoomLine,
    WallLine,
    WorldLine,
)
from code_as_room.pipeline.correction.correct import Options, find_faults
from code_as_room.pipeline.geometry.camera import camera_looking_at
from code_as_room.pipeline.geometry.placement import Rect, is_inside, penetration
from code_as_room.pipeline.geometry.polygon import point_in_polygon
from code_as_room.pipeline.program.lines import parse_layout, print_layout

PICTURES = frozenset({"floor", "sea"})
HEIGHT = 2.7
_GAP = 0.12  # metres kept free round everything, so that a new room has no faults
_LOCKED = 0.15  # share of the faults that are put into something locked

# What each category is made of, as a def of its size; parts and roles as the library writes them.
DEFS = """def table_of(size):
    w, d, h = size
    legs = [part("leg", box((0.05, 0.05, h - 0.03), at=(x, y, (h - 0.03) / 2)), material="wood")
            for x in (-w / 2 + 0.025, w / 2 - 0.025) for y in (-d / 2 + 0.025, d / 2 - 0.025)]
    return [part("top", box((w, d, 0.03), at=(0, 0, h - 0.015)), material="wood")] + legs


def block_of(size):
    w, d, h = size
    return [part("body", box((w, d, h), at=(0, 0, h / 2)), material="painted")]


def seat_of(size):
    w, d, h = size
    return [part("seat", box((w, d, h * 0.5), at=(0, 0, h * 0.25)), material="fabric"),
            part("back", box((w, 0.12, h * 0.5), at=(0, d / 2 - 0.06, h * 0.75)), material="fabric")]


def bare_of(size):
    w, d, h = size
    return [part("body", box((w, d, h), at=(0, 0, h / 2)))]


"""
FLOOR_THINGS = (
    ("table", "table_of", (0.8, 1.6), (0.6, 0.9), (0.45, 0.78)),
    ("wardrobe", "block_of", (0.8, 1.6), (0.45, 0.6), (1.6, 2.2)),
    ("dresser", "block_of", (0.6, 1.2), (0.4, 0.5), (0.6, 0.9)),
    ("armchair", "seat_of", (0.6, 0.9), (0.6, 0.9), (0.7, 0.95)),
    ("stool", "block_of", (0.35, 0.45), (0.35, 0.45), (0.42, 0.5)),
    ("floor lamp", "block_of", (0.25, 0.4), (0.25, 0.4), (1.3, 1.7)),
)


@dataclass
class Made:
    """A room while it is made: its layout, and how its things are modelled.

    Attributes:
        finishes: statements on looks by id. defs: of each object.
    """

    layout: Layout
    defs: dict[str, str] = field(default_factory=dict)
    finishes: dict[str, str] = field(default_factory=dict)

    @property
    def text(self) -> str:
        """The whole room program."""
        furnish = [f'furnish("{name}", {made})' for name, made in self.defs.items()]
        lines = print_layout(self.layout).removesuffix("build()\n")
        return DEFS + lines + "\n".join([*furnish, *self.finishes.values(), "build()"]) + "\n"


@dataclass(frozen=True)
class Injected:
    """A fault that was put in: its kind, and all ids by which finding may name it."""

    kind: FaultKind
    ids: frozenset[str]
    locked: bool


def make_room(number: int, seed: int = 1) -> Made:
    """A furnished room without faults."""
    rng = np.random.default_rng((seed, number))
    while True:
        made = _try_room(rng)
        if len(made.layout.proxies) >= 9 and not find_faults(made.text, Options(pictures=PICTURES)):
            return made


def _try_room(rng: np.random.Generator) -> Made:
    w, d = float(rng.uniform(4.6, 7.0)), float(rng.uniform(4.2, 6.0))
    floor = [(0.0, 0.0), (w, 0.0), (w, d), (0.0, d)]
    if rng.random() < 0.4:
        floor = [(0.0, 0.0), (w, 0.0), (w, 0.55 * d), (0.6 * w, 0.55 * d), (0.6 * w, d), (0.0, d)]
    floor = [(round(x - w / 2, 3), round(y - d / 2, 3)) for x, y in floor]
    walls = [
        WallLine(id=f"wall_{i + 1}", start=a, end=b, height=HEIGHT)
        for i, (a, b) in enumerate(zip(floor, floor[1:] + floor[:1], strict=True))
    ]
    (ax, ay), (bx, _) = floor[0], floor[1]
    at = round(float(rng.uniform(ax + 0.3, bx - 1.3)), 3)
    door = DoorLine(id="door_1", wall="wall_1", start=(at, ay), end=(at + 0.9, ay), open=60.0)
    layout = Layout(room=RoomLine(size=(w, d, HEIGHT), floor=floor), walls=walls, doors=[door])
    made = Made(layout)
    _furnish(made, rng, Rect(at + 0.45, ay + 0.45, 0.9, 0.9))
    _hang_and_light(made, rng)
    made.layout = parse_layout(print_layout(made.layout))
    return made


def _furnish(made: Made, rng: np.random.Generator, door: Rect) -> None:
    taken = [door]
    floor = made.layout.room.floor
    low, high = np.min(floor, axis=0), np.max(floor, axis=0)
    for n in range(int(rng.integers(6, 10))):
        category, function, *ranges = FLOOR_THINGS[int(n if n < 3 else rng.integers(len(FLOOR_THINGS)))]
        size = tuple(round(float(rng.uniform(*r)), 3) for r in ranges)
        for _ in range(60):
            x, y = (round(float(rng.uniform(low[k], high[k])), 3) for k in (0, 1))
            yaw = float(rng.choice([0, 90, 180, 270, int(rng.integers(0, 360))]))
            wide = Rect(x, y, size[0] + 2 * _GAP, size[1] + 2 * _GAP, yaw)
            if is_inside(wide, floor) and not any(penetration(wide, other) for other in taken):
                break
        else:
            continue
        taken.append(wide)
        line = ProxyLine(id=f"{category.replace(' ', '_')}_{n + 1}", category=category, centre=(x, y, size[2] / 2),
                         size=(size[0], size[1], size[2]), yaw=yaw)  # fmt: skip
        _put(made, line, function)
        if category in ("table", "dresser"):
            _load(made, line, rng)
    rug = ProxyLine(id="rug_1", category="rug", centre=(0.0, 0.0, 0.006), size=(1.2, 0.9, 0.012))
    if is_inside(Rect(-0.3, -0.6, 1.2, 0.9), floor):
        _put(made, rug.model_copy(update={"centre": (-0.3, -0.6, 0.006)}), "block_of")


def _load(made: Made, carrier: ProxyLine, rng: np.random.Generator) -> None:
    """Two small things side by side on top."""
    angle = math.radians(carrier.yaw)
    top = carrier.centre[2] + carrier.size[2] / 2
    for k, side in enumerate((-0.25, 0.25)):
        size = tuple(round(float(v), 3) for v in rng.uniform((0.1, 0.1, 0.12), (0.2, 0.18, 0.4)))
        x = carrier.centre[0] + math.cos(angle) * side * carrier.size[0]
        y = carrier.centre[1] + math.sin(angle) * side * carrier.size[0]
        line = ProxyLine(id=f"vase_{carrier.id}_{k + 1}", category="vase", centre=(x, y, top + size[2] / 2),
                         size=(size[0], size[1], size[2]), placement="surface", parent=carrier.id, salience="minor")  # fmt: skip
        _put(made, line, "block_of")


def _put(made: Made, line: ProxyLine, function: str) -> None:
    made.layout.proxies = [*made.layout.proxies, line]
    made.defs[line.id] = function


def _hang_and_light(made: Made, rng: np.random.Generator) -> None:
    (ax, _), (bx, by) = made.layout.room.floor[0], made.layout.room.floor[1]
    art = ProxyLine(id="painting_1", category="painting", centre=(bx - 0.015, (by + 0.8), 2.35), size=(0.7, 0.03, 0.5),
                    yaw=270.0, placement="wall", salience="minor")  # fmt: skip
    _put(made, art, "block_of")
    made.finishes["painting_1"] = 'finish("painting_1", {"": principled(picture("sea"))})'
    made.layout.lights = [
        LightLine(id="light_1", kind="point", at=(0.0, 0.0, 2.4), energy=round(float(rng.uniform(20, 200)), 1)),
        LightLine(id="light_2", kind="area", at=(0.5, 0.5, 2.6), energy=80.0, size=1.0),
    ]
    made.layout.worlds = [WorldLine(id="world")]
    low, high = np.min(made.layout.room.floor, axis=0), np.max(made.layout.room.floor, axis=0)
    for n in range(400):
        x, y = (float(v) for v in rng.uniform(low + 0.4, high - 0.4))
        clear = all(math.dist((x, y), p.centre[:2]) > math.hypot(*p.size[:2]) / 2 + 0.1 or p.size[2] < 0.1
                    for p in made.layout.proxies)  # fmt: skip
        if (clear or n > 390) and point_in_polygon((x, y), made.layout.room.floor):
            break
    made.layout.cameras = [_camera("eye_1", (x, y, 1.5), (ax + 1.5, by + 1.5, 1.2))]


def _camera(name: str, eye: Sequence[float], target: Sequence[float]) -> CameraLine:
    model = camera_looking_at("perspective", eye, target, 60.0, (768, 512))
    return CameraLine(id=name, kind="perspective", matrix=model.matrix, fov_y=model.fov_y, image_size=(768, 512))


# ---- faults ----


def break_room(made: Made, number: int, seed: int = 1) -> tuple[str, list[Injected], frozenset[str]]:
    """The text with faults of every kind, what was put in, and what is locked."""
    rng = np.random.default_rng((seed, number, 1))
    breakers: dict[FaultKind, Callable[[Made, np.random.Generator, set[str]], list[str]]] = {
        "material": _strip, "picture": _lose, "light": _overdrive, "outside": _push_out, "blocked": _block,
        "overlap": _collide, "support": _lift, "coincident": _flatten, "camera": _lose_camera,
    }  # fmt: skip
    used: set[str] = set()
    injected, locked = [], set()
    for kind in FAULT_KINDS:
        ids = breakers[kind](made, rng, used)
        if not ids:
            continue
        hold = bool(rng.random() < _LOCKED)
        if hold:
            locked |= set(ids)
        used |= set(ids)
        injected.append(Injected(kind, frozenset(ids), hold))
    return made.text, injected, frozenset(locked)


def _free(made: Made, used: set[str], rng: np.random.Generator, *, loaded: bool | None = None) -> list[ProxyLine]:
    """Things on the floor that nothing was done to yet, in any order; `loaded`: only those (not) carrying something."""
    parents = {p.parent for p in made.layout.proxies}
    found = [
        p for p in made.layout.proxies
        if p.placement == "floor" and p.id not in used and p.category != "rug"
        and (loaded is None or (p.id in parents) == loaded)
    ]  # fmt: skip
    return [found[int(i)] for i in rng.permutation(len(found))]


def _move(made: Made, identifier: str, dx: float, dy: float, dz: float = 0.0) -> None:
    ids = {identifier} | {p.id for p in made.layout.proxies if p.parent == identifier}
    made.layout.proxies = [
        p.model_copy(update={"centre": (p.centre[0] + dx, p.centre[1] + dy, p.centre[2] + dz)}) if p.id in ids else p
        for p in made.layout.proxies
    ]


def _strip(made: Made, rng: np.random.Generator, used: set[str]) -> list[str]:
    things = [n for n, made_by in made.defs.items() if made_by == "block_of" and n not in used and n != "painting_1"]
    name = things[int(rng.integers(len(things)))]
    made.defs[name] = "bare_of"
    return [name]


def _lose(made: Made, rng: np.random.Generator, used: set[str]) -> list[str]:
    made.finishes["painting_1"] = made.finishes["painting_1"].replace('"sea"', '"lost"')
    return ["painting_1"]


def _overdrive(made: Made, rng: np.random.Generator, used: set[str]) -> list[str]:
    k = int(rng.integers(2))
    light = made.layout.lights[k]
    energy = float(rng.choice([0.0, 2e4, 9e5]))
    changed = light.model_copy(update={"energy": energy})
    made.layout.lights = [changed if other is light else other for other in made.layout.lights]
    return [light.id]


def _push_out(made: Made, rng: np.random.Generator, used: set[str]) -> list[str]:
    for line in _free(made, used, rng):
        low, high = np.min(made.layout.room.floor, axis=0), np.max(made.layout.room.floor, axis=0)
        k, side = int(rng.integers(2)), int(rng.choice([-1, 1]))
        away = float((high if side > 0 else low)[k]) - line.centre[k] + side * float(rng.uniform(-0.1, 0.5))
        _move(made, line.id, away if k == 0 else 0.0, away if k == 1 else 0.0)
        return [line.id]
    return []


def _block(made: Made, rng: np.random.Generator, used: set[str]) -> list[str]:
    door = made.layout.doors[0]
    for line in _free(made, used, rng):
        x = (door.start[0] + door.end[0]) / 2 - line.centre[0]
        y = door.start[1] + math.hypot(*line.size[:2]) / 2 + float(rng.uniform(0.02, 0.3)) - line.centre[1]
        _move(made, line.id, x, y)
        return [line.id]
    return []


def _collide(made: Made, rng: np.random.Generator, used: set[str]) -> list[str]:
    things = _free(made, used, rng, loaded=False)
    others = [p for p in _free(made, used, rng) if made.defs[p.id] != "table_of"]
    for line in things:
        for other in others:
            if other.id != line.id:
                x, y = rng.uniform(-0.12, 0.12, 2)
                _move(made, line.id, other.centre[0] - line.centre[0] + x, other.centre[1] - line.centre[1] + y)
                return [line.id, other.id]
    return []


def _lift(made: Made, rng: np.random.Generator, used: set[str]) -> list[str]:
    things = [p for p in made.layout.proxies if p.placement in ("floor", "surface") and p.id not in used
              and p.parent not in used and p.category != "rug"]  # fmt: skip
    if not things:
        return []
    line = things[int(rng.integers(len(things)))]
    _move(made, line.id, 0.0, 0.0, float(rng.choice([-1, 1])) * float(rng.uniform(0.01, 0.3 * line.size[2])))
    return [line.id]


def _flatten(made: Made, rng: np.random.Generator, used: set[str]) -> list[str]:
    """A second rug as high as the first and across it."""
    rug = next((p for p in made.layout.proxies if p.id == "rug_1"), None)
    if rug is None or "rug_1" in used:
        return []
    other = rug.model_copy(update={"id": "rug_2", "centre": (rug.centre[0] + 0.1, rug.centre[1] + 0.15, rug.centre[2])})
    _put(made, other, "block_of")
    return ["rug_1", "rug_2"]


def _lose_camera(made: Made, rng: np.random.Generator, used: set[str]) -> list[str]:
    inside = [p for p in made.layout.proxies if p.size[2] > 1.2 and p.id not in used]
    low = np.min(made.layout.room.floor, axis=0)
    eye = (float(low[0]) - 1.0, float(low[1]) + 1.0, 1.5)
    if inside and rng.random() < 0.5:
        line = inside[0]
        eye = (line.centre[0], line.centre[1], line.size[2] * 0.7)
    made.layout.cameras = [_camera("eye_1", eye, (0.0, 0.0, 1.1))]
    return ["eye_1"]
