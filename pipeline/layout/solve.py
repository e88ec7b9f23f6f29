# SPDX-License-Identifier: GPL-3.0-or-later
"""A small deterministic solver: flush to walls, inside the room, off one another, by the least that does it.

Locked proxies never move. What moved by more than a centimetre or two is reported with the reason.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from ..artifacts.analysis import Finding
from ..artifacts.common import Metres2
from ..artifacts.layout import Layout, ProxyLine, WallLine
from ..geometry.apart import Body, least_moves
from ..geometry.placement import Rect, gap_between, is_inside, penetration, push_inside, separate, snap_to_wall
from ..geometry.polygon import overlap_fraction
from .faces import face_gap, face_inward, is_parallel, partition_body, wall_faces
from .keep_clear import Clear, door_areas
from .lshape import parts_of
from .placed import may_share
from .standing import FLAT
from .trim import trim

SNAP = 0.035
"""A floor proxy nearer to a wall than this (or as deep in it) stands flush at it, metres, when nothing else is known."""
LEAST_SNAP, MOST_SNAP = 0.01, 0.08
LEAN_SNAP = 0.2
"""The same for a thing of which it is said that it stands against that wall."""
LEAN_SPREADS = 3.0
"""What stands against a wall may stand a hand's breadth off it; beyond so many of its place's errors it does."""
TURN = 6.0
"""Most degrees by which something is turned to stand flush."""
MAX_MOVE = 0.8
MINOR_MOVE = 0.5
"""Farthest that a major and a minor thing are moved, metres."""
DOOR_MOVE = 0.06
"""What stands deeper than this where a door swings was seen there, metres: it stays and is reported."""
FOLLOW = 0.08
"""What is moved further than this, metres, takes along what keeps its place beside it."""
CORNER = 0.04
"""Part of its sides by which a thing that stands askew may reach into a wall: no armchair fills its box's corners."""
SHRINK = 0.06
"""Part by which such a thing is made smaller before it is moved away from a wall: its middle is known better."""
REPORT = 0.03
FURNITURE_OVERLAP = 0.02
PASSES = 20


@dataclass(frozen=True)
class Ties:
    """What the solver may know beside the boxes.

    Attributes:
        spread: uncertainty of a thing's place in metres, by id; the surer, the less it is drawn to a wall.
        leaning: (id, wall id) of things that are said to stand against that wall.
        companions: what keeps its place relative to what, by id (a chair to its table).
        swings: for doors, "in" where the leaf comes into the room.
    """

    spread: Mapping[str, float] = field(default_factory=dict)
    leaning: frozenset[tuple[str, str]] = frozenset()
    companions: Mapping[str, str] = field(default_factory=dict)
    swings: Mapping[str, str] = field(default_factory=dict)


NO_TIES = Ties()


@dataclass
class _Room:
    """The floor proxies of a layout while they are being settled; indices are those of `proxies`."""

    layout: Layout
    proxies: list[ProxyLine]
    rects: list[Rect]
    fixed: set[int]
    allowed: list[tuple[int, int]]
    weights: list[float]
    ties: Ties
    held: dict[int, tuple[Metres2, ...]] = field(default_factory=dict)


def solve(
    layout: Layout,
    tucked: frozenset[frozenset[str]],
    locked: frozenset[str],
    confidence: Mapping[str, float],
    ties: Ties = NO_TIES,
) -> tuple[Layout, list[Finding]]:
    """The layout with its floor proxies flush, inside and apart.

    Args:
        tucked: pairs that may overlap; confidence: 0..1 by id, the surer hold their place more.
    """
    before = layout
    for _ in range(PASSES):
        settled = _pass(layout, tucked, locked, confidence, ties)
        if settled == layout:
            break
        layout = settled
    return layout, _report(before, layout, ties)


def _pass(
    layout: Layout,
    tucked: frozenset[frozenset[str]],
    locked: frozenset[str],
    confidence: Mapping[str, float],
    ties: Ties,
) -> Layout:
    """Flush, trimmed, apart; and companions brought after what they belong to."""
    index = [i for i, p in enumerate(layout.proxies) if p.placement == "floor"]
    proxies = [layout.proxies[i] for i in index]
    fixed = {k for k, p in enumerate(proxies) if p.id in locked}
    allowed = [
        (a, b)
        for a in range(len(proxies))
        for b in range(a + 1, len(proxies))
        if may_share(proxies[a], proxies[b], tucked)
    ]
    rects = [_rect(p) for p in proxies]
    weights = [_weight(p, confidence.get(p.id, 0.5)) for p in proxies]
    room = _Room(layout, proxies, list(rects), fixed, allowed, weights, ties)
    for k, proxy in enumerate(proxies):
        if k not in fixed:
            room.rects[k], room.held[k] = _settled(rects[k], proxy, layout, ties)
    _follow(room, [(0.0, 0.0)] * len(proxies))
    # Only boxes are trimmed: what is an L gives way as a whole.
    whole = {k for k, p in enumerate(proxies) if p.shape == "l_shape"}
    room.rects = trim(room.rects, fixed | whole, [*allowed, *_notched(room)])
    moves = _apart(room)
    if _follow(room, moves):
        moves = _apart(room)
    result = list(layout.proxies)
    for k, i in enumerate(index):
        if k not in fixed:
            now = room.rects[k].moved(*moves[k])
            if now != rects[k]:
                result[i] = _at(proxies[k], now)
    return layout.model_copy(update={"proxies": result})


def _weight(proxy: ProxyLine, confidence: float) -> float:
    """How strongly a thing holds its place: surer and larger ones more, as a small thing is easily a little elsewhere."""
    return max(0.05, confidence) * max(0.05, proxy.size[0] * proxy.size[1])


def _apart(room: _Room) -> list[Metres2]:
    """Moves that take everything apart and inside: with walls kept and doors free, else without, else as far as it goes."""
    partitions = [partition_body(w) for w in room.layout.walls if w.partition]
    clear = door_areas(room.layout, room.ties.swings)
    floor = room.layout.room.floor
    for held, doors in ((True, True), (False, True), (False, False)):
        bodies = [_as_body(room, k, held) for k in range(len(room.rects))]
        bodies += [Body(rect, weight=math.inf) for rect in partitions]
        allowed = [*room.allowed, *_over_partitions(room, len(room.rects), len(partitions))]
        if doors:
            bodies += [Body(c.rect, weight=math.inf) for c in clear]
            allowed += _let_be(room, clear, len(room.rects) + len(partitions))
        found = least_moves(bodies, floor, allowed)
        if found.feasible and max((math.hypot(*m) for m in found.moves), default=0.0) <= MAX_MOVE:
            return found.moves[: len(room.rects)]
    obstacles = [*room.rects, *partitions]
    still = room.fixed | set(range(len(room.rects), len(obstacles)))
    allowed = [*room.allowed, *_notched(room), *_over_partitions(room, len(room.rects), len(partitions))]
    weights = [*room.weights, *(1.0 for _ in partitions)]
    return separate(obstacles, weights, still, floor, allowed, MAX_MOVE)[: len(room.rects)]


def _as_body(room: _Room, k: int, held: bool) -> Body:
    rect, proxy = room.rects[k], room.proxies[k]
    if k in room.fixed:
        return Body(rect, parts_of(rect, proxy.shape, _others(room, k)), math.inf)
    parts = parts_of(rect, proxy.shape, _others(room, k))
    bound = _bound(rect, room.layout.walls)
    if bound != rect and not parts:
        parts = (rect,)
    return Body(bound, parts, room.weights[k], room.held.get(k, ()) if held else ())


def _others(room: _Room, k: int) -> list[Rect]:
    """What an L at this index must not cover; empty for other shapes, which need not know."""
    if room.proxies[k].shape != "l_shape":
        return []
    free = {frozenset(pair) for pair in room.allowed}
    return [r for n, r in enumerate(room.rects) if n != k and frozenset((k, n)) not in free]


def _notched(room: _Room) -> list[tuple[int, int]]:
    """Pairs of which one lies wholly in the other's missing corner."""
    pairs = []
    for k, proxy in enumerate(room.proxies):
        if proxy.shape != "l_shape":
            continue
        parts = parts_of(room.rects[k], proxy.shape, _others(room, k))
        for n, rect in enumerate(room.rects):
            if n != k and not any(penetration(part, rect) for part in parts):
                pairs.append((min(k, n), max(k, n)))
    return pairs


def _over_partitions(room: _Room, first: int, count: int) -> list[tuple[int, int]]:
    """Partitions do not get into each other's way, nor into that of rugs."""
    walls = range(first, first + count)
    pairs = [(a, b) for a in walls for b in walls if a < b]
    return pairs + [(k, b) for k, p in enumerate(room.proxies) for b in walls if p.size[2] < FLAT]


def _let_be(room: _Room, clear: Sequence[Clear], first: int) -> list[tuple[int, int]]:
    """Pairs of things and door areas that are not to be taken apart, and of door areas with anything that never moves."""
    pairs = [(first + n, other) for n in range(len(clear)) for other in range(len(room.rects), first + len(clear))]
    for n, area in enumerate(clear):
        for k, proxy in enumerate(room.proxies):
            deep = penetration(room.rects[k], area.rect)
            low = proxy.centre[2] + proxy.size[2] / 2 <= area.above
            if low or k in room.fixed or (deep is not None and deep[0] > DOOR_MOVE):
                pairs.append((k, first + n))
    return pairs


def _follow(room: _Room, moves: Sequence[Metres2]) -> bool:
    """Bring companions after what they belong to, by what that moves in all, also to a wall; whether any went."""
    index = {p.id: k for k, p in enumerate(room.proxies)}
    went = False
    for child, parent in room.ties.companions.items():
        k, n = index.get(child), index.get(parent)
        if k is None or n is None or k in room.fixed:
            continue
        start, now = room.proxies[n].centre, room.rects[n].moved(*moves[n])
        dx, dy = now.x - start[0], now.y - start[1]
        if math.hypot(dx, dy) > FOLLOW:
            own = room.rects[k].x - room.proxies[k].centre[0], room.rects[k].y - room.proxies[k].centre[1]
            room.rects[k] = room.rects[k].moved(dx - own[0], dy - own[1])
            went = went or math.hypot(dx - own[0], dy - own[1]) > 1e-6
    return went


def _report(before: Layout, after: Layout, ties: Ties) -> list[Finding]:
    """What moved, was turned or trimmed by how much, and what is left that could not be mended."""
    findings: list[Finding] = []
    for old, new in zip(before.proxies, after.proxies, strict=True):
        if new is old:
            continue
        moved = math.dist(old.centre[:2], new.centre[:2])
        cut = max(old.size[0] - new.size[0], old.size[1] - new.size[1])
        said = []
        if moved > REPORT:
            said.append(f"moved it by {100 * moved:.0f} cm {_towards(old, new)}")
        if cut > REPORT:
            said.append(f"made it {100 * cut:.0f} cm smaller where it ran into its neighbour")
        if said:
            findings.append(Finding(about=new.id, message=f"The solver {' and '.join(said)}."))
    for clear in door_areas(after, ties.swings):
        for proxy in after.proxies:
            deep = penetration(_rect(proxy), clear.rect) if proxy.placement == "floor" else None
            if deep is not None and deep[0] > DOOR_MOVE and proxy.centre[2] + proxy.size[2] / 2 > clear.above:
                message = f"It stands where {clear.id} opens; it was seen there and stays."
                findings.append(Finding(about=proxy.id, message=message))
    return findings


def _towards(old: ProxyLine, new: ProxyLine) -> str:
    dx, dy = new.centre[0] - old.centre[0], new.centre[1] - old.centre[1]
    across, along = "right" if dx > 0 else "left", "up" if dy > 0 else "down"
    if abs(dx) > 2 * abs(dy):
        return across
    return along if abs(dy) > 2 * abs(dx) else f"{along} and {across}"


def settle_minor(proxy: ProxyLine, layout: Layout, locked: frozenset[str]) -> ProxyLine:
    """A minor floor proxy flush, inside, and off the majors, which do not move."""
    if proxy.id in locked:
        return proxy
    rect = _settled(_rect(proxy), proxy, layout, NO_TIES)[0]
    near = [p for p in layout.proxies if p.placement == "floor" and not may_share(p, proxy, frozenset())]
    # What it cannot reach need not be looked at; a room may hold hundreds of things.
    reach = math.hypot(rect.width, rect.depth) / 2 + MINOR_MOVE + 0.01
    others = [
        part
        for p in near
        if math.dist((r := _rect(p))[:2], (rect.x, rect.y)) < reach + math.hypot(r.width, r.depth) / 2
        for part in parts_of(r, p.shape, [rect]) or (r,)
    ]
    partitions = [partition_body(w) for w in layout.walls if w.partition] if proxy.size[2] >= FLAT else []
    others += [p for p in partitions if gap_between(p, rect) < MINOR_MOVE]
    if any(overlap_fraction(rect.corners(), o.corners()) > FURNITURE_OVERLAP for o in others):
        rects = [rect, *others]
        fixed = set(range(1, len(rects)))
        among_majors = [(a, b) for a in fixed for b in fixed if a < b]
        moves = separate(rects, None, fixed, layout.room.floor, among_majors, MINOR_MOVE)
        rect = rect.moved(*moves[0])
    return _at(proxy, rect)


def _settled(rect: Rect, proxy: ProxyLine, layout: Layout, ties: Ties) -> tuple[Rect, tuple[Metres2, ...]]:
    """Flush to the walls that it nearly touches, then inside the room; and the directions in which it is flush now."""
    held: list[Metres2] = []
    if proxy.size[2] >= FLAT:
        faces = sorted(wall_faces(layout.walls, proxy.centre[:2]), key=lambda f: abs(face_gap(rect, f[1])))
        for name, face in faces:
            inward = face_inward(face)
            if any(abs(inward[0] * x + inward[1] * y) > 0.7 for x, y in held):
                # It stands at the opposite wall already; being drawn here would only tear it off there.
                continue
            reach = _snap_distance(proxy.id, name, ties)
            snapped = snap_to_wall(rect, face, reach, max_turn=TURN)
            if snapped is None or (snapped.yaw == rect.yaw and not is_parallel(rect, face)):
                continue
            if math.dist(snapped[:2], rect[:2]) > 1e-6 or snapped.yaw != rect.yaw:
                rect = snapped
            held.append(inward)
    if not held:
        rect = _smaller(rect, layout)
    bound = _bound(rect, layout.walls)
    if is_inside(bound, layout.room.floor):
        return rect, tuple(held)
    return rect.moved(*push_inside(bound, layout.room.floor).shift), tuple(held)


def _bound(rect: Rect, walls: Sequence[WallLine]) -> Rect:
    """What of a footprint must be inside the room: of a thing that stands askew to all walls, all but its corners."""
    if any(is_parallel(rect, (wall.start, wall.end)) for wall in walls):
        return rect
    return rect._replace(width=rect.width * (1 - CORNER), depth=rect.depth * (1 - CORNER))


def _smaller(rect: Rect, layout: Layout) -> Rect:
    """A thing that stands askew made a little smaller where its corners reach too far into a wall."""
    if is_inside(_bound(rect, layout.walls), layout.room.floor) or _bound(rect, layout.walls) == rect:
        return rect
    for part in (SHRINK / 3, SHRINK * 2 / 3, SHRINK):
        less = rect._replace(width=rect.width * (1 - part), depth=rect.depth * (1 - part))
        if is_inside(_bound(less, layout.walls), layout.room.floor):
            break
    return less


def _snap_distance(identifier: str, wall: str, ties: Ties) -> float:
    spread = ties.spread.get(identifier)
    usual = SNAP if spread is None else max(LEAST_SNAP, min(MOST_SNAP, spread))
    if (identifier, wall) not in ties.leaning:
        return usual
    return max(usual, LEAN_SNAP if spread is None else min(LEAN_SNAP, LEAN_SPREADS * spread))


def _rect(proxy: ProxyLine) -> Rect:
    return Rect(proxy.centre[0], proxy.centre[1], proxy.size[0], proxy.size[1], proxy.yaw)


def _at(proxy: ProxyLine, rect: Rect) -> ProxyLine:
    centre = (rect.x, rect.y, proxy.centre[2])
    size = (rect.width, rect.depth, proxy.size[2])
    return proxy.model_copy(update={"centre": centre, "size": size, "yaw": rect.yaw % 360.0})
