# SPDX-License-Identifier: GPL-3.0-or-later
"""The lines of a draft as typed records, read with patience: what is plainly meant is taken, what is not is refused."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from ..artifacts.common import Metres2, Metres3, Placement, Salience, Shape
from ..errors import ProgramError

Box = tuple[float, float, float, float]
MOST_METRES = 100.0
SMALL_ON_FLOOR = 0.4
"""Metres of its longer side below which a thing on the floor is a small one."""
_PLACEMENTS: dict[str, Placement] = {
    "floor": "floor", "ground": "floor", "standing": "floor", "wall": "wall", "hung": "wall", "on_wall": "wall",
    "wall_mounted": "wall", "ceiling": "ceiling", "hanging": "ceiling", "pendant": "ceiling", "surface": "surface",
    "on": "surface", "table": "surface", "object": "surface",
}  # fmt: skip
_SHAPES: dict[str, Shape] = {
    "box": "box", "rectangle": "box", "square": "box", "round": "round", "circle": "round", "oval": "round",
    "cylinder": "round", "l_shape": "l_shape", "l": "l_shape", "l_shaped": "l_shape", "corner": "l_shape",
}  # fmt: skip
VIEWS = ("perspective", "orthographic", "plan")


@dataclass(frozen=True)
class RoomSaid:
    """The room line. `seen` and `top` are corners in the picture, 0-1000; either may be missing."""

    size: Metres3
    floor: tuple[Metres2, ...]
    seen: tuple[Metres2, ...] = ()
    top: tuple[Metres2, ...] = ()
    view: str = "perspective"
    kind: str = "room"


@dataclass(frozen=True)
class Fixed:
    """A partition, door, window, opening or built-in: a segment on the floor, metres."""

    id: str
    kind: str
    start: Metres2
    end: Metres2
    height: float
    sill: float = 0.0
    thickness: float = 0.12
    wall: str | None = None
    swing: str = ""
    seen: Box | None = None
    partition: bool = True


@dataclass(frozen=True)
class Thing:
    """A proxy line.

    Attributes:
        at: middle of its underside, metres. seen: box in the picture, 0-1000.
        like: id of the thing that it is a twin of. piece: name of the library's piece; colours and options of that.
    """

    id: str
    category: str
    at: Metres3
    size: Metres3
    yaw: float = 0.0
    placement: Placement = "floor"
    parent: str | None = None
    salience: Salience = "major"
    label: str = ""
    shape: Shape = "box"
    seen: Box | None = None
    front: str = ""
    like: str = ""
    piece: str = ""
    colours: Mapping[str, str] = field(default_factory=dict)
    options: Mapping[str, Any] = field(default_factory=dict)


@dataclass(frozen=True)
class LightSaid:
    """The lighting line."""

    style: str = ""
    sun_from: str = ""
    windows: tuple[str, ...] = ()
    lamps_on: tuple[str, ...] = ()
    warmth: str = ""


class Arguments:
    """The arguments of one line, taken by name; what was passed over is told.

    Attributes:
        notes: sentences on what was forgiven.
    """

    def __init__(self, name: str, args: Sequence[Any], keywords: Mapping[str, Any], order: Sequence[str]) -> None:
        self.name = name
        self.given = dict(zip(order, args, strict=False)) | dict(keywords)
        self.notes: list[str] = (
            [] if len(args) <= len(order) else [f"{name} takes fewer values; the last ones are left out."]
        )
        self._taken: set[str] = set()

    def take(self, *names: str) -> Any:
        """The first of these that was given, None for none."""
        self._taken |= set(names)
        return next((self.given[n] for n in names if self.given.get(n) is not None), None)

    def leave(self) -> None:
        """Tell of what nobody asked for."""
        left = [n for n in self.given if n not in self._taken]
        if left:
            self.notes.append(f"{self.name} has no {', '.join(left)[:80]}; left out.")

    def word(self, *names: str, most: int = 120) -> str:
        """A text, "" where there is none."""
        value = self.take(*names)
        if value is None:
            return ""
        if isinstance(value, (list, tuple, dict)):
            value = ", ".join(map(str, value))
        return " ".join(str(value).split())[:most]

    def number(self, default: float, *names: str, low: float = -MOST_METRES, high: float = MOST_METRES) -> float:
        """A finite number within bounds."""
        value = self.take(*names)
        number = as_number(value)
        if number is None:
            if value is not None:
                self.notes.append(f"{names[0]} is no number; {default:g} is taken.")
            return default
        return min(high, max(low, number))

    def point(self, count: int, *names: str) -> tuple[float, ...] | None:
        """So many numbers, None where they are not there."""
        found = as_numbers(self.take(*names))
        return tuple(min(MOST_METRES, max(-MOST_METRES, v)) for v in found[:count]) if len(found) >= count else None

    def words(self, *names: str) -> tuple[str, ...]:
        """A list of texts."""
        value = self.take(*names)
        if isinstance(value, str):
            value = [value]
        return tuple(str(v)[:80] for v in value if isinstance(v, str)) if isinstance(value, (list, tuple)) else ()


def as_number(value: Any) -> float | None:
    """A finite number, None for anything else; a text may hold one."""
    if isinstance(value, str):
        match = re.fullmatch(r"\s*(-?\d+(?:\.\d+)?)\s*(?:m|deg|°)?\s*", value)
        value = float(match.group(1)) if match and len(match.group(1)) < 12 else None
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        return None
    try:
        number = float(value)
    except OverflowError:
        return None
    return number if math.isfinite(number) else None


def as_numbers(value: Any) -> list[float]:
    """All numbers of a list, also of nested ones; [] where anything in it is none."""
    if not isinstance(value, (list, tuple)):
        return []
    found: list[float] = []
    for item in value:
        inner = as_numbers(item) if isinstance(item, (list, tuple)) else [as_number(item)]
        if not inner or any(v is None for v in inner):
            return []
        found += [v for v in inner if v is not None]
    return found


def as_box(value: Any) -> Box | None:
    """A box of the picture with its corners in order, None where there is none."""
    if isinstance(value, Mapping):
        value = [value.get(key) for key in ("x_min", "y_min", "x_max", "y_max")]
    found = as_numbers(value)
    if len(found) < 4:
        return None
    xs, ys = sorted(found[0:4:2]), sorted(found[1:4:2])
    return (xs[0], ys[0], xs[1], ys[1]) if xs[1] - xs[0] > 0.5 and ys[1] - ys[0] > 0.5 else None


def as_points(value: Any) -> tuple[Metres2, ...]:
    """Points (x, y), () where they are none."""
    if not isinstance(value, (list, tuple)):
        return ()
    found = []
    for item in value[:200]:
        pair = as_numbers([item.get("x"), item.get("y")]) if isinstance(item, Mapping) else as_numbers(item)
        if len(pair) < 2:
            return ()
        found.append((pair[0], pair[1]))
    return tuple(found)


def area(points: Sequence[Metres2]) -> float:
    """Signed area, positive where they run counter-clockwise with y up."""
    turns = zip(points, [*points[1:], *points[:1]], strict=True)
    return sum(a[0] * b[1] - a[1] * b[0] for a, b in turns) / 2


def read_room(given: Arguments) -> RoomSaid:
    """The room line. Raises ProgramError where it says nothing of the room's size."""
    size = list(as_numbers(given.take("size")))
    floor = as_points(given.take("floor"))
    height = given.number(2.6, "height", "wall_height", low=0.5, high=20.0)
    seen, top = as_points(given.take("seen", "floor_polygon")), as_points(given.take("top", "seen_top", "wall_top"))
    view, kind = given.word("view").lower(), given.word("kind", "type", "room_type", "category", most=60)
    given.leave()
    if len(floor) < 3 or abs(area(floor)) < 0.2:
        if len(size) < 2 or min(size[:2]) <= 0.3:
            raise ProgramError("room needs floor=[(x, y), ...], its corners in metres")
        w, d = size[0] / 2, size[1] / 2
        floor = ((-w, -d), (w, -d), (w, d), (-w, d))
        given.notes.append("The floor was no outline; a rectangle of its size is taken.")
    floor = tuple((min(60.0, max(-60.0, x)), min(60.0, max(-60.0, y))) for x, y in floor)
    if area(floor) < 0:
        floor, given.notes = floor[::-1], [*given.notes, "The floor ran clockwise; it was turned round."]
        seen, top = (s[::-1] if len(s) == len(floor) else s for s in (seen, top))
    xs, ys = [p[0] for p in floor], [p[1] for p in floor]
    tall = size[2] if len(size) > 2 and 0.5 < size[2] <= 20 else height
    found = (max(xs) - min(xs), max(ys) - min(ys), tall)
    if len(seen) < 3:
        given.notes.append("The room's corners in the picture (seen) are missing.")
    return RoomSaid(
        found,
        floor,
        seen,
        top if len(top) == len(seen) else (),
        view if view in VIEWS else "perspective",
        kind or "room",
    )


def read_fixed(kind: str, given: Arguments) -> Fixed:
    """A wall, door, window or opening line. Raises ProgramError where it has no place."""
    start, end = given.point(2, "start", "a", "from"), given.point(2, "end", "b", "to")
    usual = {"door": 2.05, "window": 1.3, "opening": 2.2}.get(kind, 2.6)
    found = Fixed(
        id=given.word("id", "name", most=60) or kind,
        kind="partition" if kind == "wall" else kind,
        start=(start[0], start[1]) if start else (0.0, 0.0),
        end=(end[0], end[1]) if end else (0.0, 0.0),
        height=given.number(usual, "height", low=0.1, high=20.0),
        sill=given.number(0.9 if kind == "window" else 0.0, "sill", low=0.0, high=10.0),
        thickness=given.number(0.12, "thickness", low=0.02, high=1.0),
        wall=given.word("wall", most=60) or None,
        swing=given.word("swing", most=200),
        seen=as_box(given.take("seen", "box")),
        partition=given.take("partition") is not False,
    )
    opened = given.take("open")
    if opened is not None and not found.swing and (degrees := as_number(opened)) is not None:
        given.take("open")
        swing = (
            "closed"
            if abs(degrees) < 1
            else f"{'into' if degrees > 0 else 'out of'} the room, {abs(degrees):.0f} degrees"
        )
        found = Fixed(**{**found.__dict__, "swing": swing})
    given.leave()
    if start is None or end is None or math.dist(found.start, found.end) < 0.02:
        raise ProgramError(f"{kind} needs start=(x, y) and end=(x, y), the ends on the floor in metres")
    return found


def read_thing(given: Arguments) -> Thing:
    """A proxy line. Raises ProgramError where it says neither place nor size."""
    name, category = given.word("id", "name", most=60), given.word("category", "kind", most=60)
    label = given.word("label", most=120)
    sides = [abs(v) for v in as_numbers(given.take("size"))]
    if len(sides) == 2:
        sides.append(0.01 if re.search(r"\b(rug|carpet|mat)\b", category.lower()) else 0.3)
        given.notes.append("size has no height.")
    place = as_numbers(given.take("at"))
    middle = as_numbers(given.take("centre", "center", "location", "position"))
    base = given.take("base", "z", "base_m")
    if len(sides) < 3 or (len(place) < 2 and len(middle) < 2):
        raise ProgramError(
            "proxy needs at=(x, y, z), the middle of its underside, and size=(width, depth, height) in metres"
        )
    size = tuple(min(MOST_METRES, max(0.005, v)) for v in sides[:3])
    if len(place) < 2:
        place = [middle[0], middle[1], max(0.0, middle[2] - size[2] / 2) if len(middle) > 2 else 0.0]
    z = as_number(base) if base is not None else place[2] if len(place) > 2 else 0.0
    parent = given.word("parent", "on", most=60) or None
    said = given.word("placement").lower().replace(" ", "_").replace("-", "_")
    placement = _PLACEMENTS.get(said) or ("surface" if parent and not said else "floor")
    salience = given.word("salience").lower()
    small = placement == "floor" and max(size[:2]) < SMALL_ON_FLOOR
    colours = given.take("colors", "colours", "tint")
    options = given.take("options")
    found = Thing(
        id=name or category or "object",
        category=category or re.sub(r"_?\d+$", "", name).replace("_", " ") or "object",
        at=(*(min(MOST_METRES, max(-MOST_METRES, v)) for v in place[:2]), min(20.0, max(0.0, z or 0.0))),  # type: ignore[arg-type]
        size=size,  # type: ignore[arg-type]
        yaw=given.number(0.0, "yaw", "rotation", low=-36000, high=36000) % 360.0,
        placement=placement,
        parent=parent,
        salience="minor" if salience == "minor" or placement != "floor" or (small and salience != "major") else "major",
        label=label,
        shape=_SHAPES.get(given.word("shape").lower().replace("-", "_").replace(" ", "_"), "box"),
        seen=as_box(given.take("seen", "box")),
        front=given.word("front", most=80),
        like=_name_of(given.take("like")),
        piece=_name_of(given.take("piece", "library")),
        colours={str(k): str(v) for k, v in colours.items()} if isinstance(colours, Mapping) else {},
        options=dict(options) if isinstance(options, Mapping) else {},
    )
    given.leave()
    return found


def _name_of(value: Any) -> str:
    text = value if isinstance(value, str) else getattr(value, "text", "")
    return re.sub(r"\(.*", "", str(text), flags=re.DOTALL).strip()[:80]


def read_light(given: Arguments) -> LightSaid:
    """The lighting line."""
    found = LightSaid(
        given.word("style", most=40),
        given.word("sun_from", "sun", most=20),
        given.words("windows"),
        given.words("lamps_on", "lamps"),
        given.word("warmth", most=20),
    )
    given.leave()
    return found
