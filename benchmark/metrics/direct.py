# SPDX-License-Identifier: GPL-3.0-or-later
"""The direct answer: what the model's first reply says in metres, taken as it is.

This is the competitor of every result. No camera, no fusing, no second look, no solver; only what cannot be read at all
is left out. The reply states the room's width and depth, and draws the floor in the picture: the outline is stretched to
that rectangle. A floor that fills its rectangle to 97 % is that rectangle, and so are four corners seen in perspective
(where the picture leans, not the room); sides within 4 degrees of an axis become straight, so that a hand's tremble while
drawing does not count as things standing outside. Floors with more corners in a tilted picture keep the tilt.
"""

from __future__ import annotations

import math
from pathlib import Path

from code_as_room.pipeline.artifacts.replies import AnalysisReply
from code_as_room.pipeline.errors import ReplyError
from code_as_room.pipeline.geometry.polygon import area, bounding_rectangle, ensure_ccw
from code_as_room.pipeline.memory import Memory, load_memory
from code_as_room.pipeline.models.validate import validate_reply

from .areas import Polygon
from .rooms import Room, room_of

FIRST_REQUEST = "01_analysis"
_FULL = 0.97
_STRAIGHT = 4.0


def direct_answer(memory: Memory | Path) -> Room | None:
    """The first reply's metres as a room; None when no usable first reply is kept.

    Args:
        memory: a run's memory, or its `memory.json`.
    """
    if isinstance(memory, Path):
        memory = load_memory(memory.read_text(encoding="utf-8"))
    for entry in memory.entries:
        if entry.type == "Answer" and entry.output.get("key") == FIRST_REQUEST:
            try:
                reply, _ = validate_reply(entry.output["text"], AnalysisReply, salvage=True)
            except ReplyError:
                continue
            return room_from_reply(reply)
    return None


def room_from_reply(reply: AnalysisReply) -> Room:
    """A reply's metres as a room."""
    objects = [
        {
            "id": o.id,
            "category": o.category,
            "centre": (o.centre_m.x_m, o.centre_m.y_m, o.base_m + o.size_m.height / 2),
            "size": (o.size_m.width, o.size_m.depth, o.size_m.height),
            "yaw": o.yaw_deg,
            "placement": o.placement,
            "parent": o.parent,
            "salience": o.salience,
            "shape": o.shape,
        }
        for o in reply.objects
    ]
    partitions = [
        {"kind": a.kind, "start": (a.start.x_m, a.start.y_m), "end": (a.end.x_m, a.end.y_m)} for a in reply.architecture
    ]
    size = (reply.room_width_m, reply.room_depth_m, reply.wall_height_m)
    room = {"floor": floor_of(reply), "size": size}
    return room_of({"room": room, "objects": objects, "architecture": partitions})


def floor_of(reply: AnalysisReply) -> Polygon:
    """The floor's outline in metres, origin at its rectangle's centre."""
    x, y = reply.room_width_m / 2, reply.room_depth_m / 2
    rectangle = [(-x, -y), (x, -y), (x, y), (-x, y)]
    drawn = [(point.x, -point.y) for point in reply.floor_polygon]
    if len(drawn) < 3 or (len(drawn) == 4 and reply.view == "perspective"):
        return rectangle
    left, low, right, high = bounding_rectangle(drawn)
    if area(drawn) <= 0 or area(drawn) >= _FULL * (right - left) * (high - low):
        return rectangle
    wide, deep = (right - left) / (2 * x), (high - low) / (2 * y)
    outline = ensure_ccw([((px - left) / wide - x, (py - low) / deep - y) for px, py in drawn])
    straight = bounding_rectangle(_straightened(outline))
    return [
        ((px - (straight[0] + straight[2]) / 2) * 2 * x / (straight[2] - straight[0]),
         (py - (straight[1] + straight[3]) / 2) * 2 * y / (straight[3] - straight[1]))
        for px, py in _straightened(outline)
    ]  # fmt: skip


def _straightened(outline: Polygon) -> Polygon:
    """Sides that nearly follow an axis follow it; both ends go to their middle."""
    points = [list(p) for p in outline]
    for i in range(len(points)):
        a, b = points[i], points[(i + 1) % len(points)]
        angle = math.degrees(math.atan2(abs(b[1] - a[1]), abs(b[0] - a[0])))
        for axis, leaning in ((1, angle), (0, 90 - angle)):
            if leaning <= _STRAIGHT:
                a[axis] = b[axis] = (a[axis] + b[axis]) / 2
    return [(px, py) for px, py in points]
