# SPDX-License-Identifier: GPL-3.0-or-later
"""Faces of different things that lie in one plane and look the same way: renders show both at once, in flickering pieces."""

from __future__ import annotations

import functools
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import product

import numpy as np
from numpy.typing import NDArray

from ..geometry.polygon import intersection_area
from .bodies import Body, Room
from .columns import Floats, turned
from .faults import Fault, Knowledge, Mend, moved

SAME = 4e-4
"""Metres between two planes below which they count as one."""
APART = 0.002
"""Metres by which one of them is brought forward."""
LEAST_FACE, LEAST_SHARED = 4e-4, 1e-4
"""Square metres of a face that is looked at, and of what two faces must share."""
HIDDEN = 0.03
"""Metres before a wall within which a face that looks at it is not seen."""
_STEPS = (1, -1, 2, -2)


@dataclass(frozen=True)
class Faces:
    """A thing's larger faces in the room's frame: unit normals (N, 3), offsets (N,), and their corners.

    Attributes:
        points: the corners of all faces, one face after the other, (M, 3); lengths: how many each face has, (N,).
    """

    normals: Floats
    offsets: Floats
    points: Floats
    lengths: NDArray[np.int64]

    @functools.cached_property
    def starts(self) -> NDArray[np.int64]:
        """The first corner of each face."""
        found: NDArray[np.int64] = np.cumsum(self.lengths) - self.lengths
        return found

    def corners(self, face: int) -> Floats:
        """The corners of one face."""
        start = int(self.starts[face])
        return self.points[start : start + int(self.lengths[face])]

    @functools.cached_property
    def bounds(self) -> tuple[Floats, Floats]:
        """Lowest and highest corner of each face, (N, 3) each."""
        if not len(self.lengths):
            return np.zeros((0, 3)), np.zeros((0, 3))
        return np.minimum.reduceat(self.points, self.starts), np.maximum.reduceat(self.points, self.starts)

    @functools.cached_property
    def box(self) -> tuple[Floats, Floats]:
        """Lowest and highest corner of all faces, with what counts as one plane."""
        return self.bounds[0].min(axis=0) - SAME, self.bounds[1].max(axis=0) + SAME

    def near(self, other: Faces) -> NDArray[np.int64]:
        """Indices of the faces that come to the box round another thing's faces."""
        low, high = other.box
        return np.flatnonzero(((self.bounds[0] <= high) & (self.bounds[1] >= low)).all(axis=1))

    def only(self, kept: NDArray[np.bool_]) -> Faces:
        """Some of the faces."""
        points = self.points[np.repeat(kept, self.lengths)]
        return Faces(self.normals[kept], self.offsets[kept], points, self.lengths[kept])


def find(room: Room, knowledge: Knowledge) -> list[Fault]:
    """Pairs of objects, or an object and the floor or a wall, with faces in one plane."""
    bodies = [b for b in room.bodies.values() if not b.cloth]
    shell: dict[str, Faces] = knowledge.remember("shell", lambda: _shell(room))
    found = []
    boxes = [b.box for b in bodies]
    low, high = (np.array([box[k] for box in boxes]).reshape(-1, 3) for k in (0, 1))
    meets = ((low[None] <= high[:, None] + SAME) & (high[None] >= low[:, None] - SAME)).all(axis=2)
    for body, near in zip(bodies, np.triu(meets, 1), strict=True):
        for other in (bodies[j] for j in np.flatnonzero(near).tolist()):
            area = knowledge.remember(
                ("plane", body.id, body.line.centre, other.id, other.line.centre),
                functools.partial(_between, body, other, shell, knowledge),
            )
            if area:
                found.append(_fault(body.id, other.id, area))
        found += knowledge.remember(
            ("in the shell", body.id, body.line.centre), functools.partial(_with_shell, body, shell, knowledge)
        )
    return found


def _between(one: Body, other: Body, shell: dict[str, Faces], knowledge: Knowledge) -> float:
    """What two things share."""
    return _shared(_faces_of(one, shell, knowledge), _faces_of(other, shell, knowledge))


def _with_shell(body: Body, shell: dict[str, Faces], knowledge: Knowledge) -> list[Fault]:
    """What it shares with the floor and the walls."""
    faces = _faces_of(body, shell, knowledge)
    areas = [(name, _shared(faces, other)) for name, other in shell.items()]
    return [_fault(body.id, name, area) for name, area in areas if area]


def _fault(one: str, other: str, area: float) -> Fault:
    return Fault(
        "coincident", one, other, area, f"It has faces in one plane with {other}, {1e4 * area:.0f} cm² of them."
    )


def fix(room: Room, fault: Fault, knowledge: Knowledge) -> Iterator[Mend]:
    """The smaller of the two, then the other, brought forward by a hair along the normals of what they share."""
    pair = [room.bodies[i] for i in (fault.id, fault.other) if i in room.bodies]
    shell = _shell(room)
    faces = {b.id: _faces_of(b, shell, knowledge) for b in pair}
    other = faces.get(fault.other) or shell[fault.other]
    axes = _common_normals(faces[fault.id], other)
    ways = [
        np.sum([s * a for s, a in zip((1, *signs), axes, strict=True)], axis=0)
        for signs in product((1, -1), repeat=len(axes) - 1)
    ]
    for body in sorted(pair, key=lambda b: b.rect.width * b.rect.depth):
        for step, way in product(_STEPS, ways):
            x, y, z = (float(v) for v in np.add(body.line.centre, way * step * APART))
            said = f"Brought {1000 * abs(step) * APART:.0f} mm off the plane that it shared."
            yield moved(room, body.id, (x, y, z), said)


def _faces_of(body: Body, shell: dict[str, Faces], knowledge: Knowledge) -> Faces:
    """The larger flat faces of a body, where it is, that can be seen."""

    def make() -> Faces:
        if "faces" not in body.known:
            body.known["faces"] = _own_faces(body)
        own: Faces = body.known["faces"]
        normals = turned(own.normals, body.line.yaw, (0.0, 0.0, 0.0))
        points = turned(own.points, body.line.yaw, body.base)
        offsets = (normals * points[own.starts]).sum(axis=1)
        return _seen(Faces(normals, offsets, points, own.lengths), shell)

    found: Faces = knowledge.remember(("faces", body.id, body.line.centre), make)
    return found


def _seen(faces: Faces, shell: dict[str, Faces]) -> Faces:
    """Without what looks down, and what looks at a wall right behind it: nobody sees these."""
    if not len(faces.normals):
        return faces
    seen = faces.normals[:, 2] > -0.9
    for wall in shell.values():
        seen &= (faces.normals @ wall.normals[0] > -0.99) | (np.abs(faces.offsets + wall.offsets[0]) > HIDDEN)
    return faces.only(seen)


def _own_faces(body: Body) -> Faces:
    flat = [shape.corners for shape in body.own if shape.faces]
    points = np.concatenate([np.zeros((0, 3)), *(s.vertices[s.corners[0]] for s in body.own if s.faces)])
    lengths = np.concatenate([np.zeros(0, dtype=np.int64), *(found for _, found in flat)])
    if not len(lengths):
        return Faces(np.zeros((0, 3)), np.zeros(0), points, lengths)
    starts = np.cumsum(lengths) - lengths
    ahead = np.arange(1, len(points) + 1)
    ahead[starts + lengths - 1] = starts
    # Newell's normal: half the sum of the cross products of following corners.
    here = points - np.repeat(points[starts], lengths, axis=0)
    cross = np.add.reduceat(np.cross(here, here[ahead]), starts) / 2
    area = np.linalg.norm(cross, axis=1)
    large = area > LEAST_FACE
    every = Faces(cross / np.maximum(area, 1e-30)[:, None], np.zeros(len(lengths)), points, lengths)
    return every.only(large)


def _shell(room: Room) -> dict[str, Faces]:
    """The floor and the inner faces of the walls that bound the room."""
    floor = np.array([(x, y, 0.0) for x, y in room.layout.room.floor])
    found = {"floor": Faces(np.array([[0.0, 0.0, 1.0]]), np.zeros(1), floor, np.array([len(floor)]))}
    for wall in room.layout.walls:
        if wall.partition:
            continue
        (ax, ay), (bx, by) = wall.start, wall.end
        length = max(1e-9, float(np.hypot(bx - ax, by - ay)))
        normal = np.array((-(by - ay) / length, (bx - ax) / length, 0.0))
        face = np.array([(ax, ay, 0.0), (bx, by, 0.0), (bx, by, wall.height), (ax, ay, wall.height)])
        found[wall.id] = Faces(normal[None], np.array([float(normal @ face[0])]), face, np.array([4]))
    return found


def _pairs(a: Faces, b: Faces) -> list[tuple[int, int]]:
    if not len(a.normals) or not len(b.normals):
        return []
    own, others = a.near(b), b.near(a)
    same = a.normals[own] @ b.normals[others].T > 1 - 1e-6
    same &= np.abs(a.offsets[own][:, None] - b.offsets[others][None]) < SAME
    return [(int(own[i]), int(others[j])) for i, j in np.argwhere(same)]


def _shared(a: Faces, b: Faces) -> float:
    """Square metres that faces of one share with faces of the other in one plane; 0 below `LEAST_SHARED`."""
    total = sum(_area(a.corners(i), b.corners(j), a.normals[i]) for i, j in _pairs(a, b))
    return total if total > LEAST_SHARED else 0.0


def _area(one: Floats, other: Floats, normal: Floats) -> float:
    """What two polygons in one plane share."""
    axis = np.eye(3)[int(np.abs(normal).argmin())]
    along = np.cross(normal, axis)
    along /= np.linalg.norm(along)
    frame = np.stack([along, np.cross(normal, along)], axis=1)
    return float(intersection_area((one @ frame).tolist(), (other @ frame).tolist()))


def _common_normals(a: Faces, b: Faces) -> list[Floats]:
    """The directions, at most three and each without its opposite, of planes in which two things share area; most first."""
    areas = sorted(((_area(a.corners(i), b.corners(j), a.normals[i]), i) for i, j in _pairs(a, b)), reverse=True)
    found: list[Floats] = []
    for area, i in areas:
        if (area > 0.0 or not found) and len(found) < 3 and all(abs(a.normals[i] @ f) < 0.99 for f in found):
            found.append(a.normals[i])
    return found
