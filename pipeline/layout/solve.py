# SPDX-License-Identifier: GPL-3.0-or-later
"""A small deterministic solver: flush to walls, inside the room, off one another, by the least that does it.

Locked proxies never move. What moved by more than a centimetre or two is reported.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

from ..artifacts.analysis import Finding
from ..artifacts.common import Metres2
from ..artifacts.layout import Layout, ProxyLine, WallLine
from ..geometry.placement import Rect, push_inside, separate, snap_to_wall
from ..geometry.polygon import overlap_fraction
from .placed import FLAT, may_share
from .trim import trim

SNAP = 0.07
"""A floor proxy nearer to a wall than this (or as deep in it) stands flush at it, metres."""
MAX_MOVE = 0.8
MINOR_MOVE = 0.5
"""Farthest that a major and a minor thing are moved, metres."""
REPORT = 0.03
FURNITURE_OVERLAP = 0.02


def solve(
    layout: Layout, tucked: frozenset[frozenset[str]], locked: frozenset[str], confidence: Mapping[str, float]
) -> tuple[Layout, list[Finding]]:
    """The layout with its floor proxies flush, inside and apart.

    Args:
        tucked: pairs that may overlap; confidence: 0..1 by id, the surer hold their place more.
    """
    proxies = list(layout.proxies)
    index = [i for i, p in enumerate(proxies) if p.placement == "floor"]
    rects = [_rect(proxies[i]) for i in index]
    fixed = {k for k, i in enumerate(index) if proxies[i].id in locked}
    for k, i in enumerate(index):
        if k not in fixed:
            rects[k] = _settled(rects[k], proxies[i], layout)
    allowed = [
        (a, b)
        for a in range(len(index))
        for b in range(a + 1, len(index))
        if may_share(proxies[index[a]], proxies[index[b]], tucked)
    ]
    rects = trim(rects, fixed, allowed)
    weights = [
        confidence.get(proxies[i].id, 0.5) * max(0.05, r.width * r.depth) for i, r in zip(index, rects, strict=True)
    ]
    partitions = [_body(w) for w in layout.walls if w.partition]
    walls = range(len(rects), len(rects) + len(partitions))
    allowed += [(a, b) for a in walls for b in walls if a < b]
    allowed += [(k, b) for k, i in enumerate(index) for b in walls if proxies[i].size[2] < FLAT]
    still = fixed | set(walls)
    moves = separate(
        [*rects, *partitions], [*weights, *(1.0 for _ in walls)], still, layout.room.floor, allowed, MAX_MOVE
    )
    findings: list[Finding] = []
    for k, i in enumerate(index):
        if k in fixed:
            continue
        rect = rects[k].moved(*moves[k])
        moved = math.dist((rect.x, rect.y), proxies[i].centre[:2])
        if moved > REPORT:
            findings.append(Finding(about=proxies[i].id, message=f"The solver moved it by {100 * moved:.0f} cm."))
        proxies[i] = _at(proxies[i], rect)
    return layout.model_copy(update={"proxies": proxies}), findings


def settle_minor(proxy: ProxyLine, layout: Layout, locked: frozenset[str]) -> ProxyLine:
    """A minor floor proxy flush, inside, and off the majors, which do not move."""
    if proxy.id in locked:
        return proxy
    rect = _settled(_rect(proxy), proxy, layout)
    near = [p for p in layout.proxies if p.placement == "floor" and not may_share(p, proxy, frozenset())]
    # What it cannot reach need not be looked at; a room may hold hundreds of things.
    reach = math.hypot(rect.width, rect.depth) / 2 + MINOR_MOVE + 0.01
    others = [
        r for p in near if math.dist((r := _rect(p))[:2], (rect.x, rect.y)) < reach + math.hypot(r.width, r.depth) / 2
    ]
    if any(overlap_fraction(rect.corners(), o.corners()) > FURNITURE_OVERLAP for o in others):
        rects = [rect, *others]
        fixed = set(range(1, len(rects)))
        among_majors = [(a, b) for a in fixed for b in fixed if a < b]
        moves = separate(rects, None, fixed, layout.room.floor, among_majors, MINOR_MOVE)
        rect = rect.moved(*moves[0])
    return _at(proxy, rect)


def _settled(rect: Rect, proxy: ProxyLine, layout: Layout) -> Rect:
    """Flush to the walls that it nearly touches, then inside the room."""
    if proxy.size[2] >= FLAT:
        for face in _faces(layout.walls, proxy.centre[:2]):
            snapped = snap_to_wall(rect, face, SNAP, max_turn=0.0)
            if snapped is not None:
                rect = snapped
    return push_inside(rect, layout.room.floor).rect


def _faces(walls: Sequence[WallLine], seen_from: Metres2) -> list[tuple[Metres2, Metres2]]:
    """Wall faces towards a point, the room to their left."""
    faces = []
    for wall in walls:
        if not wall.partition:
            faces.append((wall.start, wall.end))
            continue
        length = max(1e-9, math.dist(wall.start, wall.end))
        nx, ny = -(wall.end[1] - wall.start[1]) / length, (wall.end[0] - wall.start[0]) / length
        side = (seen_from[0] - wall.start[0]) * nx + (seen_from[1] - wall.start[1]) * ny
        sign = 1.0 if side >= 0 else -1.0
        off = (nx * sign * wall.thickness / 2, ny * sign * wall.thickness / 2)
        a = (wall.start[0] + off[0], wall.start[1] + off[1])
        b = (wall.end[0] + off[0], wall.end[1] + off[1])
        faces.append((a, b) if sign > 0 else (b, a))
    return faces


def _body(wall: WallLine) -> Rect:
    """A partition seen from above."""
    (ax, ay), (bx, by) = wall.start, wall.end
    return Rect(
        (ax + bx) / 2,
        (ay + by) / 2,
        math.dist(wall.start, wall.end),
        wall.thickness,
        math.degrees(math.atan2(by - ay, bx - ax)),
    )


def _rect(proxy: ProxyLine) -> Rect:
    return Rect(proxy.centre[0], proxy.centre[1], proxy.size[0], proxy.size[1], proxy.yaw)


def _at(proxy: ProxyLine, rect: Rect) -> ProxyLine:
    centre = (rect.x, rect.y, proxy.centre[2])
    size = (rect.width, rect.depth, proxy.size[2])
    return proxy.model_copy(update={"centre": centre, "size": size, "yaw": rect.yaw % 360.0})
