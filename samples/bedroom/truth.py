"""The ground truth of the sample in the `code-as-room/scene/1` format, checked against the meshes."""

from __future__ import annotations

import math
from typing import Any

import bpy
import numpy as np
from description import DOOR, IMAGE_SIZE, ITEMS, ROOM_SIZE, WINDOW, Item
from scene import camera_fov_y, local_bounds
from shapes import Array

TOLERANCE = 0.01


def box_of(item: Item, low: Array, high: Array) -> tuple[Array, Array]:
    """Centre in the world and size of an item's box.

    Stated boxes must agree with the meshes' bounds (ValueError beyond 1 cm); for simulated cloth the bounds are the box.
    """
    size = np.array(item.size)
    middle = np.array([0, 0, size[2] / 2])
    if item.measured:
        size, middle = high - low, (low + high) / 2
    gap = max(np.abs(low - (middle - size / 2)).max(), np.abs(high - (middle + size / 2)).max())
    if gap > TOLERANCE:
        raise ValueError(f"{item.id}: meshes span {low.round(3)} to {high.round(3)}, stated size {item.size}")
    a = math.radians(item.yaw)
    turn = np.array([[math.cos(a), -math.sin(a), 0], [math.sin(a), math.cos(a), 0], [0, 0, 1]])
    return turn @ middle + [item.x, item.y, item.base], size


def rounded(values: Any, digits: int = 4) -> list[float]:
    return [round(float(v), digits) + 0.0 for v in values]


def scene_truth(roots: dict[str, bpy.types.Object], camera: bpy.types.Object, image: str) -> dict[str, Any]:
    """The whole document; raises ValueError where a mesh does not fill its stated box."""
    w, d, h = ROOM_SIZE
    x, y = w / 2, d / 2
    corners = [(-x, -y), (x, -y), (x, y), (-x, y)]
    names = ("wall_south", "wall_east", "wall_north", "wall_west")
    architecture: list[dict[str, Any]] = [
        {
            "id": name,
            "kind": "wall",
            "start": list(corners[i]),
            "end": list(corners[(i + 1) % 4]),
            "height": h,
            "sill": 0.0,
            "wall": None,
        }
        for i, name in enumerate(names)
    ]
    architecture += [
        {
            "id": o.id,
            "kind": o.kind,
            "start": list(o.start),
            "end": list(o.end),
            "height": o.height,
            "sill": o.sill,
            "wall": o.wall,
        }
        for o in (DOOR, WINDOW)
    ]
    objects = []
    for item in ITEMS:
        centre, size = box_of(item, *local_bounds(roots[item.id]))
        objects.append(
            {
                "id": item.id,
                "category": item.category,
                "label": item.label,
                "centre": rounded(centre),
                "size": rounded(size),
                "yaw": item.yaw,
                "placement": item.placement,
                "parent": item.parent,
                "salience": item.salience,
            }
        )
    return {
        "format": "code-as-room/scene/1",
        "image": image,
        "room": {"size": list(ROOM_SIZE), "floor": [list(c) for c in corners]},
        "camera": {
            "kind": "perspective",
            "matrix": rounded(np.array(camera.matrix_world).ravel(), 6),
            "fov_y": round(camera_fov_y(), 6),
            "image_size": list(IMAGE_SIZE),
        },
        "architecture": architecture,
        "objects": objects,
    }
