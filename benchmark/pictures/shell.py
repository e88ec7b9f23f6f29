# SPDX-License-Identifier: GPL-3.0-or-later
"""The room itself in Blender: floor, walls with their openings, skirting boards, doors, windows, partitions."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from .meshes import BOX, add_box, add_mesh, give_grain
from .model import Opening, Point, Scene, outset

_SKIRTING = (0.012, 0.08)
_DEPTH_OF_FRAME = 0.06


def add_shell(scene: Scene) -> list[Any]:
    """Everything of the room that is not an item."""
    floor = np.array([(x, y, 0.0) for x, y in scene.floor])
    made = [add_mesh("floor", floor, [tuple(range(len(floor)))], [scene.look.floor], [0])]
    outer = outset(scene.floor, scene.thickness)
    for number in range(len(scene.floor)):
        made += _wall(scene, number, outer)
    for opening in scene.openings:
        made += _door(scene, opening) if opening.kind == "door" else _window(scene, opening)
    for part in scene.partitions:
        length = math.dist(part.start, part.end)
        yaw = math.degrees(math.atan2(part.end[1] - part.start[1], part.end[0] - part.start[0]))
        low, high = (0, -part.thickness / 2, 0), (length, part.thickness / 2, part.height - 0.003)
        made.append(add_box(part.id, low, high, part.material, yaw, (*part.start, 0)))
        cap = add_box(
            part.id + " cap", (0, low[1], part.height - 0.003), (length, high[1], part.height), scene.look.cap, yaw
        )
        cap.location = (*part.start, 0)
        made.append(cap)
    return made


def _wall(scene: Scene, number: int, outer: list[Point]) -> list[Any]:
    """The pieces of a wall between, under and over its openings, and its skirting boards."""
    following = (number + 1) % len(scene.floor)
    length = math.dist(scene.floor[number], scene.floor[following])
    holes = sorted((o for o in scene.openings if o.wall == number), key=lambda o: o.start)
    made, reached = [], 0.0
    for hole in holes:
        made += _piece(scene, number, outer, (reached, hole.start), (0.0, scene.height))
        made += _piece(scene, number, outer, (hole.start, hole.end), (0.0, hole.sill))
        made += _piece(scene, number, outer, (hole.start, hole.end), (hole.sill + hole.height, scene.height))
        if hole.sill == 0:
            made += _skirting(scene, number, reached, hole.start - 0.06)
            reached = hole.end
            made += [_threshold(scene, hole)]
        else:
            made += _skirting(scene, number, reached, hole.end)
            reached = hole.end
    made += _piece(scene, number, outer, (reached, length), (0.0, scene.height))
    return made + _skirting(scene, number, reached + (0.06 if holes and holes[-1].sill == 0 else 0), length)


def _normal(scene: Scene, number: int) -> Point:
    """Unit vector from the room outwards."""
    a, b = scene.floor[number], scene.floor[(number + 1) % len(scene.floor)]
    length = math.dist(a, b)
    return (b[1] - a[1]) / length, -(b[0] - a[0]) / length


def _piece(
    scene: Scene, number: int, outer: list[Point], part: tuple[float, float], levels: tuple[float, float]
) -> list[Any]:
    if part[1] - part[0] < 1e-6 or levels[1] - levels[0] < 1e-6:
        return []
    following = (number + 1) % len(scene.floor)
    length = math.dist(scene.floor[number], scene.floor[following])
    nx, ny = _normal(scene, number)
    inside = [scene.along(number, t) for t in part]
    outside = [(x + nx * scene.thickness, y + ny * scene.thickness) for x, y in inside]
    if part[0] < 1e-6:
        outside[0] = outer[number]
    if part[1] > length - 1e-6:
        outside[1] = outer[following]
    around = [outside[0], outside[1], inside[1], inside[0]]
    points = np.array([(x, y, z) for z in levels for x, y in around])
    cut = levels[1] >= scene.height
    texts = [scene.look.walls.get(number, scene.look.wall), scene.look.cap]
    obj = add_mesh(f"wall {number}", points, BOX, texts, [0, int(cut), 0, 0, 0, 0])
    give_grain(obj)
    return [obj]


def _frame_of(scene: Scene, number: int) -> tuple[float, Point]:
    """Yaw of a wall's direction, and its start."""
    a, b = scene.floor[number], scene.floor[(number + 1) % len(scene.floor)]
    return math.degrees(math.atan2(b[1] - a[1], b[0] - a[0])), a


def _skirting(scene: Scene, number: int, start: float, end: float) -> list[Any]:
    if end - start < 0.05:
        return []
    yaw, at = _frame_of(scene, number)
    deep, high = _SKIRTING
    return [add_box("skirting", (start, 0, 0), (end, deep, high), scene.look.skirting, yaw, (*at, 0))]


def _threshold(scene: Scene, hole: Opening) -> Any:
    yaw, at = _frame_of(scene, hole.wall)
    low, high = (hole.start, -scene.thickness, -0.02), (hole.end, 0.0, -0.001)
    return add_box("threshold", low, high, "wood:#6e5137:#8f6c4c", yaw, (*at, 0))


def _door(scene: Scene, door: Opening) -> list[Any]:
    """Architrave, leaf (standing open into the room) and handles; an "opening" has no leaf."""
    yaw, at = _frame_of(scene, door.wall)
    look, bar = scene.look, 0.06
    made = []
    for a, b in ((door.start - bar, door.start), (door.end, door.end + bar)):
        made.append(add_box("frame", (a, 0, 0), (b, 0.016, door.height + bar), look.frame, yaw, (*at, 0)))
    top = (door.start, 0, door.height), (door.end, 0.016, door.height + bar)
    made.append(add_box("frame", *top, look.frame, yaw, (*at, 0)))
    wide, first = door.end - door.start - 0.01, door.hinge == "start"
    hinge = scene.along(door.wall, door.start + 0.005 if first else door.end - 0.005)
    turned = yaw + door.degrees if first else yaw + 180 - door.degrees
    side = -1 if first else 1
    low, high = sorted((0.0, 0.04 * side))
    made.append(add_box("leaf", (0, low, 0.01), (wide, high, door.height - 0.01), look.door, turned, (*hinge, 0)))
    for y in (low - 0.05, high):
        grip = (wide - 0.19, y + 0.015, 1.0), (wide - 0.06, y + 0.035, 1.02)
        made.append(add_box("handle", *grip, "metal:#9a9a98:0.3", turned, (*hinge, 0)))
        knob = (wide - 0.075, y, 0.995), (wide - 0.055, y + 0.05, 1.025)
        made.append(add_box("handle", *knob, "metal:#9a9a98:0.3", turned, (*hinge, 0)))
    return made


def _window(scene: Scene, window: Opening) -> list[Any]:
    """Casements in the outer half of the wall, a sill board and a pane."""
    yaw, at = _frame_of(scene, window.wall)
    look, bar = scene.look, 0.055
    y0 = -scene.thickness + 0.01
    z0, z1 = window.sill, window.sill + window.height
    count = max(1, round((window.end - window.start) / 0.75))
    edges = np.linspace(window.start, window.end, count + 1).tolist()
    boxes = [((window.start - 0.04, -scene.thickness + 0.01, z0 - 0.03), (window.end + 0.04, 0.05, z0 + 0.002))]
    for a, b in zip(edges, edges[1:], strict=False):
        for left, right in ((a, a + bar), (b - bar, b)):
            boxes.append(((left, y0, z0), (right, y0 + _DEPTH_OF_FRAME, z1)))
        for low, high in ((z0, z0 + bar), (z1 - bar, z1)):
            boxes.append(((a, y0, low), (b, y0 + _DEPTH_OF_FRAME, high)))
    made = [add_box("window", low, high, look.frame, yaw, (*at, 0)) for low, high in boxes]
    middle = y0 + _DEPTH_OF_FRAME / 2
    pane = (window.start, middle - 0.002, z0), (window.end, middle + 0.002, z1)
    return [*made, add_box("pane", *pane, "pane", yaw, (*at, 0))]
