# SPDX-License-Identifier: GPL-3.0-or-later
"""Walls as the solver sees them: faces to stand flush at, and partitions as bodies in the way."""

from __future__ import annotations

import math
from collections.abc import Sequence

from ..artifacts.common import Metres2
from ..artifacts.layout import WallLine
from ..geometry.placement import Rect, support
from ..geometry.polygon import line_distance

Face = tuple[Metres2, Metres2]
"""Start and end of a wall's face, the room to its left."""


def face_gap(rect: Rect, face: Face) -> float:
    """Free space between a rectangle and a wall's face, metres; below 0 in it."""
    return line_distance((rect.x, rect.y), *face) - support(rect, face_inward(face))


def face_inward(face: Face) -> Metres2:
    """Unit direction from a wall into the room."""
    (ax, ay), (bx, by) = face
    length = max(1e-9, math.dist(*face))
    return -(by - ay) / length, (bx - ax) / length


def is_parallel(rect: Rect, face: Face) -> bool:
    """Whether one of a rectangle's sides runs along a wall."""
    (ax, ay), (bx, by) = face
    turn = (math.degrees(math.atan2(by - ay, bx - ax)) - rect.yaw + 45) % 90 - 45
    return abs(turn) < 1e-3


def wall_faces(walls: Sequence[WallLine], seen_from: Metres2) -> list[tuple[str, Face]]:
    """Ids and wall faces towards a point, the room to their left."""
    faces = []
    for wall in walls:
        if not wall.partition:
            faces.append((wall.id, (wall.start, wall.end)))
            continue
        length = max(1e-9, math.dist(wall.start, wall.end))
        nx, ny = -(wall.end[1] - wall.start[1]) / length, (wall.end[0] - wall.start[0]) / length
        side = (seen_from[0] - wall.start[0]) * nx + (seen_from[1] - wall.start[1]) * ny
        sign = 1.0 if side >= 0 else -1.0
        off = (nx * sign * wall.thickness / 2, ny * sign * wall.thickness / 2)
        a = (wall.start[0] + off[0], wall.start[1] + off[1])
        b = (wall.end[0] + off[0], wall.end[1] + off[1])
        faces.append((wall.id, (a, b) if sign > 0 else (b, a)))
    return faces


def partition_body(wall: WallLine) -> Rect:
    """A partition seen from above."""
    (ax, ay), (bx, by) = wall.start, wall.end
    return Rect(
        (ax + bx) / 2,
        (ay + by) / 2,
        math.dist(wall.start, wall.end),
        wall.thickness,
        math.degrees(math.atan2(by - ay, bx - ax)),
    )
