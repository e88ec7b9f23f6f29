# SPDX-License-Identifier: GPL-3.0-or-later
"""The camera that the reference image was seen through, as data."""

from __future__ import annotations

from typing import Literal

from .common import Artifact, ImagePoint


class CameraModel(Artifact):
    """A camera in Blender's convention: it looks along its local -Z, local +Y is up in the picture.

    Attributes:
        kind: "perspective" (pinhole) or "orthographic".
        matrix: camera-to-world matrix, 16 numbers, row by row (rotation is orthonormal, no scale).
        fov_y: vertical field of view in radians (perspective), 0 for orthographic.
        ortho_height: metres that the picture's height spans (orthographic), 0 for perspective.
        image_size: width and height of the picture in pixels.
        principal: where the optical axis meets the picture, 0-1000 of width and height; (500, 500) is the centre.
    """

    kind: Literal["perspective", "orthographic"]
    matrix: tuple[float, ...]
    fov_y: float = 0.0
    ortho_height: float = 0.0
    image_size: tuple[int, int]
    principal: ImagePoint = ImagePoint(x=500.0, y=500.0)
