# SPDX-License-Identifier: GPL-3.0-or-later
"""What is seen all round a place of a room, and how much of each larger object, by rays on boxes."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, fields, replace

import numpy as np

from ..artifacts.layout import DoorLine, Layout, ProxyLine, WallLine
from ..geometry.polygon import Floats
from .bulk import FLAT, Bools, Boxes, Ints, Row, boxes_of
from .space import FLOOR, SKY, WALLS, Space

_TURNS, _RISES = 90, 12
_SLOPES = (-0.75, 0.39)
"""Lowest and highest line of sight, metres of rise a metre."""
_SIDE = 3  # points along each side of a face
_MOST = 24  # larger objects that are looked at
_WIDE = 0.3  # metres: smaller things hide nothing
_LEAF = 0.04  # metres: thickness of a door's leaf
_TALL = 1.2  # metres
_GREY = 0.5  # what is given back by what is only looked at
_CLOSE = 0.04  # metres by which a point of an object may lie behind what a ray meets


@dataclass(frozen=True)
class Panorama:
    """What is seen all round a place.

    Attributes:
        turns, rises: azimuths (A,) in degrees and slopes (1, R) of the lines of sight.
        distance: metres to what they meet. box: which box that is, -1 for others. ends: of partitions. blank: walls. sky:
            the outside. All (A, R).
        azimuth, slope: of points on the larger objects, degrees and metres a metre (P,); owner: whose they are, 0-based.
        visible: solid angle that each point stands for, 0 where it is hidden (P,); whole: of each object, if nothing hid it.
        weights: how much each larger object counts, their sum is 1; tall: which of them fill an edge of a picture.
        larger: the boxes of the larger objects.
    """

    at: tuple[float, float, float]
    turns: Floats
    rises: Floats
    distance: Floats
    box: Ints
    ends: Bools
    blank: Bools
    sky: Bools
    azimuth: Floats
    slope: Floats
    owner: Ints
    visible: Floats
    whole: Floats
    weights: Floats
    tall: Bools
    larger: frozenset[int]


def viewing_space(space: Space) -> Space:
    """A room as eyes meet it: with curtains, lamps and plants, with open doors' leaves and with the ends of partitions."""
    there = set(space.boxes.owners)
    more = [_row(p) for p in space.layout.proxies if p.id not in there and p.size[2] >= FLAT and max(p.size) > _WIDE]
    more += open_leaves(space.layout)
    more += [end for w in space.layout.walls if w.partition for end in _ends(w)]
    if not more:
        return space
    b, added = space.boxes, boxes_of(more)
    joined = {f.name: np.concatenate([getattr(b, f.name), getattr(added, f.name)]) for f in fields(Boxes)[:-1]}
    return replace(space, boxes=Boxes(**joined, owners=(*b.owners, *added.owners)))


def _row(p: ProxyLine) -> Row:
    return (p.id, p.centre, (p.size[0] / 2, p.size[1] / 2, p.size[2] / 2), p.yaw, _GREY)


def open_leaves(layout: Layout) -> list[Row]:
    """The leaves of doors that stand open: id, centre, half sizes in metres, yaw in degrees."""
    walls = {w.id: w for w in layout.walls}
    return [_leaf(d, walls[d.wall]) for d in layout.doors if d.open and d.wall in walls]


def _leaf(door: DoorLine, wall: WallLine) -> Row:
    """The leaf of a door that stands open."""
    way = (door.end[0] - door.start[0], door.end[1] - door.start[1])
    runs = way[0] * (wall.end[0] - wall.start[0]) + way[1] * (wall.end[1] - wall.start[1])
    yaw = math.degrees(math.atan2(way[1], way[0])) + (door.open if runs >= 0 else -door.open)
    half = math.hypot(*way) / 2
    x, y = half * math.cos(math.radians(yaw)), half * math.sin(math.radians(yaw))
    centre = (door.start[0] + x, door.start[1] + y, door.height / 2)
    return (door.id, centre, (half, _LEAF / 2, door.height / 2), yaw, _GREY)


def _ends(wall: WallLine) -> list[Row]:
    """Thin boxes that close the ends of a partition, which for rays is two faces only."""
    yaw = math.degrees(math.atan2(wall.end[1] - wall.start[1], wall.end[0] - wall.start[0]))
    half = (0.01, wall.thickness / 2, wall.height / 2)
    return [(wall.id, (*end, wall.height / 2), half, yaw, _GREY) for end in (wall.start, wall.end)]


def panoramas(view: Space, places: Sequence[tuple[float, float, float]]) -> Iterator[Panorama]:
    """What is seen from each place of a `viewing_space`."""
    turns, rises = np.arange(_TURNS) * 360.0 / _TURNS, np.linspace(*_SLOPES, _RISES)
    a, r = np.meshgrid(np.radians(turns), rises, indexing="ij")
    ways = np.stack([np.cos(a), np.sin(a), r], axis=-1).reshape(-1, 3)
    ways /= np.linalg.norm(ways, axis=1, keepdims=True)
    points, normals, areas, owner, boxes, weights, tall = _points(view)
    roots = _roots(view)
    shape = (_TURNS, _RISES)
    walls = {w.id for w in view.layout.walls}
    partition = np.array([o in walls for o in view.boxes.owners] or [False])
    for at in places:
        eye = np.array(at)
        way = points - eye
        far = np.maximum(np.linalg.norm(way, axis=1), 1e-6)
        facing = -np.einsum("ij,ij->i", way, normals) / far
        share = np.where(facing > 0.02, areas * facing / far**2, 0.0)
        origins = np.broadcast_to(eye, (len(ways) + len(points), 3))
        distance, surface, _ = view.hit(origins, np.concatenate([ways, way / far[:, None]]))
        box = surface - WALLS - len(view.walls)
        met = box[len(ways) :]
        clear = ((met >= 0) & (roots[np.maximum(met, 0)] == roots[boxes])) | (distance[len(ways) :] > far - _CLOSE)
        around = box[: len(ways)].reshape(shape)
        kind = surface[: len(ways)].reshape(shape)
        ends = (around >= 0) & partition[np.maximum(around, 0)]
        yield Panorama(
            at=at,
            turns=turns,
            rises=rises[None, :],
            distance=distance[: len(ways)].reshape(shape),
            box=np.where(ends, -1, around),
            ends=ends,
            blank=ends | ((kind > FLOOR) & (around < 0)),
            sky=kind == SKY,
            azimuth=np.degrees(np.arctan2(way[:, 1], way[:, 0])),
            slope=way[:, 2] / np.maximum(np.hypot(way[:, 0], way[:, 1]), 1e-6),
            owner=owner,
            visible=np.where(clear, share, 0.0),
            whole=np.bincount(owner, share, len(weights)).astype(float),
            weights=weights,
            tall=tall,
            larger=frozenset(boxes.tolist()),
        )


def _points(view: Space) -> tuple[Floats, Floats, Floats, Ints, Ints, Floats, Bools]:
    """Points all over the larger objects: place, normal, area, owner and box of each; and what each owner counts."""
    larger = [p for p in view.layout.proxies if p.salience == "major" and p.size[2] > FLAT]
    index = {owner: i for i, owner in reversed(list(enumerate(view.boxes.owners)))}
    larger = [p for p in larger if p.id in index]
    larger.sort(key=lambda p: -_importance(p))
    larger = larger[:_MOST]
    steps = (np.arange(_SIDE) + 0.5) / _SIDE * 2 - 1
    u, v = (m.ravel() for m in np.meshgrid(steps, steps))
    rows: list[Floats] = []
    for number, p in enumerate(larger):
        i = index[p.id]
        b = view.boxes
        half, c, s = b.halves[i], b.cosines[i], b.sines[i]
        turn = np.array(((c, -s, 0), (s, c, 0), (0, 0, 1)))
        for axis, sign in ((0, 1), (0, -1), (1, 1), (1, -1), (2, 1)):
            others = [k for k in range(3) if k != axis]
            local = np.zeros((len(u), 3))
            local[:, axis], local[:, others[0]], local[:, others[1]] = sign, u, v
            place = (local * half) @ turn.T + b.centres[i]
            normal = np.repeat((turn[:, axis] * sign)[None], len(u), axis=0)
            area = np.full((len(u), 1), 4 * half[others[0]] * half[others[1]] / len(u))
            rows.append(np.concatenate([place, normal, area, np.full((len(u), 1), number), np.full((len(u), 1), i)], 1))
    data = np.concatenate(rows) if rows else np.zeros((0, 9))
    weights = np.array([_importance(p) for p in larger])
    weights = weights / weights.sum() if len(weights) else weights
    tall = np.array([p.centre[2] + p.size[2] / 2 > _TALL for p in larger], dtype=bool)
    return (
        data[:, :3],
        data[:, 3:6],
        data[:, 6],
        data[:, 7].astype(np.int64),
        data[:, 8].astype(np.int64),
        weights,
        tall,
    )


def _roots(view: Space) -> Ints:
    """A number for each box that is the same for a thing and all that lies on it: a duvet does not hide its bed."""
    parents = {p.id: p.parent for p in view.layout.proxies if p.placement == "surface"}
    numbers: dict[str, int] = {}
    found = []
    for name in view.boxes.owners:
        for _ in range(len(parents)):
            name = parents.get(name) or name
        found.append(numbers.setdefault(name, len(numbers)))
    return np.array(found or [0], dtype=np.int64)


def _importance(p: ProxyLine) -> float:
    """Larger things count more, but not as much as they are larger; a curtain less than a bed that is as high as it is long."""
    w, d, h = p.size
    return math.cbrt(w * d * h)
