# SPDX-License-Identifier: GPL-3.0-or-later
"""Cameras at eye level that stand outside of the room or inside of something; they would show nothing but its inside.

A camera above the walls looks in from above, one that shows the picture's own view stands where the picture was taken
from, and one with a near clip beyond `CUTS` cuts what is before it: all of these stay.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from ..artifacts.layout import CameraLine
from ..geometry.placement import Rect, is_inside
from ..geometry.polygon import centroid, point_in_polygon
from ..program.lines import rounded_line
from .bodies import Room
from .columns import Floats
from .faults import Fault, Knowledge, Mend

CUTS = 0.3
AROUND = 0.2
"""Metres between a camera that was moved and walls and things."""
_STEP, _REACH = 0.1, 6.0
_EYE = 1.5  # metres
_FROM_ABOVE = 0.7  # of its look's length that goes down: such a camera shows the room wherever it stands over it


def find(room: Room, knowledge: Knowledge) -> list[Fault]:
    """Cameras that stand outside of the room or in something."""
    found = []
    for camera in room.layout.cameras:
        if camera.kind != "perspective" or camera.near > CUTS or camera.id in knowledge.reference:
            continue
        at = _at(camera)
        if at[2] >= room.height and _matrix(camera)[2, 2] > _FROM_ABOVE:
            continue
        if not 0.0 < at[2] < room.height or not point_in_polygon(at[:2].tolist(), room.layout.room.floor):
            found.append(Fault("camera", camera.id, "room", 1.0, "It stands outside of the room."))
            continue
        for identifier in _holding(room, at, 0.0):
            found.append(Fault("camera", camera.id, identifier, 1.0, f"It stands inside of {identifier}."))
    return found


def fix(room: Room, fault: Fault, knowledge: Knowledge) -> Iterator[Mend]:
    """The nearest free place in the room; it keeps its look, unless nothing of the room would be before it."""
    camera = next(c for c in room.layout.cameras if c.id == fault.id)
    at = _at(camera)
    level = float(at[2]) if AROUND < at[2] < room.height - AROUND else min(_EYE, room.height / 2)
    floor = np.array(room.layout.room.floor)
    low, high = floor.min(axis=0), floor.max(axis=0)
    near = np.clip(at[:2], low, high)
    steps = np.arange(-int(_REACH / _STEP), int(_REACH / _STEP) + 1) * _STEP
    places = [(float(near[0] + x), float(near[1] + y)) for x in steps for y in steps]
    places = [p for p in places if low[0] <= p[0] <= high[0] and low[1] <= p[1] <= high[1]]
    for x, y in sorted(places, key=lambda p: (math.dist(p, at[:2]), p)):
        square = Rect(x, y, 2 * AROUND, 2 * AROUND)
        spot = np.array((x, y, level))
        if not is_inside(square, room.layout.room.floor) or _holding(room, spot, AROUND / 2):
            continue
        matrix = _matrix(camera).copy()
        matrix[:3, 3] = spot
        middle = np.array((*centroid(room.layout.room.floor), level))
        if math.dist(spot, middle) > AROUND and -matrix[:3, 2] @ (middle - spot) <= 0:
            matrix[:3, :3] = _looking(middle - spot)
        line = rounded_line(camera.model_copy(update={"matrix": tuple(float(v) for v in matrix.ravel())}))
        cameras = [line if c.id == camera.id else c for c in room.layout.cameras]
        before, after = (str(tuple(round(float(v), 3) for v in p)) for p in (at, spot))
        distance = round(float(np.linalg.norm(spot - at)), 4)
        yield Mend(
            room.with_lines(cameras=cameras), camera.id, before, after, distance, "Moved to a free place in the room."
        )
        return


def _matrix(camera: CameraLine) -> Floats:
    return np.array(camera.matrix, dtype=float).reshape(4, 4)


def _at(camera: CameraLine) -> Floats:
    place: Floats = _matrix(camera)[:3, 3]
    return place


def _holding(room: Room, at: Floats, around: float) -> list[str]:
    """Ids of the objects whose boxes hold a point, or come as near to it as `around`."""
    found = []
    for body in [*room.bodies.values(), *room.partitions]:
        if body.low - around <= at[2] <= body.high + around:
            rect = body.rect
            angle = math.radians(-rect.yaw)
            dx, dy = at[0] - rect.x, at[1] - rect.y
            x, y = dx * math.cos(angle) - dy * math.sin(angle), dx * math.sin(angle) + dy * math.cos(angle)
            if (
                abs(x) <= rect.width / 2 + around
                and abs(y) <= rect.depth / 2 + around
                and body.line.placement != "wall"
            ):
                found.append(body.id)
    return found


def _looking(way: Floats) -> Floats:
    """Rotation of a level camera that looks along a way."""
    back = -np.array((way[0], way[1], 0.0)) / max(1e-9, math.hypot(way[0], way[1]))
    right = np.cross((0.0, 0.0, 1.0), back)
    return np.stack([right, np.cross(back, right), back], axis=1)
