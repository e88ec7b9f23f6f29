# SPDX-License-Identifier: GPL-3.0-or-later
"""Walls: which side the room is on, mitred corners, and the solid around the holes.

A wall's own frame: origin at its start, x along it, y to its left (into the room for outer walls), z up.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np

from .pieces import Hole, ShellPiece, WallRun
from .shape import Floats, Shape

FLOOR_THICKNESS = 0.10  # metres, below z = 0; outer walls stand beside the slab and go as deep
SMALLEST_HOLE = 0.05  # metres; also the shortest wall
_SAME_POINT = 0.02  # metres; wall ends closer than this meet in a corner
_MITRE_LIMIT = 4.0  # wall thicknesses; sharper corners are cut square


def wall_runs(
    lines: list[dict[str, Any]], floor: list[tuple[float, float]], notes: list[str] | None = None
) -> list[WallRun]:
    """The wall lines as directed runs with mitred ends, in the order of the lines; unusable ones are left out."""
    notes = [] if notes is None else notes
    runs: list[WallRun] = []
    for line in lines:
        run = _plain_run(line, floor)
        if run.length < SMALLEST_HOLE:
            notes.append(f"Wall {run.id} is shorter than 5 cm and was left out.")
        elif any(other.id == run.id for other in runs):
            notes.append(f"Wall {run.id} is there twice; the second one was left out.")
        else:
            runs.append(run)
    return [replace(run, ends=(_joint(run, runs, False), _joint(run, runs, True))) for run in runs]


def _plain_run(line: dict[str, Any], floor: list[tuple[float, float]]) -> WallRun:
    """A run with square ends, turned round when the room would be on its right."""
    start = (float(line["start"][0]), float(line["start"][1]))
    end = (float(line["end"][0]), float(line["end"][1]))
    partition = bool(line.get("partition", False))
    if not partition and len(floor) >= 3 and _room_is_right(start, end, floor):
        start, end = end, start
    length = math.dist(start, end)
    thickness = max(0.01, float(line.get("thickness", 0.12)))
    height = max(0.05, float(line["height"]))
    return WallRun(line["id"], start, end, height, thickness, partition, ((0.0, 0.0), (length, length)))


def _room_is_right(start: tuple[float, float], end: tuple[float, float], floor: list[tuple[float, float]]) -> bool:
    """Whether the floor lies to the right of the segment and not to its left."""
    length = max(math.dist(start, end), 1e-9)
    nx, ny = -(end[1] - start[1]) / length * 0.05, (end[0] - start[0]) / length * 0.05
    mx, my = (start[0] + end[0]) / 2, (start[1] + end[1]) / 2
    return _inside((mx - nx, my - ny), floor) and not _inside((mx + nx, my + ny), floor)


def _inside(point: tuple[float, float], polygon: list[tuple[float, float]]) -> bool:
    """Even-odd test of a point against a polygon."""
    x, y = point
    inside = False
    for (ax, ay), (bx, by) in zip(polygon, polygon[1:] + polygon[:1], strict=True):
        if (ay > y) != (by > y) and x < (bx - ax) * (y - ay) / (by - ay) + ax:
            inside = not inside
    return inside


def _joint(run: WallRun, runs: list[WallRun], at_end: bool) -> tuple[float, float]:
    """x of the left and the right face of a run at one of its ends, mitred with the one wall that meets it there.

    Faces that continue each other are intersected. Outer walls join start to end only, since their outsides must be
    on the same side. A partition that butts against another wall stays square.
    """
    plain = run.length if at_end else 0.0
    corner = run.end if at_end else run.start
    meeting = []
    for other in runs:
        if other.id == run.id or other.partition != run.partition:
            continue
        if math.dist(corner, other.start if at_end else other.end) < _SAME_POINT:
            meeting.append((other.direction, other.start, other.left, other.right))
        elif run.partition and math.dist(corner, other.end if at_end else other.start) < _SAME_POINT:
            dx, dy = other.direction
            meeting.append(((-dx, -dy), other.start, -other.right, -other.left))
    if len(meeting) != 1:
        return plain, plain
    direction, point, left, right = meeting[0]
    found = [_face_crossing(run, own, direction, point, face) for own, face in ((run.left, left), (run.right, right))]
    limit = _MITRE_LIMIT * run.thickness
    safe = [plain if x is None or abs(x - plain) > min(limit, run.length) else x for x in found]
    return (safe[0] if run.partition else plain), safe[1]


def _face_crossing(
    run: WallRun, offset: float, direction: tuple[float, float], point: tuple[float, float], other_offset: float
) -> float | None:
    """x in the run's frame where its face y = offset meets the other wall's face, None when they are parallel."""
    dx, dy = run.direction
    ux, uy = direction
    turn = dx * uy - dy * ux
    if abs(turn) < 0.02:
        return None
    px, py = run.start[0] - dy * offset, run.start[1] + dx * offset
    qx, qy = point[0] - uy * other_offset, point[1] + ux * other_offset
    return ((qx - px) * uy - (qy - py) * ux) / turn


def wall_piece(run: WallRun, holes: list[Hole]) -> ShellPiece:
    """A wall as one closed mesh: a grid of solid and empty cells, with faces wherever solid meets empty."""
    bottom = 0.0 if run.partition else -FLOOR_THICKNESS
    xs = sorted({0.0, run.length, *(x for hole in holes for x in hole.x)})
    zs = sorted({bottom, run.height, *(z for hole in holes for z in hole.z)})
    columns, rows = len(xs) - 1, len(zs) - 1

    def solid(i: int, k: int) -> bool:
        if not (0 <= i < columns and 0 <= k < rows):
            return False
        x, z = (xs[i] + xs[i + 1]) / 2, (zs[k] + zs[k + 1]) / 2
        return not any(h.x[0] < x < h.x[1] and h.z[0] < z < h.z[1] for h in holes)

    lefts, rights = (_face_positions(run, xs, side) for side in (0, 1))
    mesh = _WallMesh()

    def corner(i: int, k: int, side: int) -> int:
        x, y = (lefts[i], run.left) if side == 0 else (rights[i], run.right)
        return mesh.vertex((x, y, zs[k]))

    for i in range(columns):
        for k in range(rows):
            if not solid(i, k):
                continue
            a, b, c, d = (i, k), (i + 1, k), (i + 1, k + 1), (i, k + 1)
            mesh.face(*(corner(*p, 0) for p in (d, c, b, a)))  # left face, seen from the room
            mesh.face(*(corner(*p, 1) for p in (a, b, c, d)))  # right face
            for near, far, beyond in ((a, d, (i - 1, k)), (c, b, (i + 1, k)), (b, a, (i, k - 1)), (d, c, (i, k + 1))):
                if not solid(*beyond):
                    mesh.face(corner(*near, 0), corner(*near, 1), corner(*far, 1), corner(*far, 0))
    kind = "partition" if run.partition else "wall"
    dx, dy = run.direction
    return ShellPiece(
        run.id,
        kind,
        [Shape(mesh.array(), tuple(mesh.faces), kind, kind)],
        (run.start[0], run.start[1], 0.0),
        math.degrees(math.atan2(dy, dx)),
        inward=None if run.partition else (-dy, dx),
    )


def _face_positions(run: WallRun, xs: list[float], side: int) -> list[float]:
    """The grid's x positions on one face: the first and last follow the mitre, the others are square to the wall."""
    first, last = run.ends[0][side], run.ends[1][side]
    return [first, *xs[1:-1], last]


class _WallMesh:
    """Collects faces over shared vertices."""

    def __init__(self) -> None:
        self.faces: list[tuple[int, ...]] = []
        self._index: dict[tuple[float, float, float], int] = {}

    def vertex(self, point: tuple[float, float, float]) -> int:
        """Index of a point, the same for the same point."""
        return self._index.setdefault(point, len(self._index))

    def face(self, *corners: int) -> None:
        """Add a face, counter-clockwise from outside."""
        self.faces.append(corners)

    def array(self) -> Floats:
        """The vertices, (N, 3)."""
        return np.array(list(self._index), dtype=float).reshape(-1, 3)
