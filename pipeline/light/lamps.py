# SPDX-License-Identifier: GPL-3.0-or-later
"""Where the light of a lamp comes from: inside its shade, beside its bulb, measured on what was built.

A lamp's parts say it: "bulb", "shade", "globe", or what has the material role "shade". A light inside a closed globe
would be swallowed by it, so there it gets the globe's size and shines from its surface.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ..artifacts.layout import ProxyLine
from ..geometry.polygon import Floats
from ..program.prelude.palette import category_family, split_role
from ..program.prelude.shape import Shape

MOST_BULBS = 6
"""Lights that one lamp gets at most; a chandelier of more is lit by these."""
_SHADES = ("shade", "globe", "diffuser", "glass", "light", "lantern", "glow")
_NO_LAMPS = ("switch", "lighter", "lampshade")
_APART = 0.15  # metres between the middles of two shades of one lamp
_RAYS = 64
_CLOSED = 0.05  # share of directions in which light must get out, or the lamp counts as closed
_BULB = 0.03  # metres: radius of a light in an open shade
_WALL = 1.02  # how much larger than a closed globe its light is


@dataclass(frozen=True)
class Bulb:
    """One place that a lamp shines from.

    Attributes:
        at: in the room, metres; radius: of the shining ball.
        open: share of all directions in which it gets out of its shade; 1 for what shines from a globe's surface.
        inside: the lower and upper corner of its shade in the room, as far as the box round it goes.
    """

    at: tuple[float, float, float]
    radius: float
    open: float
    inside: tuple[tuple[float, float, float], tuple[float, float, float]]


def is_lamp(proxy: ProxyLine) -> bool:
    """Whether an object is there to give light."""
    words = f"{proxy.category}".lower().replace("_", " ").split()
    return category_family(proxy.category) == "lamp" and not any(word in _NO_LAMPS for word in words)


def bulbs(proxy: ProxyLine, shapes: Sequence[Shape]) -> list[Bulb]:
    """Where a lamp shines from, at most `MOST_BULBS` places, in the room's frame.

    Args:
        shapes: the lamp's parts in its own frame (origin at the centre of its base).
    """
    shades = [s for s in shapes if s.vertex_count and _is_shade(s)]
    cores = [s for s in shapes if s.vertex_count and s.part == "bulb"]
    groups = _clusters(shades or cores)[:MOST_BULBS] or [[_upper_part(proxy)]]
    return [_bulb(proxy, group, cores, [s for s in shapes if s.vertex_count]) for group in groups]


def _is_shade(shape: Shape) -> bool:
    if shape.part == "bulb":
        return False
    return any(word in _SHADES for word in shape.part.split()) or split_role(shape.material)[0] == "shade"


def _upper_part(proxy: ProxyLine) -> Shape:
    """Stands in for the shade of a lamp that shows none: the upper third, or the lower one of what hangs."""
    w, d, h = proxy.size
    low, high = (0.0, h / 3) if proxy.placement == "ceiling" else (h * 2 / 3, h)
    corners = np.array([(x, y, z) for z in (low, high) for y in (-d / 2, d / 2) for x in (-w / 2, w / 2)], dtype=float)
    faces = ((0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5))
    return Shape(corners, faces, "shade")


def _clusters(shapes: Sequence[Shape]) -> list[list[Shape]]:
    """Shades that stand apart from each other, the larger ones first."""
    groups: list[list[Shape]] = []
    for shape in sorted(shapes, key=lambda s: -_reach(s)):
        middle = _middle(shape)
        for group in groups:
            near = max(_APART, _reach(group[0]))
            if float(np.linalg.norm((_middle(group[0]) - middle)[:2])) < near:
                group.append(shape)
                break
        else:
            groups.append([shape])
    return groups


def _middle(shape: Shape) -> Floats:
    result: Floats = (shape.vertices.min(axis=0) + shape.vertices.max(axis=0)) / 2
    return result


def _reach(shape: Shape) -> float:
    return float(np.linalg.norm(shape.vertices.max(axis=0) - shape.vertices.min(axis=0))) / 2


def _bulb(proxy: ProxyLine, shade: list[Shape], cores: list[Shape], everything: list[Shape]) -> Bulb:
    points = np.concatenate([s.vertices for s in shade])
    low, high = points.min(axis=0), points.max(axis=0)
    middle = (low + high) / 2
    own = [c for c in cores if bool(np.all(_middle(c) > low - 0.05) and np.all(_middle(c) < high + 0.05))]
    if own:
        middle[:2] = _middle(own[0])[:2]
    near = [
        s for s in everything if bool(np.all(s.vertices.max(axis=0) > low) and np.all(s.vertices.min(axis=0) < high))
    ]
    corners = _triangles(near or shade)
    best, share = middle, -1.0
    for t in (0.5, 0.62, 0.38, 0.74, 0.26, 0.86, 0.14):
        place = np.array((middle[0], middle[1], low[2] + t * (high[2] - low[2])))
        if any(_touches(place, core) for core in own):
            continue
        gets_out = _escape(place, corners)
        if gets_out > share + 0.05:
            best, share = place, gets_out
    closed = share < _CLOSED
    radius = _BULB
    if closed:
        best = (low + high) / 2
        radius = _WALL * float(np.linalg.norm((high - low)[:2])) / 2 / math.sqrt(2.0)
        radius = max(_BULB, radius, min(_WALL * (high[2] - low[2]) / 2, 0.4))
    else:
        radius = min(_BULB, max(0.004, 0.25 * float(min(high[:2] - low[:2]))))
    at, a, b = (_in_room(proxy, p) for p in (best, low, high))
    box = (tuple(np.minimum(a, b).tolist()), tuple(np.maximum(a, b).tolist()))
    return Bulb(at, radius, 1.0 if closed else share, box)


def _touches(place: Floats, core: Shape) -> bool:
    """Whether a light there would be inside its bulb, or all but touch it."""
    low, high = core.vertices.min(axis=0) - 0.004, core.vertices.max(axis=0) + 0.004
    return bool(np.all(place > low) and np.all(place < high))


def _triangles(shapes: Sequence[Shape]) -> Floats:
    """All faces as triangles, (N, 3, 3)."""
    rows = []
    for shape in shapes:
        for face in shape.faces:
            rows += [(shape.vertices[face[0]], shape.vertices[face[i]], shape.vertices[face[i + 1]])
                     for i in range(1, len(face) - 1)]  # fmt: skip
    return np.array(rows, dtype=float).reshape(-1, 3, 3)


def _escape(place: Floats, corners: Floats) -> float:
    """The share of directions from a place that meet none of the triangles."""
    ways = directions(_RAYS)
    a, e1, e2 = corners[:, 0], corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    s = place - a
    q = np.cross(s, e1)
    p = np.cross(ways[:, None, :], e2[None])
    size = (p * e1[None]).sum(axis=2)
    with np.errstate(divide="ignore", invalid="ignore"):
        u = (p * s[None]).sum(axis=2) / size
        v = (ways @ q.T) / size
        t = (e2 * q).sum(axis=1)[None] / size
    met = (np.abs(size) > 1e-12) & (u >= 0) & (v >= 0) & (u + v <= 1) & (t > 1e-6)
    return float(1.0 - met.any(axis=1).mean())


def directions(count: int) -> Floats:
    """Unit vectors spread evenly over all directions, (count, 3)."""
    i = np.arange(count) + 0.5
    z = 1.0 - 2.0 * i / count
    angle = math.pi * (1.0 + math.sqrt(5.0)) * i
    r = np.sqrt(1.0 - z * z)
    return np.stack([r * np.cos(angle), r * np.sin(angle), z], axis=1)


def _in_room(proxy: ProxyLine, point: Floats) -> tuple[float, float, float]:
    """A place in an object's own frame as a place in the room."""
    c, s = math.cos(math.radians(proxy.yaw)), math.sin(math.radians(proxy.yaw))
    x, y, z = (float(v) for v in point)
    cx, cy, cz = proxy.centre
    return (cx + c * x - s * y, cy + s * x + c * y, cz - proxy.size[2] / 2 + z)
