# SPDX-License-Identifier: GPL-3.0-or-later
"""How bright floor and walls are in the picture: at places that the camera sees and that nothing stands before."""

from __future__ import annotations

import functools
from dataclasses import dataclass

import numpy as np
from PIL import Image

from ..artifacts.camera import CameraModel
from ..artifacts.common import ImageBox
from ..geometry.camera import Projector
from ..geometry.polygon import Floats
from ..picture import ReferencePicture
from .bulk import Bools
from .developed import developed
from .space import FLOOR, WALLS, Space, from_walls, inside
from .tone import linear, luminance

LONG_SIDE = 512
"""Pixels of the copy of the picture that is measured: places are some centimetres wide then."""
MOST_PLACES = 90
"""Of each kind."""
_KEEP_OFF = 0.08  # metres from walls, corners and holes: no skirting, no frames
_SEEN = 0.03  # metres that a line of sight may end before its place and still count
_RUG = 0.05  # metres; floor places on a rug are the rug's
LEAST_PLACES = 12
RUGS = -10


@dataclass(frozen=True)
class Places:
    """Places of the shell that the picture shows.

    Attributes:
        points, normals: (N, 3) in the room; colours: (N, 3) linear, as on the screen.
        surface: numbers of `Space`; what lies on a rug has a number from `RUGS` downwards, one for each rug.
    """

    points: Floats
    normals: Floats
    surface: Floats
    colours: Floats

    @property
    def is_floor(self) -> Bools:
        """Which of them are on the bare floor."""
        result: Bools = self.surface == FLOOR
        return result

    @property
    def is_wall(self) -> Bools:
        """Which of them are on walls."""
        result: Bools = self.surface >= WALLS
        return result

    def only(self, mask: Bools) -> Places:
        """Some of the places."""
        return Places(self.points[mask], self.normals[mask], self.surface[mask], self.colours[mask])

    @property
    def light(self) -> Floats:
        """Luminance on the screen, linear, (N,)."""
        return luminance(self.colours)


def visible_places(space: Space, camera: CameraModel, picture: ReferencePicture, meant: bool = True) -> Places:
    """Places on floor and walls that the picture shows, spread evenly, at most `MOST_PLACES` of each.

    Args:
        meant: with the colours that things had, where the picture is washed out; else as the picture shows them.
    """
    pixels = small(picture, meant)
    points, normals, surface = _floor_places(space)
    bare = surface == FLOOR
    floor = _seen(space, camera, pixels, points[bare], normals[bare], surface[bare])
    rugs = _seen(space, camera, pixels, points[~bare], normals[~bare], surface[~bare])
    walls = _seen(space, camera, pixels, *_wall_places(space))
    parts = [_spread(places, MOST_PLACES) for places in (floor, rugs, walls)]
    return Places(
        *(np.concatenate([getattr(p, name) for p in parts]) for name in ("points", "normals", "surface", "colours"))
    )


def floor_and_walls(space: Space, each: int = 60) -> tuple[Floats, Floats, Floats]:
    """Places on floor and walls whether seen or not: points, normals, surface numbers."""
    parts = []
    for points, normals, surface in (_floor_places(space), _wall_places(space)):
        points, normals, surface = (values[surface >= 0] for values in (points, normals, surface))
        step = max(1, len(points) // each)
        parts.append((points[::step], normals[::step], surface[::step]))
    return tuple(np.concatenate([p[i] for p in parts]) for i in range(3))


@functools.lru_cache(maxsize=2)
def small(picture: ReferencePicture, meant: bool = False) -> Floats:
    """The picture as linear colours (height, width, 3), at most `LONG_SIDE` pixels; not to be written into.

    Args:
        meant: the colours that things had, where the picture is washed out (`developed`).
    """
    image = Image.fromarray(developed(picture) if meant else picture.pixels())
    image.thumbnail((LONG_SIDE, LONG_SIDE), Image.Resampling.BOX)
    found = linear(np.asarray(image, dtype=float) / 255.0)
    found.flags.writeable = False
    return found


def surround(picture: ReferencePicture) -> Floats:
    """The usual colour of the picture's margin, linear (3,): what lies round the room."""
    pixels = small(picture)
    edge = max(1, round(0.012 * max(pixels.shape[:2])))
    margin = np.concatenate([
        pixels[:edge].reshape(-1, 3), pixels[-edge:].reshape(-1, 3),
        pixels[:, :edge].reshape(-1, 3), pixels[:, -edge:].reshape(-1, 3),
    ])  # fmt: skip
    result: Floats = np.median(margin, axis=0)
    return result


def shines(picture: ReferencePicture, box: ImageBox) -> bool:
    """Whether something in a box of the picture is as bright as a lamp that is on, and clearly brighter than around."""
    pixels = luminance(small(picture))
    high, wide = pixels.shape
    x0, x1 = (int(v * wide / 1000) for v in (box.x_min, box.x_max))
    y0, y1 = (int(v * high / 1000) for v in (box.y_min, box.y_max))
    inner = pixels[max(0, y0) : y1 + 1, max(0, x0) : x1 + 1]
    if inner.size < 4:
        return False
    w, h = x1 - x0 + 1, y1 - y0 + 1
    outer = pixels[max(0, y0 - h) : y1 + h + 1, max(0, x0 - w) : x1 + w + 1]
    bright = float(np.percentile(inner, 98))
    return bright > 0.8 and bright > 1.35 * float(np.median(outer))


def _floor_places(space: Space) -> tuple[Floats, Floats, Floats]:
    low, high = space.floor.min(axis=0), space.floor.max(axis=0)
    step = max(0.05, float(np.sqrt(np.prod(high - low) / 1000)))
    xs, ys = (np.arange(low[i] + step / 2, high[i], step) for i in (0, 1))
    grid = np.stack(np.meshgrid(xs, ys), axis=-1).reshape(-1, 2)
    grid = grid[inside(space.floor, grid) & (from_walls(space.floor, grid) > _KEEP_OFF)]
    surface = np.full(len(grid), FLOOR)
    height = np.zeros(len(grid))
    for number, proxy in enumerate(space.layout.proxies):
        if proxy.size[2] < _RUG and proxy.placement == "floor":
            c, s = np.cos(np.radians(proxy.yaw)), np.sin(np.radians(proxy.yaw))
            offset = grid - np.array(proxy.centre[:2])
            x, y = c * offset[:, 0] + s * offset[:, 1], c * offset[:, 1] - s * offset[:, 0]
            on = (np.abs(x) < proxy.size[0] / 2) & (np.abs(y) < proxy.size[1] / 2)
            surface[on], height[on] = RUGS - number, proxy.size[2]
    points = np.concatenate([grid, height[:, None]], axis=1)
    return points, np.tile((0.0, 0.0, 1.0), (len(grid), 1)), surface


def _wall_places(space: Space) -> tuple[Floats, Floats, Floats]:
    points, normals, surface = [], [], []
    for number, wall in enumerate(space.walls):
        step = 0.18
        xs = np.arange(_KEEP_OFF + step / 2, wall.length - _KEEP_OFF, step)
        zs = np.arange(_KEEP_OFF + step / 2, wall.height - _KEEP_OFF, step)
        grid = np.stack(np.meshgrid(xs, zs), axis=-1).reshape(-1, 2)
        for low, high, bottom, top in wall.holes:
            m = _KEEP_OFF
            beside = (
                (grid[:, 0] < low - m) | (grid[:, 0] > high + m) | (grid[:, 1] < bottom - m) | (grid[:, 1] > top + m)
            )
            grid = grid[beside]
        x, y = (wall.start[i] + grid[:, 0] * wall.along[i] for i in (0, 1))
        points.append(np.stack([x, y, grid[:, 1]], axis=1))
        normals.append(np.tile((*wall.normal, 0.0), (len(grid), 1)))
        surface.append(np.full(len(grid), WALLS + number))
    if not points:
        return np.zeros((0, 3)), np.zeros((0, 3)), np.zeros(0)
    return np.concatenate(points), np.concatenate(normals), np.concatenate(surface)


def _seen(
    space: Space, camera: CameraModel, pixels: Floats, points: Floats, normals: Floats, surface: Floats
) -> Places:
    """Those of the places that the camera sees from the front."""
    lens = Projector.of(camera)
    high, wide = pixels.shape[:2]
    at = lens.pixels(points) * np.array((wide, high)) / lens.size if len(points) else np.zeros((0, 2))
    spots = np.nan_to_num(at, nan=-1.0).astype(int)
    keep = (spots[:, 0] >= 1) & (spots[:, 0] < wide - 1) & (spots[:, 1] >= 1) & (spots[:, 1] < high - 1)
    if lens.perspective:
        away = points - lens.position
        length = np.linalg.norm(away, axis=1)
        ways = away / np.maximum(length, 1e-9)[:, None]
        starts = np.broadcast_to(lens.position, points.shape)
    else:
        ways = np.broadcast_to(-lens.rotation[:, 2], points.shape)
        length = (points - lens.position) @ -lens.rotation[:, 2] + 100.0
        starts = points - length[:, None] * ways
    keep &= (ways * normals).sum(axis=1) < -0.08
    # Walls that turn their back to the camera are not in its way: such pictures leave them out.
    distance = _first_before(space, starts, ways)
    keep &= distance > length - _SEEN
    spots = spots[keep]
    return Places(points[keep], normals[keep], surface[keep], pixels[spots[:, 1], spots[:, 0]])


def _first_before(space: Space, starts: Floats, ways: Floats) -> Floats:
    """How far lines of sight go until furniture, or a wall's front, stops them."""
    distance, surface, normal = space.hit(starts, ways, ceiling=False)
    for _ in range(3):
        behind = (surface >= WALLS) & (surface < WALLS + len(space.walls)) & ((normal * ways).sum(axis=1) > 0)
        if not behind.any():
            break
        step = distance[behind] + 1e-3
        more, surface_now, normal_now = space.hit(
            starts[behind] + ways[behind] * step[:, None], ways[behind], ceiling=False
        )
        distance[behind] = np.minimum(step + more, 1e9)
        surface[behind], normal[behind] = surface_now, normal_now
    return distance


def _spread(places: Places, count: int) -> Places:
    """Evenly chosen ones where there are more."""
    if len(places.points) <= count:
        return places
    mask = np.zeros(len(places.points), dtype=bool)
    mask[np.linspace(0, len(places.points) - 1, count).astype(int)] = True
    return places.only(mask)
