# SPDX-License-Identifier: GPL-3.0-or-later
"""Where a texture comes to lie: one unit of U or V is one metre, and the grain of a long part runs along U.

What was made ring by ring (turned, swept, extruded) is unrolled round its rings; cloth brings its own places; all else
is projected along the axis that each face looks along most, in the frame that the part was made in. So a leg that
leans, was copied or mirrored has the grain of the upright one.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from .shape import Floats, Shape

UNWRAPPED = "unwrapped"
"""Where a shape remembers its places, as the looks of a room change far more often than its meshes."""
_LONG = 1.2
"""How much longer than wide a part is for its grain to follow it."""


def newell_normals(points: Floats, corners: Any, lengths: Any) -> Floats:
    """Unit normals of faces (Newell's method), array (faces, 3)."""
    if not len(lengths):
        return np.zeros((0, 3))
    starts = np.cumsum(lengths) - lengths
    ahead = np.arange(1, len(corners) + 1)
    ahead[starts + lengths - 1] = starts
    here = points[corners] - np.repeat(points[corners[starts]], lengths, axis=0)
    following = here[ahead]
    a = here[:, 1] * following[:, 2] - here[:, 2] * following[:, 1]
    b = here[:, 2] * following[:, 0] - here[:, 0] * following[:, 2]
    c = here[:, 0] * following[:, 1] - here[:, 1] * following[:, 0]
    found = np.add.reduceat(np.stack([a, b, c], axis=1), starts, axis=0)
    return np.asarray(found / np.maximum(np.linalg.norm(found, axis=1, keepdims=True), 1e-15))


def face_normals(shape: Shape) -> Floats:
    """Unit normals of the faces, array (faces, 3)."""
    return newell_normals(shape.vertices, *shape.corners)


def corner_uvs(shape: Shape) -> Floats:
    """(u, v) of every face corner, metres, array (corners, 2)."""
    if not shape.faces:
        return np.zeros((0, 2))
    corners, lengths = shape.corners
    if shape.uvs is not None and len(shape.uvs) == len(corners):
        return shape.uvs
    found: Floats | None = shape.__dict__.get(UNWRAPPED)
    if found is None:
        found = projected(shape, corners, lengths)
        if shape.rings:
            unroll(shape, corners, lengths, found)
        found.flags.writeable = False
        shape.__dict__[UNWRAPPED] = found
    return found


def projected(shape: Shape, corners: Any, lengths: Any) -> Floats:
    """Every face seen along its nearest axis of the part's own frame; never mirrored, U along the longer side."""
    own = shape.vertices if shape.axes is None else shape.vertices @ shape.axes
    normals = face_normals(shape)
    normals = normals if shape.axes is None else normals @ shape.axes
    main = np.abs(normals + np.array((0.0, 1e-9, 2e-9))).argmax(axis=1)
    extent = np.ptp(own, axis=0)
    across, up, turned = np.array((1, 0, 0)), np.array((2, 2, 1)), np.array((1.0, -1.0, 1.0))
    lying = extent[up] > _LONG * extent[across]
    first, second = np.where(lying, up, across), np.where(lying, across, up)
    hand = np.where(normals[np.arange(len(main)), main] < 0, -1.0, 1.0) * turned[main] * np.where(lying[main], -1.0, 1)
    if shape.axes is not None and float(np.linalg.det(shape.axes)) < 0:
        hand = -hand
    face = np.repeat(np.arange(len(lengths)), lengths)
    rows, places = np.arange(len(corners)), own[corners]
    u, v = places[rows, first[main][face]], places[rows, second[main][face]]
    # What keeps a texture from being mirrored is done to the direction that is free: V where U follows the grain.
    turned_v = lying[main][face]
    return np.stack([np.where(turned_v, u, u * hand[face]), np.where(turned_v, v * hand[face], v)], axis=1)


def unroll(shape: Shape, corners: Any, lengths: Any, uvs: Floats) -> None:
    """Write the places of the faces between rings: U round the rings and V along them, or the other way round.

    Flat bands, as of a plate, keep their projected places. The faces must be in the order that `rings.skin` makes.
    """
    counts = np.array(shape.rings)
    starts = np.cumsum(counts) - counts
    rings = [shape.vertices[a : a + n] for a, n in zip(starts.tolist(), counts.tolist(), strict=True)]
    centres = np.array([ring.mean(axis=0) for ring in rings])
    pairs = [(k, k + 1) for k in range(len(rings) - 1)] + ([(len(rings) - 1, 0)] if shape.loop else [])
    rounds = [girth(ring, centre) for ring, centre in zip(rings, centres, strict=True)]
    steps = [float(np.linalg.norm(rings[b] - rings[a], axis=1).mean()) for a, b in pairs]
    widest = max(float(line[-1] - line[0]) for line in rounds)
    along = sum(steps) > _LONG * widest
    level, done, ends = 0.0, 0, np.cumsum(lengths)
    for (a, b), step in zip(pairs, steps, strict=True):
        low, high = len(rings[a]), len(rings[b])
        many = max(low, high)
        if float(np.linalg.norm(centres[b] - centres[a])) >= 0.5 * step:
            places = band_places(rounds[a], rounds[b], low, high, level, level + step)
            if shape.flipped:
                places = places[:, ::-1]
            first = int(ends[done] - lengths[done])
            flat = places.reshape(-1, 2)
            uvs[first : first + len(flat)] = np.stack([flat[:, 1], -flat[:, 0]], axis=1) if along else flat
        level += step
        done += many if low > 1 or high > 1 else 0


def girth(ring: Floats, centre: Floats) -> Floats:
    """How far round a ring each of its points lies, the first again at the end; 0 is opposite to the seam."""
    if len(ring) == 1:
        return np.zeros(2)
    edges = np.linalg.norm(np.roll(ring, -1, axis=0) - ring, axis=1)
    line = np.concatenate([[0.0], np.cumsum(edges)])
    return np.asarray(line - line[-1] / 2)


def band_places(lower: Floats, upper: Floats, low: int, high: int, z: float, top: float) -> Floats:
    """Places of the corners of the faces between two rings, in the order of `rings.band`, (faces, corners, 2)."""

    def at(u: Floats, v: float) -> Floats:
        return np.stack([u, np.full(len(u), v)], axis=1)

    if low == 1:
        return np.stack([at((upper[:-1] + upper[1:]) / 2, z), at(upper[1:], top), at(upper[:-1], top)], axis=1)
    if high == 1:
        return np.stack([at(lower[:-1], z), at(lower[1:], z), at((lower[:-1] + lower[1:]) / 2, top)], axis=1)
    return np.stack([at(lower[:-1], z), at(lower[1:], z), at(upper[1:], top), at(upper[:-1], top)], axis=1)


def refitted(shape: Shape, vertices: Floats) -> Floats | None:
    """A cloth's own places after its points were moved to `vertices`: scaled along U and V so that a metre stays one."""
    if shape.uvs is None:
        return None
    corners, lengths = shape.corners
    starts = np.cumsum(lengths) - lengths
    ahead = np.arange(1, len(corners) + 1)
    ahead[starts + lengths - 1] = starts
    flat = (shape.uvs[ahead] - shape.uvs) ** 2
    far = ((vertices[corners[ahead]] - vertices[corners]) ** 2).sum(axis=1)
    normal = flat.T @ flat
    if abs(float(np.linalg.det(normal))) < 1e-30:
        return shape.uvs
    squares = np.linalg.solve(normal, flat.T @ far)
    return np.asarray(shape.uvs * np.sqrt(np.maximum(squares, 1e-12)))
