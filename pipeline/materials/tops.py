# SPDX-License-Identifier: GPL-3.0-or-later
"""The colour of the walls' upper faces: in a picture from above they frame the whole room."""

from __future__ import annotations

import numpy as np

from ..artifacts.camera import CameraModel
from ..artifacts.layout import Layout
from ..geometry.camera import Projector
from ..light.measure import LEAST_PLACES
from ..objects.colours import Floats
from ..program.prelude.walls import wall_runs

_STEP = 0.1  # metres between places
_FROM_ENDS = 0.15  # metres
_ACROSS = (0.35, 0.5, 0.65)  # of a wall's thickness
_ALIKE = 0.12
"""How far from the usual brightness, as displayed, places may be; the rest is something else that is seen there."""


def top_colour(layout: Layout, camera: CameraModel, pixels: Floats) -> Floats | None:
    """Linear light (3,) of the upper faces of the walls in the picture; None where it does not show enough of them.

    Args:
        pixels: the picture as linear light (height, width, 3).
    """
    points = _places(layout)
    lens = Projector.of(camera)
    if lens.perspective and len(points):
        points = points[points[:, 2] < lens.position[2] - 0.1]
    if not len(points):
        return None
    high, wide = pixels.shape[:2]
    spots = np.nan_to_num(lens.pixels(points) * np.array((wide, high)) / lens.size, nan=-1.0).astype(int)
    inside = (spots[:, 0] >= 0) & (spots[:, 0] < wide) & (spots[:, 1] >= 0) & (spots[:, 1] < high)
    seen = pixels[spots[inside, 1], spots[inside, 0]]
    if len(seen) < LEAST_PLACES:
        return None
    middle = np.median(seen, axis=0)
    near = np.abs(np.cbrt(seen) - np.cbrt(middle)).max(axis=1) < _ALIKE
    if near.mean() < 0.4:  # no face of one colour: the walls are not where they were thought, or hidden
        return None
    found: Floats = seen[near].mean(axis=0)
    return found


def _places(layout: Layout) -> Floats:
    """Places on the upper faces (N, 3), the room's frame."""
    runs = wall_runs([line.model_dump() for line in layout.walls], [(float(x), float(y)) for x, y in layout.room.floor])
    rows = []
    for run in runs:
        along = np.arange(_FROM_ENDS, run.length - _FROM_ENDS, _STEP)
        dx, dy = run.direction
        for part in _ACROSS:
            across = run.left + (run.right - run.left) * part
            x = run.start[0] + dx * along - dy * across
            y = run.start[1] + dy * along + dx * across
            rows.append(np.stack([x, y, np.full(len(along), run.height)], axis=1))
    return np.concatenate(rows) if rows else np.zeros((0, 3))
