# SPDX-License-Identifier: GPL-3.0-or-later
"""Joins foreground areas into things: what makes a fuller rectangle together belongs together."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from .boxes import OrientedBox, Points, convex_hull, oriented_box, outline_points, polygon_area
from .grid import Bools, Floats, Ints, components
from .segment import area_means, neighbours


@dataclass
class Thing:
    """One thing seen from above, in pixels of the working picture.

    Attributes:
        size: number of its own visible pixels; hull: convex hull of them; colour: mean Lab colour.
        box: smallest rectangle around it; parts: how many areas it was joined from.
        inside: index of the thing it lies on, or -1.
        flat: True for what lies flat on the floor, such as a rug.
    """

    size: int
    hull: Points
    colour: Floats
    box: OrientedBox
    parts: int = 1
    inside: int = -1
    flat: bool = False
    covered: float = 0.0
    children: list[int] = field(default_factory=list)

    @property
    def fill(self) -> float:
        """Share of its rectangle that is its own."""
        return min(1.0, self.size / max(self.box.area, 1.0))

    @property
    def roundness(self) -> float:
        """Hull area over the rectangle's: 0.785 for an ellipse, 1 for a rectangle."""
        return polygon_area(self.hull) / max(self.box.area, 1.0)


def joined(a: Thing, b: Thing) -> Thing:
    """The two as one thing."""
    hull = convex_hull(np.concatenate([a.hull, b.hull]))
    size = a.size + b.size
    colour = ((a.colour * a.size + b.colour * b.size) / size).astype(np.float32)
    return Thing(size, hull, colour, oriented_box(hull), a.parts + b.parts)


def _within(inner: Thing, outer: Thing) -> float:
    """Share of the inner thing's hull corners (and centre) that lie inside the outer's rectangle."""
    points = np.concatenate([inner.hull, np.array([inner.box.centre])])
    return float(outer.box.contains(points, 1.5).mean())


class _Board:
    """Things and their common borders while they are being joined."""

    def __init__(self, things: dict[int, Thing], borders: dict[tuple[int, int], int]) -> None:
        self.things = things
        self.touch: dict[int, dict[int, int]] = {key: {} for key in things}
        for (a, b), length in borders.items():
            self.touch[a][b] = self.touch[b][a] = length

    def join(self, a: int, b: int) -> None:
        """Join b into a."""
        self.things[a] = joined(self.things[a], self.things[b])
        for other, length in self.touch.pop(b).items():
            del self.touch[other][b]
            if other != a:
                total = self.touch[a].get(other, 0) + length
                self.touch[a][other] = self.touch[other][a] = total
        del self.things[b]


def _absorb_slivers(board: _Board, thin: set[int], least: float) -> None:
    """Give thin lines and specks to the neighbour with the longest common border; lone specks go."""
    for key in sorted(
        thin | {k for k, t in board.things.items() if t.size < least}, key=lambda k: board.things[k].size
    ):
        near = board.touch[key]
        if near:
            board.join(max(near, key=lambda k: (near[k], k)), key)
        elif board.things[key].size < least:
            del board.things[key], board.touch[key]


def _solid_fill(board: _Board, key: int) -> float:
    """Share of a thing's rectangle that it fills together with the small things that lie in it."""
    thing = board.things[key]
    extra = sum(
        board.things[o].size
        for o in board.touch[key]
        if board.things[o].size < 0.5 * thing.size and _within(board.things[o], thing) > 0.95
    )
    return min(1.0, (thing.size + extra) / max(thing.box.area, 1.0))


def _gain(board: _Board, key: int, other: int) -> float:
    """How much two touching things look like one rectangle; 0 when they should stay apart."""
    a, b, border = board.things[key], board.things[other], board.touch[key][other]
    small, large = (a, b) if a.size <= b.size else (b, a)
    if border < 0.6 * min(small.box.length, small.box.breadth):
        return 0.0
    if small.size < 0.5 * large.size and _within(small, large) > 0.95:
        return 0.0  # what lies on something is no part of its outline
    union = joined(a, b)
    solid = _solid_fill(board, key), _solid_fill(board, other)
    if min(solid) < 0.7 and small.size > 0.25 * large.size:
        return 0.0  # something with a bite out of it lies under something else, as a rug under a bed
    full = min(1.0, (solid[0] * a.box.area + solid[1] * b.box.area) / max(union.box.area, 1.0))
    if min(full, union.fill + 0.3) < 0.8:
        return 0.0
    before = max(solid) if small.size > 0.25 * large.size else solid[0] if large is a else solid[1]
    better = full - max(before, 0.5 * (solid[0] + solid[1]))
    return full + 0.2 * better if better > -0.06 else 0.0


def _merge_rectangles(board: _Board) -> None:
    """Join pairs, the best first, while the pair makes a full rectangle."""
    gains: dict[tuple[int, int], float] = {}

    def refresh(key: int) -> None:
        for other in board.touch[key]:
            gains[min(key, other), max(key, other)] = _gain(board, key, other)

    for key in board.things:
        refresh(key)
    while gains:
        pair = max(gains, key=lambda p: (gains[p], p))
        if gains[pair] <= 0:
            break
        a, b = pair
        for stale in [p for p in gains if a in p or b in p]:
            del gains[stale]
        board.join(a, b)
        refresh(a)


def _merge_contained(board: _Board, room: float) -> None:
    """Join what lies inside a thing and is no thing of its own: patterns, borders, frames, cushions' folds."""
    changed = True
    while changed:
        changed = False
        for key in sorted(board.things, key=lambda k: board.things[k].size):
            inner = board.things[key]
            for other in board.touch[key]:
                outer = board.things[other]
                if outer.box.area <= inner.box.area or _within(inner, outer) < 0.95:
                    continue
                apart = float(np.linalg.norm(np.array(inner.box.centre) - np.array(outer.box.centre)))
                share = inner.box.area / outer.box.area
                apart_colour = float(np.linalg.norm(inner.colour - outer.colour))
                pattern = share > 0.3 and apart < 0.12 * min(outer.box.length, outer.box.breadth) and outer.fill < 0.8
                speck = inner.size < 0.0015 * room or inner.fill < 0.55
                hole = outer.box.area < 0.12 * room and outer.fill < 0.75 and joined(inner, outer).fill > 0.85
                small = inner.size < 0.0006 * room
                close = outer.box.area < 12 * inner.box.area or apart_colour < 12 or small
                if pattern or (speck and close) or share > 0.72 or hole:
                    board.join(other, key)
                    changed = True
                    break
            if changed:
                break


def _likeness(thing: Thing, mate: Thing, border: int, room: float) -> float:
    """How readily a small piece joins its neighbour; below 0.12 it stays."""
    if thing.size > 0.006 * room:
        return 0.0
    if mate.size > 0.02 * room and thing.fill > 0.6 and thing.size > 0.0015 * room:
        return 0.0
    around = 2 * (thing.box.length + thing.box.breadth)
    likeness = border / max(around, 1.0) - (0.004 if mate.box.area < 6 * thing.box.area else 0.012) * float(
        np.linalg.norm(thing.colour - mate.colour)
    )
    if likeness < 0.12:
        return 0.0
    union = joined(thing, mate)
    return 0.0 if union.fill < 0.5 and union.fill < mate.fill - 0.02 else likeness


def _merge_fragments(board: _Board, room: float) -> None:
    """Join small pieces that touch along much of their border, such as leaves, to their closest neighbour."""

    def score(pair: tuple[int, int]) -> float:
        key, other = pair
        return _likeness(board.things[key], board.things[other], board.touch[key][other], room)

    scores = {(a, b): score((a, b)) for a in board.things for b in board.touch[a]}
    while scores:
        best = max(scores, key=lambda p: (scores[p], p))
        if scores[best] < 0.12:
            break
        key, other = best
        scores = {p: v for p, v in scores.items() if key not in p and other not in p}
        board.join(other, key)
        for near in board.touch[other]:
            scores[other, near] = score((other, near))
            scores[near, other] = score((near, other))


def group_things(labels: Ints, foreground: Bools, lab: Floats, room: float) -> list[Thing]:
    """Join the foreground's areas into things, largest first.

    Args:
        labels: areas of even colour; room: floor area in pixels.
    """
    if not foreground.any():
        return []
    parts = components(np.where(foreground, labels, -1))
    _, mean = area_means(parts, lab)
    core = _same_around(parts)
    things: dict[int, Thing] = {}
    thin: set[int] = set()
    ids, index = np.unique(parts[foreground], return_inverse=True)
    for key in ids:
        rows, columns = np.nonzero(parts == key)
        y0, x0 = int(rows.min()), int(columns.min())
        mask = parts[y0 : rows.max() + 1, x0 : columns.max() + 1] == key
        hull = convex_hull(outline_points(mask, (x0, y0)))
        things[int(key)] = Thing(len(rows), hull, mean[key], oriented_box(hull))
        if core[rows, columns].mean() < 0.2:
            thin.add(int(key))
    a, b, length = neighbours(parts)
    borders = {
        (int(x), int(y)): int(n) for x, y, n in zip(a, b, length, strict=True) if int(x) in things and int(y) in things
    }
    board = _Board(things, borders)
    _absorb_slivers(board, thin, max(6.0, 0.0004 * room))
    _merge_rectangles(board)
    _merge_contained(board, room)
    _merge_fragments(board, room)
    _merge_rectangles(board)
    _merge_contained(board, room)
    return sorted(board.things.values(), key=lambda t: -t.box.area)


def _same_around(labels: Ints) -> Bools:
    """Pixels whose eight neighbours at distance 1 all have the same label."""
    padded = np.pad(labels, 1, mode="edge")
    height, width = labels.shape
    same = np.ones(labels.shape, dtype=bool)
    for dy in range(3):
        for dx in range(3):
            same &= padded[dy : dy + height, dx : dx + width] == labels
    return same
