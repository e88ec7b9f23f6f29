# SPDX-License-Identifier: GPL-3.0-or-later
"""What kind of thing a newly added object is, judged by where it stands."""

from __future__ import annotations

import math
from typing import Any, Protocol

from ..artifacts.common import Placement, Salience
from ..artifacts.layout import LayoutEdit
from .measure import Box
from .naming import category_from_name
from .tags import FIELD, ID

_NEAR = 0.06  # metres between a base and what it stands on
_SMALL = 0.15  # square metres of footprint below which a new object decorates


class Measured(Protocol):
    """Boxes of the room's objects by id, measured when they are asked for."""

    def __getitem__(self, name: str) -> Box | None: ...

    def __setitem__(self, name: str, box: Box | None) -> None: ...

    def everything(self) -> dict[str, Box | None]:
        """All of them."""
        ...


def guess_placement(box: Box, parent: str | None, boxes: Measured, height: float) -> Placement:
    """On the floor, on a surface, under the ceiling or on a wall."""
    base, top = box.centre[2] - box.size[2] / 2, box.centre[2] + box.size[2] / 2
    if parent is not None and boxes[parent] is not None:
        return "surface"
    if base < _NEAR:
        return "floor"
    if height and top > height - _NEAR:
        return "ceiling"
    return "wall"


def supporting(box: Box, boxes: Measured) -> str | None:
    """Id of the object whose top the box stands on, with its centre above it; None when there is none."""
    base = box.centre[2] - box.size[2] / 2
    if base < _NEAR:
        return None
    for name, other in boxes.everything().items():
        if other is None or other is box:
            continue
        angle = math.radians(other.yaw)
        dx, dy = box.centre[0] - other.centre[0], box.centre[1] - other.centre[1]
        x, y = dx * math.cos(angle) + dy * math.sin(angle), dy * math.cos(angle) - dx * math.sin(angle)
        within = abs(x) <= other.size[0] / 2 and abs(y) <= other.size[1] / 2
        if within and abs(base - other.centre[2] - other.size[2] / 2) <= _NEAR:
            return name
    return None


def new_proxy_edit(obj: Any, name: str, box: Box, parent: str | None, boxes: Measured, height: float) -> LayoutEdit:
    """The edit that adds an object of the artist to the program; a copy takes over what its original says."""
    is_copy = ID in obj and FIELD + "category" in obj
    if parent is None and not is_copy:
        parent = supporting(box, boxes)
    placement: Placement = guess_placement(box, parent, boxes, height)
    salience: Salience = "minor" if box.size[0] * box.size[1] < _SMALL else "major"
    if is_copy:
        placement, salience = obj[FIELD + "placement"], obj[FIELD + "salience"]
    boxes[name] = box
    return LayoutEdit(
        op="add",
        id=name,
        category=str(obj[FIELD + "category"]) if is_copy else category_from_name(obj.name),
        label=str(obj.get(FIELD + "label", "")),
        centre=tuple(round(v, 4) + 0.0 for v in box.centre),
        size=tuple(round(max(v, 1e-4), 4) for v in box.size),
        yaw=round(box.yaw, 4),
        placement=placement,
        parent=parent,
        salience=salience,
        shape=obj.get(FIELD + "shape", "box") if is_copy else "box",
        reason="copied by hand" if is_copy else "added by hand",
        origin="artist",
    )
