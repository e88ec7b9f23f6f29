# SPDX-License-Identifier: GPL-3.0-or-later
"""A camera as the two matrices that a graphics card draws with."""

from __future__ import annotations

import numpy as np

from ..artifacts.camera import CameraModel
from .camera import GeometryError, Projector
from .polygon import Floats


def view_matrix(camera: CameraModel) -> Floats:
    """World to camera, (4, 4), row by row."""
    inverse: Floats = np.linalg.inv(np.array(camera.matrix, dtype=float).reshape(4, 4))
    return inverse


def projection_matrix(camera: CameraModel, near: float, far: float) -> Floats:
    """Camera to clip space as OpenGL has it (4, 4): the picture's left and right edge are at -1 and 1, its top at 1.

    The principal point is in it, so what is drawn lies where `project` says, whatever the number of pixels.

    Args:
        near, far: depths in metres between which things are drawn; near above zero for a perspective camera.

    Raises:
        GeometryError: the camera's or the depths' numbers cannot be.
    """
    lens = Projector.of(camera)
    if not near < far or (lens.perspective and near <= 0):
        raise GeometryError("The nearest depth must be above zero and below the farthest.")
    (width, height), (x, y) = lens.size, lens.principal
    matrix = np.zeros((4, 4))
    matrix[0, 0], matrix[1, 1] = 2 * lens.scale / width, 2 * lens.scale / height
    off_x, off_y = 2 * x / width - 1, 1 - 2 * y / height
    if lens.perspective:
        matrix[0, 2], matrix[1, 2] = -off_x, -off_y
        matrix[2, 2], matrix[2, 3] = -(far + near) / (far - near), -2 * far * near / (far - near)
        matrix[3, 2] = -1.0
    else:
        matrix[0, 3], matrix[1, 3] = off_x, off_y
        matrix[2, 2], matrix[2, 3] = -2 / (far - near), -(far + near) / (far - near)
        matrix[3, 3] = 1.0
    return matrix
