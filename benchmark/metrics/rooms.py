# SPDX-License-Identifier: GPL-3.0-or-later
"""Rooms to compare: results and ground truths of several formats as one simple form.

Frame of every room: metres, x right, y up in the picture, z up, origin at the centre of the floor's bounding rectangle.
Yaw in degrees counter-clockwise; at 0 the front faces -Y.
"""

from __future__ import annotations

import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Any

from code_as_room.pipeline.geometry.polygon import bounding_rectangle, centroid, rectangle_corners

from . import categories
from .areas import Polygon

FLAT = 0.06
"""Metres; what lies on the floor and is lower (rugs) may lie under other things."""
VISIBLE = 0.15
"""Share of an object that a picture must show; below it the object is not asked for."""
FLAT_ON_WALL = 0.06
"""Metres; what hangs on a wall and is thinner cannot be told in a picture without perspective, taken straight down."""
_ROUND_SEGMENTS = 48
_L_ARM = 0.45


@dataclass(frozen=True)
class Thing:
    """One object.

    Attributes:
        outline: its footprint as a polygon, by its shape (an ellipse, an L) where that is known.
        rectangle: corners of the oriented rectangle around it.
        base, top: lower and upper end above the floor; None where a truth was annotated without heights.
        yaw: None when it has no front.
        symmetry: it looks the same when turned by a full turn divided by this; 0: from everywhere.
        major: large furniture, whose footprints are scored one by one.
        shown: whether the picture shows enough of it; a truth's things that it does not show are not asked for.
        mirrored: the L of the other hand, where nobody said on which side its short arm comes forward.
    """

    id: str
    category: str
    outline: Polygon
    rectangle: Polygon
    base: float | None
    top: float | None
    yaw: float | None
    placement: str
    parent: str | None
    major: bool
    symmetry: int = 1
    shape: str = "box"
    shown: bool = True
    mirrored: Polygon | None = None

    @property
    def hands(self) -> list[Polygon]:
        """The outlines that it may have: one, or both hands of an L."""
        return [self.outline] if self.mirrored is None else [self.outline, self.mirrored]

    def with_other_hand(self) -> Thing:
        """The same thing as the L of the other hand."""
        return self if self.mirrored is None else replace(self, outline=self.mirrored, mirrored=self.outline)

    @cached_property
    def centre(self) -> tuple[float, float]:
        """Centre of the rectangle around it."""
        return centroid(self.rectangle)

    @property
    def flat(self) -> bool:
        """Whether it lies flat on the floor, as rugs do."""
        if self.base is None or self.top is None:
            return self.placement == "floor" and "rug" in categories.kinds(self.category)
        return self.placement == "floor" and self.top - self.base < FLAT


@dataclass(frozen=True)
class Zone:
    """A part of the room with a use of its own: its main thing, and the ids of all that belongs to it."""

    anchor: str
    members: tuple[str, ...]


@dataclass(frozen=True)
class Room:
    """A room to compare.

    Attributes:
        size: width and depth of the floor's bounding rectangle, metres. floor: its outline. height: of the walls.
        partitions: segments of walls that stand inside the room.
        boxes_only: the outlines are axis-aligned boxes around the true footprints (annotated by hand).
        shapes_known: whether it is known which things are round or L-shaped.
        metric: whether its metres are measured; an annotated picture has an estimate only.
    """

    size: tuple[float, float]
    floor: Polygon
    things: tuple[Thing, ...]
    height: float | None = None
    zones: tuple[Zone, ...] = ()
    partitions: tuple[tuple[tuple[float, float], tuple[float, float]], ...] = ()
    boxes_only: bool = False
    shapes_known: bool = False
    metric: bool = True

    @cached_property
    def by_id(self) -> dict[str, Thing]:
        """Things by id."""
        return {thing.id: thing for thing in self.things}


def load_truth(path: Path, style: str = "") -> Room:
    """Read a ground truth: `scene.json` and what was added to it, `room.polygon`, or a picture annotated by hand.

    Args:
        style: which of the truth's pictures was shown ("persp"); things it does not show are marked so.
    """
    data = json.loads(path.read_text(encoding="utf-8"))
    return _annotated(data) if "room_size_m_estimate" in data else room_of(data, style=style)


def load_result(path: Path, shapes: Mapping[str, str] | None = None) -> Room:
    """Read a result's `scene.json`.

    Args:
        shapes: the proxies' shapes by id, which the file does not hold; None when unknown.
    """
    return room_of(json.loads(path.read_text(encoding="utf-8")), shapes)


def room_of(data: Mapping[str, Any], shapes: Mapping[str, str] | None = None, style: str = "") -> Room:
    """A room from a document of objects with centre, size and yaw."""
    room = data["room"]
    floor = [(float(x), float(y)) for x, y in (room.get("floor") if _is_outline(room) else room["polygon"])]
    x0, y0, x1, y1 = bounding_rectangle(floor)
    middle = ((x0 + x1) / 2, (y0 + y1) / 2)
    items = data["objects"]
    stated = shapes is not None or any({"shape", "outline", "footprint"} & item.keys() for item in items)
    flat_view = _is_flat_view(data, style)
    things = tuple(_thing(item, middle, (shapes or {}).get(item["id"]), style, flat_view) for item in items)
    return Room(
        size=(x1 - x0, y1 - y0),
        floor=_moved(floor, middle),
        things=things,
        height=float(room["size"][2]) if len(room.get("size", ())) > 2 else None,
        zones=tuple(Zone(z["anchor"], tuple(z["objects"])) for z in data.get("zones", ()) if "anchor" in z),
        partitions=tuple(
            (_moved([a["start"]], middle)[0], _moved([a["end"]], middle)[0])
            for a in data.get("architecture", ())
            if a.get("kind") in ("partition", "wall")
        ),
        shapes_known=stated,
    )


def _is_outline(room: Mapping[str, Any]) -> bool:
    return isinstance(room.get("floor"), list)


def _moved(points: Sequence[Sequence[float]], middle: tuple[float, float]) -> Polygon:
    return [(float(p[0]) - middle[0], float(p[1]) - middle[1]) for p in points]


def _thing(item: Mapping[str, Any], middle: tuple[float, float], shape: str | None, style: str, flat: bool) -> Thing:
    centre, size, placement = item["centre"], item["size"], item["placement"]
    shape = shape or item.get("shape") or "box"
    base, top = float(centre[2]) - float(size[2]) / 2, float(centre[2]) + float(size[2]) / 2
    large = placement == "floor" and top - base >= FLAT and max(size[:2]) > 0.35
    kept = _visible(item, style) >= VISIBLE and not (flat and placement == "wall" and min(size[:2]) <= FLAT_ON_WALL)
    symmetry = item.get("symmetry")
    if symmetry is None:
        symmetry = 0 if shape == "round" else categories.symmetry(item["category"])
    stated = item.get("outline") or item.get("footprint")
    yaw, both = float(item["yaw"]), shape == "l_shape" and not stated
    return Thing(
        id=str(item["id"]),
        category=str(item["category"]),
        outline=_moved(stated or outline_of(centre, size, yaw, shape), middle),
        rectangle=_moved(rectangle_corners(centre, size, yaw).tolist(), middle),
        base=base,
        top=top,
        yaw=yaw,
        placement=placement,
        parent=item.get("parent"),
        major=item["salience"] == "major" if "salience" in item else large,
        symmetry=_square_symmetry(int(symmetry), size),
        shape=shape,
        shown=kept,
        mirrored=_moved(outline_of(centre, size, yaw, shape, hand=-1), middle) if both else None,
    )


def _square_symmetry(symmetry: int, size: Sequence[float]) -> int:
    """A nearly square thing that looks the same turned by 180 degrees looks nearly the same turned by 90."""
    return 4 if symmetry == 2 and min(size[:2]) > 0.9 * max(size[:2]) else symmetry


def outline_of(centre: Sequence[float], size: Sequence[float], yaw: float, shape: str, hand: int = 1) -> Polygon:
    """Footprint of a proxy: rectangle, ellipse, or an L with one arm along the back and one coming forward.

    Args:
        hand: 1 when the L's short arm is on its own -X side, as proxies are built; -1 for the other side.
    """
    half_x, half_y = float(size[0]) / 2, float(size[1]) / 2
    if shape == "round":
        turns = [2 * math.pi * i / _ROUND_SEGMENTS for i in range(_ROUND_SEGMENTS)]
        local = [(half_x * math.cos(t), half_y * math.sin(t)) for t in turns]
    elif shape == "l_shape":
        inner_x, inner_y = -half_x + 2 * _L_ARM * half_x, half_y - 2 * _L_ARM * half_y
        local = [(-half_x, -half_y), (inner_x, -half_y), (inner_x, inner_y), (half_x, inner_y), (half_x, half_y)]
        local = [(hand * x, y) for x, y in [*local, (-half_x, half_y)]]
    else:
        local = [(-half_x, -half_y), (half_x, -half_y), (half_x, half_y), (-half_x, half_y)]
    cos, sin = math.cos(math.radians(yaw)), math.sin(math.radians(yaw))
    return [(centre[0] + x * cos - y * sin, centre[1] + x * sin + y * cos) for x, y in local]


def _visible(item: Mapping[str, Any], style: str) -> float:
    shown = item.get("image", {}).get(style, item) if isinstance(item.get("image"), Mapping) else item
    value = shown.get("visible", 1.0)
    if isinstance(value, Mapping):
        value = value.get(style, 1.0)
    return float(value)


def _is_flat_view(data: Mapping[str, Any], style: str) -> bool:
    """Whether the picture was taken straight down without perspective."""
    camera = data.get("cameras", {}).get(style) or data.get("camera") or {}
    kind = str(camera.get("kind") or camera.get("type") or "").lower()
    matrix = camera.get("matrix")
    return kind.startswith("ortho") and (matrix is None or abs(float(matrix[10])) > 0.999)


def _annotated(data: Mapping[str, Any]) -> Room:
    """A picture annotated by hand: footprints are bounding boxes in 0..1 of the floor, v downward, with a rough scale."""
    width = float(data["room_size_m_estimate"][0])
    depth = width / float(data["floor_aspect"])
    ids = {item["id"] for item in data["objects"]}
    things = []
    for item in data["objects"]:
        u0, v0, u1, v1 = item["room_uv"]
        x0, x1, y0, y1 = (u0 - 0.5) * width, (u1 - 0.5) * width, (0.5 - v1) * depth, (0.5 - v0) * depth
        box = [(x0, y0), (x1, y0), (x1, y1), (x0, y1)]
        facing, category = item.get("facing"), item["category"].replace("_", " ")
        compass = {"N": 0.0, "E": 90.0, "S": 180.0, "W": 270.0}.get(facing, facing)
        things.append(
            Thing(
                id=item["id"],
                category=category,
                outline=box,
                rectangle=box,
                base=None,
                top=None,
                yaw=None if compass is None else (180.0 - float(compass)) % 360,
                placement=item["placement"],
                parent=item["parent"] if item["parent"] in ids else None,
                major=item["salience"] == "major",
                symmetry=0 if compass is None else 1,
            )
        )
    corners = [(-width / 2, -depth / 2), (width / 2, -depth / 2), (width / 2, depth / 2), (-width / 2, depth / 2)]
    segments = [a["footprint"] for a in data.get("architecture", ()) if a["type"] == "partition"]
    image = data["floor_polygon"]
    left, upper = min(p[0] for p in image), min(p[1] for p in image)
    wide, deep = max(p[0] for p in image) - left, max(p[1] for p in image) - upper

    def on_floor(x: float, y: float) -> tuple[float, float]:
        return ((x - left) / wide - 0.5) * width, (0.5 - (y - upper) / deep) * depth

    partitions = tuple(
        (on_floor((a + c) / 2, b), on_floor((a + c) / 2, d))
        if d - b > c - a
        else (on_floor(a, (b + d) / 2), on_floor(c, (b + d) / 2))
        for a, b, c, d in segments
    )
    return Room((width, depth), corners, tuple(things), partitions=partitions, boxes_only=True, metric=False)


def boxed(polygon: Polygon) -> Polygon:
    """Its axis-aligned bounding rectangle."""
    x0, y0, x1, y1 = bounding_rectangle(polygon)
    return [(x0, y0), (x1, y0), (x1, y1), (x0, y1)]


def laid_over(room: Room, size: tuple[float, float]) -> Room:
    """The room stretched along both axes so that its floor's rectangle has this size; heights and yaw stay."""
    x, y = (size[0] / room.size[0] if room.size[0] else 1.0), (size[1] / room.size[1] if room.size[1] else 1.0)

    def stretched(polygon: Polygon) -> Polygon:
        return [(px * x, py * y) for px, py in polygon]

    things = tuple(
        replace(
            t,
            outline=stretched(t.outline),
            rectangle=stretched(t.rectangle),
            mirrored=stretched(t.mirrored) if t.mirrored else None,
        )
        for t in room.things
    )
    partitions = tuple((stretched([a])[0], stretched([b])[0]) for a, b in room.partitions)
    return replace(room, size=size, floor=stretched(room.floor), things=things, partitions=partitions)
