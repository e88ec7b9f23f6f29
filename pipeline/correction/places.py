# SPDX-License-Identifier: GPL-3.0-or-later
"""The nearest places where an object can be: inside, off its neighbours, out of doors' ways, on what carries it.

Each is tried in the order of its distance from where the object is, so the first one that fits is the least move: on the
floor over a local grid and the places where it would just touch; on a carrier over the cells of its surfaces.
"""

from __future__ import annotations

import functools
import math
from collections.abc import Iterator

import numpy as np

from ..artifacts.common import Metres3
from ..geometry.placement import Rect, is_inside, penetration, push_inside, support
from ..geometry.polygon import ensure_ccw
from ..light.space import inside
from ..surfaces.find import Surface, support_surfaces
from ..surfaces.seat import find_seat, occupied
from .bodies import Body, Room
from .faults import Knowledge
from .held import settled, wall_places
from .meeting import DEEP, IN_THE_WAY, clear_areas, in_the_way, shared_part

STEP, REACH = 0.05, 1.5
"""Spacing and extent of the grid of places on the floor, metres."""
BY_MESH = 0.15
"""Metres that a thing may go where only the meshes, not the outlines, are off each other."""
_GRACE = 1e-3  # metres kept to what is only touched
MOST = 4
"""Places that are offered, at most."""


def places_for(room: Room, body: Body, knowledge: Knowledge) -> Iterator[Metres3]:
    """Centres of an object's box where it can be, nearest first, at most `MOST`."""
    placement = body.line.placement
    if placement == "surface":
        yield from _seats(room, body, knowledge)
    elif placement == "wall":
        yield from _on_walls(room, body, knowledge)
    else:
        yield from _on_floor(room, body, knowledge)


def _on_floor(room: Room, body: Body, knowledge: Knowledge) -> Iterator[Metres3]:
    x, y, z = body.line.centre
    others = [o for o in _others(room, body) if min(body.high, o.high) - max(body.low, o.low) > DEEP]
    # Far off, outlines decide, as they are quick; meshes only of what stands in a notch already, as a chair under a table.
    tucked = [o for o in others if _meets(body, o) and not shared_part(body, o, knowledge)]
    bars = [(o.rect, DEEP) for o in others if o not in tucked]
    bars += [(area.rect, IN_THE_WAY) for area in clear_areas(room, knowledge) if body.line.placement == "floor"
             and not body.flat and body.high > area.above]  # fmt: skip
    shifts = _shifts(room, body, knowledge)
    near = [shift for shift in shifts if math.hypot(*shift) <= BY_MESH]
    given = 0
    for dx, dy in _maybe_inside(body.rect, [*near, *_clear(body.rect, shifts[len(near) :], bars)], room):
        if not is_inside(body.rect.moved(dx, dy), room.layout.room.floor):
            continue
        there = body.moved((x + dx, y + dy, z))
        close = math.hypot(dx, dy) <= BY_MESH
        if is_free(room, there, knowledge) if close else not any(shared_part(there, o, knowledge) for o in tucked):
            yield settled(room, there, knowledge)
            given += 1
            if given >= MOST:
                return


def _clear(rect: Rect, shifts: list[tuple[float, float]], bars: list[tuple[Rect, float]]) -> list[tuple[float, float]]:
    """The moves after which a rectangle reaches into none of the bars deeper than it may; separating axes, all at once."""
    moves = np.array(shifts).reshape(-1, 2)
    good = np.ones(len(moves), dtype=bool)
    for bar, most in bars:
        deepest = np.full(len(moves), np.inf)
        for yaw in (rect.yaw, rect.yaw + 90.0, bar.yaw, bar.yaw + 90.0):
            axis = math.cos(math.radians(yaw)), math.sin(math.radians(yaw))
            apart = np.abs((moves + (rect.x - bar.x, rect.y - bar.y)) @ np.array(axis))
            deepest = np.minimum(deepest, support(rect, axis) + support(bar, axis) - apart)
        good &= deepest <= most
    return [shift for shift, fits in zip(shifts, good, strict=True) if fits]


def _maybe_inside(rect: Rect, shifts: list[tuple[float, float]], room: Room) -> list[tuple[float, float]]:
    """The moves without those after which a corner is clearly outside of the room, all at once."""
    slim = rect._replace(width=max(0.0, rect.width - 2 * _GRACE), depth=max(0.0, rect.depth - 2 * _GRACE))
    moves, outline = np.array(shifts).reshape(-1, 2), np.array(ensure_ccw(room.layout.room.floor))
    good = np.ones(len(moves), dtype=bool)
    for corner in slim.corners():
        good &= inside(outline, moves + corner)
    return [shift for shift, fits in zip(shifts, good, strict=True) if fits]


def is_free(room: Room, body: Body, knowledge: Knowledge) -> bool:
    """Whether a body, where it is, is off all others and out of doors' ways."""
    if any(in_the_way(body, area) for area in clear_areas(room, knowledge)):
        return False
    return not any(shared_part(body, other, knowledge) for other in _others(room, body))


def _others(room: Room, body: Body) -> list[Body]:
    """What a body must be off."""
    if body.flat or body.cloth:
        return []
    family = {body.id, *room.below(body.id), *room.above(body.id)}
    others = [o for o in room.bodies.values() if o.id not in family and not o.flat and not o.cloth]
    return [*others, *room.partitions]


def _meets(body: Body, other: Body) -> bool:
    """Whether the boxes of two bodies run into each other by more than they may."""
    if min(body.high, other.high) - max(body.low, other.low) <= DEEP:
        return False
    deep = penetration(body.rect, other.rect)
    return deep is not None and deep[0] > DEEP


def _shifts(room: Room, body: Body, knowledge: Knowledge) -> list[tuple[float, float]]:
    """Moves on the floor, shortest first: onto the grid, just inside, just off what it runs into now."""
    found = list(_grid())
    floor = room.layout.room.floor
    into = push_inside(body.rect, floor).shift
    start = body.rect.moved(*into)
    found += [into, *(_beyond(into, d) for d in _ways_off(room, body, start, knowledge))]
    for dx, dy in _ways_off(room, body, body.rect, knowledge):
        inside = push_inside(body.rect.moved(dx, dy), floor).shift
        found += [(dx, dy), (dx + inside[0], dy + inside[1])]
    if math.hypot(*into) > REACH:
        found += [(into[0] + dx, into[1] + dy) for dx, dy in found if math.hypot(dx, dy) <= 1.0]
    moves = np.array(found)
    lengths = np.hypot(moves[:, 0], moves[:, 1])
    order = np.lexsort((moves[:, 1], moves[:, 0], np.round(lengths, 4)))
    return [(float(x), float(y)) for x, y in moves[order[lengths[order] > 1e-4]]]


@functools.lru_cache(maxsize=1)
def _grid() -> list[tuple[float, float]]:
    """Moves onto the places of the grid."""
    count = int(REACH / STEP)
    grid = np.stack(np.meshgrid(*[np.arange(-count, count + 1) * STEP] * 2), axis=-1).reshape(-1, 2)
    return [(float(x), float(y)) for x, y in grid if 0.0 < math.hypot(x, y) <= REACH]


def _beyond(shift: tuple[float, float], more: tuple[float, float]) -> tuple[float, float]:
    return shift[0] + more[0], shift[1] + more[1]


def _ways_off(room: Room, body: Body, rect: Rect, knowledge: Knowledge) -> list[tuple[float, float]]:
    """Moves that take a rectangle just off each thing that it runs into, along that thing's sides."""
    others = [o.rect for o in [*room.bodies.values(), *room.partitions] if o.id != body.id and not o.flat]
    others += [area.rect for area in clear_areas(room, knowledge)]
    found = []
    for other in others:
        if penetration(rect, other) is None:
            continue
        angle = math.radians(other.yaw)
        for turn in range(4):
            way = math.cos(angle + turn * math.pi / 2), math.sin(angle + turn * math.pi / 2)
            reach = support(rect, way) + support(other, way) + _GRACE
            apart = (rect.x - other.x) * way[0] + (rect.y - other.y) * way[1]
            found.append((way[0] * (reach - apart), way[1] * (reach - apart)))
    return found


def _on_walls(room: Room, body: Body, knowledge: Knowledge) -> Iterator[Metres3]:
    """Along the walls, nearest first."""
    given = 0
    for centre in wall_places(room, body):
        there = body.moved(centre)
        if is_free(room, there, knowledge):
            yield centre
            given += 1
            if given >= MOST:
                return


def _seats(room: Room, body: Body, knowledge: Knowledge) -> Iterator[Metres3]:
    """Free places on its carrier's surfaces: those at its own height first, then the nearest."""
    parent = room.bodies.get(body.line.parent or "")
    if parent is None:
        yield from _on_floor(room, body, knowledge)
        return
    surfaces: list[Surface] = knowledge.remember(("surfaces", parent.id), lambda: support_surfaces(parent.own))
    angle = math.radians(-parent.line.yaw)
    cos, sin = math.cos(angle), math.sin(angle)

    def local(x: float, y: float) -> tuple[float, float]:
        dx, dy = x - parent.base[0], y - parent.base[1]
        return dx * cos - dy * sin, dx * sin + dy * cos

    size = (body.rect.width, body.rect.depth, body.high - body.low)
    turn = body.line.yaw - parent.line.yaw
    offset = body.rect.x - body.line.centre[0], body.rect.y - body.line.centre[1]
    beside = [o for o in room.bodies.values() if o.line.parent == parent.id and o.id != body.id and not o.cloth]
    for surface in sorted(surfaces, key=lambda s: abs(s.level + parent.base[2] - body.low)):
        level = surface.level + parent.base[2]
        for other in beside:
            if other.low < level + size[2] and other.high > level + _GRACE:
                at = local(other.rect.x, other.rect.y)
                reach = other.rect.width, other.rect.depth
                surface = surface.taken(occupied(surface.grid, *at, *reach, other.line.yaw - parent.line.yaw))
        seat = find_seat(surface, local(body.rect.x, body.rect.y), size, turn)
        if seat is None or seat.scale != 1.0:
            continue
        x = parent.base[0] + seat.x * cos + seat.y * sin - offset[0]
        y = parent.base[1] - seat.x * sin + seat.y * cos - offset[1]
        z = parent.base[2] + seat.z - float(body.bounds[0][2]) + body.line.size[2] / 2
        yield settled(room, body.moved((x, y, z)), knowledge)
