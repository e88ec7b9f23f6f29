# SPDX-License-Identifier: GPL-3.0-or-later
"""Flat polygons: cut into convex ones, and pieces of faces put together again to a mesh without gaps."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from .rings import Faces
from .shape import Floats

_CELL = 1e-6  # metres: points nearer than this are one
Points = list[tuple[float, ...]]
Flat = list[tuple[float, float]]


def cut_to_convex(corners: Any, normal: Any) -> list[Points]:
    """A flat polygon as convex polygons: itself where it is convex, else triangles."""
    points: Points = [tuple(p) for p in corners]
    flat = flattened(points, normal)
    count = len(flat)
    if all(turn(flat[i - 1], flat[i], flat[(i + 1) % count]) >= -1e-12 for i in range(count)):
        return [points]
    return [[points[i] for i in triangle] for triangle in ears(flat)]


def flattened(points: Points, normal: Any) -> Flat:
    """The polygon seen along its normal's largest axis, counter-clockwise if it is so seen against its normal."""
    main = max(range(3), key=lambda i: abs(normal[i]))
    first, second = (main + 1) % 3, (main + 2) % 3
    if normal[main] < 0:
        first, second = second, first
    return [(p[first], p[second]) for p in points]


def turn(a: tuple[float, float], b: tuple[float, float], c: tuple[float, float]) -> float:
    """Twice the area of a triangle, positive when it is counter-clockwise."""
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])


def ears(flat: Flat) -> list[tuple[int, int, int]]:
    """Triangles of a counter-clockwise polygon, which may be concave and may touch itself along bridges."""
    left = list(range(len(flat)))
    found: list[tuple[int, int, int]] = []
    while len(left) > 3:
        best, sharpest = -1, -math.inf
        for k in range(len(left)):
            a, b, c = left[k - 1], left[k], left[(k + 1) % len(left)]
            area = turn(flat[a], flat[b], flat[c])
            if area <= 1e-15 or not is_ear(flat, left, a, b, c):
                continue
            base = max(math.dist(flat[a], flat[c]), math.dist(flat[a], flat[b]), math.dist(flat[b], flat[c]))
            if area / (base * base) > sharpest:
                best, sharpest = k, area / (base * base)
        if best < 0:  # only slivers are left
            best = min(
                range(len(left)), key=lambda k: abs(turn(*(flat[left[(k + j) % len(left)]] for j in (-1, 0, 1))))
            )
        found.append((left[best - 1], left[best], left[(best + 1) % len(left)]))
        del left[best]
    return [*found, (left[0], left[1], left[2])]


def is_ear(flat: Flat, left: list[int], a: int, b: int, c: int) -> bool:
    """Whether no other corner lies in the triangle; corners at the same place as one of its own do not count."""
    own = (flat[a], flat[b], flat[c])
    for i in left:
        p = flat[i]
        if i in (a, b, c) or p in own:
            continue
        if turn(own[0], own[1], p) >= 0 and turn(own[1], own[2], p) >= 0 and turn(own[2], own[0], p) >= 0:
            return False
    return True


def bridged(outer: Flat, holes: list[Flat]) -> list[tuple[int, int]]:
    """One loop round an outline and its holes, joined by bridges: (ring, corner) of every point; ring 0 is the outline.

    The outline runs counter-clockwise, holes clockwise.
    """
    loop = [(0, i) for i in range(len(outer))]
    rings = [outer, *holes]

    def at(place: tuple[int, int]) -> tuple[float, float]:
        return rings[place[0]][place[1]]

    for number in sorted(range(1, len(rings)), key=lambda r: -max(p[0] for p in rings[r])):
        ring = rings[number]
        start = max(range(len(ring)), key=lambda i: ring[i])
        order = sorted(range(len(loop)), key=lambda k: math.dist(at(loop[k]), ring[start]))
        for k in order:
            if is_free(at(loop[k]), ring[start], [[at(p) for p in loop], *rings[1:]]):
                break
        else:
            k = order[0]
        round_hole = [(number, (start + i) % len(ring)) for i in range(len(ring) + 1)]
        loop = loop[: k + 1] + round_hole + loop[k:]
    return loop


def is_free(p: tuple[float, float], q: tuple[float, float], rings: list[Flat]) -> bool:
    """Whether the line from p to q crosses no edge of the rings."""
    for ring in rings:
        for a, b in zip(ring, ring[1:] + ring[:1], strict=True):
            if p in (a, b) or q in (a, b):
                continue
            if turn(p, q, a) * turn(p, q, b) < 0 and turn(a, b, p) * turn(a, b, q) < 0:
                return False
    return True


def joined_faces(pieces: list[tuple[int, Points]]) -> tuple[Floats, Faces]:
    """A mesh of pieces of faces; those of one face (the same number) are joined where they make one simple polygon."""
    index: dict[tuple[int, ...], int] = {}
    points: Points = []

    def vertex(p: tuple[float, ...]) -> int:
        cell = tuple(math.floor(v / _CELL) for v in p)
        for i in (-1, 0, 1):
            for j in (-1, 0, 1):
                for k in (-1, 0, 1):
                    near = index.get((cell[0] + i, cell[1] + j, cell[2] + k))
                    if near is not None and math.dist(points[near], p) < _CELL:
                        return near
        index[cell] = len(points)
        points.append(p)
        return len(points) - 1

    loops = [(n, list(dict.fromkeys(vertex(p) for p in piece))) for n, piece in pieces]
    loops = [(n, loop) for n, loop in loops if len(loop) >= 3]
    at = np.array(points)
    loops = [(n, with_touching(loop, at)) for n, loop in loops]
    groups: dict[int, list[list[int]]] = {}
    for n, loop in loops:
        groups.setdefault(n, []).append(loop)
    faces = [loop for group in groups.values() for loop in merged(group)]
    return tidied(at, faces)


def with_touching(loop: list[int], at: Floats) -> list[int]:
    """The polygon with all points added that lie on one of its edges."""
    found: list[int] = []
    low, high = at[loop].min(axis=0) - 1e-6, at[loop].max(axis=0) + 1e-6
    near = np.flatnonzero(((at >= low) & (at <= high)).all(axis=1))
    near = near[~np.isin(near, loop)]
    for a, b in zip(loop, loop[1:] + loop[:1], strict=True):
        found.append(a)
        if not len(near):
            continue
        edge = at[b] - at[a]
        length = float(np.linalg.norm(edge))
        t = (at[near] - at[a]) @ edge / max(length * length, 1e-30)
        off = np.linalg.norm(at[near] - at[a] - t[:, None] * edge, axis=1)
        on = (off < 2 * _CELL) & (t > 0) & (t < 1)
        found += [int(i) for _, i in sorted(zip(t[on].tolist(), near[on].tolist(), strict=True))]
    return found


def merged(group: list[list[int]]) -> list[list[int]]:
    """Pieces of one face, joined along shared edges for as long as the result is a simple polygon."""
    group = list(group)
    k = 0
    while k < len(group):
        for other in range(len(group)):
            union = joined_pair(group[k], group[other]) if other != k else None
            if union is not None:
                group[k] = union
                del group[other]
                k = -1
                break
        k += 1
    return group


def joined_pair(one: list[int], other: list[int]) -> list[int] | None:
    """The outline of two polygons that share edges, None when they share none or it would not be simple."""
    first = set(zip(one, one[1:] + one[:1], strict=True))
    second = set(zip(other, other[1:] + other[:1], strict=True))
    shared = {(a, b) for a, b in first if (b, a) in second}
    if not shared:
        return None
    edges = (first - shared) | {(a, b) for a, b in second if (b, a) not in shared}
    follow = dict(edges)
    if len(follow) != len(edges) or len(edges) < 3:
        return None
    start = min(follow)
    loop = [start]
    while (following := follow.get(loop[-1])) is not None and following != start and len(loop) <= len(edges):
        loop.append(following)
    return loop if len(loop) == len(edges) and follow.get(loop[-1]) == start else None


def tidied(at: Floats, loops: list[list[int]]) -> tuple[Floats, Faces]:
    """Without the points that lie straight on an edge of all their polygons, and numbered anew."""
    straight: dict[int, bool] = {}
    for loop in loops:
        for k, v in enumerate(loop):
            a, b = at[loop[k - 1]] - at[v], at[loop[(k + 1) % len(loop)]] - at[v]
            size = max(float(np.linalg.norm(a) * np.linalg.norm(b)), 1e-30)
            level = float(np.linalg.norm(np.cross(a, b))) < 1e-6 * size and float(a @ b) < 0
            straight[v] = straight.get(v, True) and level
    kept = [[v for v in loop if not straight[v]] for loop in loops]
    kept = [loop for loop in kept if len(loop) >= 3]
    used = sorted({v for loop in kept for v in loop})
    new = {v: i for i, v in enumerate(used)}
    return at[used], [tuple(new[v] for v in loop) for loop in kept]
