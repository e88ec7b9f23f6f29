# SPDX-License-Identifier: GPL-3.0-or-later
"""Solids from an outline: turned, pulled straight, or led along a path. `at` moves the result."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from .arguments import by_kind
from .budget import spend_vertices
from .checks import choice, fail, flag, is_number, number, point, positive, whole
from .polygons import bridged, ears, merged
from .rings import AXES, Faces, circle, crease_of, revolve, ring_sizes, ringed, skin
from .shape import Floats, Shape
from .solids import MOST_SEGMENTS, ORIGIN, RIM_STEPS

MOST_POINTS = 20_000


def outline_of(where: str, name: str, points: Any, size: int, least: int) -> list[tuple[float, ...]]:
    """A list of points without immediate repetitions."""
    if not isinstance(points, (list, tuple)) or not least <= len(points) <= MOST_POINTS:
        raise fail(where, f"{name} must be a list of at least {least} points")
    found = [point(where, f"each point of {name}", p, size) for p in points]
    kept = found[:1] + [b for a, b in zip(found, found[1:], strict=False) if math.dist(a, b) > 1e-9]
    if len(kept) < least:
        raise fail(where, f"{name} needs at least {least} different points")
    return kept


def ring_of(where: str, name: str, points: Any) -> list[tuple[float, ...]]:
    """A closed outline (x, y), counter-clockwise, the first point not repeated at the end."""
    kept = outline_of(where, name, points, 2, 3)
    if math.dist(kept[0], kept[-1]) <= 1e-9:
        kept = kept[:-1]
    turns = zip(kept, kept[1:] + kept[:1], strict=True)
    area = sum(a[0] * b[1] - a[1] * b[0] for a, b in turns) / 2
    if len(kept) < 3 or abs(area) < 1e-12:
        raise fail(where, f"{name} must go round an area")
    return kept if area > 0 else kept[::-1]


_WAIST = 1e-4  # metres


@by_kind
def lathe(profile: Any, segments: Any = 32, at: Any = ORIGIN) -> Shape:
    """Points (radius, z) turned round Z: vases, lamp feet, bowls. Ends off the axis get a flat face; a profile that ends
    with its first point is a ring: shades, hollow pots.

    Other ends than those on the axis get a flat face. When the last point is the first, the profile is a closed ring, as
    for a rim. A waist on the axis between the ends would be a single point: it gets a radius of 0.1 mm.
    """
    found = outline_of("lathe", "profile", profile, 2, 2)
    loop = len(found) > 3 and math.dist(found[0], found[-1]) <= 1e-9
    found = found[:-1] if loop else found
    if any(radius < 0 for radius, _ in found):
        raise fail("lathe", "a radius must not be negative")
    if not any(radius for radius, _ in found):
        raise fail("lathe", "all points lie on the axis (radius 0)")
    count = whole("lathe", "segments", segments, 3, MOST_SEGMENTS)
    ends = () if loop else (0, len(found) - 1)
    points = [(p[0] if n in ends else max(p[0], _WAIST), p[1]) for n, p in enumerate(found)]
    vertices, faces = revolve(points, count, loop)
    return ringed("lathe", vertices, faces, at, ring_sizes(points, count), loop, crease=crease_of(count))


@by_kind
def extrude(
    outline: Any, height: Any, at: Any = ORIGIN, axis: Any = "z", edge: Any = 0.0, holes: Any = ()
) -> Shape:  # fmt: skip
    """Pulled from 0 to height along the axis; outline (x, y), for "y" (x, z), for "x" (y, z).

    Args:
        edge: rounds the edges of both ends, less than half of the thinnest part. holes: outlines that go through, without edge.
    """  # fmt: skip
    corners = ring_of("extrude", "outline", outline)
    depth = positive("extrude", "height", height)
    place = {"x": (1, 2, 0), "y": (0, 2, 1), "z": (0, 1, 2)}[choice("extrude", "axis", axis, AXES)]
    bend = min(number("extrude", "edge", edge, 0.0), 0.49 * depth)
    if not isinstance(holes, (list, tuple)):
        raise fail("extrude", "holes must be a list of outlines")
    if holes:
        made, faces = with_holes(corners, [ring_of("extrude", "each hole", hole) for hole in holes], depth)
        rings: tuple[int, ...] = ()
    else:
        base = np.array([(a, b, 0.0) for a, b in corners])
        turns = [math.pi / 2 * i / RIM_STEPS for i in range(RIM_STEPS + 1)] if bend > 1e-6 else [math.pi / 2]
        lower = [(bend * (1 - math.sin(a)), bend * (1 - math.cos(a))) for a in turns]
        lower = lower if bend > 1e-6 else [(0.0, 0.0)]
        levels = lower + [(inset, depth - z) for inset, z in reversed(lower)]
        spend_vertices(len(levels) * len(corners))
        inward = inward_of(base)
        made, faces = skin([base + inward * inset + (0.0, 0.0, z) for inset, z in levels])
        rings = (len(corners),) * len(levels)
    vertices = np.empty_like(made)
    vertices[:, place] = made
    return ringed("extrude", vertices, faces, at, rings, smooth=bend > 1e-6)


def inward_of(base: Floats) -> Floats:
    """For each corner of a counter-clockwise outline, where it goes when all edges move in by one unit, (N, 3)."""
    ahead = np.roll(base, -1, axis=0) - base
    ahead /= np.maximum(np.linalg.norm(ahead, axis=1, keepdims=True), 1e-12)
    normal = np.stack([-ahead[:, 1], ahead[:, 0], np.zeros(len(base))], axis=1)
    both = normal + np.roll(normal, 1, axis=0)
    return np.asarray(both / np.maximum((both * both).sum(axis=1, keepdims=True) / 2, 0.4))


def with_holes(
    outline: list[tuple[float, ...]], holes: list[list[tuple[float, ...]]], depth: float
) -> tuple[Floats, Faces]:
    """Vertices and faces of a straight prism with holes through it, from 0 to `depth` along Z."""
    outer = [(p[0], p[1]) for p in outline]
    inner = [[(p[0], p[1]) for p in hole[::-1]] for hole in holes]
    if any(not inside_of(p, outer) for hole in inner for p in hole):
        raise fail("extrude", "each hole must lie inside of the outline")
    rings = [outer, *inner]
    starts = np.cumsum([0, *map(len, rings)]).tolist()
    total = starts[-1]
    spend_vertices(4 * total)
    loop = bridged(outer, inner)
    flat = [rings[r][i] for r, i in loop]
    number_of = [starts[r] + i for r, i in loop]
    caps = merged([[number_of[k] for k in triangle] for triangle in ears(flat)])
    faces: Faces = [tuple(face[::-1]) for face in caps] + [tuple(v + total for v in face) for face in caps]
    for ring, start in zip(rings, starts, strict=False):
        n = len(ring)
        faces += [(start + i, start + (i + 1) % n, total + start + (i + 1) % n, total + start + i) for i in range(n)]
    flat_points = [p for ring in rings for p in ring]
    return np.array([(x, y, z) for z in (0.0, depth) for x, y in flat_points]), faces


def inside_of(p: tuple[float, float], outline: list[tuple[float, float]]) -> bool:
    """Whether a point lies inside of an outline (even-odd rule)."""
    found = False
    for a, b in zip(outline, outline[1:] + outline[:1], strict=True):
        if (a[1] > p[1]) != (b[1] > p[1]) and p[0] < a[0] + (p[1] - a[1]) / (b[1] - a[1]) * (b[0] - a[0]):
            found = not found
    return found


@by_kind
def tube(points: Any, radius: Any, segments: Any = 12, closed: Any = False, at: Any = ORIGIN) -> Shape:
    """Round, along points (x, y, z); radius a number or one for each point."""
    count = whole("tube", "segments", segments, 3, MOST_SEGMENTS)
    path, loop = path_of("tube", points, closed)
    if is_number(radius):
        radii = [positive("tube", "radius", radius)] * len(path)
    elif isinstance(radius, (list, tuple)) and len(radius) == len(path):
        radii = [positive("tube", "each radius", r) for r in radius]
    else:
        raise fail("tube", f"radius must be a number or a list of {len(path)} numbers, one for each different point")
    return led("tube", circle(count)[:, :2], path, loop, radii, at, smooth=True)


@by_kind
def sweep(outline: Any, points: Any, closed: Any = False, at: Any = ORIGIN, smooth: Any = False) -> Shape:
    """An outline (right, up) led along points (x, y, z), mitred: frames, rails, mouldings."""
    corners = np.array(ring_of("sweep", "outline", outline))
    path, loop = path_of("sweep", points, closed)
    return led("sweep", corners, path, loop, [1.0] * len(path), at, flag("sweep", "smooth", smooth))


def path_of(where: str, points: Any, closed: Any) -> tuple[Floats, bool]:
    """The path's different points, array (N, 3), and whether it returns to its start."""
    loop = flag(where, "closed", closed)
    found = outline_of(where, "points", points, 3, 2)
    if loop and math.dist(found[0], found[-1]) <= 1e-9:
        found = found[:-1]
    if loop and len(found) < 3:
        raise fail(where, "a closed path needs at least three different points")
    return np.array(found), loop


def led(where: str, outline: Floats, path: Floats, loop: bool, radii: list[float], at: Any, smooth: bool) -> Shape:
    """Rings of the outline (N, 2) at each point of the path, mitred at its corners, skinned and closed."""
    spend_vertices(len(outline) * len(path))
    right, up, mitre, stretch = frames(path, loop)
    made = outline[None, :, :1] * right[:, None] + outline[None, :, 1:] * up[:, None]
    made = made * np.array(radii)[:, None, None]
    wider = np.einsum("rik,rk->ri", made, mitre) * (stretch - 1)[:, None]
    rings = list(made + wider[:, :, None] * mitre[:, None] + path[:, None])
    vertices, faces = skin(rings, loop)
    crease = crease_of(len(outline)) if where == "tube" else 35.0
    return ringed(where, vertices, faces, at, (len(outline),) * len(rings), loop, smooth, crease)


_MOST_POINTS = 2000
Triple = tuple[float, float, float]


def frames(path: Floats, loop: bool) -> tuple[Floats, Floats, Floats, Floats]:
    """At each point of a path: right, up, the direction in which a mitred corner widens, and how much it does.

    The frame is carried on with as little turning as possible: from a corner's mean direction to the edge behind it,
    and from there to the next corner's. On a loop the turning that is left at the seam is spread evenly.
    """
    if len(path) > _MOST_POINTS:
        raise ValueError(f"a path may have at most {_MOST_POINTS} points: use fewer")
    after = np.roll(path, -1, axis=0) - path
    after /= np.maximum(np.linalg.norm(after, axis=1, keepdims=True), 1e-12)
    before = np.roll(after, 1, axis=0)
    if not loop:
        before[0], after[-1] = after[0], before[-1]
    tangents = before + after
    lengths = np.linalg.norm(tangents, axis=1, keepdims=True)
    tangents = np.where(lengths > 1e-6, tangents / np.maximum(lengths, 1e-12), after)
    ups = np.array(carried_ups(after.tolist(), tangents.tolist(), loop))
    bends = after - before
    sizes = np.linalg.norm(bends, axis=1, keepdims=True)
    mitres = np.where(sizes > 1e-9, bends / np.maximum(sizes, 1e-12), ups)
    stretch = 1 / np.maximum(np.einsum("ij,ij->i", tangents, after), 0.4)
    return np.cross(tangents, ups), ups, mitres, stretch


def carried_ups(after: list[Triple], tangents: list[Triple], loop: bool) -> list[Triple]:
    """The up direction at each point: upwards (+Z) on the first edge, or +Y where that rises straight."""
    first = (0.0, 0.0, 1.0) if abs(after[0][2]) < 0.99 else (0.0, 1.0, 0.0)
    ups = [carried(across(first, after[0]), after[0], tangents[0])]
    for i in range(1, len(after)):
        ups.append(carried(carried(ups[-1], tangents[i - 1], after[i - 1]), after[i - 1], tangents[i]))
    if not loop:
        return ups
    last = carried(carried(ups[-1], tangents[-1], after[-1]), after[-1], tangents[0])
    rest = math.atan2(dot(cross(last, ups[0]), tangents[0]), dot(last, ups[0]))
    if abs(rest) < 1e-9:
        return ups
    turned = []
    for i, (up, tangent) in enumerate(zip(ups, tangents, strict=True)):
        c, s = math.cos(rest * i / len(ups)), math.sin(rest * i / len(ups))
        x, y, z = cross(tangent, up)
        turned.append((up[0] * c + x * s, up[1] * c + y * s, up[2] * c + z * s))
    return turned


def carried(up: Triple, one: Triple, other: Triple) -> Triple:
    """The unit vector `up`, at a right angle to the direction `one`, turned along when that turns into `other`.

    The smallest rotation that does it; for opposite directions, half a turn about `up` itself.
    """
    cosine = dot(one, other)
    if cosine < -1 + 1e-9:
        return across(up, other)
    axis = cross(one, other)
    x, y, z = cross(axis, up)
    u, v, w = cross(axis, (x, y, z))
    k = 1 / (1 + cosine)
    return across((up[0] + x + u * k, up[1] + y + v * k, up[2] + z + w * k), other)


def across(direction: Triple, tangent: Triple) -> Triple:
    """The unit vector nearest to `direction` at a right angle to the tangent."""
    level = direction
    for guess in (direction, (0.0, 0.0, 1.0), (1.0, 0.0, 0.0)):
        k = dot(guess, tangent)
        level = (guess[0] - k * tangent[0], guess[1] - k * tangent[1], guess[2] - k * tangent[2])
        size = math.sqrt(dot(level, level))
        if size > 1e-6:
            return (level[0] / size, level[1] / size, level[2] / size)
    return level


def dot(a: Triple, b: Triple) -> float:
    """The inner product."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def cross(a: Triple, b: Triple) -> Triple:
    """The vector product."""
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


@by_kind
def loft(outlines: Any, heights: Any, at: Any = ORIGIN, smooth: Any = True) -> Shape:
    """A solid through outlines (x, y) above each other, all of as many points."""
    if not isinstance(outlines, (list, tuple)) or not 2 <= len(outlines) <= 1000:
        raise fail("loft", "outlines must be a list of at least two outlines")
    if not isinstance(heights, (list, tuple)) or len(heights) != len(outlines):
        raise fail("loft", f"heights must be a list of {len(outlines)} numbers, one for each outline")
    levels = [number("loft", "each height", height) for height in heights]
    if any(b <= a for a, b in zip(levels, levels[1:], strict=False)):
        raise fail("loft", "heights must rise from one outline to the next")
    rings = []
    for outline, level in zip(outlines, levels, strict=True):
        if not isinstance(outline, (list, tuple)) or not 3 <= len(outline) <= MOST_POINTS:
            raise fail("loft", "each outline must be a list of at least three points")
        corners = [point("loft", "each point of an outline", p, 2) for p in outline]
        rings.append(np.array([(x, y, level) for x, y in corners]))
    if len({len(ring) for ring in rings}) > 1:
        raise fail("loft", "all outlines must have the same number of points")
    spend_vertices(sum(len(ring) for ring in rings))
    vertices, faces = skin(rings)
    sizes_of = tuple(len(ring) for ring in rings)
    return ringed("loft", vertices, faces, at, sizes_of, smooth=flag("loft", "smooth", smooth), crease=50.0)
