# SPDX-License-Identifier: GPL-3.0-or-later
"""The shell of a layout: outer walls from the floor polygon, partitions, and what is cut into them."""

from __future__ import annotations

import math

from ..artifacts.analysis import ArchitectureItem, Calibration, Finding, SceneAnalysis
from ..artifacts.common import Metres2
from ..artifacts.layout import DoorLine, OpeningLine, RoomLine, WallLine, WindowLine
from .doors import door_stands

SIDES = {"left": (-1.0, 0.0), "right": (1.0, 0.0), "top": (0.0, 1.0), "bottom": (0.0, -1.0)}
NAMES = {"left": "wall_w", "right": "wall_e", "top": "wall_n", "bottom": "wall_s"}
MIN_WIDTH = 0.3


def outer_walls(floor: list[Metres2], height: float) -> list[WallLine]:
    """One wall for each edge of the counter-clockwise floor outline, named after the side it lies on."""
    walls: list[WallLine] = []
    taken: set[str] = set()
    for i, start in enumerate(floor):
        end = floor[(i + 1) % len(floor)]
        if math.dist(start, end) < 0.02:
            continue
        base = NAMES[side_of(start, end)]
        name, number = base, 2
        while name in taken:
            name, number = f"{base}_{number}", number + 1
        taken.add(name)
        walls.append(WallLine(id=name, start=start, end=end, height=height, thickness=0.12))
    return walls


def side_of(start: Metres2, end: Metres2) -> str:
    """Which side of the room a wall of the counter-clockwise outline is on: "left", "right", "top" or "bottom"."""
    outward = (end[1] - start[1], start[0] - end[0])
    return max(SIDES, key=lambda side: SIDES[side][0] * outward[0] + SIDES[side][1] * outward[1])


def along(wall: WallLine, point: Metres2) -> tuple[float, float]:
    """Distance along the wall from its start, and distance from its line (positive to the left), metres."""
    length = max(1e-9, math.dist(wall.start, wall.end))
    ux, uy = (wall.end[0] - wall.start[0]) / length, (wall.end[1] - wall.start[1]) / length
    dx, dy = point[0] - wall.start[0], point[1] - wall.start[1]
    return dx * ux + dy * uy, dy * ux - dx * uy


def point_on(wall: WallLine, distance: float) -> Metres2:
    """The point of the wall's line at this distance from its start."""
    length = max(1e-9, math.dist(wall.start, wall.end))
    t = distance / length
    return (
        wall.start[0] + t * (wall.end[0] - wall.start[0]),
        wall.start[1] + t * (wall.end[1] - wall.start[1]),
    )


def wall_for(item: ArchitectureItem, walls: list[WallLine]) -> WallLine | None:
    """The wall that an opening lies in: the named one, else the nearest that runs along it."""
    if item.wall:
        named = [w for w in walls if w.id == item.wall]
        if not named and item.wall in NAMES:
            named = [w for w in walls if w.id == NAMES[item.wall] or w.id.startswith(NAMES[item.wall] + "_")]
        if named:
            return min(named, key=lambda w: _offset(item, w))
    near = [w for w in walls if _offset(item, w) < 0.8]
    return min(near, key=lambda w: _offset(item, w)) if near else None


def _offset(item: ArchitectureItem, wall: WallLine) -> float:
    length = math.dist(wall.start, wall.end)
    total = 0.0
    for point in (item.start, item.end):
        t, off = along(wall, point)
        total += abs(off) + max(0.0, -t, t - length)
    return total


def shell(
    analysis: SceneAnalysis, calibration: Calibration
) -> tuple[RoomLine, list[WallLine], list[DoorLine], list[WindowLine], list[OpeningLine], list[Finding]]:
    """Floor, walls and openings of the layout; openings are pushed onto their wall and kept inside its span."""
    floor = calibration.floor
    height = calibration.height
    xs, ys = [p[0] for p in floor], [p[1] for p in floor]
    room = RoomLine(size=(max(xs) - min(xs), max(ys) - min(ys), height), floor=floor)
    walls = outer_walls(floor, height)
    findings: list[Finding] = []
    for item in analysis.architecture:
        if item.kind == "partition":
            walls.append(_partition(item, height, floor))
    doors: list[DoorLine] = []
    windows: list[WindowLine] = []
    openings: list[OpeningLine] = []
    for item in analysis.architecture:
        if item.kind == "builtin":
            findings.append(Finding(about=item.id, message="Built-in parts of the room are not built; it is left out."))
        if item.kind not in ("door", "window", "opening"):
            continue
        wall = wall_for(item, walls)
        span = _span(item, wall) if wall is not None else None
        if wall is None or span is None:
            level = "note" if item.kind == "opening" else "warning"
            findings.append(
                Finding(
                    about=item.id, message=f"No wall was found for this {item.kind}; it is left out.", severity=level
                )
            )
            continue
        start, end = span
        if item.kind == "door":
            top = min(item.height, height - 0.05)
            hinge, edge, degrees = door_stands(item, wall, span, calibration)
            doors.append(DoorLine(id=item.id, wall=wall.id, start=hinge, end=edge, height=top, open=degrees))
        elif item.kind == "window":
            sill = min(item.sill, height - 0.5)
            top = min(item.height, height - 0.05 - sill)
            windows.append(WindowLine(id=item.id, wall=wall.id, start=start, end=end, sill=sill, height=top))
        else:
            sill = min(item.sill, height - 0.5)
            top = min(item.height, height - sill)
            openings.append(OpeningLine(id=item.id, wall=wall.id, start=start, end=end, sill=sill, height=top))
    return room, walls, doors, windows, openings, findings


def _partition(item: ArchitectureItem, height: float, floor: list[Metres2]) -> WallLine:
    thickness = max(0.05, min(0.4, item.thickness))
    top = height if item.height > 0.8 * height else item.height
    start, end = _reach_walls(item.start, floor), _reach_walls(item.end, floor)
    return WallLine(id=item.id, start=start, end=end, height=top, thickness=thickness, partition=True)


def _reach_walls(point: Metres2, floor: list[Metres2], reach: float = 0.25) -> Metres2:
    """A partition's end that stops just short of an outer wall is drawn up to it."""
    best, moved = reach, point
    for i, a in enumerate(floor):
        b = floor[(i + 1) % len(floor)]
        length = math.dist(a, b)
        if length < 1e-6:
            continue
        t = ((point[0] - a[0]) * (b[0] - a[0]) + (point[1] - a[1]) * (b[1] - a[1])) / length**2
        if not 0 <= t <= 1:
            continue
        foot = (a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1]))
        gap = math.dist(point, foot)
        if gap < best:
            best, moved = gap, foot
    return moved


def _span(item: ArchitectureItem, wall: WallLine) -> tuple[Metres2, Metres2] | None:
    """Start and end on the wall's line, inside its length; None when too little is left."""
    length = math.dist(wall.start, wall.end)
    a, b = sorted(along(wall, p)[0] for p in (item.start, item.end))
    a, b = max(0.0, a), min(length, b)
    if b - a < MIN_WIDTH:
        return None
    return point_on(wall, a), point_on(wall, b)
