# SPDX-License-Identifier: GPL-3.0-or-later
"""What a thing's own mesh is like, and whether it runs through others: its box, its loose parts, its neighbours."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from code_as_room.pipeline.program.prelude.skirting import SKIRTING
from mathutils import Vector
from mathutils.bvhtree import BVHTree

from .bodies import Body, BuiltRoom, Floats, Ints, is_inside

TOUCH = 0.004
"""Metres between parts that still count as touching."""
DEEP = 0.005
_MOST_POINTS = 400


@dataclass(frozen=True)
class Filling:
    """How a thing fits its proxy: share of the box's length that it reaches on its worst axis, metres that it sticks out."""

    share: float
    beyond: float


def filling_of(body: Body) -> Filling | None:
    """How a thing fits the box that it was made for; None without a box."""
    if len(body.box) < 7:
        return None
    x, y, z, *size = body.box[:6]
    angle = np.radians(body.box[6])
    turned = (body.points - (x, y, z)) @ np.array(
        [[np.cos(angle), -np.sin(angle), 0], [np.sin(angle), np.cos(angle), 0], [0, 0, 1]]
    )
    half = np.array(size) / 2
    low, high = turned.min(axis=0), turned.max(axis=0)
    inside = np.minimum(high, half) - np.maximum(low, -half)
    beyond = float(np.maximum(-half - low, high - half).max())
    return Filling(float((inside / (2 * half)).min()), max(0.0, beyond))


def islands(body: Body) -> list[Ints]:
    """Indices of the triangles of each connected piece of a mesh; vertices at one place are one."""
    _, same = np.unique(np.round(body.points, 5), axis=0, return_inverse=True)
    corners = same.reshape(-1)[body.triangles]
    label = np.arange(int(corners.max()) + 1)
    while True:
        lowest = label[corners].min(axis=1)
        before = label.copy()
        for k in range(3):
            np.minimum.at(label, corners[:, k], lowest)
        label = label[label]
        if (label == before).all():
            break
    owner = label[corners[:, 0]]
    order = np.argsort(owner, kind="stable")
    return np.split(order, np.flatnonzero(np.diff(owner[order])) + 1)


def loose_parts(body: Body) -> tuple[int, int]:
    """How many connected pieces of a thing touch neither the rest of it nor what holds it, and how many pieces it has."""
    pieces = [_Piece(body, triangles) for triangles in islands(body)]
    group = list(range(len(pieces)))

    def root(i: int) -> int:
        while group[i] != i:
            group[i] = group[group[i]]
            i = group[i]
        return i

    lows, highs = np.array([p.low for p in pieces]), np.array([p.high for p in pieces])
    for i, piece in enumerate(pieces):
        near = (lows <= piece.high + TOUCH).all(axis=1) & (highs >= piece.low - TOUCH).all(axis=1)
        for j in np.flatnonzero(near):
            if j > i and root(i) != root(int(j)) and piece.touches(pieces[j]):
                group[root(int(j))] = root(i)
    held = {root(i) for i, piece in enumerate(pieces) if piece.is_held}
    if not held:
        sizes = {r: sum(root(i) == r for i in range(len(pieces))) for r in set(map(root, range(len(pieces))))}
        held = {max(sizes, key=lambda r: sizes[r])}
    return sum(root(i) not in held for i in range(len(pieces))), len(pieces)


class _Piece:
    """One connected piece of a thing's mesh."""

    def __init__(self, body: Body, triangles: Ints) -> None:
        used, corners = np.unique(body.triangles[triangles], return_inverse=True)
        self.points: Floats = body.points[used]
        self.low, self.high = self.points.min(axis=0), self.points.max(axis=0)
        self._corners = corners.reshape(-1, 3)
        self._tree: BVHTree | None = None
        back = body.direction((0.0, 1.0, 0.0))
        self.is_held = {
            "wall": float((self.points @ back).max()) > float((body.points @ back).max()) - TOUCH,
            "ceiling": self.high[2] > body.high[2] - TOUCH,
        }.get(body.placement, self.low[2] < body.low[2] + TOUCH)

    @property
    def tree(self) -> BVHTree:
        if self._tree is None:
            self._tree = BVHTree.FromPolygons(self.points.tolist(), self._corners.tolist(), all_triangles=True)
        return self._tree

    def touches(self, other: _Piece) -> bool:
        """Whether two pieces cross, come close, or one is in the other."""
        if self.tree.overlap(other.tree):
            return True
        for a, b in ((self, other), (other, self)):
            near = ((a.points > b.low - TOUCH) & (a.points < b.high + TOUCH)).all(axis=1)
            for point in _some(a.points[near]):
                if b.tree.find_nearest(Vector(point), TOUCH)[0] is not None:
                    return True
            if (a.low > b.low).all() and (a.high < b.high).all() and is_inside(b.tree, a.points[0]):
                return True
        return False


def _some(points: Floats) -> Floats:
    return points[:: max(1, len(points) // _MOST_POINTS)]


def crossings(room: BuiltRoom) -> list[tuple[str, str, float]]:
    """Pairs of things that run through each other by more than `DEEP`, and how deep in metres; a thing and what it stands
    on are not looked at here, nor is what lies flat on the floor, nor the skirting, which furniture at a wall covers."""
    things = [b for b in room.things.values() if not b.flat]
    others = [*things, *(w for w in room.walls if w.kind not in ("opening", SKIRTING))]
    found = []
    for i, a in enumerate(things):
        for b in others[i + 1 :]:
            if b.id in (a.parent, a.id) or a.id == b.parent or _is_ancestor(room, a, b):
                continue
            if (a.low > b.high - DEEP).any() or (b.low > a.high - DEEP).any():
                continue
            deep = max(_depth(a, b), _depth(b, a))
            if deep > DEEP:
                found.append((a.id, b.id, deep))
    return sorted(found, key=lambda f: -f[2])


def _is_ancestor(room: BuiltRoom, a: Body, b: Body) -> bool:
    return b.id in room.below(a.id) or a.id in room.below(b.id)


def _depth(a: Body, b: Body) -> float:
    """How deep the skin of one thing lies inside of another, metres."""
    near = ((a.skin > b.low) & (a.skin < b.high)).all(axis=1)
    deepest = 0.0
    for point in _some(a.skin[near]):
        _, _, _, distance = b.tree.find_nearest(Vector(point))
        if distance is not None and distance > max(DEEP, deepest) and is_inside(b.tree, point):
            deepest = float(distance)
    return deepest
