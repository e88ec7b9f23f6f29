# SPDX-License-Identifier: GPL-3.0-or-later
"""A scene's ground truth: `code-as-room/scene/1` (see `samples/bedroom`), and where the picture shows each object.

Beyond that format every object has `symmetry`, `shape`, `footprint` (metres, where it is not the rectangle), `under` (the
table that it is pushed under), `box` (of the whole object, hidden parts too), `visible` (share of its pixels that are
not hidden by others) and `visible_box` (of those pixels); boxes are 0-1000 of the picture's width and height, y down.
`camera` is a `CameraModel`. `zones` hold the id of their main thing and of all that belongs to them.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from code_as_room.pipeline.program.prelude.shape import Floats
from PIL import Image, ImageDraw

from .model import Item, Scene

SHOWN = 0.15
_FINE = 3  # silhouettes are drawn this many times finer than the picture


@dataclass(frozen=True)
class Sight:
    """How the picture shows an object: boxes in 0-1000 of the picture."""

    box: dict[str, float]
    visible: float = 1.0
    visible_box: dict[str, float] | None = None


def box_of(points: Floats, size: tuple[int, int]) -> dict[str, float]:
    """The box of pixels (N, 2) as 0-1000 of the picture."""
    low, high = points.min(axis=0) * 1000 / size, points.max(axis=0) * 1000 / size
    names = ("x_min", "y_min", "x_max", "y_max")
    return dict(zip(names, (round(float(v), 1) for v in (*low, *high)), strict=True))


def sight_of(points: Floats, faces: list[tuple[int, ...]], shown: Floats, size: tuple[int, int]) -> Sight:
    """How an object is seen, from its projected faces and the pixels that show it."""
    whole = Image.new("1", (size[0] * _FINE, size[1] * _FINE))
    pen = ImageDraw.Draw(whole)
    fine = points * _FINE - 0.5
    for face in faces:
        pen.polygon([(x, y) for x, y in fine[list(face)].tolist()], fill=1)
    area = float(np.asarray(whole).sum()) / _FINE**2
    rows, columns = np.nonzero(shown)
    if not len(rows):
        return Sight(box_of(points, size), 0.0)
    corners = np.array([[columns.min(), rows.min()], [columns.max() + 1, rows.max() + 1]], dtype=float)
    return Sight(box_of(points, size), round(min(1.0, len(rows) / area), 3), box_of(corners, size))


def truth_of(scene: Scene, items: list[Item], sights: Mapping[str, Sight], image: str) -> dict[str, Any]:
    """The document. Raises ValueError when the picture hardly shows something that is said to be there."""
    hidden = [item.id for item in items if sights[item.id].visible < SHOWN]
    if hidden:
        raise ValueError(f"Hardly to be seen: {', '.join(hidden)}.")
    xs, ys = [p[0] for p in scene.floor], [p[1] for p in scene.floor]
    return {
        "format": "code-as-room/scene/1",
        "image": image,
        "room_type": scene.room_type,
        "room": {
            "size": [round(max(xs) - min(xs), 4), round(max(ys) - min(ys), 4), scene.height],
            "floor": [list(p) for p in scene.floor],
        },
        "camera": scene.camera.model_dump(mode="json"),
        "architecture": _architecture(scene),
        "zones": [{"name": name, "anchor": anchor, "objects": list(ids)} for name, anchor, ids in scene.zones],
        "objects": [_object(item, sights[item.id]) for item in items],
    }


def _architecture(scene: Scene) -> list[dict[str, Any]]:
    count = len(scene.floor)
    found: list[dict[str, Any]] = []
    for number in range(count):
        a, b = scene.floor[number], scene.floor[(number + 1) % count]
        found.append(_line(f"wall_{number + 1}", "wall", a, b, scene.height, thickness=scene.thickness))
    for o in scene.openings:
        a, b = scene.along(o.wall, o.start), scene.along(o.wall, o.end)
        line = _line(o.id, o.kind, a, b, o.height, sill=o.sill, wall=f"wall_{o.wall + 1}")
        found.append({**line, "hinge": o.hinge, "degrees": o.degrees} if o.kind == "door" else line)
    for p in scene.partitions:
        found.append(_line(p.id, "partition", p.start, p.end, p.height, thickness=p.thickness))
    return found


def _line(id: str, kind: str, a: Any, b: Any, height: float, **more: Any) -> dict[str, Any]:
    ends = {"start": [round(v, 4) for v in a], "end": [round(v, 4) for v in b]}
    return {"id": id, "kind": kind, **ends, "height": height, "sill": 0.0, "wall": None, **more}


def _object(item: Item, sight: Sight) -> dict[str, Any]:
    middle = (item.base or 0.0) + item.size[2] / 2
    found: dict[str, Any] = {
        "id": item.id,
        "category": item.category,
        "label": item.label,
        "centre": [round(v, 4) for v in (item.x, item.y, middle)],
        "size": [round(v, 4) for v in item.size],
        "yaw": round(math.remainder(item.yaw, 360), 2),
        "placement": item.placement,
        "parent": item.parent,
        "salience": item.salience,
        "symmetry": item.symmetry,
        "shape": item.shape,
        "box": sight.box,
        "visible": sight.visible,
        "visible_box": sight.visible_box or sight.box,
    }
    if item.outline:
        found["footprint"] = [[round(v, 4) for v in p] for p in item.to_room(item.outline)]
    if item.under:
        found["under"] = item.under
    return found
