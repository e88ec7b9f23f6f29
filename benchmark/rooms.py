# SPDX-License-Identifier: GPL-3.0-or-later
"""Rooms to compare: results and ground truths of several formats as one simple form.

Every footprint is a polygon in the frame of the floor's bounding rectangle, 0..1 in both directions (x right, y up), so
that rooms of different scale can be laid over one another. `metres` is the size of that rectangle.
"""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from code_as_room.pipeline.geometry.polygon import rectangle_corners

Polygon = list[tuple[float, float]]


@dataclass(frozen=True)
class Thing:
    """One object: category words, footprint in the unit frame, placement, yaw in degrees (None when it has no front).

    `flat` things (rugs) may lie under others.
    """

    id: str
    category: str
    footprint: Polygon
    placement: str
    parent: str | None
    major: bool
    yaw: float | None
    flat: bool = False


@dataclass(frozen=True)
class Room:
    """A room to compare: floor outline in the unit frame, its bounding size in metres, and its things."""

    metres: tuple[float, float]
    floor: Polygon
    things: list[Thing]
    bounding_boxes_only: bool = False


def load_room(path: Path) -> Room:
    """Read `scene.json`, or a truth file of one of the known formats."""
    data = json.loads(path.read_text(encoding="utf-8"))
    if str(data.get("format", "")).startswith("code-as-room/scene/"):
        return _scene(data, data["room"]["floor"], "salience")
    if "room_size_m_estimate" in data:
        return _annotated(data)
    return _scene(data, data["room"]["polygon"], None)


def _scene(data: dict[str, Any], floor: list[list[float]], salience: str | None) -> Room:
    xs, ys = [p[0] for p in floor], [p[1] for p in floor]
    low, size = (min(xs), min(ys)), (max(xs) - min(xs), max(ys) - min(ys))

    def unit(points: Any) -> Polygon:
        return [((float(x) - low[0]) / size[0], (float(y) - low[1]) / size[1]) for x, y in points]

    things = []
    for item in data["objects"]:
        footprint = unit(rectangle_corners(item["centre"], item["size"], item["yaw"]))
        flat = item["size"][2] < 0.06
        large = item["placement"] == "floor" and not flat and max(item["size"][:2]) > 0.35
        major = item[salience] == "major" if salience else large
        things.append(
            Thing(item["id"], item["category"], footprint, item["placement"], item["parent"], major, item["yaw"], flat)
        )
    return Room(size, unit(floor), things)


def _annotated(data: dict[str, Any]) -> Room:
    """A picture annotated by hand: footprints are bounding boxes in 0..1 of the floor, v downward."""
    things = []
    for item in data["objects"]:
        u0, v0, u1, v1 = item["room_uv"]
        box = [(u0, 1 - v1), (u1, 1 - v1), (u1, 1 - v0), (u0, 1 - v0)]
        facing = item.get("facing")
        compass = {"N": 0.0, "E": 90.0, "S": 180.0, "W": 270.0}.get(facing, facing)
        yaw = None if compass is None else (180.0 - float(compass)) % 360
        things.append(
            Thing(
                item["id"], item["category"].replace("_", " "), box, item["placement"], item["parent"],
                item["salience"] == "major", yaw,
            )
        )  # fmt: skip
    width = float(data["room_size_m_estimate"][0])
    metres = (width, width / float(data["floor_aspect"]))
    return Room(metres, [(0, 0), (1, 0), (1, 1), (0, 1)], things, bounding_boxes_only=True)
