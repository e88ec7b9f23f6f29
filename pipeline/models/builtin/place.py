# SPDX-License-Identifier: GPL-3.0-or-later
"""From pixels to metres: the room's frame, and footprints that stand back from where a picture from above leans them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .boxes import OrientedBox
from .outline import Polygon

TYPICAL_AREA = 15.0
"""Square metres of a typical room, used when nothing of known size is seen."""
WALL_HEIGHT = 2.6


@dataclass(frozen=True)
class Footprint:
    """A rectangle on the floor, metres in the room's frame (x right, y up in the picture).

    `length` runs along `angle` (degrees counter-clockwise from x), `breadth` across it.
    """

    x: float
    y: float
    length: float
    breadth: float
    angle: float


@dataclass(frozen=True)
class Frame:
    """The floor plane of the picture: working pixels to metres.

    Attributes:
        floor: floor outline in pixels; top: wall tops' outline, equal to `floor` when orthographic.
        vanishing: where vertical edges run to, pixels.
        shrink: floor size over wall-top size.
        scale: metres for a pixel at floor level.
        height: wall height in metres.
    """

    floor: Polygon
    top: Polygon
    vanishing: tuple[float, float]
    shrink: float
    scale: float
    height: float = WALL_HEIGHT

    @property
    def centre(self) -> NDArray[np.float64]:
        """Centre of the floor's bounding rectangle, pixels."""
        result: NDArray[np.float64] = (self.floor.max(0) + self.floor.min(0)) / 2
        return result

    @property
    def size(self) -> tuple[float, float]:
        """Width and depth of the floor's bounding rectangle, metres."""
        span = (self.floor.max(0) - self.floor.min(0)) * self.scale
        return float(span[0]), float(span[1])

    def magnification(self, height: float) -> float:
        """How much larger something at this height looks than on the floor; 1 when orthographic."""
        if self.shrink >= 0.999:
            return 1.0
        camera = self.height / (1.0 - self.shrink)
        return camera / max(camera - height, 0.1 * camera)

    def leaning_height(self, box: OrientedBox) -> float | None:
        """Height of something that reaches over the foot of a wall in the picture, metres; None when it does not.

        What stands in the room cannot stand beyond its walls, so its top must be this high at least; furniture at a
        wall is this high.
        """
        if self.shrink >= 0.999:
            return None
        x0, y0, x1, y1 = box.bounds()
        low, high = self.floor.min(0), self.floor.max(0)
        px, py = self.vanishing
        ratios = [
            (px - x0) / max(px - low[0], 1e-6),
            (x1 - px) / max(high[0] - px, 1e-6),
            (py - y0) / max(py - low[1], 1e-6),
            (y1 - py) / max(high[1] - py, 1e-6),
        ]
        camera = self.height / (1.0 - self.shrink)
        height = camera * (1 - 1 / max(max(ratios), 1.0))
        return float(min(height, self.height)) if height > 0.25 else None

    def metres(self, x: float, y: float) -> tuple[float, float]:
        """A pixel at floor level in metres."""
        cx, cy = self.centre
        return (x - float(cx)) * self.scale, (float(cy) - y) * self.scale

    def footprint(self, box: OrientedBox, height: float, base: float = 0.0) -> Footprint:
        """The rectangle that an upright thing of this height stands on.

        Of an axis-aligned thing the outward sides are its upper edges and the inward sides its foot, so each side is
        moved by its own magnification; of a turned one the middle height stands for all.
        """
        low, high = self.magnification(base), self.magnification(base + height)
        px, py = self.vanishing
        if box.angle == 0.0:
            x0, y0, x1, y1 = box.bounds()
            sides = []
            for near, far, point in ((x0, x1, px), (y0, y1, py)):
                a, b = near - point, far - point
                sides.append((a / (high if a < 0 else low) + point, b / (high if b > 0 else low) + point))
            (x0, x1), (y0, y1) = sides
            if x1 - x0 > 1 and y1 - y0 > 1:
                x, y = self.metres((x0 + x1) / 2, (y0 + y1) / 2)
                return Footprint(x, y, (x1 - x0) * self.scale, (y1 - y0) * self.scale, 0.0)
        middle = (low + high) / 2
        x, y = self.metres(px + (box.centre[0] - px) / middle, py + (box.centre[1] - py) / middle)
        return Footprint(x, y, box.length / middle * self.scale, box.breadth / middle * self.scale, box.angle)

    def rescaled(self, factor: float) -> Frame:
        """The same frame with another scale."""
        return Frame(self.floor, self.top, self.vanishing, self.shrink, self.scale * factor, self.height)

    def walls(self) -> list[tuple[NDArray[np.float64], NDArray[np.float64]]]:
        """Floor edges in metres, counter-clockwise (the room lies to the left of each)."""
        corners = [np.array(self.metres(*point)) for point in self.floor[::-1]]
        return [(corners[i], corners[(i + 1) % len(corners)]) for i in range(len(corners))]


@dataclass(frozen=True)
class WallContact:
    """How a footprint stands to its nearest wall.

    Attributes:
        gap: metres from the wall to the nearest side of the footprint, negative when it crosses the wall.
        yaw: yaw of something that has its back to that wall.
        index: the wall's place in `Frame.walls()`.
    """

    gap: float
    yaw: float
    index: int


def half_extent(foot: Footprint, direction: NDArray[np.float64]) -> float:
    """Half the footprint's extent along a unit direction, metres."""
    turn = np.radians(foot.angle)
    along = np.array([np.cos(turn), np.sin(turn)])
    across = np.array([-np.sin(turn), np.cos(turn)])
    return float(abs(along @ direction) * foot.length + abs(across @ direction) * foot.breadth) / 2


def contacts(frame: Frame, foot: Footprint) -> list[WallContact]:
    """All walls beside the footprint, the nearest first."""
    result = []
    position = np.array([foot.x, foot.y])
    for index, (a, b) in enumerate(frame.walls()):
        length = float(np.linalg.norm(b - a))
        if length < 1e-6:
            continue
        along = (b - a) / length
        inward = np.array([-along[1], along[0]])
        at = float((position - a) @ along)
        if not -0.05 * length <= at <= 1.05 * length:
            continue
        distance = float((position - a) @ inward)
        if distance < -0.3:
            continue
        # Something with its back to the wall faces `inward`; at yaw 0 it faces -y.
        yaw = float(np.degrees(np.arctan2(inward[0], -inward[1])))
        result.append(WallContact(distance - half_extent(foot, inward), yaw, index))
    return sorted(result, key=lambda c: c.gap)
