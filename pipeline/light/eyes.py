# SPDX-License-Identifier: GPL-3.0-or-later
"""The two views of a room that a photographer of interiors would take, found by rays on boxes.

Each eye stands on free floor at a person's height and looks level (so that walls stay upright) through the longest clear
space. What counts is how much of each larger object is seen and how large, uncut by the frame; what is close to the lens,
blank or glaring counts against it. The two are chosen together: from different sides, and showing most between them.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from ..artifacts.layout import CameraLine
from ..geometry.polygon import Floats
from .bulk import Bools
from .panorama import Panorama, open_leaves, panoramas, viewing_space
from .space import Space, from_walls, inside

EYES = ("eye_1", "eye_2")
EYE_HEIGHT = 1.5
LENSES = ((24.0, 0.12), (24.0, 0.22), (28.0, 0.15))
"""Focal lengths in mm, and the part of the picture's height by which the horizon is raised, to show more of the floor."""
SENSOR_MM = 36.0
EYE_SIZE = (1536, 1024)
LEAST_FREE = 0.8
"""Metres in the middle of the picture that nothing may stand in, in rooms that have the space for it."""
_FROM_WALL, _FROM_THINGS = 0.3, 0.25  # metres; less where no place has it
_TINY = 7.0  # square metres: a room in which one stands with the back to the wall
_LOW = 0.2  # metres: an eye may stand above what is lower than this
_MOST_PLACES = 48
_APART = 20.0  # degrees between the looks that are kept of one place
_KEPT = 3
_PAIRED = 90
_TURNED = 60.0  # degrees between the two looks
_LARGE = 0.025  # part of the picture with which an object is shown well
_WHOLE = 0.7  # part of an object's own faces that is as good as all of it
_SEEN = 0.2  # of what would show an object perfectly: from there on it counts as seen


@dataclass(frozen=True)
class Eye:
    """A place to look from.

    Attributes:
        look: degrees counter-clockwise from +X. lens: one of `LENSES`. shown: how well each larger object is shown,
            0..1, in the panoramas' order. score: what the view is worth by itself.
    """

    at: tuple[float, float, float]
    look: float
    lens: tuple[float, float]
    shown: tuple[float, ...]
    score: float


def eye_cameras(space: Space, names: tuple[str, ...] = EYES) -> tuple[list[CameraLine], dict[str, float]]:
    """Up to two eye-level cameras with these names, and the share of larger objects that each sees."""
    view = viewing_space(space)
    places = _places(space)
    weights, eyes = np.zeros(0), []
    for panorama in panoramas(view, places):
        weights = panorama.weights
        eyes += _looks(panorama, space)
    chosen = _chosen(eyes, weights, _across(space))[: len(names)]
    lines = [eye_line(name, eye) for name, eye in zip(names, chosen, strict=False)]
    seen = [sum(s >= _SEEN for s in eye.shown) / max(1, len(weights)) for eye in chosen]
    return lines, {line.id: share for line, share in zip(lines, seen, strict=True)}


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
        matrix=tuple(float(v) for v in matrix.ravel()),
        fov_y=2 * math.atan(_half(eye.lens)[1]),
        image_size=EYE_SIZE,
        principal=(500.0, round(1000 * (0.5 - eye.lens[1]), 1)),
    )


def _half(lens: tuple[float, float]) -> tuple[float, float]:
    """Half the picture's width and height at 1 m."""
    return SENSOR_MM / 2 / lens[0], SENSOR_MM / 2 / lens[0] * EYE_SIZE[1] / EYE_SIZE[0]


def _within(y: Floats, lens: tuple[float, float]) -> Bools:
    """Whether heights at 1 m are within the picture."""
    half = _half(lens)[1]
    found: Bools = (y > -half * (1 + 2 * lens[1])) & (y < half * (1 - 2 * lens[1]))
    return found


def _places(space: Space) -> list[tuple[float, float, float]]:
    """Places to stand, spread over the free floor, its corners first."""
    height = min(EYE_HEIGHT, 0.62 * space.height)
    low, high = space.floor.min(axis=0), space.floor.max(axis=0)
    step = min(0.4, max(0.15, float(np.sqrt(np.prod(high - low) / 260))))
    for ease in (1.0, 0.6, 0.3, 0.1) if _area(space.floor) > _TINY else (0.4, 0.1):
        margin = ease * _FROM_WALL
        xs, ys = (
            np.linspace(low[i] + margin, high[i] - margin, max(2, round((high[i] - low[i]) / step))) for i in (0, 1)
        )
        grid = np.stack(np.meshgrid(xs, ys), axis=-1).reshape(-1, 2)
        corners = _inner_corners(space.floor, margin)
        grid = np.concatenate([corners, grid]) if len(corners) else grid
        grid = grid[inside(space.floor, grid) & (from_walls(space.floor, grid) > 0.95 * margin)]
        grid = grid[_free(space, grid, height, ease)]
        if len(grid) >= 4:
            break
    return [(float(x), float(y), height) for x, y in _spread(grid)]


def _spread(grid: Floats) -> Floats:
    """The places that are farthest from each other, the first one kept."""
    if len(grid) <= _MOST_PLACES:
        return grid
    chosen, off = [0], np.linalg.norm(grid - grid[0], axis=1)
    while len(chosen) < _MOST_PLACES:
        chosen.append(int(off.argmax()))
        off = np.minimum(off, np.linalg.norm(grid - grid[chosen[-1]], axis=1))
    return grid[chosen]


def _inner_corners(floor: Floats, margin: float) -> Floats:
    """Places a little inside each corner of the room."""
    places = []
    for before, corner, after in zip(np.roll(floor, 1, axis=0), floor, np.roll(floor, -1, axis=0), strict=True):
        a, b = before - corner, after - corner
        a, b = a / max(float(np.linalg.norm(a)), 1e-9), b / max(float(np.linalg.norm(b)), 1e-9)
        if a[1] * b[0] - a[0] * b[1] > 0.2:
            places.append(corner + (a + b) * 1.02 * margin)
    return np.array(places, dtype=float).reshape(-1, 2)


def _free(space: Space, places: Floats, height: float, ease: float) -> Bools:
    """Places at which nobody would stand in furniture, in a partition, in an open door's leaf, or with the eyes in something that hangs."""
    free = np.ones(len(places), dtype=bool)
    m = ease * _FROM_THINGS
    for p in space.layout.proxies:
        low, high = p.centre[2] - p.size[2] / 2, p.centre[2] + p.size[2] / 2
        if high < _LOW or low > height + 0.25:
            continue
        x, y = _turned(places - np.array(p.centre[:2]), p.yaw)
        free &= (np.abs(x) > p.size[0] / 2 + m) | (np.abs(y) > p.size[1] / 2 + m)
    for _, centre, half, yaw, _ in open_leaves(space.layout):
        x, y = _turned(places - np.array(centre[:2]), yaw)
        free &= (np.abs(x) > half[0] + m) | (np.abs(y) > half[1] + m)
    for wall in space.walls:
        offset = places - np.array(wall.start)
        along = offset @ np.array(wall.along)
        off = np.abs(offset @ np.array(wall.normal))
        margin = 0.8 * ease * _FROM_WALL
        free &= (along < -margin) | (along > wall.length + margin) | (off > margin)
    return free


def _turned(offset: Floats, yaw: float) -> tuple[Floats, Floats]:
    """Offsets (N, 2) from something's middle along its own width and depth."""
    c, s = math.cos(math.radians(yaw)), math.sin(math.radians(yaw))
    return c * offset[:, 0] + s * offset[:, 1], c * offset[:, 1] - s * offset[:, 0]


def _looks(view: Panorama, space: Space) -> list[Eye]:
    """The best looks from one place."""
    found: list[tuple[float, float, tuple[float, float], Floats]] = []
    for lens in LENSES:
        shown, cut = _shown(view, lens)
        worth = shown @ view.weights - cut + _frame_worth(view, lens, _across(space))
        found += [(float(w), float(t), lens, s) for w, t, s in zip(worth, view.turns, shown, strict=True)]
    found.sort(key=lambda f: -f[0])
    kept: list[Eye] = []
    for score, look, lens, shares in found:
        if len(kept) < _KEPT and all(_between(look, eye.look) >= _APART for eye in kept):
            kept.append(Eye(view.at, look, lens, tuple(float(s) for s in shares), score))
    return kept


def _shown(view: Panorama, lens: tuple[float, float]) -> tuple[Floats, Floats]:
    """How well each larger object is shown, 0..1, by looks (L, objects): by how much of it is seen, and how large.

    The second array (L,) is how much the frame cuts off what fills it, tall things above all.
    """
    half_x, half_y = _half(lens)
    there = view.visible > 0.0
    turn = np.radians((view.azimuth[there] - view.turns[:, None] + 180.0) % 360.0 - 180.0)
    cos = np.cos(turn)
    y = view.slope[there] / np.maximum(cos, 0.1)
    framed = (cos > math.cos(math.atan(half_x))) & _within(y, lens)
    whose = np.zeros((int(there.sum()), len(view.weights)))
    whose[np.arange(len(whose)), view.owner[there]] = view.visible[there]
    seen = framed @ whose
    part = seen / np.maximum(view.whole, 1e-9)
    fills = seen / (4 * half_x * half_y)
    cut = np.minimum(0.25, fills) * (1.0 - seen / np.maximum(whose.sum(axis=0), 1e-9))
    shown: Floats = np.minimum(1.0, part / _WHOLE) * np.sqrt(np.minimum(1.0, fills / _LARGE))
    return shown, cut @ np.where(view.tall, 1.5, 0.5)


def _frame_worth(view: Panorama, lens: tuple[float, float], across: float) -> Floats:
    """What pictures (L,) are worth beside their objects: depth counts for them; what is close, blank or glaring against.

    The looks are those of the panorama's lines of sight, so that every picture is a window on the same columns.
    """
    half_x, _ = _half(lens)
    step = math.radians(360.0 / len(view.turns))
    wide = int(math.atan(half_x) / step)
    turn = np.arange(-wide, wide + 1)[:, None] * step
    cos = np.cos(turn)
    x, y = np.tan(turn) * np.ones_like(view.rises), view.rises / cos
    area = np.where(_within(y, lens), cos**-3.0, 0.0)
    middle = np.where((np.abs(x) < 0.55 * half_x) & (np.abs(y) < 0.3), area, 0.0)
    edges = [np.where(side, area, 0.0) for side in (x < -0.72 * half_x, x > 0.72 * half_x)]
    columns = (np.arange(len(view.turns))[:, None] + np.arange(-wide, wide + 1)) % len(view.turns)

    def share(which: Floats | Bools, within: Floats = area) -> Floats:
        result: Floats = np.tensordot(np.asarray(which, dtype=float)[columns], within / within.sum(), 2)
        return result

    away = view.distance
    reach = min(7.0, across)
    deep = np.minimum(away, reach) / reach
    worth: Floats = 0.9 * np.sqrt(share(deep)) + 0.9 * share(deep, middle)
    worth -= 6.0 * _over(share(away < 0.55), 0.01) + 2.5 * _over(share(away < 0.95), 0.05)
    worth -= 2.0 * share(away < 1.2, middle) + 6.0 * share(away < LEAST_FREE + 0.1, middle)
    worth -= 1.2 * _over(share(view.blank & (away < 1.6)), 0.2) + 1.5 * _over(share(view.sky), 0.12)
    ends = view.ends & (away < 3.0)
    worth -= 2.0 * share(ends, middle) + 2.5 * _over(share(ends), 0.015)
    for edge in edges:
        worth -= 1.2 * _over(share((view.box >= 0) & (away < 1.9), edge), 0.25)
    for box in np.unique(view.box[view.box >= 0]):
        worth -= 1.2 * _over(share(view.box == box), 0.35 if box in view.larger else 0.15)
    return worth


def _over(value: Floats, allowed: float) -> Floats:
    result: Floats = np.maximum(0.0, value - allowed)
    return result


def _chosen(eyes: list[Eye], weights: Floats, across: float) -> list[Eye]:
    """The best pair: each good by itself, from different sides, showing most between them; the better one first."""
    eyes = sorted(eyes, key=lambda e: -e.score)
    # What shows the rest of the room may be far down the list.
    pool = eyes[:_PAIRED] + eyes[_PAIRED :: max(1, len(eyes) // _PAIRED)]
    if len(pool) < 2:
        return pool
    score = np.array([e.score for e in pool])
    shown = np.array([e.shown for e in pool]).reshape(len(pool), -1)
    look, at = np.array([e.look for e in pool]), np.array([e.at for e in pool])
    turned = np.abs((look[:, None] - look + 180.0) % 360.0 - 180.0)
    worth = score[:, None] + 0.8 * score + 1.2 * np.maximum(shown[:, None], shown) @ weights
    worth += 0.25 * np.minimum(1.0, 2 * np.linalg.norm(at[:, None] - at, axis=2) / across) + 0.25 * turned / 180
    worth -= 1.5 * np.maximum(0.0, _TURNED - turned) / _TURNED
    worth[np.tril_indices(len(pool))] = -math.inf
    one, other = np.unravel_index(int(worth.argmax()), worth.shape)
    return [pool[one], pool[other]]


def _between(one: float, other: float) -> float:
    return abs((one - other + 180.0) % 360.0 - 180.0)


def _area(floor: Floats) -> float:
    x, y = floor[:, 0], floor[:, 1]
    return abs(float(x @ np.roll(y, -1) - y @ np.roll(x, -1))) / 2


def _across(space: Space) -> float:
    return max(1.0, float(np.linalg.norm(np.ptp(space.floor, axis=0))))
