# SPDX-License-Identifier: GPL-3.0-or-later
"""What of the picture shows something in front of a face: every solid that reaches above the face's plane, drawn as it is seen."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterable, Sequence
from dataclasses import dataclass

import numpy as np
from PIL import Image, ImageDraw

from ..artifacts.camera import CameraModel
from ..artifacts.common import ImageBox
from ..artifacts.layout import Layout
from ..geometry.camera import Projector
from ..geometry.footprint import box_corners
from ..geometry.polygon import Floats
from ..objects.colours import convex_hull
from .pixels import Mask
from .planes import Face

GROWN = 0.04
"""Metres by which objects are grown: places are not exact, and contact shadows lie round them."""
ABOVE = 0.004
"""Metres above a plane that are no solid in front of it."""
_NEAR = 0.05
_DOOR_DOUBT = 12.0


@dataclass(frozen=True)
class Solid:
    """A convex body of the room: whose it is, and its corners (N, 3) in metres."""

    owner: str
    corners: Floats


def solids_of(layout: Layout, grow: float = GROWN) -> list[Solid]:
    """The objects, walls and doors of a layout, objects grown a little."""
    found = []
    for proxy in layout.proxies:
        wide = (proxy.size[0] + 2 * grow, proxy.size[1] + 2 * grow, proxy.size[2])
        found.append(Solid(proxy.id, box_corners(proxy.centre, wide, proxy.yaw)))
    for wall in layout.walls:
        outside = 0.0 if not wall.partition else wall.thickness / 2
        found.append(Solid(wall.id, _slab(wall.start, wall.end, -outside, wall.thickness - outside, 0.0, wall.height)))
    for door in layout.doors:
        # Which side of its wall a leaf swings to depends on the wall's direction; outside of the room it hides nothing.
        for side in (1.0, -1.0):
            found.append(Solid(door.id, _leaf(door.start, door.end, door.height, door.open, side)))
    return found


def _slab(start: Sequence[float], end: Sequence[float], inner: float, outer: float, low: float, high: float) -> Floats:
    """A wall's body: from `inner` to `outer` metres to the right of the line (the room is on its left)."""
    a, b = np.array(start, dtype=float), np.array(end, dtype=float)
    length = float(np.linalg.norm(b - a)) or 1.0
    along = (b - a) / length
    outward = np.array((along[1], -along[0]))
    flat = [a + inner * outward, b + inner * outward, a + outer * outward, b + outer * outward]
    return np.array([(x, y, z) for x, y in flat for z in (low, high)])


def _leaf(start: Sequence[float], end: Sequence[float], height: float, degrees: float, side: float) -> Floats:
    """A door's leaf with the room that it may take, since nobody knows its angle exactly."""
    hinge, edge = np.array(start, dtype=float), np.array(end, dtype=float) - np.array(start, dtype=float)
    points = [hinge]
    for angle in (max(0.0, degrees - _DOOR_DOUBT), degrees, degrees + _DOOR_DOUBT if degrees > 1 else 0.0):
        cos, sin = math.cos(math.radians(angle)), side * math.sin(math.radians(angle))
        points.append(hinge + 1.03 * np.array((edge[0] * cos - edge[1] * sin, edge[0] * sin + edge[1] * cos)))
    return np.array([(x, y, z) for x, y in points for z in (0.0, height)])


def hidden_pixels(
    camera: CameraModel,
    size: tuple[int, int],
    face: Face,
    solids: Iterable[Solid],
    without: Collection[str] = (),
    boxes: Iterable[ImageBox] = (),
) -> Mask:
    """The pixels of the picture that show something before the face's plane.

    Args:
        size: the picture's (width, height). without: owners that do not count: what the face belongs to.
        boxes: further parts of the picture that show something else, 0-1000.
    """
    lens = Projector.of(camera)
    scale = np.array(size) / lens.size
    image = Image.new("1", size)
    draw = ImageDraw.Draw(image)
    normal = face.normal
    for solid in solids:
        heights = (solid.corners - face.corner) @ normal
        if solid.owner in without or heights.max() < ABOVE:
            continue
        points = _cut(solid.corners, heights)
        if lens.perspective:
            points = points[lens.depth(points) > _NEAR]
        if len(points) < 3:
            continue
        hull = convex_hull(lens.pixels(points) * scale)
        if len(hull) >= 3:
            draw.polygon([(float(x), float(y)) for x, y in hull], fill=1)
    for box in boxes:
        draw.rectangle(
            (
                box.x_min * size[0] / 1000,
                box.y_min * size[1] / 1000,
                box.x_max * size[0] / 1000,
                box.y_max * size[1] / 1000,
            ),
            fill=1,
        )
    return np.array(image, dtype=bool)


def _cut(corners: Floats, heights: Floats) -> Floats:
    """The corners of the part of a convex body that lies before a plane, going by each corner's height over it."""
    above = heights >= 0
    if above.all():
        return corners
    kept = [corners[above]]
    a, b = np.nonzero(above)[0], np.nonzero(~above)[0]
    one, other = np.meshgrid(a, b)
    one, other = one.ravel(), other.ravel()
    # Lines between any two corners stay inside a convex body.
    part = heights[one] / (heights[one] - heights[other])
    kept.append(corners[one] + part[:, None] * (corners[other] - corners[one]))
    return np.concatenate(kept)
