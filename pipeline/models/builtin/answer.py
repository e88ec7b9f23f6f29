# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes an analysis in the form of the answer to prompt 01_analysis (`artifacts.replies.AnalysisReply`)."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from .categories import room_type
from .furnish import Item
from .openings import Opening
from .outline import Polygon
from .place import Frame

if TYPE_CHECKING:
    from .analyse import Analysis

_FACINGS = ("down", "down-right", "right", "up-right", "up", "up-left", "left", "down-left")
_NO_FRONT = (
    "rug",
    "potted_plant",
    "round_table",
    "dining_table",
    "coffee_table",
    "side_table",
    "table_lamp",
    "pouf",
    "stool",
    "floor_lamp",
    "decor",
    "table",
    "storage_box",
)


class _Units:
    """Working pixels to 0-1000 of the picture."""

    def __init__(self, shape: tuple[int, int]) -> None:
        self.x, self.y = 1000.0 / shape[1], 1000.0 / shape[0]

    def points(self, polygon: Polygon) -> list[dict[str, float]]:
        return [{"x": round(float(x * self.x), 1), "y": round(float(y * self.y), 1)} for x, y in polygon]

    def box(self, bounds: tuple[float, float, float, float]) -> dict[str, float]:
        x0, y0, x1, y1 = (float(np.clip(v * u, 0, 1000)) for v, u in zip(bounds, (self.x, self.y) * 2, strict=True))
        return {"x_min": round(x0, 1), "y_min": round(y0, 1), "x_max": round(x1, 1), "y_max": round(y1, 1)}


def _from_bottom_left(polygon: Polygon) -> list[int]:
    """Order of the corners: counter-clockwise as seen, beginning at the bottom left."""
    order = list(range(len(polygon)))[::-1]
    first = min(order, key=lambda i: polygon[i, 0] - polygon[i, 1])
    start = order.index(first)
    return order[start:] + order[:start]


def _side(frame: Frame, wall: int) -> str:
    start, end = frame.walls()[wall]
    dx, dy = end - start
    if abs(dx) >= abs(dy):
        return "bottom" if dx > 0 else "top"
    return "right" if dy > 0 else "left"


def _facing(yaw: float) -> str:
    return _FACINGS[round((yaw % 360) / 45) % 8]


def _opening(opening: Opening, name: str, frame: Frame, units: _Units) -> dict[str, Any]:
    start, end = frame.walls()[opening.wall]
    along = (end - start) / max(float(np.linalg.norm(end - start)), 1e-9)
    a, b = start + along * opening.along[0], start + along * opening.along[1]
    return {
        "id": name,
        "kind": opening.kind,
        "wall": _side(frame, opening.wall),
        "start": {"x_m": round(float(a[0]), 3), "y_m": round(float(a[1]), 3)},
        "end": {"x_m": round(float(b[0]), 3), "y_m": round(float(b[1]), 3)},
        "height_m": round(opening.height, 2),
        "sill_m": round(opening.sill, 2),
        "thickness_m": 0.12,
        "box": units.box(opening.bounds),
        "swing": "",
    }


def _picture(opening: Opening, name: str, frame: Frame, units: _Units) -> dict[str, Any]:
    start, end = frame.walls()[opening.wall]
    along = (end - start) / max(float(np.linalg.norm(end - start)), 1e-9)
    inward = np.array([-along[1], along[0]])
    middle = start + along * (opening.along[0] + opening.along[1]) / 2 + inward * 0.02
    yaw = float(np.degrees(np.arctan2(inward[0], -inward[1])))
    return {
        "id": name,
        "category": "picture",
        "label": "picture",
        "placement": "wall",
        "parent": _side(frame, opening.wall),
        "salience": "minor",
        "zone": None,
        "shape": "box",
        "box": units.box(opening.bounds),
        "centre_m": {"x_m": round(float(middle[0]), 3), "y_m": round(float(middle[1]), 3)},
        "base_m": round(opening.sill, 3),
        "size_m": {
            "width": round(opening.along[1] - opening.along[0], 3),
            "depth": 0.03,
            "height": round(opening.height, 3),
        },
        "facing": _facing(yaw),
        "yaw_deg": round(yaw, 1),
        "confidence": 0.3,
    }


def _object(item: Item, name: str, parent: str | None, units: _Units) -> dict[str, Any]:
    front = item.directed and item.category not in _NO_FRONT
    round_shape = item.thing.roundness < 0.86 and item.thing.fill > 0.6 and item.thing.box.angle == 0.0
    bounds = item.thing.hull.min(0).tolist() + item.thing.hull.max(0).tolist()
    return {
        "id": name,
        "category": item.category,
        "label": item.category.replace("_", " "),
        "placement": "surface" if parent is not None else "floor",
        "parent": parent,
        "salience": "minor" if item.minor else "major",
        "zone": None,
        "shape": "round" if round_shape else "box",
        "box": units.box((bounds[0], bounds[1], bounds[2], bounds[3])),
        "centre_m": {"x_m": round(item.foot.x, 3), "y_m": round(item.foot.y, 3)},
        "base_m": round(item.base, 3),
        "size_m": {"width": round(item.width, 3), "depth": round(item.depth, 3), "height": round(item.height, 3)},
        "facing": _facing(item.yaw) if front else "none",
        "yaw_deg": round(item.yaw, 1),
        "confidence": round(item.confidence, 2),
    }


def answer_of(seen: Analysis, shape: tuple[int, int]) -> dict[str, Any]:
    """The answer as plain data.

    Args:
        shape: height and width of the working picture.
    """
    units = _Units(shape)
    frame = seen.frame
    order = _from_bottom_left(frame.floor)
    counts: dict[str, int] = {}

    def name(category: str) -> str:
        counts[category] = counts.get(category, 0) + 1
        return f"{category}_{counts[category]}"

    names = [name(item.category) for item in seen.items]
    objects = [
        _object(item, names[i], names[item.parent] if item.parent >= 0 else None, units)
        for i, item in enumerate(seen.items)
    ]
    objects += [_picture(o, name("picture"), frame, units) for o in seen.openings if o.kind == "picture"]
    width, depth = frame.size
    return {
        "view": seen.view,
        "room_type": room_type({item.category for item in seen.items}),
        "room_width_m": round(width, 3),
        "room_depth_m": round(depth, 3),
        "wall_height_m": frame.height,
        "floor_polygon": units.points(frame.floor[order]),
        "wall_top_polygon": units.points(frame.top[order]) if seen.view == "perspective" else None,
        "zones": [],
        "architecture": [_opening(o, name(o.kind), frame, units) for o in seen.openings if o.kind != "picture"],
        "objects": objects,
    }
