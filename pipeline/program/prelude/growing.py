# SPDX-License-Identifier: GPL-3.0-or-later
"""Foliage: many leaves round a stem, as one shape. Thin leaves are single sheets, seen from both sides."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np

from .arguments import by_kind
from .budget import spend_vertices
from .checks import choice, number, positive, whole
from .numbers import rand
from .rings import Faces, placed
from .ripples import seed_of
from .shape import Floats, Shape
from .solids import ORIGIN

Profile = tuple[tuple[float, float], ...]
BLADES: dict[str, Profile] = {
    "oval": ((0, 0.05), (0.15, 0.07), (0.28, 0.78), (0.52, 1.0), (0.8, 0.56), (1, 0)),
    "lance": ((0, 0.2), (0.14, 0.6), (0.4, 1.0), (0.72, 0.66), (1, 0)),
    "heart": ((0, 0.04), (0.26, 0.04), (0.27, 0.66), (0.4, 1.0), (0.62, 0.86), (0.84, 0.42), (1, 0)),
    "strap": ((0, 0.7), (0.15, 0.9), (0.4, 1.0), (0.65, 0.98), (0.85, 0.72), (0.96, 0.3), (1, 0)),
    "round": ((0, 0.03), (0.34, 0.03), (0.38, 0.5), (0.5, 0.9), (0.68, 1.0), (0.86, 0.82), (0.96, 0.46), (1, 0)),
    "grass": ((0, 0.8), (0.3, 1.0), (0.6, 0.8), (0.85, 0.45), (1, 0)),
    "succulent": ((0, 0.3), (0.25, 0.62), (0.55, 0.95), (0.78, 1.0), (0.93, 0.66), (1, 0)),
    "fern": ((0, 1.0), (1, 0)),
}
"""Half widths along a leaf, from where it grows to its tip: (share of the length, share of the widest)."""
FOLDS = {"strap": 0.45, "grass": 0.5, "lance": 0.4, "round": 0.12, "heart": 0.25}
GOLDEN = math.pi * (3 - math.sqrt(5))
FROND = 12
"""Pairs of leaflets of a fern's frond."""


@by_kind
def leaves(
    count: Any, length: Any, width: Any, height: Any = 0.3, spread: Any = 0.5, droop: Any = 0.5, kind: Any = "oval",
    at: Any = ORIGIN, seed: Any = 0,
) -> Shape:  # fmt: skip
    """Round an upright stem that stands on at and is not drawn (add a tube); length and width of one.

    Args:
        height: of the stem. spread: 0 upright to 1 flat. droop: of the tips, 0 to 1.
        kind: "oval", "lance", "heart", "strap", "round", "grass", "fern" or "succulent".
    """  # fmt: skip
    number_of = whole("leaves", "count", count, 1, 3000)
    long, wide = positive("leaves", "length", length), positive("leaves", "width", width)
    tall, flat = number("leaves", "height", height, 0.0, 20.0), number("leaves", "spread", spread, 0.0, 1.0)
    fall = number("leaves", "droop", droop, 0.0, 1.0)
    form = choice("leaves", "kind", kind, tuple(BLADES))
    mark = seed_of(seed)
    one, faces, places = {"fern": frond, "succulent": fat_blade}.get(form, blade)(form)
    spend_vertices(number_of * len(one))
    vertices: list[Floats] = []
    for i in range(number_of):
        name = f"{mark}/{i}"
        rise = (i + 0.5) / number_of
        small = rand(name + "size", 0.62, 1.0) * (1.0 if form == "grass" else 1.06 - 0.34 * rise)
        tilt = math.radians(8 + 78 * flat * (1.15 - 0.75 * rise) + rand(name + "tilt", -10, 10))
        made = one * (long * small, wide * small / 2 * rand(name + "width", 0.85, 1.1), wide * small / 2)
        made = bowed(made, long * small, tilt, fall * rand(name + "droop", 0.5, 1.3), form == "fern")
        vertices.append(
            turned_leaf(made, i * GOLDEN + rand(name + "turn", -0.4, 0.4), rand(name + "roll", -0.35, 0.35))
        )
        vertices[-1][:, 2] += tall * rise
    n = len(one)
    all_faces = [tuple(v + n * i for v in face) for i in range(number_of) for face in faces]
    corners = np.array([v for face in faces for v in face])
    uvs = np.tile((places * (long, wide / 2))[corners], (number_of, 1))
    crease = 180.0 if form == "succulent" else 70.0
    return replace(placed("leaves", np.concatenate(vertices), all_faces, at, smooth=True, crease=crease), uvs=uvs)


def blade(form: str) -> tuple[Floats, Faces, Floats]:
    """A flat leaf along +X of length 1 and half width 1, folded along its rib: vertices, faces, places on the leaf."""
    profile, fold = BLADES[form], FOLDS.get(form, 0.3)
    rows = [[(x, y, fold * w), (x, 0.0, 0.0), (x, -y, fold * w)] for x, w in profile[:-1] for y in (w,)]
    points = np.array([p for row in rows for p in row] + [(1.0, 0.0, 0.0)])
    faces: Faces = []
    for i in range(len(rows) - 1):
        a = 3 * i
        faces += [(a + 1, a + 4, a + 3, a), (a + 2, a + 5, a + 4, a + 1)]
    last = 3 * (len(rows) - 1)
    faces += [(last + 1, last + 3, last), (last + 2, last + 3, last + 1)]
    return points, faces, points[:, :2].copy()


def fat_blade(form: str) -> tuple[Floats, Faces, Floats]:
    """A fleshy leaf along +X, flat above and round below, closed."""
    section = [(1.0, 0.15), (0.6, 0.24), (-0.6, 0.24), (-1.0, 0.15), (-0.6, -0.3), (0.6, -0.3)]
    rows = [[(x, w * a, w * b) for a, b in section] for x, w in BLADES[form][:-1]]
    points = np.array([p for row in rows for p in row] + [(1.0, 0.0, 0.1)])
    faces: Faces = [tuple(range(5, -1, -1))]
    for i in range(len(rows) - 1):
        faces += [(6 * i + k, 6 * i + 6 + k, 6 * i + 6 + (k + 1) % 6, 6 * i + (k + 1) % 6) for k in range(6)]
    last = 6 * (len(rows) - 1)
    faces += [(last + k, last + 6, last + (k + 1) % 6) for k in range(6)]
    return points, [face[::-1] for face in faces], points[:, :2].copy()


def frond(form: str) -> tuple[Floats, Faces, Floats]:
    """A fern's frond along +X: a rib with pairs of leaflets that grow shorter towards the tip."""
    points: list[tuple[float, float, float]] = []
    for i in range(7):
        points += [(i / 6, 0.05 * (1 - i / 6) + 0.004, 0.0), (i / 6, -0.05 * (1 - i / 6) - 0.004, 0.0)]
    faces: Faces = [(2 * i + 1, 2 * i + 3, 2 * i + 2, 2 * i) for i in range(6)]
    for i in range(FROND):
        x = 0.12 + 0.86 * i / FROND
        long = min(1.0, 0.45 + 2.2 * (x - 0.1)) * (1.04 - x) / 0.62
        long, wide = min(long, 1.0), 1.0 / FROND
        for side in (1, -1):
            start = len(points)
            tip = x + 0.45 * wide + 0.06
            points += [(x, 0.0, 0.0), (x + 0.75 * wide, 0.5 * long * side, 0.06), (tip, long * side, -0.06),
                       (x - 0.02 + 0.3 * wide, 0.5 * long * side, 0.06)]  # fmt: skip
            face = (start, start + 1, start + 2, start + 3)
            faces.append(face if side > 0 else face[::-1])
    made = np.array(points)
    return made, faces, made[:, :2].copy()


def bowed(leaf: Floats, length: float, tilt: float, droop: float, arching: bool) -> Floats:
    """The leaf growing up from the origin, `tilt` off straight up, its tip bent down more and more."""
    steps = 12
    bend = 2.4 if arching else 2.0
    angles = [math.pi / 2 - tilt - droop * bend * ((i + 0.5) / steps) ** 2 for i in range(steps)]
    x = np.concatenate([[0.0], np.cumsum([math.cos(a) for a in angles])]) * length / steps
    z = np.concatenate([[0.0], np.cumsum([math.sin(a) for a in angles])]) * length / steps
    place = np.clip(leaf[:, 0] / length, 0, 1) * steps
    angle = math.pi / 2 - tilt - droop * bend * (place / steps) ** 2
    here = np.arange(steps + 1)
    lift = leaf[:, 2]
    out = np.interp(place, here, x) - lift * np.sin(angle)
    return np.stack([out, leaf[:, 1], np.interp(place, here, z) + lift * np.cos(angle)], axis=1)


def turned_leaf(leaf: Floats, heading: float, roll: float) -> Floats:
    """The leaf rolled a little about its own line, then turned towards its heading."""
    side = leaf[:, 1] * math.cos(roll)
    lifted = leaf[:, 2] + leaf[:, 1] * math.sin(roll)
    c, s = math.cos(heading), math.sin(heading)
    return np.stack([leaf[:, 0] * c - side * s, leaf[:, 0] * s + side * c, lifted], axis=1)
