# SPDX-License-Identifier: GPL-3.0-or-later
"""How much brighter a photographer would expose a single view than the room.

The room's exposure makes floor and walls as bright as the picture has them, which is seen from above and shows walls at a
slant. At eye level bright walls fill the view, and dark furniture an alcove: each such view is exposed for what it shows.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from ..artifacts.layout import CameraLine, LightLine, ViewLine
from ..geometry.polygon import Floats
from .estimate import irradiance
from .exposure import GLOSS
from .space import SKY, Space
from .tone import scene_light

_ACROSS, _DOWN = 16, 10
_BRIGHT = 80.0
"""Per cent of a view that are darker than what is exposed for: a wall, a bed, a worktop in the light."""
_AS = 0.8
"""How bright that is on the screen."""
_BRIGHTEST, _NOT_BURNT = 95.0, 0.93
"""The same of what is brightest in it: in a dark alcove a white wall at its side is not to burn out. Where the sun falls may."""
_LEAST, _MOST = -0.5, 1.0
_ABOVE = 2e-3  # metres


def stops_for(space: Space, lights: Sequence[LightLine], sky: float, camera: CameraLine, view: ViewLine) -> float:
    """Stops by which pictures through a perspective camera are brighter than the room's exposure, -0.5 to 1."""
    at, ways = _sight(camera)
    distance, surface, normals = space.hit(np.broadcast_to(at, ways.shape), ways)
    met = surface != SKY
    if met.sum() < len(met) / 4:
        return 0.0
    points = at + ways[met] * distance[met, None] + _ABOVE * normals[met]
    arriving = irradiance(space, lights, sky, points, normals[met])
    suns = [n for n, light in enumerate(lights) if light.kind == "sun"]
    even = arriving.lights.sum(axis=0) - arriving.direct[suns].sum(axis=0) + arriving.sky
    gives = even * (space.albedo_of(surface[met]) + GLOSS) / math.pi
    stops = []
    for share, shown in ((_BRIGHT, _AS), (_BRIGHTEST, _NOT_BURNT)):
        now = float(np.percentile(gives, share)) * 2.0**view.exposure
        wanted = float(scene_light(np.array([shown]), view.transform, view.look)[0])
        stops.append(math.log2(wanted / max(now, 1e-6)))
    return round(float(np.clip(min(stops), _LEAST, _MOST)), 2)


def _sight(camera: CameraLine) -> tuple[Floats, Floats]:
    """Where a camera is, and unit vectors (N, 3) spread over what it sees."""
    matrix = np.array(camera.matrix, dtype=float).reshape(4, 4)
    high = math.tan(camera.fov_y / 2)
    wide = high * camera.image_size[0] / camera.image_size[1]
    right, up = np.meshgrid(np.linspace(-0.95, 0.95, _ACROSS), np.linspace(-0.95, 0.95, _DOWN))
    x = wide * (right + (0.5 - camera.principal[0] / 1000.0) * 2.0)
    y = high * (up - (0.5 - camera.principal[1] / 1000.0) * 2.0)
    local = np.stack([x.ravel(), y.ravel(), -np.ones(x.size)], axis=1)
    ways = local @ matrix[:3, :3].T
    found: Floats = ways / np.linalg.norm(ways, axis=1, keepdims=True)
    return matrix[:3, 3], found
