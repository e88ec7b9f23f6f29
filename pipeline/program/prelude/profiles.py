# SPDX-License-Identifier: GPL-3.0-or-later
"""Solids from an outline: turned, pulled straight, or led along a path. `at` moves the result."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from .budget import spend_vertices
from .checks import choice, fail, flag, is_number, number, point, positive, whole
from .rings import AXES, circle, outward, placed, revolve, skin
from .shape import Floats, Shape
from .solids import MOST_SEGMENTS, ORIGIN

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


def lathe(profile: Any, segments: Any = 32, at: Any = ORIGIN) -> Shape:
    """Turn a profile of points (radius, z) round the Z axis, as for vases, lamp feet and bowls.

    The profile may begin and end on the axis (radius 0); where it does not, the end is closed by a flat face. When
    its last point is its first, the profile is a closed ring, as for a rim.
    """
    found = outline_of("lathe", "profile", profile, 2, 2)
    loop = len(found) > 3 and math.dist(found[0], found[-1]) <= 1e-9
    found = found[:-1] if loop else found
    if any(radius < 0 for radius, _ in found):
        raise fail("lathe", "a radius must not be negative")
    if any(radius == 0 for radius, _ in (found if loop else found[1:-1])) or not any(r for r, _ in found):
        raise fail("lathe", "only the first and the last point may lie on the axis (radius 0)")
    count = whole("lathe", "segments", segments, 3, MOST_SEGMENTS)
    vertices, faces = revolve([(p[0], p[1]) for p in found], count, loop)
    return placed("lathe", vertices, outward(vertices, faces), at, smooth=True)


def extrude(outline: Any, height: Any, at: Any = ORIGIN, axis: Any = "z") -> Shape:
    """Pull a flat outline straight from 0 to `height` along the axis.

    The outline is (x, y) for axis "z", (x, z) for axis "y" and (y, z) for axis "x"; it may be concave and need not be
    closed.
    """
    corners = ring_of("extrude", "outline", outline)
    depth = positive("extrude", "height", height)
    place = {"x": (1, 2, 0), "y": (0, 2, 1), "z": (0, 1, 2)}[choice("extrude", "axis", axis, AXES)]
    spend_vertices(2 * len(corners))
    base = np.array([(a, b, 0.0) for a, b in corners])
    made, faces = skin([base, base + (0.0, 0.0, depth)])
    vertices = np.empty_like(made)
    vertices[:, place] = made
    return placed("extrude", vertices, outward(vertices, faces), at)


def tube(points: Any, radius: Any, segments: Any = 12, closed: Any = False, at: Any = ORIGIN) -> Shape:
    """A round tube along points (x, y, z); the radius is a number, or a list with one for each point."""
    count = whole("tube", "segments", segments, 3, MOST_SEGMENTS)
    path, loop = path_of("tube", points, closed)
    if is_number(radius):
        radii = [positive("tube", "radius", radius)] * len(path)
    elif isinstance(radius, (list, tuple)) and len(radius) == len(path):
        radii = [positive("tube", "each radius", r) for r in radius]
    else:
        raise fail("tube", f"radius must be a number or a list of {len(path)} numbers, one for each different point")
    return led("tube", circle(count)[:, :2], path, loop, radii, at, smooth=True)


def sweep(outline: Any, points: Any, closed: Any = False, at: Any = ORIGIN, smooth: Any = False) -> Shape:
    """Lead an outline (x to the right, y up, seen along the path) along points (x, y, z)."""
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
    rings = []
    for here, (right, up, mitre, stretch), radius in zip(path, frames(path, loop), radii, strict=True):
        ring = radius * (outline[:, :1] * right + outline[:, 1:] * up)
        ring = ring + (ring @ mitre)[:, None] * mitre * (stretch - 1)
        rings.append(here + ring)
    vertices, faces = skin(rings, loop)
    return placed(where, vertices, outward(vertices, faces), at, smooth)


_MOST_POINTS = 2000


def frames(path: Floats, loop: bool) -> list[tuple[Floats, Floats, Floats, float]]:
    """At each point of a path: right, up, the direction in which a mitred corner widens, and how much it does.

    Frames turn as little as possible from point to point (Bishop frames); on a loop what is left is spread evenly.
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
    first = np.array((0.0, 0.0, 1.0)) if abs(tangents[0][2]) < 0.99 else np.array((0.0, 1.0, 0.0))
    ups = [across(first, tangents[0])]
    for tangent in tangents[1:]:
        ups.append(across(ups[-1], tangent))
    rest = 0.0
    if loop:
        last = across(ups[-1], tangents[0])
        rest = math.atan2(float(np.cross(last, ups[0]) @ tangents[0]), float(last @ ups[0]))
    found = []
    for i, (tangent, up) in enumerate(zip(tangents, ups, strict=True)):
        turn = rest * i / len(path)
        side = np.cross(tangent, up)
        up = up * math.cos(turn) + side * math.sin(turn)
        bend = after[i] - before[i]
        size = float(np.linalg.norm(bend))
        mitre = bend / size if size > 1e-9 else up
        stretch = 1 / max(float(tangent @ after[i]), 0.4)
        found.append((np.cross(tangent, up), up, mitre, stretch))
    return found


def across(direction: Floats, tangent: Floats) -> Floats:
    """The unit vector nearest to `direction` at a right angle to the tangent."""
    for guess in (direction, np.array((0.0, 0.0, 1.0)), np.array((1.0, 0.0, 0.0))):
        level: Floats = guess - (guess @ tangent) * tangent
        size = float(np.linalg.norm(level))
        if size > 1e-6:
            return level / size
    return level


def loft(outlines: Any, heights: Any, at: Any = ORIGIN, smooth: Any = True) -> Shape:
    """A solid through outlines that lie above each other, each a list of as many points (x, y), at the given heights."""
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
    return placed("loft", vertices, outward(vertices, faces), at, flag("loft", "smooth", smooth))
