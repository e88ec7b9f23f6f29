# SPDX-License-Identifier: GPL-3.0-or-later
"""What objects tell of the camera: each was measured in metres and seen as a box, and only some cameras join the two.

Tall things away from the camera's foot point lean outward in a perspective picture, so their boxes are larger than
their footprints and lie further out; how much, and which way, tells the camera's height and its tilt where the floor's
corners alone leave them open.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from ..artifacts.common import ImageBox, Shape
from .polygon import Floats, rectangle_corners

MOST = 60
FEWEST = 3
"""Fewer objects than that tell too little; of more, those with the largest boxes are taken."""
USUAL_SPREAD = 0.012
LEAST_SPREAD, MOST_SPREAD = 0.002, 0.06
"""Usual distance of a box's edge from where the metres put it, and how small and large it may turn out to be: parts of
the picture's longer side."""
SHARED = 0.5
"""How much an edge counts: two opposite edges share the error of the object's place."""
ROBUST_FROM = 2.0  # beyond so many standard deviations an edge is taken for a mistake more and more
ROUND_POINTS = 8


@dataclass(frozen=True)
class Seen:
    """One object as both measurements have it: centre, size (metres, in the model's own room) and yaw; and its box."""

    centre: Sequence[float]
    size: Sequence[float]
    yaw: float
    box: ImageBox
    shape: Shape = "box"


@dataclass(frozen=True)
class Evidence:
    """The objects as arrays.

    Attributes:
        points: (K, P, 2) outlines of the footprints as parts of the stated room's width and depth, origin at its middle.
        low, high: (K,) metres of base and top. edges: (K, 4) box in pixels: x and y minimum, x and y maximum.
        size: picture in pixels. area: of the stated room's rectangle, square metres.
        spread: pixels, standard deviation of an edge.
    """

    points: Floats
    low: Floats
    high: Floats
    edges: Floats
    size: Floats
    area: float
    spread: float

    @staticmethod
    def of(objects: Sequence[Seen], room: tuple[float, float], image_size: tuple[int, int]) -> Evidence | None:
        """Take what can be used; None when that is too little."""
        usable = sorted((o for o in objects if o.box.area > 1.0), key=lambda o: -o.box.area)[:MOST]
        if len(usable) < FEWEST:
            return None
        size = np.array(image_size, dtype=float)
        points = ROUND_POINTS if any(o.shape == "round" for o in usable) else 4
        unit = np.tile(size, 2) / 1000.0
        return Evidence(
            points=np.stack([_outline(o, points) for o in usable]) / np.array(room),
            low=np.array([o.centre[2] - o.size[2] / 2 for o in usable]),
            high=np.array([o.centre[2] + o.size[2] / 2 for o in usable]),
            edges=np.array([(o.box.x_min, o.box.y_min, o.box.x_max, o.box.y_max) for o in usable]) * unit,
            size=size,
            area=room[0] * room[1],
            spread=USUAL_SPREAD * float(size.max()),
        )

    def points_in(self, corners: Floats) -> tuple[Floats, Floats]:
        """Every outline at its base and at its top in the metres of floors (B, N, 2): (B, 2KP, 2) across, (B, 2KP) up.

        The stated room is stretched over the floor's bounding rectangle; heights follow the mean of both directions.
        """
        least, most = corners.min(axis=1), corners.max(axis=1)
        extent, middle = most - least, (least + most) / 2
        count, each = self.points.shape[:2]
        flat = self.points.reshape(1, count * each, 2) * extent[:, None] + middle[:, None]
        stretch = np.sqrt(np.maximum(1e-9, extent[:, 0] * extent[:, 1]) / self.area)
        levels = np.concatenate([np.repeat(self.low, each), np.repeat(self.high, each)])
        return np.concatenate([flat, flat], axis=1), levels[None] * stretch[:, None]

    def errors(self, pixels: Floats) -> Floats:
        """Box as seen less box as given, pixels (B, K, 4), for the pixels (B, 2KP, 2) of `points_in`."""
        count, each = self.points.shape[:2]
        seen = pixels.reshape(len(pixels), 2, count, each, 2)
        # Behind the camera: as far off as the picture is large. Boxes end at the picture's edge.
        seen = np.clip(np.nan_to_num(seen, nan=-1e5), -self.size, 2 * self.size)
        edges = np.concatenate([seen.min(axis=(1, 3)), seen.max(axis=(1, 3))], axis=2)
        result: Floats = np.clip(edges, 0.0, np.tile(self.size, 2)) - self.edges
        return result

    def residuals(self, errors: Floats) -> Floats:
        """Errors (B, K, 4) in standard deviations, large ones weighted down (Cauchy): (B, 4K)."""
        relative = errors.reshape(len(errors), -1) / self.spread / ROBUST_FROM
        result: Floats = np.sign(relative) * ROBUST_FROM * np.sqrt(SHARED * np.log1p(relative**2))
        return result

    def with_spread(self, errors: Floats) -> Evidence:
        """The same with the standard deviation that these errors (K, 4) show, robustly."""
        found = 1.4826 * float(np.median(np.abs(errors)))
        least, most = (part * float(self.size.max()) for part in (LEAST_SPREAD, MOST_SPREAD))
        return replace(self, spread=min(most, max(least, found)))


def _outline(item: Seen, points: int) -> Floats:
    """So many points (P, 2) on the footprint's outline, metres; a box repeats its corners."""
    if item.shape != "round":
        corners: Floats = rectangle_corners(item.centre, item.size, item.yaw)[np.arange(points) % 4]
        return corners
    angles = 2 * math.pi * np.arange(points) / points
    own = np.column_stack([np.cos(angles) * item.size[0] / 2, np.sin(angles) * item.size[1] / 2])
    cos, sin = math.cos(math.radians(item.yaw)), math.sin(math.radians(item.yaw))
    turned: Floats = own @ np.array(((cos, sin), (-sin, cos))) + np.array(item.centre[:2])
    return turned
