# SPDX-License-Identifier: GPL-3.0-or-later
"""Between an object's oriented box in the room and its box in the picture, both ways.

Seen from above, the top of an object is nearer to the camera than its base, so its image box is larger than its
footprint's image and lies further out (parallax). The lift undoes that, given the object's height.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np

from ..artifacts.camera import CameraModel
from ..artifacts.common import ImageBox, Shape
from .camera import GeometryError, Projector
from .least_squares import levenberg_marquardt
from .polygon import Floats, rectangle_corners

MIN_SIZE = 0.01
MAX_SIZE = 100.0
NEAR_PLANE = 0.01
# How far a hinted width-to-depth ratio is trusted against the edges of a box, as standard deviations: of the log of
# the ratio, and of an edge as a part of the box. Only used where the edges leave the ratio open.
RATIO_SPREAD = 0.25
EDGE_SPREAD = 0.02
# Wall objects seen from above: an edge of the box may be off by 3 of 1000, a guessed height on the wall by 0.5 m,
# a guessed extent up the wall by half.
WALL_EDGE_SPREAD = 3.0
WALL_Z_SPREAD = 0.5
WALL_EXTENT_SPREAD = 0.5
_EDGES = [(a, b) for a in range(8) for b in range(a + 1, 8) if bin(a ^ b).count("1") == 1]


class Lifted(NamedTuple):
    """An oriented box in the room found from an image box.

    Attributes:
        centre: (x, y, z) of the box's centre, metres.
        size: width (own x), depth (own y), height, metres.
        residual: root mean square mismatch of the four edges of the image box, 0-1000.
        iou: of the given image box with the image box of the result.
    """

    centre: tuple[float, float, float]
    size: tuple[float, float, float]
    residual: float
    iou: float


class LiftedOnWall(NamedTuple):
    """An object found on a wall.

    Attributes:
        along: metres from the wall's start to the object's middle.
        width: metres along the wall; z_min, z_max: metres above the floor.
        centre, size, yaw: the same as an oriented box that faces the room, its back on the wall.
        z_known: 0 when the given height was taken as it was, 1 when the picture alone decided it.
        residual: as in `Lifted`.
    """

    along: float
    width: float
    z_min: float
    z_max: float
    centre: tuple[float, float, float]
    size: tuple[float, float, float]
    yaw: float
    z_known: float
    residual: float


def box_corners(centre: Sequence[float], size: Sequence[float], yaw: float) -> Floats:
    """The eight corners (8, 3) of an oriented box; corner bits are x, y, z from the lowest bit."""
    flat = rectangle_corners(centre, size, yaw)[[0, 1, 3, 2]]
    corners = np.empty((8, 3))
    corners[:4, :2] = corners[4:, :2] = flat
    corners[:4, 2] = centre[2] - size[2] / 2
    corners[4:, 2] = centre[2] + size[2] / 2
    return corners


def image_box_of(
    camera: CameraModel, centre: Sequence[float], size: Sequence[float], yaw: float, shape: Shape = "box"
) -> ImageBox:
    """The box of an object in the picture, 0-1000, not clipped to the picture.

    Args:
        centre: (x, y, z) of the oriented box's centre in metres, z half-way up.
        size: width, depth, height in metres.
        yaw: degrees counter-clockwise.
        shape: "round" is the upright elliptic cylinder inside the box; anything else is the box itself.

    Raises:
        GeometryError: all of it is behind the camera. What is partly behind is cut at 1 cm in front of the camera.
    """
    lens = Projector.of(camera)
    return _as_box(lens, _extent(lens, centre, size, yaw, shape))


def _extent(lens: Projector, centre: Sequence[float], size: Sequence[float], yaw: float, shape: Shape) -> Floats:
    """Pixel extent (x_min, y_min, x_max, y_max)."""
    corners = box_corners(centre, size, yaw)
    if lens.perspective:
        depth = lens.depth(corners)
        if depth.min() < NEAR_PLANE:
            corners = _cut_near(corners, depth)
        elif shape == "round":
            return _round_extent(lens, corners)
    elif shape == "round":
        return _round_extent(lens, corners)
    pixels = lens.pixels(corners)
    return np.concatenate([pixels.min(axis=0), pixels.max(axis=0)])


def _cut_near(corners: Floats, depth: Floats) -> Floats:
    kept = [corners[i] for i in range(8) if depth[i] >= NEAR_PLANE]
    if not kept:
        raise GeometryError("The object is behind the camera.", "Move it, or fit the camera again.")
    for a, b in _EDGES:
        if (depth[a] < NEAR_PLANE) != (depth[b] < NEAR_PLANE):
            t = (NEAR_PLANE * 1.001 - depth[a]) / (depth[b] - depth[a])
            kept.append(corners[a] + t * (corners[b] - corners[a]))
    return np.array(kept)


def _round_extent(lens: Projector, corners: Floats) -> Floats:
    """Extent of the two ellipses inside the lower and the upper face, exact through their dual conics.

    The circle c + a cos t + b sin t maps to homogeneous pixels A (cos t, sin t, 1); its tangents l satisfy
    l^T A diag(1, 1, -1) A^T l = 0 (Hartley and Zisserman, 2.2.3), and l = (1, 0, -x) is the tangent at an extreme x.
    """
    extents = []
    flip = np.array((1.0, -1.0))
    for face in (corners[:4], corners[4:]):
        centre, along_x, along_y = face.mean(axis=0), (face[1] - face[0]) / 2, (face[2] - face[0]) / 2
        local = np.stack([along_x, along_y, centre - lens.position]) @ lens.rotation
        columns = np.empty((3, 3))
        columns[:2] = (local[:, :2] * flip * lens.scale).T
        columns[2] = -local[:, 2] if lens.perspective else (0.0, 0.0, 1.0)
        columns[:2] += np.outer(lens.principal, columns[2])
        dual = columns @ np.diag((1.0, 1.0, -1.0)) @ columns.T
        middle = dual[:2, 2] / dual[2, 2]
        reach = np.sqrt(np.maximum(0.0, middle**2 - np.diag(dual)[:2] / dual[2, 2]))
        extents.append(np.concatenate([middle - reach, middle + reach]))
    lower, upper = extents
    return np.concatenate([np.minimum(lower[:2], upper[:2]), np.maximum(lower[2:], upper[2:])])


def lift_box(
    camera: CameraModel,
    box: ImageBox,
    base_z: float,
    height: float,
    yaw: float,
    size_hint: Sequence[float] | None = None,
    ratio_hint: float | None = None,
    shape: Shape = "box",
) -> Lifted:
    """The oriented box that stands at `base_z` with this height and yaw and shows as `box`: undoes `image_box_of`.

    Four edges give centre, width and depth. Seen straight down at a yaw near 45 degrees they say little about width
    against depth, so the hinted ratio comes in there, the more the nearer to 45 degrees.

    Args:
        box: the whole object in the picture, 0-1000; may reach beyond the picture but must have an area.
        base_z, height: metres.
        yaw: degrees counter-clockwise.
        size_hint: expected (width, depth) or (width, depth, height); only the ratio is used.
        ratio_hint: expected width / depth, when there is no size_hint; 1 when neither is given.

    Returns:
        The best fit. A box that no object of this height can show as (smaller than its own parallax) comes back
        with its smallest sizes and a residual that says so.

    Raises:
        GeometryError: the box is inside out or not finite, or cannot lie on that level.
    """
    lens = Projector.of(camera)
    target = _target(lens, box)
    ratio = _ratio(size_hint, ratio_hint)
    height = max(0.0, height)
    middle_z = base_z + height / 2
    start = _first_lift(lens, target, base_z, height, yaw, ratio)
    edge_unit = EDGE_SPREAD * float(np.mean(target[2:] - target[:2]))
    ratio_weight = abs(math.sin(2 * math.radians(yaw))) ** 2 / RATIO_SPREAD
    low, high = math.log(MIN_SIZE), math.log(MAX_SIZE)

    def residuals(x: Floats) -> Floats:
        width, depth = np.clip(x[2:], low, high)
        size = (math.exp(width), math.exp(depth), height)
        edges = _extent(lens, (x[0], x[1], middle_z), size, yaw, shape) - target
        prior = (width - depth - math.log(ratio)) * ratio_weight
        return np.concatenate([edges / edge_unit, [prior], 0.01 * (x[2:] - np.clip(x[2:], low, high))])

    solution = _solve(residuals, start, np.array((0.1, 0.1, 0.1, 0.1)))
    width, depth = np.exp(np.clip(solution[2:], low, high)).tolist()
    centre = (float(solution[0]), float(solution[1]), middle_z)
    size = (width, depth, height)
    found = _extent(lens, centre, size, yaw, shape)
    return Lifted(centre, size, _mismatch(lens, found, target), _as_box(lens, found).iou(_as_box(lens, target)))


def _solve(residuals: Callable[[Floats], Floats], start: Floats, steps: Floats) -> Floats:
    def guarded(x: Floats) -> Floats:
        try:
            return residuals(x)
        except GeometryError:
            return np.full(len(start) + 3, np.nan)

    return levenberg_marquardt(guarded, start, steps, iterations=50, tolerance=1e-12).x


def _target(lens: Projector, box: ImageBox) -> Floats:
    edges = np.array((box.x_min, box.y_min, box.x_max, box.y_max), dtype=float)
    if not np.isfinite(edges).all() or box.x_max <= box.x_min or box.y_max <= box.y_min:
        raise GeometryError("An object's box in the picture has no area.")
    target: Floats = edges * np.tile(lens.size, 2) / 1000.0
    return target


def _as_box(lens: Projector, extent: Floats) -> ImageBox:
    low_x, low_y, high_x, high_y = (extent * 1000.0 / np.tile(lens.size, 2)).tolist()
    return ImageBox(x_min=low_x, y_min=low_y, x_max=high_x, y_max=high_y)


def _mismatch(lens: Projector, found: Floats, target: Floats) -> float:
    return float(np.sqrt(np.mean(((found - target) * 1000.0 / np.tile(lens.size, 2)) ** 2)))


def _ratio(size_hint: Sequence[float] | None, ratio_hint: float | None) -> float:
    if size_hint is not None and size_hint[0] > 0 and size_hint[1] > 0:
        ratio_hint = size_hint[0] / size_hint[1]
    if ratio_hint is None or not math.isfinite(ratio_hint) or ratio_hint <= 0:
        return 1.0
    return min(50.0, max(0.02, ratio_hint))


def _first_lift(lens: Projector, target: Floats, base_z: float, height: float, yaw: float, ratio: float) -> Floats:
    """Start of the lift: the image box's corners on the level half-way up, shared out to width and depth."""
    low_x, low_y, high_x, high_y = target
    quad = np.array(((low_x, low_y), (high_x, low_y), (high_x, high_y), (low_x, high_y)))
    level = lens.on_plane(quad, base_z + height / 2)
    if not np.isfinite(level).all():
        raise GeometryError("An object's box in the picture does not meet the floor.", "Check the camera and the box.")
    centre = level.mean(axis=0)
    extent = level.max(axis=0) - level.min(axis=0)
    cos, sin = abs(math.cos(math.radians(yaw))), abs(math.sin(math.radians(yaw)))
    # Extents of a turned rectangle: (w cos + d sin, w sin + d cos), solved in the least-squares sense with w = r d.
    depth = (extent[0] * (ratio * cos + sin) + extent[1] * (ratio * sin + cos)) / (
        (ratio * cos + sin) ** 2 + (ratio * sin + cos) ** 2
    )
    width = ratio * depth
    if min(cos, sin) < 1e-9:
        width, depth = (extent[0], extent[1]) if cos > sin else (extent[1], extent[0])
    return np.array((centre[0], centre[1], math.log(max(MIN_SIZE, width)), math.log(max(MIN_SIZE, depth))))


def wall_yaw(start: Sequence[float], end: Sequence[float]) -> float:
    """Yaw of something that hangs on a wall and faces the room, which lies to the left of start-end; -180..180."""
    yaw = math.degrees(math.atan2(-(end[1] - start[1]), -(end[0] - start[0])))
    return 180.0 if yaw == -180.0 else yaw


def lift_on_wall(
    camera: CameraModel,
    box: ImageBox,
    start: Sequence[float],
    end: Sequence[float],
    z_hint: tuple[float, float],
    depth: float = 0.05,
) -> LiftedOnWall:
    """Where on a wall an object with this image box hangs.

    Along the wall the box gives place and width. How far up the wall it reaches shows in the extent across the wall,
    when the camera is perspective or tilted; the hint fills in what the picture leaves open, all of it for a straight
    orthographic view.

    Args:
        start, end: the wall's inner face on the floor, the room to its left, metres.
        z_hint: expected lower and upper edge above the floor, metres.
        depth: how far it stands out into the room, metres.

    Raises:
        GeometryError: the wall has no length, or the box has no area.
    """
    length = math.hypot(end[0] - start[0], end[1] - start[1])
    if length < 1e-6:
        raise GeometryError("A wall has no length.")
    lens = Projector.of(camera)
    target = _target(lens, box)
    frame = _WallFrame(start, end, length, depth)
    low, high = min(z_hint), max(z_hint)
    hint_z, hint_extent = (low + high) / 2, math.log(max(MIN_SIZE, high - low))
    unit = WALL_EDGE_SPREAD * lens.size.max() / 1000.0

    def residuals(x: Floats) -> Floats:
        edges = (_extent(lens, *frame.box(x), "box") - target) / unit
        priors = ((x[2] - hint_z) / WALL_Z_SPREAD, (x[3] - hint_extent) / WALL_EXTENT_SPREAD)
        return np.concatenate([edges, priors, 1e-3 * (x[1:2] - math.log(length))])

    guess = lens.on_plane(((target[:2] + target[2:]) / 2)[None], hint_z)[0]
    if not np.isfinite(guess).all():
        raise GeometryError("An object's box in the picture does not meet its wall.", "Check the camera and the box.")
    along = float(np.dot(guess[:2] - frame.start, frame.direction))
    x0 = np.array((min(length, max(0.0, along)), math.log(max(0.1, length / 4)), hint_z, hint_extent))
    x = _solve(residuals, x0, np.array((0.1, 0.1, 0.1, 0.1)))
    x[1], x[3] = min(x[1], math.log(MAX_SIZE)), min(x[3], math.log(MAX_SIZE))
    centre, size, yaw = frame.box(x)
    found = _extent(lens, centre, size, yaw, "box")
    z_min, z_max = centre[2] - size[2] / 2, centre[2] + size[2] / 2
    known = _height_evidence(residuals, x)
    return LiftedOnWall(float(x[0]), size[0], z_min, z_max, centre, size, yaw, known, _mismatch(lens, found, target))


class _WallFrame:
    """Turns (along, log width, z, log extent) into an oriented box on one wall."""

    def __init__(self, start: Sequence[float], end: Sequence[float], length: float, depth: float) -> None:
        self.start = np.array(start[:2], dtype=float)
        self.direction = (np.array(end[:2], dtype=float) - self.start) / length
        self.inward = np.array((-self.direction[1], self.direction[0]))
        self.depth = max(0.0, depth)
        self.yaw = wall_yaw(start, end)

    def box(self, x: Floats) -> tuple[tuple[float, float, float], tuple[float, float, float], float]:
        flat = self.start + x[0] * self.direction + self.depth / 2 * self.inward
        size = (math.exp(min(8.0, x[1])), self.depth, math.exp(min(8.0, x[3])))
        return (float(flat[0]), float(flat[1]), float(x[2])), size, self.yaw


def _height_evidence(residuals: Callable[[Floats], Floats], x: Floats) -> float:
    """How much of what is known of z comes from the picture rather than from the hint, 0..1."""
    moved = x.copy()
    moved[2] += 1e-3
    slope = (residuals(moved) - residuals(x)) / 1e-3
    picture, hint = float(slope[:4] @ slope[:4]), 1 / WALL_Z_SPREAD**2
    return picture / (picture + hint)
