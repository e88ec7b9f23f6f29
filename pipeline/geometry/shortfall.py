# SPDX-License-Identifier: GPL-3.0-or-later
"""How far a thing may stay inside of the box that its measures span.

Furniture is no cuboid: lamps and plants do not fill the corners of their tops, chairs have splayed legs, armchairs that
are turned do not fill the corners of their footprint. So its tight box in the picture lies inside of the projected
cuboid, usually by little, more where a tall thing's top decides the edge and where it is turned. Nothing makes the tight
box larger, so this counts only for edges of the projection that stick out of the box.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from ..artifacts.camera import CameraModel
from ..artifacts.common import ImageBox, Shape
from .footprint import image_box_of
from .polygon import Floats

ROUNDED = 3.0
"""Thousandths of the picture's longer side that every edge may fall short by."""
OF_TOP = 0.3
"""Part of the shift between a thing's foot and its top that an edge may fall short by."""
OF_TURNED = 0.12
"""Part of its extent that the edges of a thing turned by 45 degrees may fall short by."""
GROWTH = 1.05


class Edges(NamedTuple):
    """The projection of an oriented box, in thousandths of the picture's longer side.

    Attributes:
        at: x_min, y_min, x_max, y_max; heights: how they change when the height grows by the factor e; the base stays.
        short: how far each edge of a tight box may usually lie inside.
    """

    at: Floats
    heights: Floats
    short: Floats


def thousandths(camera: CameraModel) -> Floats:
    """Factors from 0-1000 of width and height to thousandths of the longer side, for (x, y, x, y)."""
    longer = max(camera.image_size)
    return np.array((camera.image_size[0] / longer, camera.image_size[1] / longer) * 2)


def edges_of(box: ImageBox) -> Floats:
    """x_min, y_min, x_max, y_max."""
    return np.array((box.x_min, box.y_min, box.x_max, box.y_max))


def projected_edges(
    camera: CameraModel, centre: Sequence[float], size: Sequence[float], yaw: float, shape: Shape
) -> Edges:
    """Where an oriented box shows, and how far what it measures may fall short of it.

    Raises:
        GeometryError: it lies behind the camera.
    """
    unit = thousandths(camera)
    base, tall = centre[2] - size[2] / 2, size[2] * GROWTH
    at = edges_of(image_box_of(camera, centre, size, yaw, shape)) * unit
    grown = edges_of(image_box_of(camera, (*centre[:2], base + tall / 2), (*size[:2], tall), yaw, shape)) * unit
    heights = (grown - at) / math.log(GROWTH)
    extent = np.tile(at[2:] - at[:2], 2)
    turned = 0.0 if shape == "round" else abs(math.sin(2 * math.radians(yaw)))
    short = np.sqrt(ROUNDED**2 + (OF_TOP * heights) ** 2 + (OF_TURNED * turned * extent) ** 2)
    return Edges(at, heights, short)
