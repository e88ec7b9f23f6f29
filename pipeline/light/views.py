# SPDX-License-Identifier: GPL-3.0-or-later
"""From where the finished room is looked at: straight from above with its walls cut, and twice from eye level (`eyes`)."""

from __future__ import annotations

import numpy as np

from ..artifacts.layout import CameraLine, Layout
from ..geometry.polygon import Floats
from .eyes import EYES, LEAST_FREE, eye_cameras
from .space import Space

__all__ = ["EYES", "LEAST_FREE", "TOP", "cut_height", "eye_cameras", "top_camera"]

TOP = "top"
TOP_LONG_SIDE = 1536
_ABOVE = 3.0  # metres of the top camera above the walls
_FRAME = 1.06  # the top view shows this much more than the room with its walls
_LOWEST_CUT = 1.2
_DOORS = 2.0  # metres: walls are cut below the lintels, where furniture allows it


def cut_height(space: Space) -> float:
    """Where the top view cuts the walls, metres: below the lintels if no furniture is higher; 0 where it cannot."""
    tall = max(
        (p.centre[2] + p.size[2] / 2 for p in space.layout.proxies if p.placement in ("floor", "surface")), default=0.0
    )
    height = max(_LOWEST_CUT, min(_DOORS, 0.8 * space.height), tall + 0.02)
    return round(height, 3) if height < space.height - 0.05 else 0.0


def top_camera(space: Space, cut: float, name: str = TOP) -> CameraLine:
    """An orthographic camera over the room that sees what is below the cut (0: everything)."""
    low, high = _outside(space.layout)
    width, depth = (float(v) * _FRAME for v in high - low)
    scale = TOP_LONG_SIDE / max(width, depth)
    size = (max(16, round(width * scale)), max(16, round(depth * scale)))
    z = space.height + _ABOVE
    matrix = np.eye(4)
    matrix[:3, 3] = (*((low + high) / 2), z)
    return CameraLine(
        id=name,
        kind="orthographic",
        matrix=_flat(matrix),
        ortho_height=depth,
        image_size=size,
        near=round(z - cut, 4) if cut else 0.02,
    )


def _outside(layout: Layout) -> tuple[Floats, Floats]:
    """The corners of the rectangle round the floor and the walls' outsides."""
    floor = np.array(layout.room.floor, dtype=float)
    thick = max((w.thickness for w in layout.walls if not w.partition), default=0.12)
    return floor.min(axis=0) - thick, floor.max(axis=0) + thick


def _flat(matrix: Floats) -> tuple[float, ...]:
    return tuple(float(v) for v in matrix.ravel())
