# SPDX-License-Identifier: GPL-3.0-or-later
"""Closed solids. All lengths in metres; `at` is the solid's centre; faces run counter-clockwise seen from outside."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from .arguments import by_kind
from .budget import spend_vertices
from .checks import fail, is_number, number, positive, sizes, whole
from .rings import Faces, along, circle, crease_of, placed, revolve, ring_sizes, ringed, skin
from .shape import Shape

MOST_SEGMENTS = 512
RIM_STEPS = 3
ORIGIN = (0.0, 0.0, 0.0)
BOX_CORNERS = np.array([(x, y, z) for z in (-1, 1) for x, y in ((-1, -1), (1, -1), (1, 1), (-1, 1))])
BOX_FACES: Faces = [(3, 2, 1, 0), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7)]


@by_kind
def box(size: Any, at: Any = ORIGIN) -> Shape:
    """size is (width x, depth y, height z)."""
    half = np.array(sizes("box", "size", size)) / 2
    spend_vertices(8)
    return placed("box", BOX_CORNERS * half, BOX_FACES, at)


@by_kind
def rounded_box(size: Any, radius: Any = 0.02, at: Any = ORIGIN, segments: Any = 3) -> Shape:
    """Edges and corners rounded; segments=1 bevels them.

    The radius is cut to a little under half of the smallest side.
    """
    half = np.array(sizes("rounded_box", "size", size)) / 2
    bend = min(positive("rounded_box", "radius", radius), 0.98 * float(half.min()))
    steps = whole("rounded_box", "segments", segments, 1, 32)
    columns = 4 * (steps + 1)
    spend_vertices(2 * steps * columns + 8)
    inner = half - bend
    quarters = [(1, 1), (-1, 1), (-1, -1), (1, -1)]
    around = [(q, math.pi / 2 * (q + i / steps)) for q in range(4) for i in range(steps + 1)]
    points = [np.array([(x * inner[0], y * inner[1], -half[2]) for x, y in quarters])]
    tilts = [math.pi / 2 * i / steps for i in range(steps + 1)]
    levels = [(-1, tilt) for tilt in reversed(tilts[:-1])] + [(1, tilt) for tilt in tilts[:-1]]
    for side, tilt in levels:
        flat, rise = bend * math.cos(tilt), side * (inner[2] + bend * math.sin(tilt))
        ring = [(quarters[q][0] * inner[0] + flat * math.cos(a), quarters[q][1] * inner[1] + flat * math.sin(a), rise)
                for q, a in around]  # fmt: skip
        points.append(np.array(ring))
    points.append(points[0] * (1, 1, -1))
    _, faces = skin(points[1:-1])
    faces = [tuple(i + 4 for i in face) for face in faces[:-2]]
    last = 4 + len(levels) * columns
    faces += rounded_ends(steps, columns, last)
    return placed("rounded_box", np.concatenate(points), faces, at, smooth=steps > 1)


def rounded_ends(steps: int, columns: int, last: int) -> list[tuple[int, ...]]:
    """Bottom and top of a rounded box: the flat face, four strips and four corner fans at each end.

    The bottom's four vertices come first; then rings of `columns`; the top's four start at `last`.
    """
    faces: list[tuple[int, ...]] = [(3, 2, 1, 0), (last, last + 1, last + 2, last + 3)]
    top_ring = last - columns
    for i in range(columns):
        j = (i + 1) % columns
        q, r = i // (steps + 1), j // (steps + 1)
        if q == r:
            faces += [(q, 4 + j, 4 + i), (top_ring + i, top_ring + j, last + q)]
        else:
            faces += [(q, r, 4 + j, 4 + i), (top_ring + i, top_ring + j, last + r, last + q)]
    return faces


@by_kind
def cylinder(radius: Any, height: Any, at: Any = ORIGIN, segments: Any = 24, axis: Any = "z", edge: Any = 0.0) -> Shape:
    """edge rounds the rims."""
    return frustum("cylinder", positive("cylinder", "radius", radius), None, height, at, segments, axis, edge)


@by_kind
def cone(
    radius: Any, height: Any, top_radius: Any = 0.0, at: Any = ORIGIN, segments: Any = 24, axis: Any = "z",
    edge: Any = 0.0,
) -> Shape:  # fmt: skip
    """Cut off where top_radius is above 0."""
    bottom, top = number("cone", "radius", radius, 0.0), number("cone", "top_radius", top_radius, 0.0)
    if bottom == 0 and top == 0:
        raise fail("cone", "radius and top_radius must not both be 0")
    return frustum("cone", bottom, top, height, at, segments, axis, edge)


def frustum(
    where: str, bottom: float, top: float | None, height: Any, at: Any, segments: Any, axis: Any, edge: Any = 0.0
) -> Shape:  # fmt: skip
    """What cylinder and cone share; a top of None is as wide as the bottom."""
    half = positive(where, "height", height) / 2
    count = whole(where, "segments", segments, 3, MOST_SEGMENTS)
    profile = [(bottom, -half), (bottom if top is None else top, half)]
    profile = rounded_rims(profile, number(where, "edge", edge, 0.0))
    vertices, faces = revolve(profile, count)
    sizes_of, crease = ring_sizes(profile, count), crease_of(count)
    return ringed(where, along(where, vertices, axis), faces, at, sizes_of, crease=crease)


def rounded_rims(profile: list[tuple[float, float]], edge: float) -> list[tuple[float, float]]:
    """A profile of two points (radius, z) with its rims rounded; the radius is cut to a little under what fits."""
    (bottom, low), (top, high) = profile
    edge = min(edge, 0.49 * (high - low), 0.9 * bottom if bottom else edge, 0.9 * top if top else edge)
    if edge < 1e-6:
        return profile
    turns = [math.pi / 2 * i / RIM_STEPS for i in range(RIM_STEPS + 1)]
    slope = (top - bottom) / (high - low)

    def side(z: float) -> float:
        return bottom + slope * (z - low)

    found = [
        (side(low + edge * (1 - math.cos(a))) - edge * (1 - math.sin(a)), low + edge * (1 - math.cos(a))) for a in turns
    ]
    found = found if bottom else [profile[0]]
    ends = [
        (side(high - edge * (1 - math.cos(a))) - edge * (1 - math.sin(a)), high - edge * (1 - math.cos(a)))
        for a in turns
    ]
    return found + (ends[::-1] if top else [profile[1]])


@by_kind
def prism(sides: Any, radius: Any, height: Any, at: Any = ORIGIN, axis: Any = "z", edge: Any = 0.0) -> Shape:
    """On a regular polygon, radius to a corner; edge rounds the ends."""
    count = whole("prism", "sides", sides, 3, MOST_SEGMENTS)
    half, across = positive("prism", "height", height) / 2, positive("prism", "radius", radius)
    profile = rounded_rims([(across, -half), (across, half)], number("prism", "edge", edge, 0.0))
    vertices, faces = revolve(profile, count)
    return ringed(
        "prism", along("prism", vertices, axis), faces, at, ring_sizes(profile, count), smooth=len(profile) > 2
    )


@by_kind
def wedge(size: Any, front: Any = 0.0, at: Any = ORIGIN) -> Shape:
    """A box whose top slopes from full height at the back (+Y) to `front` at the front (-Y)."""
    w, d, h = sizes("wedge", "size", size)
    low = number("wedge", "front", front, 0.0)
    if low > h:
        raise fail("wedge", "front must not be higher than the size")
    spend_vertices(8)
    x, y, z = w / 2, d / 2, h / 2
    back = [(x, y, -z), (-x, y, -z), (-x, y, z), (x, y, z)]
    ahead = [(-x, -y, -z), (x, -y, -z)]
    if low < 1e-9:
        faces: Faces = [(0, 1, 2, 3), (4, 1, 0, 5), (4, 5, 3, 2), (4, 2, 1), (5, 0, 3)]
        return placed("wedge", np.array(back + ahead), faces, at)
    ahead += [(x, -y, low - z), (-x, -y, low - z)]
    faces = [(0, 1, 2, 3), (4, 1, 0, 5), (4, 5, 6, 7), (7, 6, 3, 2), (4, 7, 2, 1), (5, 0, 3, 6)]
    return placed("wedge", np.array(back + ahead), faces, at)


@by_kind
def sphere(radius: Any, at: Any = ORIGIN, segments: Any = 24, rings: Any = 12) -> Shape:
    """A radius (x, y, z) makes an ellipsoid."""
    if is_number(radius):
        radius = (radius, radius, radius)
    radii = np.array(sizes("sphere", "radius", radius))
    columns, rows = whole("sphere", "segments", segments, 3, MOST_SEGMENTS), whole("sphere", "rings", rings, 2, 256)
    arc = [(math.sin(math.pi * i / rows), -math.cos(math.pi * i / rows)) for i in range(1, rows)]
    profile = [(0.0, -1.0), *arc, (0.0, 1.0)]
    vertices, faces = revolve(profile, columns)
    return ringed("sphere", vertices * radii, faces, at, ring_sizes(profile, columns), crease=180.0)


@by_kind
def capsule(radius: Any, height: Any, at: Any = ORIGIN, segments: Any = 24, rings: Any = 6, axis: Any = "z") -> Shape:
    """Half-round ends; height is over all."""
    bend, whole_height = positive("capsule", "radius", radius), positive("capsule", "height", height)
    if whole_height < 2 * bend:
        raise fail("capsule", "height is over all and must be at least twice the radius")
    columns, rows = whole("capsule", "segments", segments, 3, MOST_SEGMENTS), whole("capsule", "rings", rings, 1, 128)
    straight = max(whole_height / 2 - bend, 1e-6)
    arc = [(bend * math.cos(math.pi / 2 * i / rows), bend * math.sin(math.pi / 2 * i / rows)) for i in range(rows)]
    upper = [(r, straight + z) for r, z in arc] + [(0.0, straight + bend)]
    profile = [(r, -z) for r, z in reversed(upper)] + upper
    vertices, faces = revolve(profile, columns)
    return ringed("capsule", along("capsule", vertices, axis), faces, at, ring_sizes(profile, columns), crease=180.0)


@by_kind
def torus(
    radius: Any, thickness: Any, at: Any = ORIGIN, segments: Any = 32, rings: Any = 12, axis: Any = "z",
    angle: Any = 360.0,
) -> Shape:  # fmt: skip
    """A ring, or an arc of `angle` degrees from +X on: radius to the tube's middle, thickness the tube's own radius.

    Round "x" an arc begins at +Y, round "y" at +Z.
    """
    middle, bend = positive("torus", "radius", radius), positive("torus", "thickness", thickness)
    if bend >= middle:
        raise fail("torus", "thickness, the tube's own radius, must be smaller than radius")
    columns, rows = whole("torus", "segments", segments, 3, MOST_SEGMENTS), whole("torus", "rings", rings, 3, 256)
    profile = [(middle + bend * x, bend * z) for x, z, _ in circle(rows).tolist()]
    span = math.radians(number("torus", "angle", angle, 1.0, 360.0))
    if span >= math.tau - 1e-9:
        vertices, faces = revolve(profile, columns, loop=True)
        return ringed("torus", along("torus", vertices, axis), faces, at, (columns,) * rows, True, crease=180.0)
    spend_vertices((columns + 1) * rows)
    section = np.array(profile)
    turns = [span * i / columns for i in range(columns + 1)]
    round_z = [np.stack([section[:, 0] * math.cos(a), section[:, 0] * math.sin(a), section[:, 1]], 1) for a in turns]
    vertices, faces = skin(round_z)
    return ringed("torus", along("torus", vertices, axis), faces, at, (rows,) * len(turns), crease=80.0)
