# SPDX-License-Identifier: GPL-3.0-or-later
"""Flat rectangular faces in the room, and the reference picture seen straight onto one: metric, with what is hidden left out."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from ..artifacts.camera import CameraModel
from ..artifacts.layout import ProxyLine
from ..geometry.camera import Projector
from ..geometry.polygon import Floats, PolygonLike, edges
from .pixels import Mask, Pixels, sampled

MOST_PER_METRE = 400.0
MOST_SIDE = 1024
LEAST_SIDE = 8


@dataclass(frozen=True)
class Face:
    """A rectangle in the room.

    Attributes:
        corner: its lower left corner seen from where it faces, metres; right, up: unit vectors along its sides.
        size: metres along right and up.
    """

    corner: Floats
    right: Floats
    up: Floats
    size: tuple[float, float]

    @property
    def normal(self) -> Floats:
        """Unit vector to the side from which it is seen."""
        found: Floats = np.cross(self.right, self.up)
        return found

    def points(self, across: Floats, along: Floats) -> Floats:
        """Points (N, 3) at metres (N,) along right and up."""
        found: Floats = self.corner + across[:, None] * self.right + along[:, None] * self.up
        return found

    def widened(self, left: float, below: float, right: float, above: float) -> Face:
        """The same plane with its sides moved outwards by metres."""
        corner = self.corner - left * self.right - below * self.up
        return replace(self, corner=corner, size=(self.size[0] + left + right, self.size[1] + below + above))


def floor_face(floor: PolygonLike, turn: float = 0.0) -> Face:
    """The floor's bounding rectangle whose sides are turned by degrees counter-clockwise from the room's."""
    angle = math.radians(turn)
    right = np.array((math.cos(angle), math.sin(angle), 0.0))
    up = np.array((-right[1], right[0], 0.0))
    points = np.array([(float(p[0]), float(p[1]), 0.0) for p in floor])
    across, along = points @ right, points @ up
    corner = across.min() * right + along.min() * up
    return Face(corner, right, up, (float(np.ptp(across)), float(np.ptp(along))))


def top_face(proxy: ProxyLine, low: Sequence[float], high: Sequence[float], z: float) -> Face:
    """A level rectangle on an object.

    Args:
        low, high: its corners (x, y) in the object's own frame, metres from the middle of its base; z above the base.
    """
    right, up = own_axes(proxy)
    base = np.array((proxy.centre[0], proxy.centre[1], proxy.centre[2] - proxy.size[2] / 2 + z))
    return Face(base + low[0] * right + low[1] * up, right, up, (high[0] - low[0], high[1] - low[1]))


def front_face(proxy: ProxyLine, low: Sequence[float], high: Sequence[float], y: float) -> Face:
    """An upright rectangle on an object that looks to the object's front (-Y).

    Args:
        low, high: its corners (x, z) in the object's own frame, metres from the middle of its base; y: where it stands.
    """
    right, back = own_axes(proxy)
    base = np.array((proxy.centre[0], proxy.centre[1], proxy.centre[2] - proxy.size[2] / 2)) + y * back
    up = np.array((0.0, 0.0, 1.0))
    return Face(base + low[0] * right + low[1] * up, right, up, (high[0] - low[0], high[1] - low[1]))


def own_axes(proxy: ProxyLine) -> tuple[Floats, Floats]:
    """An object's own +X and +Y in the room."""
    angle = math.radians(proxy.yaw)
    right = np.array((math.cos(angle), math.sin(angle), 0.0))
    return right, np.array((-right[1], right[0], 0.0))


@dataclass(frozen=True)
class Rectified:
    """A face as the picture shows it, seen straight on, row 0 at its upper side.

    Attributes:
        pixels: linear light; seen: where the picture shows the face itself.
        scale: pixels for a metre, the same both ways.
        detail: pixels of the reference picture for a metre of the face: along its clearer and its less clear direction.
    """

    pixels: Pixels
    seen: Mask
    scale: float
    detail: tuple[float, float]

    @property
    def share(self) -> float:
        """Share of the face that is seen."""
        return float(self.seen.mean()) if self.seen.size else 0.0


def detail_of(camera: CameraModel, face: Face) -> tuple[float, float]:
    """Picture pixels for a metre in the middle of a face, along its clearest and least clear direction; 0 when unseen."""
    lens = Projector.of(camera)
    centre = face.points(np.array((face.size[0] / 2,)), np.array((face.size[1] / 2,)))
    toward = lens.position - centre[0] if lens.perspective else lens.rotation[:, 2]
    if float(toward @ face.normal) <= 1e-9:
        return 0.0, 0.0
    step = 1e-3
    pixels = lens.pixels(np.concatenate([centre, centre + step * face.right, centre + step * face.up]))
    if not np.isfinite(pixels).all():
        return 0.0, 0.0
    jacobian = np.stack([pixels[1] - pixels[0], pixels[2] - pixels[0]], axis=1) / step
    clear, unclear = np.linalg.svd(jacobian, compute_uv=False)
    return float(clear), float(unclear)


def rectify(
    picture: Pixels, camera: CameraModel, face: Face, hidden: Mask, scale: float | None = None
) -> Rectified | None:
    """The picture resampled onto a face; None where the camera does not see it or it is too small.

    Args:
        picture: linear light, of the size that the camera knows; hidden: pixels of it that show something else.
        scale: pixels for a metre; never more than the picture has, which is also what None takes.
    """
    clear, unclear = detail_of(camera, face)
    if clear <= 0:
        return None
    longest = max(face.size)
    scale = min(scale or clear, clear, MOST_PER_METRE, MOST_SIDE / longest)
    columns, rows = round(face.size[0] * scale), round(face.size[1] * scale)
    if min(columns, rows) < LEAST_SIDE:
        return None
    across = (np.arange(columns) + 0.5) / columns * face.size[0]
    along = (1.0 - (np.arange(rows) + 0.5) / rows) * face.size[1]
    grid = [g.ravel() for g in np.meshgrid(across, along)]
    where = Projector.of(camera).pixels(face.points(grid[0], grid[1])).reshape(rows, columns, 2)
    height, width = picture.shape[:2]
    x, y = where[..., 0] * width / camera.image_size[0], where[..., 1] * height / camera.image_size[1]
    seen = np.isfinite(x) & np.isfinite(y) & (x > 0.5) & (x < width - 0.5) & (y > 0.5) & (y < height - 0.5)
    x, y = np.where(seen, x, 0.5), np.where(seen, y, 0.5)
    seen &= ~hidden[np.clip(y.astype(int), 0, height - 1), np.clip(x.astype(int), 0, width - 1)]
    pixels = np.zeros((rows, columns, 3), dtype=np.float32)
    pixels[seen] = sampled(picture, x[seen], y[seen])
    return Rectified(pixels, seen, scale, (clear, unclear))


def inside_polygon(face: Face, shape: tuple[int, ...], floor: PolygonLike) -> Mask:
    """Which pixels of a level face lie over a polygon of the floor."""
    rows, columns = shape[:2]
    across = (np.arange(columns) + 0.5) / columns * face.size[0]
    along = (1.0 - (np.arange(rows) + 0.5) / rows) * face.size[1]
    grid = [g.ravel() for g in np.meshgrid(across, along)]
    points = face.points(grid[0], grid[1])
    x, y = points[:, 0], points[:, 1]
    inside = np.zeros(len(points), dtype=bool)
    for (ax, ay), (bx, by) in edges(floor):
        if ay == by:
            continue
        crosses = ((ay > y) != (by > y)) & (x < ax + (y - ay) * (bx - ax) / (by - ay))
        inside ^= crosses
    return inside.reshape(rows, columns)
