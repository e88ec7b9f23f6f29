# SPDX-License-Identifier: GPL-3.0-or-later
"""From metres to the picture and back, for the two kinds of camera that `CameraModel` describes.

Blender's convention: the camera looks along its local -Z, local +Y is up in the picture, pixels are square. Image
coordinates are 0-1000 of the picture's width (x, right) and height (y, down). `fov_y` is the vertical field of view
of the lens as if the principal point were at the picture's centre; an off-centre principal point is a lens shift.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from ..artifacts.camera import CameraModel
from ..artifacts.common import ImagePoint
from ..errors import RoomError
from .polygon import Floats

Kind = Literal["perspective", "orthographic"]
CENTRE = (500.0, 500.0)
NEAR = 1e-6


class GeometryError(RoomError):
    """Corners, boxes or a camera that no room can have."""


@dataclass(frozen=True)
class Projector:
    """A camera taken apart for fast repeated use.

    Attributes:
        rotation: (3, 3), columns are the camera's own axes in the world.
        position: (3,) metres.
        scale: pixels: the focal length (perspective) or pixels for a metre (orthographic).
        principal: (2,) pixels, x right, y down.
        size: (2,) picture width and height in pixels.
    """

    perspective: bool
    rotation: Floats
    position: Floats
    scale: float
    principal: Floats
    size: Floats

    @staticmethod
    def of(camera: CameraModel) -> Projector:
        """Take a camera apart; GeometryError when its numbers cannot be a camera."""
        if len(camera.matrix) != 16:
            raise GeometryError("The camera's matrix does not have 16 numbers.")
        matrix = np.array(camera.matrix, dtype=float).reshape(4, 4)
        size = np.array(camera.image_size, dtype=float)
        if camera.kind == "perspective":
            if not 0 < camera.fov_y < math.pi:
                raise GeometryError("The camera's field of view must be between 0 and 180 degrees.")
            scale = size[1] / 2 / math.tan(camera.fov_y / 2)
        else:
            if not camera.ortho_height > 0:
                raise GeometryError("The camera's orthographic height must be above zero.")
            scale = size[1] / camera.ortho_height
        principal = np.array((camera.principal.x, camera.principal.y)) * size / 1000.0
        return Projector(camera.kind == "perspective", matrix[:3, :3], matrix[:3, 3], float(scale), principal, size)

    def depth(self, points: Floats) -> Floats:
        """Distance in front of the camera along its axis, (N,) metres; negative behind."""
        depth: Floats = -((points - self.position) @ self.rotation[:, 2])
        return depth

    def pixels(self, points: Floats) -> Floats:
        """World points (N, 3) to pixels (N, 2); nan for points behind a perspective camera."""
        local = (points - self.position) @ self.rotation
        flat = local[:, :2] * (1.0, -1.0)
        if self.perspective:
            depth = -local[:, 2:]
            with np.errstate(divide="ignore", invalid="ignore"):
                flat = np.where(depth > NEAR, flat / depth, np.nan)
        result: Floats = self.principal + self.scale * flat
        return result

    def rays(self, pixels: Floats) -> tuple[Floats, Floats]:
        """Origins and unit directions (N, 3) of the lines of sight through pixels (N, 2)."""
        flat = (pixels - self.principal) / self.scale * (1.0, -1.0)
        if self.perspective:
            local = np.concatenate([flat, -np.ones((len(flat), 1))], axis=1)
            directions = local @ self.rotation.T
            directions /= np.linalg.norm(directions, axis=1, keepdims=True)
            return np.broadcast_to(self.position, directions.shape).copy(), directions
        origins = self.position + flat @ self.rotation[:, :2].T
        return origins, np.broadcast_to(-self.rotation[:, 2], origins.shape).copy()

    def on_plane(self, pixels: Floats, z: float) -> Floats:
        """Where the lines of sight through pixels (N, 2) meet the level z, (N, 3); nan where they do not."""
        origins, directions = self.rays(pixels)
        with np.errstate(divide="ignore", invalid="ignore"):
            steps = (z - origins[:, 2]) / directions[:, 2]
        steps = np.where(np.isfinite(steps) & (steps > 0 if self.perspective else True), steps, np.nan)
        points: Floats = origins + steps[:, None] * directions
        points[:, 2] = np.where(np.isnan(steps), np.nan, z)
        return points


def project(camera: CameraModel, points: ArrayLike) -> Floats:
    """World points (N, 3) in metres to image coordinates (N, 2), 0-1000; nan behind a perspective camera.

    Points outside the picture are not clipped.
    """
    lens = Projector.of(camera)
    result: Floats = lens.pixels(_rows(points, 3)) * 1000.0 / lens.size
    return result


def ray(camera: CameraModel, image_points: ArrayLike) -> tuple[Floats, Floats]:
    """Lines of sight through image points (N, 2), 0-1000: origins (N, 3) in metres and unit directions (N, 3)."""
    lens = Projector.of(camera)
    return lens.rays(_rows(image_points, 2) * lens.size / 1000.0)


def to_plane(camera: CameraModel, image_points: ArrayLike, z: float) -> Floats:
    """Where image points (N, 2), 0-1000, lie if they are at height z: (N, 3) metres, nan where nothing is there."""
    lens = Projector.of(camera)
    return lens.on_plane(_rows(image_points, 2) * lens.size / 1000.0, z)


def _rows(values: ArrayLike, columns: int) -> Floats:
    rows = np.asarray(values, dtype=float)
    return rows.reshape(-1, columns)


def image_points(points: Sequence[ImagePoint]) -> Floats:
    """Named image points as an array (N, 2), 0-1000."""
    return np.array([(p.x, p.y) for p in points], dtype=float).reshape(-1, 2)


def tilt_rotation(tilt_x: float, tilt_y: float, roll: float = 0.0) -> Floats:
    """Rotation (3, 3) of a camera that looks down, tilted and rolled; all angles in degrees.

    At 0, 0, 0 it looks straight down with +Y up in the picture. `tilt_x` > 0 turns the view towards +Y (the camera
    stands south and looks north), `tilt_y` > 0 towards +X; together they are one turn about a level axis, so no
    roll comes in. `roll` turns the camera counter-clockwise as seen from above: the room appears turned clockwise.
    """
    angle = math.radians(math.hypot(tilt_x, tilt_y))
    turned = _about_z(math.radians(roll))
    if angle == 0:
        return turned
    # Turning about +X takes -Z towards +Y; turning about -Y takes -Z towards +X.
    axis = np.array((tilt_x, -tilt_y, 0.0)) / math.hypot(tilt_x, tilt_y)
    cross = np.array(((0, -axis[2], axis[1]), (axis[2], 0, -axis[0]), (-axis[1], axis[0], 0)))
    tilted = np.eye(3) + math.sin(angle) * cross + (1 - math.cos(angle)) * cross @ cross
    result: Floats = tilted @ turned
    return result


def _about_z(angle: float) -> Floats:
    cos, sin = math.cos(angle), math.sin(angle)
    return np.array(((cos, -sin, 0.0), (sin, cos, 0.0), (0.0, 0.0, 1.0)))


def camera_from(
    kind: Kind,
    position: Sequence[float],
    rotation: Floats,
    scale_px: float,
    image_size: tuple[int, int],
    principal: Sequence[float] = CENTRE,
) -> CameraModel:
    """A camera from its parts.

    Args:
        rotation: (3, 3) camera-to-world.
        scale_px: focal length in pixels (perspective) or pixels for a metre (orthographic).
        principal: 0-1000 of width and height.
    """
    if not (math.isfinite(scale_px) and scale_px > 0):
        raise GeometryError("The camera's scale must be above zero.")
    matrix = np.eye(4)
    matrix[:3, :3] = rotation
    matrix[:3, 3] = position
    perspective = kind == "perspective"
    return CameraModel(
        kind=kind,
        matrix=tuple(float(v) for v in matrix.ravel()),
        fov_y=2 * math.atan(image_size[1] / 2 / scale_px) if perspective else 0.0,
        ortho_height=0.0 if perspective else image_size[1] / scale_px,
        image_size=(int(image_size[0]), int(image_size[1])),
        principal=ImagePoint(x=float(principal[0]), y=float(principal[1])),
    )


def camera_from_projector(lens: Projector) -> CameraModel:
    """The same camera as data."""
    principal = lens.principal / lens.size * 1000.0
    size = (round(float(lens.size[0])), round(float(lens.size[1])))
    kind: Kind = "perspective" if lens.perspective else "orthographic"
    return camera_from(kind, lens.position.tolist(), lens.rotation, lens.scale, size, principal.tolist())


def camera_looking_at(
    kind: Kind,
    eye: Sequence[float],
    target: Sequence[float],
    view_size: float,
    image_size: tuple[int, int],
    principal: Sequence[float] = CENTRE,
) -> CameraModel:
    """A camera at `eye` that looks at `target` with +Y (or +Z, for level views) up in the picture.

    `view_size` is the vertical field of view in degrees (perspective) or the metres that the picture's height spans
    (orthographic).
    """
    back = np.asarray(eye, dtype=float) - np.asarray(target, dtype=float)
    length = float(np.linalg.norm(back))
    if length == 0:
        raise GeometryError("The camera stands on the point that it looks at.")
    back /= length
    right = np.cross((0.0, 1.0, 0.0) if back[2] > 0.9 else (0.0, 0.0, 1.0), back)
    right /= np.linalg.norm(right)
    rotation = np.stack([right, np.cross(back, right), back], axis=1)
    perspective = kind == "perspective"
    scale = image_size[1] / 2 / math.tan(math.radians(view_size) / 2) if perspective else image_size[1] / view_size
    return camera_from(kind, eye, rotation, scale, image_size, principal)


def camera_straight_down(
    kind: Kind,
    width: float,
    depth: float,
    image_size: tuple[int, int],
    fov_degrees: float = 45.0,
    margin: float = 0.05,
    top: float = 0.0,
) -> CameraModel:
    """A camera above the origin that shows a rectangle of width x depth metres at height `top` with a margin.

    `fov_degrees` is the vertical field of view, `margin` the empty part of the picture at each side, 0..0.5.
    """
    room = 1 - 2 * margin
    pixels_per_metre = min(image_size[0] * room / width, image_size[1] * room / depth)
    if kind == "orthographic":
        return camera_from(kind, (0.0, 0.0, top + 10.0), np.eye(3), pixels_per_metre, image_size)
    focal = image_size[1] / 2 / math.tan(math.radians(fov_degrees) / 2)
    return camera_from(kind, (0.0, 0.0, top + focal / pixels_per_metre), np.eye(3), focal, image_size)


def blender_shift(camera: CameraModel) -> tuple[float, float]:
    """Blender's lens shift (shift_x, shift_y), in units of the picture's longer side, for the principal point."""
    width, height = camera.image_size
    longer = max(width, height)
    return (0.5 - camera.principal.x / 1000) * width / longer, (camera.principal.y / 1000 - 0.5) * height / longer


def image_scale(camera: CameraModel, point: Sequence[float]) -> float:
    """Pixels for a metre across the line of sight at a world point."""
    lens = Projector.of(camera)
    if not lens.perspective:
        return lens.scale
    return lens.scale / max(NEAR, float(lens.depth(np.array([point], dtype=float))[0]))
