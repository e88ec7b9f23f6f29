# SPDX-License-Identifier: GPL-3.0-or-later
"""Rugs, and the threads that hang from the hems of rugs and throws."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from .arguments import by_kind
from .budget import spend_vertices
from .checks import choice, number, point, sizes
from .numbers import rand
from .outlines import rectangle
from .rings import ringed, skin
from .ripples import ripples, seed_of
from .shape import Floats, Shape, remeshed
from .solids import ORIGIN
from .unwrap import corner_uvs


def tasselled(made: Shape, roots: Floats, sides: Floats, falls: Floats, length: float, seed: Any) -> Shape:
    """The shape with a thread at every root (N, 3), hanging along `falls`; `sides` point along the hem."""
    count = len(roots)
    spend_vertices(7 * count)
    long = np.array([[length * rand((seed, "tassel", i), 0.85, 1.0)] for i in range(count)])
    lean = np.array([[rand((seed, "lean", i), -0.1, 0.1)] for i in range(count)])
    up = np.cross(sides, falls)
    ways = falls + lean * sides
    ways /= np.maximum(np.linalg.norm(ways, axis=1, keepdims=True), 1e-9)
    thin = min(0.0035, 0.12 * length)
    section = [
        thin * (math.cos(a) * sides + math.sin(a) * up) for a in (math.pi / 2, 7 * math.pi / 6, 11 * math.pi / 6)
    ]
    parts = (
        [roots + c for c in section] + [roots + 0.8 * long * ways + 1.15 * c for c in section] + [roots + long * ways]
    )
    vertices = np.stack(parts, axis=1).reshape(-1, 3)
    one = [(0, 1, 2), (0, 3, 4, 1), (1, 4, 5, 2), (2, 5, 3, 0), (3, 6, 4), (4, 6, 5), (5, 6, 3)]
    start = made.vertex_count
    faces = [*made.faces, *(tuple(v + start + 7 * i for v in f) for i in range(count) for f in one)]
    uvs = corner_uvs(made)
    added = 24 * count
    return remeshed(
        made, np.concatenate([made.vertices, vertices]), faces, uvs=np.concatenate([uvs, np.zeros((added, 2))])
    )


@by_kind
def rug(size: Any, shape: Any = "box", fringe: Any = 0.0, border: Any = 0.0, at: Any = ORIGIN, seed: Any = 0) -> Shape:
    """size (width, depth, thickness), underside at z = 0; shape "box", "round" or "hide".

    Args:
        fringe: length, within size. border: width of a band.
    """
    w, d, h = sizes("rug", "size", size)
    form = choice("rug", "shape", shape, ("box", "round", "hide"))
    length = min(number("rug", "fringe", fringe, 0.0, 0.5), 0.2 * d) if form == "box" else 0.0
    band = min(number("rug", "border", border, 0.0, 10.0), 0.4 * min(w, d - 2 * length))
    mark = seed_of(seed)
    outline, extent = rug_outline(form, w, d - 2 * length, mark)
    edge = min(0.45 * h, 0.01)
    levels = [(0.0, 0.0), (0.0, h - edge), (0.3 * edge, h - 0.3 * edge), (edge, h)]
    if band > 0.03:
        levels += [(band - 0.006, h), (band, 0.55 * h), (band + 0.006, h)]
    levels.append((levels[-1][0] + 0.02, h))
    spend_vertices(len(outline) * len(levels))
    rings = []
    for inset, z in levels:
        share = 1 - 2 * inset / extent
        rings.append(np.column_stack([outline * share, np.full(len(outline), z)]))
    vertices, faces = skin(rings)
    made = ringed("rug", vertices, faces, at, (len(outline),) * len(rings))
    if not length:
        return made
    x, y, z = point("rug", "at", at)
    count = min(300, max(2, round(w / 0.018)))
    xs = x + np.linspace(-w / 2 + 0.006, w / 2 - 0.006, count)
    roots = np.array([(a, y + side * (d / 2 - length - 0.004), z + 0.45 * h) for side in (-1, 1) for a in xs.tolist()])
    sides = np.array([(-side, 0.0, 0.0) for side in (-1, 1) for _ in range(count)])
    reach = length + 0.004
    falls = np.array([(0.0, side, -0.4 * h / reach) for side in (-1, 1) for _ in range(count)])
    return tasselled(made, roots, -sides, falls, reach, mark)


def rug_outline(form: str, w: float, d: float, mark: str) -> tuple[Floats, Floats]:
    """A rug's outline round the origin, (N, 2), and its width and depth."""
    if form == "box":
        return np.array(rectangle(w, d, min(0.012, 0.1 * min(w, d)), segments=2)), np.array((w, d))
    angles = np.linspace(0, math.tau, 72, endpoint=False)
    reach = np.ones(len(angles))
    if form == "hide":
        reach = 0.78 + 0.16 * np.cos(4 * angles + 0.4) + 0.05 * ripples(mark, np.cos(angles), np.sin(angles), 0.5)
    outline = np.stack([np.cos(angles) * reach, np.sin(angles) * reach], axis=1)
    outline *= np.array((w, d)) / np.ptp(outline, axis=0)
    return outline - (outline.max(axis=0) + outline.min(axis=0)) / 2, np.array((w, d))
