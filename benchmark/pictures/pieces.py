# SPDX-License-Identifier: GPL-3.0-or-later
"""From items to shapes: the furniture library and `extra.room`, evaluated; what lies on something is let down onto it."""

from __future__ import annotations

import functools
import math
from collections.abc import Iterable
from dataclasses import replace
from pathlib import Path

import bpy  # noqa: F401 (mathutils comes with it)
import numpy as np
from code_as_room.pipeline.library import catalogue
from code_as_room.pipeline.program.evaluate import evaluate_object
from code_as_room.pipeline.program.prelude.shape import Shape
from mathutils import Vector
from mathutils.bvhtree import BVHTree

from .model import Item

EXTRA = Path(__file__).with_name("extra.room")
_TOLERANCE = 0.012  # metres that a piece may miss its size by
_REACH = 0.35  # how far from its middle, in parts of its size, a thing feels for what is under it


@functools.cache
def _extra() -> str:
    return EXTRA.read_text(encoding="utf-8")


def shapes_of(item: Item) -> list[Shape]:
    """The item's shapes in its own axes, standing on z = 0.

    Raises:
        ValueError: they do not fill the item's size.
    """
    text = catalogue.source([item.piece]) if item.piece in catalogue.pieces() else _extra()
    options = "".join(f", {name}={value!r}" for name, value in item.options.items())
    shapes = evaluate_object(f"{text}\n\ndef made():\n    return {item.piece}({item.size!r}{options})\n", "made")
    points = np.concatenate([shape.vertices for shape in shapes])
    low, high = points.min(axis=0), points.max(axis=0)
    wanted = np.array(item.size)
    if np.abs(low - (-wanted[0] / 2, -wanted[1] / 2, 0)).max() > _TOLERANCE or np.abs(high - low - wanted).max() > 0.02:
        raise ValueError(f"{item.id} was modelled {np.round(high - low, 3)} but is stated as {item.size}.")
    return shapes


def settle(items: Iterable[Item]) -> dict[str, tuple[Item, list[Shape]]]:
    """Every item with its shapes, by id, those without a base let down onto their parents (which come before them)."""
    done: dict[str, tuple[Item, list[Shape]]] = {}
    for item in items:
        if item.base is None:
            if item.parent is None:
                raise ValueError(f"{item.id} has neither base nor parent.")
            item = replace(item, base=_top_under(item, *done[item.parent]))
        done[item.id] = (item, shapes_of(item))
    return done


def _top_under(item: Item, parent: Item, shapes: list[Shape]) -> float:
    """The height of the parent's surface under an item: the median of what vertical rays meet."""
    points, faces, start = [], [], 0
    for shape in shapes:
        points += shape.vertices.tolist()
        faces += [tuple(i + start for i in face) for face in shape.faces]
        start += shape.vertex_count
    tree = BVHTree.FromPolygons(points, faces)
    width, depth = item.size[0] * _REACH, item.size[1] * _REACH
    places = item.to_room([(a * width, b * depth) for a in (-1, 0, 1) for b in (-1, 0, 1)])
    cos, sin = math.cos(math.radians(parent.yaw)), math.sin(math.radians(parent.yaw))
    heights = []
    for x, y in places:
        dx, dy = x - parent.x, y - parent.y
        hit = tree.ray_cast(Vector((dx * cos + dy * sin, dy * cos - dx * sin, 10.0)), Vector((0, 0, -1)))[0]
        if hit is not None:
            heights.append(float(hit[2]))
    if len(heights) < 5:
        raise ValueError(f"{item.id} does not lie on {parent.id}.")
    return (parent.base or 0.0) + float(np.median(heights))
