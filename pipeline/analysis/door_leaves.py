# SPDX-License-Identifier: GPL-3.0-or-later
"""Door leaves that were listed among the objects belong to their doors: no furniture is made of them."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence

from ..artifacts.analysis import ArchitectureItem, DetectedObject, Finding
from ..artifacts.common import ImageBox

_LEAF = frozenset(
    ("door", "leaf", "panel", "open", "opened", "closed", "entrance", "entry", "interior", "room", "hinged", "swing",
     "wooden", "white")
)  # fmt: skip
_REACH = 1.2
"""Of a door's width: how far from the door's middle the middle of its leaf may be."""
_IN_LINE = 0.15
"""Metres from the wall up to which a leaf is closed."""


def without_leaves(
    objects: Sequence[DetectedObject], architecture: Sequence[ArchitectureItem], findings: list[Finding]
) -> tuple[list[DetectedObject], list[ArchitectureItem]]:
    """Objects without the leaves of doors, and the doors with what their leaves tell: boxes that hold them, and "open"."""
    doors = {a.id: a for a in architecture if a.kind == "door"}
    gone: set[str] = set()
    for item in objects:
        door = _door_of(item, list(doors.values())) if _is_leaf(item) else None
        if door is not None:
            gone.add(item.id)
            doors[door.id] = _with_leaf(door, item)
            findings.append(Finding(about=item.id, message=f"It is the leaf of {door.id} and became part of it."))
    kept = [o.model_copy(update={"parent": None}) if o.parent in gone else o for o in objects if o.id not in gone]
    return (kept if gone else list(objects)), [doors.get(a.id, a) for a in architecture]


def _is_leaf(item: DetectedObject) -> bool:
    words = re.findall(r"[a-z]+", item.category.lower())
    return item.size[2] > 1.2 and "door" in words and _LEAF.issuperset(words)


def _door_of(item: DetectedObject, doors: Sequence[ArchitectureItem]) -> ArchitectureItem | None:
    """The nearest door whose leaf a thing can be."""

    def off(door: ArchitectureItem) -> float:
        middle = [(a + b) / 2 for a, b in zip(door.start, door.end, strict=True)]
        return math.dist(middle, item.centre[:2]) / math.dist(door.start, door.end)

    nearest = min(doors, key=off, default=None)
    return nearest if nearest is not None and off(nearest) < _REACH else None


def _with_leaf(door: ArchitectureItem, leaf: DetectedObject) -> ArchitectureItem:
    width = math.dist(door.start, door.end)
    ux, uy = (door.end[0] - door.start[0]) / width, (door.end[1] - door.start[1]) / width
    dx, dy = leaf.centre[0] - door.start[0], leaf.centre[1] - door.start[1]
    stands = "standing open" if abs(dy * ux - dx * uy) > _IN_LINE else "closed"
    return door.model_copy(update={"box": _union(door.box, leaf.box), "swing": door.swing or stands})


def _union(one: ImageBox | None, other: ImageBox | None) -> ImageBox | None:
    if one is None or other is None:
        return one or other
    return ImageBox(
        x_min=min(one.x_min, other.x_min),
        y_min=min(one.y_min, other.y_min),
        x_max=max(one.x_max, other.x_max),
        y_max=max(one.y_max, other.y_max),
    )
