# SPDX-License-Identifier: GPL-3.0-or-later
"""Foliage: many leaf blades round a stem, as one shape of thin two-sided sheets."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from .budget import spend_vertices
from .checks import choice, number, positive, whole
from .numbers import rand
from .rings import Faces, placed
from .ripples import seed_of
from .shape import Floats, Shape
from .solids import ORIGIN

BLADES: dict[str, tuple[float, ...]] = {
    "oval": (0.12, 0.72, 1.0, 0.94, 0.68, 0.30, 0.0),
    "lance": (0.30, 0.80, 1.0, 0.86, 0.62, 0.32, 0.0),
    "heart": (0.62, 1.0, 0.96, 0.78, 0.52, 0.22, 0.0),
    "strap": (0.75, 0.95, 1.0, 1.0, 0.92, 0.62, 0.0),
    "round": (0.55, 0.95, 1.0, 0.98, 0.84, 0.5, 0.0),
}
"""Half widths along a leaf, from its stalk to its tip, as shares of the widest."""
GOLDEN = math.pi * (3 - math.sqrt(5))


def leaves(
    count: Any, length: Any, width: Any, height: Any = 0.3, spread: Any = 0.5, droop: Any = 0.5, kind: Any = "oval",
    at: Any = ORIGIN, seed: Any = 0,
) -> Shape:  # fmt: skip
    """`count` leaves that grow from a stem standing at `at`, spiralling up over `height`.

    Args:
        length, width: of one leaf. spread: 0 upright to 1 flat. droop: how far the tips bend down, 0 to 1.
        kind: "oval", "lance", "heart", "strap" or "round".
    """  # fmt: skip
    number_of = whole("leaves", "count", count, 1, 3000)
    long, wide = positive("leaves", "length", length), positive("leaves", "width", width)
    tall, flat = number("leaves", "height", height, 0.0, 20.0), number("leaves", "spread", spread, 0.0, 1.0)
    fall = number("leaves", "droop", droop, 0.0, 1.0)
    profile = BLADES[choice("leaves", "kind", kind, tuple(BLADES))]
    spend_vertices(number_of * 3 * len(profile))
    mark = seed_of(seed)
    vertices: list[Floats] = []
    faces: Faces = []
    for i in range(number_of):
        name = f"{mark}/{i}"
        size = rand(name + "size", 0.72, 1.0)
        rise = (i + 0.5) / number_of
        tilt = math.radians(8 + 78 * flat * (1.15 - 0.75 * rise) + rand(name + "tilt", -8, 8))
        made = blade(long * size, wide * size / 2, profile, tilt, fall * rand(name + "droop", 0.6, 1.2))
        turned = i * GOLDEN + rand(name + "turn", -0.3, 0.3)
        c, s = math.cos(turned), math.sin(turned)
        spot = made @ np.array([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]]) + (0.0, 0.0, tall * rise)
        faces += [tuple(v + 3 * len(profile) * i for v in face) for face in blade_faces(len(profile))]
        vertices.append(spot)
    return placed("leaves", np.concatenate(vertices), faces, at, smooth=True)


def blade(length: float, half: float, profile: tuple[float, ...], tilt: float, droop: float) -> Floats:
    """One leaf growing from the origin towards +X: left edge, midrib and right edge at each step, array (3 n, 3)."""
    steps = len(profile)
    points = np.zeros((steps, 3, 3))
    x = z = 0.0
    for i in range(steps):
        share = i / (steps - 1)
        angle = math.pi / 2 - tilt - droop * 2.0 * share * share
        if i:
            x += length / (steps - 1) * math.cos(angle)
            z += length / (steps - 1) * math.sin(angle)
        across, lift = half * profile[i], 0.35 * half * profile[i]
        back = (-lift * math.sin(angle), lift * math.cos(angle))
        points[i] = [(x + back[0], across, z + back[1]), (x, 0.0, z), (x + back[0], -across, z + back[1])]
    return points.reshape(-1, 3)


def blade_faces(steps: int) -> Faces:
    """Faces of one leaf, upper side up."""
    found: Faces = []
    for i in range(steps - 1):
        a = 3 * i
        if i == steps - 2:  # the tip's three points are one
            found += [(a + 1, a + 4, a), (a + 2, a + 4, a + 1)]
        else:
            found += [(a + 1, a + 4, a + 3, a), (a + 2, a + 5, a + 4, a + 1)]
    return found
