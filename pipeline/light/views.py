# SPDX-License-Identifier: GPL-3.0-or-later
"""From where the finished room is looked at: straight from above with its walls cut, and twice from eye level.

An eye stands in the room at a person's height, outside of furniture and not before a tall back, looks level (so that walls
stay upright) and sees as much as possible of the larger objects; the second one looks for what the first one missed.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from ..artifacts.layout import CameraLine, Layout
from ..geometry.polygon import Floats
from .space import SKY, WALLS, Bools, Space, from_walls, inside

TOP, EYES = "top", ("eye_1", "eye_2")
EYE_HEIGHT = 1.5
LENS_MM, SENSOR_MM = 24.0, 36.0
EYE_SIZE, TOP_LONG_SIDE = (1536, 1024), 1536
LEAST_FREE = 0.45
"""Metres in front of an eye that nothing may stand in."""
_ABOVE = 3.0  # metres of the top camera above the walls
_FRAME = 1.06  # the top view shows this much more than the room with its walls
_LOWEST_CUT = 1.2
_DOORS = 2.0  # metres: walls are cut below the lintels, where furniture allows it
_FROM_WALL = 0.22  # metres between an eye and the walls
_FROM_THINGS = 0.12
_AZIMUTHS, _HEIGHTS = 72, 11
_LOOKS = 24
_MOST_PLACES = 28
_SHIFT = 0.12  # of the picture's height by which the horizon is raised, to show more of the floor
_LOW = 0.5  # metres: an eye may stand above what is lower than this
_ENOUGH = 0.012  # share of the picture with which an object counts as fully shown


@dataclass(frozen=True)
class Eye:
    """A place to look from: degrees of the look counter-clockwise from +X, and the share of larger objects it sees."""

    at: tuple[float, float, float]
    look: float
    seen: frozenset[str]
    score: float


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


def eye_cameras(space: Space, names: tuple[str, ...] = EYES) -> tuple[list[CameraLine], dict[str, float]]:
    """Up to as many eye-level cameras as there are names, and the share of larger objects that each sees."""
    wanted = {p.id for p in space.layout.proxies if p.salience == "major" and p.size[2] > 0.05}
    wanted &= set(space.boxes.owners)
    eyes: list[Eye] = []
    candidates = _candidates(space)
    for _ in names:
        best = max((e for c in candidates for e in _looks(space, c, wanted, eyes)), key=lambda e: e.score, default=None)
        if best is None:
            break
        eyes.append(best)
    lines = [eye_line(name, eye) for name, eye in zip(names, eyes, strict=False)]
    return lines, {line.id: len(eye.seen) / max(1, len(wanted)) for line, eye in zip(lines, eyes, strict=True)}


def eye_line(name: str, eye: Eye) -> CameraLine:
    """The camera of an eye: level, its lens shifted down."""
    angle = math.radians(eye.look)
    forward = np.array((math.cos(angle), math.sin(angle), 0.0))
    right = np.array((forward[1], -forward[0], 0.0))
    matrix = np.eye(4)
    matrix[:3, 0], matrix[:3, 1], matrix[:3, 2], matrix[:3, 3] = right, (0.0, 0.0, 1.0), -forward, eye.at
    return CameraLine(
        id=name,
        kind="perspective",
        matrix=_flat(matrix),
        fov_y=fov_y(),
        image_size=EYE_SIZE,
        principal=(500.0, round(1000 * (0.5 - _SHIFT), 1)),
    )


def fov_y() -> float:
    """The vertical field of view of the eyes' lens, radians."""
    return 2 * math.atan(SENSOR_MM * EYE_SIZE[1] / EYE_SIZE[0] / 2 / LENS_MM)


def _candidates(space: Space) -> list[_Panorama]:
    """Places to stand, each with what is to be seen from it."""
    height = min(EYE_HEIGHT, 0.62 * space.height)
    low, high = space.floor.min(axis=0), space.floor.max(axis=0)
    step = max(0.25, float(np.sqrt(np.prod(high - low) / 90)))
    xs, ys = (
        np.linspace(low[i] + _FROM_WALL, high[i] - _FROM_WALL, max(2, round((high[i] - low[i]) / step))) for i in (0, 1)
    )
    grid = np.stack(np.meshgrid(xs, ys), axis=-1).reshape(-1, 2)
    corners = _inner_corners(space.floor)
    grid = np.concatenate([grid, corners]) if len(corners) else grid
    grid = grid[inside(space.floor, grid) & (from_walls(space.floor, grid) > 0.8 * _FROM_WALL)]
    grid = grid[_free(space, grid, height)]
    # From the middle of a room half of it is behind one's back.
    if len(grid) > _MOST_PLACES:
        near = np.argsort(from_walls(space.floor, grid), kind="stable")[:_MOST_PLACES]
        grid = grid[near]
    return _panoramas(space, [(float(x), float(y), height) for x, y in grid])


def _inner_corners(floor: Floats) -> Floats:
    """Places a little inside each corner of the room."""
    places = []
    for before, corner, after in zip(np.roll(floor, 1, axis=0), floor, np.roll(floor, -1, axis=0), strict=True):
        a, b = before - corner, after - corner
        a, b = a / max(float(np.linalg.norm(a)), 1e-9), b / max(float(np.linalg.norm(b)), 1e-9)
        if a[1] * b[0] - a[0] * b[1] > 0.2:
            places.append(corner + (a + b) * 1.3 * _FROM_WALL)
    return np.array(places, dtype=float).reshape(-1, 2)


def _free(space: Space, places: Floats, height: float) -> Bools:
    """Places at which nobody would stand in furniture, in a partition, or with the eyes in something that hangs."""
    free = np.ones(len(places), dtype=bool)
    for p in space.layout.proxies:
        low, high = p.centre[2] - p.size[2] / 2, p.centre[2] + p.size[2] / 2
        if high < _LOW or low > height + 0.25:
            continue
        c, s = math.cos(math.radians(p.yaw)), math.sin(math.radians(p.yaw))
        offset = places - np.array(p.centre[:2])
        x, y = c * offset[:, 0] + s * offset[:, 1], c * offset[:, 1] - s * offset[:, 0]
        m = _FROM_THINGS
        free &= (np.abs(x) > p.size[0] / 2 + m) | (np.abs(y) > p.size[1] / 2 + m)
    for wall in space.walls:
        offset = places - np.array(wall.start)
        along = offset @ np.array(wall.along)
        off = np.abs(offset @ np.array(wall.normal))
        free &= (along < -0.2) | (along > wall.length + 0.2) | (off > 0.8 * _FROM_WALL)
    return free


@dataclass(frozen=True)
class _Panorama:
    """What is seen all round a place.

    Attributes:
        distance: of what is seen, (azimuths, heights). shown: how many lines of sight end on each of the owners in each
            azimuth, (azimuths, owners). sky: how many end nowhere, (azimuths,).
    """

    at: tuple[float, float, float]
    distance: Floats
    shown: Floats
    sky: Floats
    owners: tuple[str, ...]


def _panoramas(space: Space, places: list[tuple[float, float, float]]) -> list[_Panorama]:
    """What is seen from each place."""
    azimuth = np.arange(_AZIMUTHS) * 2 * math.pi / _AZIMUTHS
    rise = np.linspace(*_rises(), _HEIGHTS)
    a, r = np.meshgrid(azimuth, rise, indexing="ij")
    ways = np.stack([np.cos(a), np.sin(a), r], axis=-1).reshape(-1, 3)
    ways /= np.linalg.norm(ways, axis=1, keepdims=True)
    origins = np.repeat(np.array(places, dtype=float).reshape(-1, 3), len(ways), axis=0)
    distance, surface, _ = space.hit(origins, np.tile(ways, (len(places), 1)))
    owners = tuple(dict.fromkeys(space.boxes.owners))
    numbers = np.array([owners.index(o) for o in space.boxes.owners], dtype=np.int64)
    found = []
    shape = (_AZIMUTHS, _HEIGHTS)
    for i, at in enumerate(places):
        part = slice(i * len(ways), (i + 1) * len(ways))
        box = surface[part].reshape(shape) - WALLS - len(space.walls)
        shown = np.zeros((_AZIMUTHS, len(owners)))
        rows, columns = np.nonzero(box >= 0)
        if len(rows):
            np.add.at(shown, (rows, numbers[box[rows, columns]]), 1.0)
        sky = (surface[part].reshape(shape) == SKY).sum(axis=1)
        found.append(_Panorama(at, distance[part].reshape(shape), shown, sky, owners))
    return found


def _rises() -> tuple[float, float]:
    """Tangents of the lowest and the highest line of sight of the shifted lens."""
    half = math.tan(fov_y() / 2)
    return -half * (1 + 2 * _SHIFT), half * (1 - 2 * _SHIFT)


def _looks(space: Space, view: _Panorama, wanted: set[str], before: list[Eye]) -> list[Eye]:
    """The looks from one place, with what each is worth."""
    half = math.atan(SENSOR_MM / 2 / LENS_MM)
    found = []
    known = frozenset().union(*(eye.seen for eye in before))
    for k in range(_LOOKS):
        look = 360.0 * k / _LOOKS
        turn = (np.arange(_AZIMUTHS) * 360.0 / _AZIMUTHS - look + 180) % 360 - 180
        columns = np.abs(turn) < math.degrees(half)
        distance = view.distance[columns]
        ahead = np.abs(turn) < 12
        if float(view.distance[ahead].min()) < LEAST_FREE:
            continue
        counts = view.shown[columns].sum(axis=0) / distance.size
        shares = {owner: float(share) for owner, share in zip(view.owners, counts, strict=True) if share > 0}
        seen = frozenset(i for i, share in shares.items() if i in wanted and share > _ENOUGH / 3)
        things = sum(min(1.0, shares[i] / _ENOUGH) for i in seen)
        new = sum(min(1.0, shares[i] / _ENOUGH) for i in seen - known)
        biggest = max(shares.values(), default=0.0)
        worth = (new + 0.35 * (things - new)) / max(1, len(wanted))
        worth += 0.35 * min(1.0, float(np.median(distance)) / _across(space))
        worth -= 2.0 * max(0.0, float((distance < 0.9).mean()) - 0.03) + 0.8 * max(0.0, biggest - 0.35)
        worth += 0.1 * min(1.0, 1.0 - float(view.sky[columns].sum()) / distance.size)
        for eye in before:
            apart = math.dist(eye.at, view.at) / _across(space)
            turned = abs((eye.look - look + 180) % 360 - 180) / 180
            worth += 0.35 * min(1.0, apart + turned) - 0.35
        found.append(Eye(view.at, look, seen, worth))
    return found


def _across(space: Space) -> float:
    return max(1.0, float(np.linalg.norm(np.ptp(space.floor, axis=0))))


def _outside(layout: Layout) -> tuple[Floats, Floats]:
    """The corners of the rectangle round the floor and the walls' outsides."""
    floor = np.array(layout.room.floor, dtype=float)
    thick = max((w.thickness for w in layout.walls if not w.partition), default=0.12)
    return floor.min(axis=0) - thick, floor.max(axis=0) + thick


def _flat(matrix: Floats) -> tuple[float, ...]:
    return tuple(float(v) for v in matrix.ravel())
