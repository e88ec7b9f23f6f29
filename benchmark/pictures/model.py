# SPDX-License-Identifier: GPL-3.0-or-later
"""What stands where in a room that is to be photographed: plain data.

Metres, Z up, floor at z = 0, origin at the centre of the floor's bounding rectangle, +X picture right, +Y picture up.
Yaw in degrees counter-clockwise; an object at yaw 0 faces -Y. `size` is (width, depth, height) in the object's own axes.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from code_as_room.pipeline.artifacts.camera import CameraModel

Point = tuple[float, float]
Size = tuple[float, float, float]


@dataclass(frozen=True)
class Item:
    """One object.

    Attributes:
        piece: def of the furniture library or of `extra.room`, called with the size and `options`.
        base: height of its underside; None: it lies on its parent, wherever that is under it.
        symmetry: it looks the same when turned by a full turn divided by this; 0: from everywhere.
        shape: of its footprint: "box", "round" or "l_shape". outline: the footprint in its own axes where that is known
            better than by the shape.
        colours: material by role, over those of the room; "*" is every role that the item does not name.
        under: id of a table that it is pushed under a little.
    """

    id: str
    category: str
    label: str
    piece: str
    x: float
    y: float
    size: Size
    yaw: float = 0.0
    base: float | None = 0.0
    placement: str = "floor"
    parent: str | None = None
    salience: str = "minor"
    symmetry: int = 1
    shape: str = "box"
    outline: tuple[Point, ...] = ()
    under: str | None = None
    options: Mapping[str, Any] = field(default_factory=dict)
    colours: Mapping[str, str] = field(default_factory=dict)

    def to_room(self, points: Sequence[Point]) -> list[Point]:
        """Points of its own axes (origin at the middle of its footprint) in the room."""
        cos, sin = math.cos(math.radians(self.yaw)), math.sin(math.radians(self.yaw))
        return [(self.x + x * cos - y * sin, self.y + x * sin + y * cos) for x, y in points]


@dataclass(frozen=True)
class Opening:
    """A door, window or opening in wall number `wall`, from `start` to `end` metres along it.

    `hinge` is the end a door turns about ("start" or "end"), `degrees` how far it stands open into the room.
    """

    id: str
    kind: str
    wall: int
    start: float
    end: float
    height: float
    sill: float = 0.0
    hinge: str = "start"
    degrees: float = 0.0


@dataclass(frozen=True)
class Partition:
    """A wall that stands inside the room: its centre line, height and thickness."""

    id: str
    start: Point
    end: Point
    height: float
    thickness: float
    material: str = "plain:#e7e4de:0.8"


@dataclass(frozen=True)
class Light:
    """A lamp that lights the room: "sun" (energy W/m2, towards `at` from `towards`), "area" or "point" (watts)."""

    kind: str
    at: tuple[float, float, float]
    energy: float
    colour: str = "#ffffff"
    size: float = 0.1
    towards: tuple[float, float, float] = (0.0, 0.0, 0.0)


@dataclass(frozen=True)
class Look:
    """How the picture is taken: materials by role, light, and what the film does to it.

    Attributes:
        floor, wall, cap: materials of the floor, the walls' faces and their cut tops. walls: other faces by number.
        sky: colour and strength of the light from everywhere. paper: colour around the room.
        vignette: how much darker the corners are, 0..1. grain: standard deviation of the noise, 0..255.
        fade: how much of its contrast the picture loses, its blacks turning grey; 0..1.
    """

    floor: str
    wall: str = "plain:#e7e4de:0.8"
    cap: str = "glow:#d8d6d2:1.0"
    walls: Mapping[int, str] = field(default_factory=dict)
    skirting: str = "plain:#f0eeea:0.5"
    door: str = "plain:#e6e2da:0.45"
    frame: str = "plain:#f0efec:0.4"
    roles: Mapping[str, str] = field(default_factory=dict)
    lights: tuple[Light, ...] = ()
    sky: tuple[str, float] = ("#f2f5ff", 0.8)
    paper: str = "#f7f6f3"
    exposure: float = 0.0
    samples: int = 48
    vignette: float = 0.0
    grain: float = 0.0
    fade: float = 0.0


@dataclass(frozen=True)
class Scene:
    """A room and the picture of it.

    Attributes:
        floor: outline, counter-clockwise; wall number i runs from corner i to the next.
        plan: whether the picture is drawn with lines instead of being rendered.
        zones: name, id of the main thing, ids of all.
    """

    id: str
    room_type: str
    floor: tuple[Point, ...]
    height: float
    camera: CameraModel
    items: tuple[Item, ...]
    look: Look
    openings: tuple[Opening, ...] = ()
    partitions: tuple[Partition, ...] = ()
    zones: tuple[tuple[str, str, tuple[str, ...]], ...] = ()
    thickness: float = 0.14
    plan: bool = False

    def along(self, wall: int, metres: float) -> Point:
        """The point of a wall's inner face so many metres from its start."""
        a, b = self.floor[wall], self.floor[(wall + 1) % len(self.floor)]
        t = metres / math.dist(a, b)
        return a[0] + (b[0] - a[0]) * t, a[1] + (b[1] - a[1]) * t


def outset(floor: tuple[Point, ...], distance: float) -> list[Point]:
    """The outline moved outwards, corners mitred."""
    points = np.array(floor)
    found = []
    for before, here, after in zip(np.roll(points, 1, 0), points, np.roll(points, -1, 0), strict=True):
        a, b = (here - before) / np.linalg.norm(here - before), (after - here) / np.linalg.norm(after - here)
        na, nb = np.array([a[1], -a[0]]), np.array([b[1], -b[0]])
        x, y = here + distance * (na + nb) / (1 + na @ nb)
        found.append((float(x), float(y)))
    return found


class Furnishing:
    """Collects items with little writing; sizes and places are given, ids must differ."""

    def __init__(self) -> None:
        self.items: dict[str, Item] = {}

    def put(self, id: str, category: str, piece: str, at: Point, size: Size, yaw: float = 0.0, **more: Any) -> Item:
        """Something on the floor, unless `more` says otherwise. The label is the category unless given."""
        if id in self.items:
            raise ValueError(f"There are two of {id}.")
        options = more.pop("options", {})
        item = Item(id, category, more.pop("label", category), piece, *at, size, yaw, options=options)
        self.items[id] = replace(item, **more)
        return self.items[id]

    def major(self, id: str, category: str, piece: str, at: Point, size: Size, yaw: float = 0.0, **more: Any) -> Item:
        """A large piece of furniture on the floor."""
        return self.put(id, category, piece, at, size, yaw, salience="major", **more)

    def on(
        self, parent: str, id: str, category: str, piece: str, at: Point, size: Size, turn: float = 0.0, **more: Any
    ) -> Item:
        """Something on another thing: `at` and `turn` in that thing's own axes."""
        under = self.items[parent]
        (place,) = under.to_room([at])
        more = {"placement": "surface", "parent": parent, "base": None, **more}
        return self.put(id, category, piece, place, size, under.yaw + turn, **more)

    def hang(
        self, id: str, category: str, piece: str, at: Point, base: float, size: Size, yaw: float, **more: Any
    ) -> Item:
        """Something on a wall, its underside at `base`; it faces away from the wall."""
        return self.put(id, category, piece, at, size, yaw, base=base, placement="wall", **more)

    def all(self) -> tuple[Item, ...]:
        """The items in the order they were put."""
        return tuple(self.items.values())
