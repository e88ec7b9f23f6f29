# SPDX-License-Identifier: GPL-3.0-or-later
"""Stuffed things: seat cushions with seams, pillows, tufted panels. They fill `size` exactly; `at` is their centre."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from .arguments import by_kind
from .budget import spend_vertices
from .checks import choice, fail, flag, number, positive, sizes, whole
from .profiles import tube
from .rings import Faces, placed, ringed, skin
from .ripples import cells, fitted, ripples, seed_of
from .shape import Floats, Shape, remeshed
from .solids import ORIGIN
from .unwrap import corner_uvs


@by_kind
def cushion(
    size: Any, puff: Any = 0.25, radius: Any = 0.04, seam: Any = True, sag: Any = 0.0, at: Any = ORIGIN, seed: Any = 0
) -> Shape:
    """A seat or back cushion with crowned faces and piping (seam).

    Args:
        puff: 0 flat to 1 round. sag: metres that its middle is sat in.
    """
    w, d, h = sizes("cushion", "size", size)
    bulge = number("cushion", "puff", puff, 0.0, 1.0)
    dent = number("cushion", "sag", sag, 0.0, h)
    bend = min(positive("cushion", "radius", radius), 0.45 * min(w, d, h))
    half = np.array((w, d, h)) / 2
    ball, faces = cube_grid(tuple(max(5, min(16, round(2 * side / 0.035))) for side in half.tolist()))
    flat = ball * half
    inner = np.clip(flat, bend - half, half - bend)
    away = flat - inner
    length = np.linalg.norm(away, axis=1, keepdims=True)
    body = inner + np.where(length > 1e-9, away / np.maximum(length, 1e-9) * bend, 0.0)
    x, y, z = (body / half).T
    crown = np.stack(
        [x * (1 - y * y) * (1 - z * z), y * (1 - x * x) * (1 - z * z), z * (1 - x * x) * (1 - y * y)], axis=1
    )
    body = body + crown * bulge * np.minimum(half, 0.35 * half.min() + 0.02)
    body[:, 2] += (
        0.006 * bulge * ripples(seed_of(seed), body[:, 0], body[:, 1], 0.22) * np.sign(z) * (1 - x**4) * (1 - y**4)
    )
    body = fitted(body, (w, d, h))
    if dent:
        top = np.clip(z, 0, 1) * (1 - x * x) ** 2 * (1 - y * y) ** 2
        body[:, 2] -= dent * top
    found = placed("cushion", body, faces, at, smooth=True, crease=60.0)
    if not flag("cushion", "seam", seam):
        return found
    cord = min(0.007, 0.15 * bend + 0.002)
    cords = []
    for side in (-1.0, 1.0):
        rim = body[(ball[:, 2] == side) & (np.abs(ball[:, :2]).max(axis=1) == 1.0)]
        turned = np.arctan2(rim[:, 1] / d, rim[:, 0] / w)
        cords.append(tube(rim[np.argsort(turned)].tolist(), cord, segments=5, closed=True, at=at))
    return welded([found, *cords])


def welded(shapes: list[Shape]) -> Shape:
    """One shape of several, which stay separate bodies."""
    faces: list[tuple[int, ...]] = []
    start = 0
    for shape in shapes:
        faces += [tuple(i + start for i in face) for face in shape.faces]
        start += shape.vertex_count
    uvs = np.concatenate([corner_uvs(shape) for shape in shapes])
    crease = max(shape.crease for shape in shapes)
    return remeshed(shapes[0], np.concatenate([s.vertices for s in shapes]), faces, uvs=uvs, crease=crease)


def cube_grid(cuts: tuple[int, ...]) -> tuple[Floats, Faces]:
    """The surface of the cube -1..1 cut into cells along x, y and z, as one closed mesh."""
    spend_vertices(2 * sum((cuts[a] + 1) * (cuts[b] + 1) for a, b in ((0, 1), (1, 2), (0, 2))))
    index: dict[tuple[int, int, int], int] = {}
    points: list[tuple[float, float, float]] = []
    faces: Faces = []

    def vertex(cell: tuple[int, int, int]) -> int:
        if cell not in index:
            index[cell] = len(points)
            x, y, z = (2 * c / n - 1 for c, n in zip(cell, cuts, strict=True))
            points.append((x, y, z))
        return index[cell]

    for axis in range(3):
        u, v = (axis + 1) % 3, (axis + 2) % 3
        for end in (0, cuts[axis]):
            for i in range(cuts[u]):
                for j in range(cuts[v]):
                    ring = []
                    for a, b in ((i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)):
                        cell = [0, 0, 0]
                        cell[axis], cell[u], cell[v] = end, a, b
                        ring.append(vertex((cell[0], cell[1], cell[2])))
                    faces.append(tuple(ring if end else ring[::-1]))
    return np.array(points), faces


@by_kind
def pillow(size: Any, plump: Any = 0.6, ears: Any = 0.5, at: Any = ORIGIN, seed: Any = 0) -> Shape:
    """Lying flat; turn it to lean.

    Args:
        plump: 0 limp to 1 stuffed. ears: how far edges draw in between the corners, 0 to 1.
    """
    w, d, h = sizes("pillow", "size", size)
    full, drawn = number("pillow", "plump", plump, 0.0, 1.0), number("pillow", "ears", ears, 0.0, 1.0)
    count = 19
    spend_vertices(2 * count * count)
    line = np.sin(np.linspace(-1, 1, count) * math.pi / 2)
    u, v = np.meshgrid(line, line)
    pull = 0.16 * drawn
    x = u * (1 - pull * (1 - v * v) * np.abs(u)) * w / 2
    y = v * (1 - pull * (1 - u * u) * np.abs(v)) * d / 2
    power = 1.5 + 2.5 * full
    rise = ((1 - np.abs(u) ** power) * (1 - np.abs(v) ** power)) ** (0.75 - 0.3 * full)
    mark = seed_of(seed)
    crease = ripples((mark, "crease"), x, y, 0.16 * min(w, d) + 0.04) * (1 - rise) * rise
    upper = rise * (1 + 0.10 * ripples((mark, "upper"), x, y, 0.45 * min(w, d))) + 0.22 * crease
    lower = rise * (0.9 + 0.05 * ripples((mark, "lower"), x, y, 0.45 * min(w, d))) + 0.10 * crease
    edge = (np.abs(u) == 1) | (np.abs(v) == 1)
    upper[edge] = lower[edge] = 0.0
    top = np.stack([x, y, np.maximum(upper, 0)], axis=2).reshape(-1, 3)
    bottom = np.stack([x, y, -np.maximum(lower, 0)], axis=2).reshape(-1, 3)
    rim = edge.ravel()
    number_below = np.where(rim, np.arange(count * count), 0)
    number_below[~rim] = count * count + np.arange(int((~rim).sum()))
    faces = cells(count, count)
    faces += [tuple(int(number_below[i]) for i in face[::-1]) for face in faces]
    vertices = fitted(np.concatenate([top, bottom[~rim]]), (w, d, h))
    return placed("pillow", vertices, faces, at, smooth=True, crease=75.0)


@by_kind
def tufted(size: Any, columns: Any = 4, rows: Any = 2, depth: Any = 0.03, at: Any = ORIGIN) -> Shape:
    """An upright panel, its front (-Y) buttoned: headboards, sofa backs."""
    w, d, h = sizes("tufted", "size", size)
    across, up = whole("tufted", "columns", columns, 1, 24), whole("tufted", "rows", rows, 1, 24)
    dent = number("tufted", "depth", depth, 0.0, d)
    if dent > 0.8 * d:
        raise fail("tufted", "depth must be less than 0.8 of the panel's own depth")
    fine = (min(96, 12 * across), 3, min(96, 12 * up))
    ball, faces = without_back(*cube_grid(fine))
    half = np.array((w, d, h)) / 2
    body = ball * half
    bend = min(0.02, 0.4 * d)
    inner = np.clip(body, bend - half, half - bend)
    away = body - inner
    length = np.linalg.norm(away, axis=1, keepdims=True)
    body = inner + np.where(length > 1e-9, away / np.maximum(length, 1e-9) * bend, 0.0)
    a, b = (ball[:, 0] + 1) / 2 * across, (ball[:, 2] + 1) / 2 * up
    one, two = np.sin(math.pi * (a + b) / 2) ** 2, np.sin(math.pi * (a - b + up % 2) / 2) ** 2
    crease = np.maximum((1 - one) ** 6, (1 - two) ** 6)
    button = ((1 - one) * (1 - two)) ** 3
    border = np.clip(8 * (1 - np.abs(ball[:, 0])), 0, 1) * np.clip(8 * (1 - np.abs(ball[:, 2])), 0, 1)
    body[:, 1] += np.where(ball[:, 1] == -1, dent * (0.45 * crease + 0.55 * button) * border, 0.0)
    return placed("tufted", fitted(body, (w, d, h)), faces, at, smooth=True, crease=75.0)


def without_back(points: Floats, faces: Faces) -> tuple[Floats, Faces]:
    """A cube's surface with its back (+Y) as one face, which nobody sees."""
    behind = points[:, 1] == 1
    front = [face for face in faces if not all(behind[v] for v in face)]
    edges = {
        (b, a) for face in front for a, b in zip(face, face[1:] + face[:1], strict=True) if behind[a] and behind[b]
    }
    follow = dict(edges)
    loop = [next(iter(sorted(follow)))]
    while (following := follow[loop[-1]]) != loop[0]:
        loop.append(following)
    front.append(tuple(loop))
    used = sorted({v for face in front for v in face})
    new = {v: i for i, v in enumerate(used)}
    return points[used], [tuple(new[v] for v in face) for face in front]


@by_kind
def pouf(size: Any, style: Any = "knit", at: Any = ORIGIN, seed: Any = 0) -> Shape:
    """Round; style "knit" or "panels"."""
    w, d, h = sizes("pouf", "size", size)
    knit = choice("pouf", "style", style, ("knit", "panels")) == "knit"
    around, up = (96, 36) if knit else (64, 18)
    spend_vertices(around * (up - 1) + 2)
    turns = np.linspace(0, math.tau, around, endpoint=False)[None, :]
    rise = (np.arange(1, up) / up)[:, None]
    tilt = math.pi * (rise - 0.5)
    out = np.maximum(np.cos(tilt), 0) ** 0.42
    z = np.sign(np.sin(tilt)) * np.abs(np.sin(tilt)) ** 0.8
    if knit:
        column = turns / math.tau * 24
        side = column % 1.0
        plait = np.cos(math.tau * (9 * rise + np.abs(side - 0.5))) * np.sin(math.pi * side)
        relief = 0.028 * plait - 0.05 * np.abs(np.cos(math.pi * column)) ** 6
    else:
        relief = -0.05 * np.exp(-(((turns / math.tau * 8 + 0.5) % 1.0 - 0.5) ** 2) / 0.003) + 0.0 * rise
    fade = np.minimum(1, 3.2 * np.cos(tilt))
    out = out * (1 + relief * fade) * (1 + 0.012 * ripples(seed_of(seed), np.cos(turns), np.sin(turns) + rise, 0.9))
    rings = [
        np.stack([o * np.cos(turns[0]), o * np.sin(turns[0]), np.full(around, k)], axis=1)
        for o, k in zip(out, z[:, 0], strict=True)
    ]
    poles = [np.array([(0.0, 0.0, z[0, 0] - 0.004)]), np.array([(0.0, 0.0, z[-1, 0] - (0.015 if knit else 0.05))])]
    vertices, faces = skin([poles[0], *rings, poles[1]])
    return ringed("pouf", fitted(vertices, (w, d, h)), faces, at, (1, *[around] * (up - 1), 1), crease=180.0)
