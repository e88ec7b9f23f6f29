# SPDX-License-Identifier: GPL-3.0-or-later
"""What the picture's camera sees of each thing in a built room."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from code_as_room.pipeline.artifacts.camera import CameraModel
from code_as_room.pipeline.geometry.camera import Projector
from mathutils import Vector
from mathutils.bvhtree import BVHTree

from .bodies import Body, BuiltRoom, Floats

_FAR = 50.0  # metres that rays of a camera without perspective start before their points
_CLOSE = 0.004  # metres before a point at which a ray counts as having met it


@dataclass(frozen=True)
class Look:
    """A camera before everything that stands in a room; walls are left out, as such pictures leave them out."""

    lens: Projector
    tree: Any

    @classmethod
    def of(cls, camera: CameraModel, room: BuiltRoom) -> Look:
        """The camera of a picture, before a room."""
        points: list[list[float]] = []
        triangles: list[list[int]] = []
        for body in room.things.values():
            triangles += (body.triangles + len(points)).tolist()
            points += body.points.tolist()
        return cls(Projector.of(camera), BVHTree.FromPolygons(points, triangles, all_triangles=True))

    def seen_of(self, body: Body) -> Floats:
        """Those of its skin's points that nothing stands before, not even itself, (N, 3)."""
        kept = [point for point in body.skin if self._is_seen(point)]
        return np.array(kept, dtype=float).reshape(-1, 3)

    def _is_seen(self, point: Floats) -> bool:
        away = point - self.lens.position if self.lens.perspective else -self.lens.rotation[:, 2] * _FAR
        length = float(np.linalg.norm(away))
        way = away / length
        _, _, _, distance = self.tree.ray_cast(Vector(point - length * way), Vector(way), length)
        return distance is None or distance > length - _CLOSE
