# SPDX-License-Identifier: GPL-3.0-or-later
"""A room that rays can be sent through: its walls with their holes, its floor and ceiling, and a box or two an object.

Coarse on purpose: it answers in a fraction of a second what a render would tell in minutes. Metres, the room's frame.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from ..artifacts.layout import Layout
from ..geometry.polygon import Floats
from ..program.prelude.holes import wall_holes
from ..program.prelude.palette import role_colour
from ..program.prelude.pieces import Hole, WallRun
from ..program.prelude.record import Record
from ..program.prelude.walls import wall_runs
from .bulk import FAR, SKIN, Bools, Boxes, Ints, entered, furniture_boxes, near, veils_of
from .tone import luminance

_AT_ONCE = 2048  # rays
SKY, FLOOR, CEILING, WALLS = -1, 0, 1, 2
"""What a ray meets: the outside, the floor, the ceiling, walls from `WALLS` on, then boxes."""


@dataclass(frozen=True)
class Wall:
    """One face of a wall that the room can see: a rectangle with holes.

    Attributes:
        start: its lower left corner as seen from the room; along: unit vector (x, y); normal: into the room.
        holes: (from, to, lower, upper) along it and above the floor.
    """

    id: str
    start: tuple[float, float]
    along: tuple[float, float]
    length: float
    height: float
    normal: tuple[float, float]
    holes: tuple[tuple[float, float, float, float], ...] = ()
    glazed: tuple[tuple[float, float, float, float], ...] = ()


@dataclass(frozen=True)
class Space:
    """A room for rays.

    Attributes:
        floor: outline, counter-clockwise; height: of the ceiling.
        albedo: luminance that floor, ceiling and each wall give back, by surface number.
        veils: what light goes through in part.
    """

    floor: Floats
    height: float
    walls: tuple[Wall, ...]
    boxes: Boxes
    veils: Boxes
    albedo: Floats
    layout: Layout = field(repr=False)

    def hit(
        self, origins: Floats, ways: Floats, boxes: bool = True, ceiling: bool = True
    ) -> tuple[Floats, Ints, Floats]:
        """What rays (N, 3) meet first: distance (1e9 for the sky), surface number, and its normal (N, 3)."""
        count = len(origins)
        distance = np.full(count, FAR)
        surface = np.full(count, SKY, dtype=np.int64)
        normal = np.zeros((count, 3))
        with np.errstate(divide="ignore", invalid="ignore"):
            levels = [(0.0, -1.0, FLOOR)] + ([(self.height, 1.0, CEILING)] if ceiling else [])
            for level, side, number in levels:
                t = (level - origins[:, 2]) / ways[:, 2]
                meets = ways[:, 2] * side > 0
                # Rays that left by a window meet neither.
                meets[meets] = inside(self.floor, (origins[meets] + t[meets, None] * ways[meets])[:, :2])
                self._take(distance, surface, normal, t, meets, number, (0.0, 0.0, -side))
            for number, wall in enumerate(self.walls):
                t, meets = _wall_hit(wall, origins, ways)
                self._take(distance, surface, normal, t, meets, WALLS + number, (*wall.normal, 0.0))
        if boxes and len(self.boxes.centres):
            self._boxes_hit(origins, ways, distance, surface, normal)
        return distance, surface, normal

    def blocked(self, origins: Floats, ways: Floats, lengths: Floats, boxes: bool = True) -> Bools:
        """Whether something stands within these lengths (N,) of rays whose directions are unit vectors."""
        distance, surface, _ = self.hit(origins, ways, boxes)
        result: Bools = (surface != SKY) & (distance < lengths - 1e-3)
        return result

    def let_through(self, origins: Floats, ways: Floats, lengths: Floats) -> Floats:
        """How much of the light on rays (N, 3) of these lengths goes through the curtains before them, (N,)."""
        passed = np.ones(len(origins))
        if len(self.veils.centres) and len(origins):
            ray, box = np.nonzero(near(self.veils, origins, ways))
            enter, _, _ = entered(self.veils, box, origins[ray], ways[ray], lengths[ray])
            met = enter < FAR
            np.multiply.at(passed, ray[met], self.veils.albedo[box[met]])
        return passed

    def albedo_of(self, surface: Ints) -> Floats:
        """Luminance that surfaces give back; 0 for the sky."""
        table = np.concatenate([self.albedo, self.boxes.albedo, [0.0]])
        result: Floats = table[surface]
        return result

    def owner(self, surface: int) -> str | None:
        """Id of the object whose box a surface number is, None for the shell."""
        index = surface - WALLS - len(self.walls)
        return self.boxes.owners[index] if index >= 0 else None

    def _take(
        self,
        distance: Floats,
        surface: Ints,
        normal: Floats,
        t: Floats,
        meets: Bools,
        number: int,
        facing: tuple[float, ...],
    ) -> None:
        nearer = meets & (t > SKIN) & (t < distance)
        distance[nearer] = t[nearer]
        surface[nearer] = number
        normal[nearer] = facing

    def _boxes_hit(self, origins: Floats, ways: Floats, distance: Floats, surface: Ints, normal: Floats) -> None:
        b = self.boxes
        for start in range(0, len(origins), _AT_ONCE):
            part = slice(start, start + _AT_ONCE)
            ray, box = np.nonzero(near(b, origins[part], ways[part]))
            ray += start
            enter, axis, sign = entered(b, box, origins[ray], ways[ray], distance[ray])
            # Of the boxes that a ray meets the nearest, and of equally near ones the first.
            met = np.flatnonzero(enter < FAR)
            met = met[np.lexsort((box[met], enter[met], ray[met]))]
            met = met[np.diff(ray[met], prepend=-1) > 0]
            index, box, axis, sign = ray[met], box[met], axis[met], sign[met]
            distance[index] = enter[met]
            surface[index] = WALLS + len(self.walls) + box
            c, s = b.cosines[box], b.sines[box]
            along = [np.where(axis == k, sign, 0.0) for k in range(3)]
            normal[index] = np.stack([c * along[0] - s * along[1], s * along[0] + c * along[1], along[2]], axis=1)


def _wall_hit(wall: Wall, origins: Floats, ways: Floats) -> tuple[Floats, Bools]:
    """Distance to a wall's face, and which rays meet its solid part from either side."""
    nx, ny = wall.normal
    toward = ways[:, 0] * nx + ways[:, 1] * ny
    dx, dy = origins[:, 0] - wall.start[0], origins[:, 1] - wall.start[1]
    t = -(dx * nx + dy * ny) / toward
    ax, ay = wall.along
    x = (dx + t * ways[:, 0]) * ax + (dy + t * ways[:, 1]) * ay
    z = origins[:, 2] + t * ways[:, 2]
    meets = (x >= 0) & (x <= wall.length) & (z >= 0) & (z <= wall.height) & np.isfinite(t)
    for low, high, bottom, top in wall.holes:
        meets &= ~((x > low) & (x < high) & (z > bottom) & (z < top))
    return t, meets


def space_of(layout: Layout, albedo: dict[str, float] | None = None) -> Space:
    """The room that a layout describes.

    Args:
        albedo: luminance that things give back, by their id, "floor", "walls" or "ceiling"; the palette's otherwise.
    """
    given = albedo or {}
    record = Record(room=layout.room.model_dump())
    for name in ("walls", "doors", "windows", "openings"):
        setattr(record, name, [line.model_dump() for line in getattr(layout, name)])
    floor = [(float(x), float(y)) for x, y in layout.room.floor]
    runs = wall_runs(record.walls, floor)
    holes = wall_holes(record, runs, [])
    walls = tuple(face for run in runs for face in _faces(run, holes[run.id]))
    height = max([run.height for run in runs if not run.partition] or [layout.room.size[2]])
    plain = given.get("walls", _usual("wall"))
    surfaces = [given.get("floor", _usual("floor")), given.get("ceiling", 0.8)]
    surfaces += [given.get(wall.id, plain) for wall in walls]
    return Space(
        floor=np.array(floor, dtype=float),
        height=height,
        walls=walls,
        boxes=furniture_boxes(layout.proxies, given),
        veils=veils_of(layout.proxies),
        albedo=np.array(surfaces, dtype=float),
        layout=layout,
    )


def _usual(part: str) -> float:
    return float(luminance(np.array(role_colour(part, "")[:3])))


def _faces(run: WallRun, holes: list[Hole]) -> list[Wall]:
    """The faces of a wall: one for outer walls, both for partitions."""
    dx, dy = run.direction
    faces = []
    for side in (run.left, run.right) if run.partition else (0.0,):
        normal = (-dy, dx) if side >= 0 else (dy, -dx)
        start = (run.start[0] - dy * side, run.start[1] + dx * side)
        spans = [(h.kind, (*h.x, *h.z)) for h in holes if h.kind != "door" or abs(h.line.get("open", 0.0)) > 30]
        faces.append(
            Wall(run.id, start, (dx, dy), run.length, run.height, normal,
                 tuple(s for _, s in spans), tuple(s for k, s in spans if k == "window"))
        )  # fmt: skip
    return faces


def inside(floor: Floats, points: Floats) -> Bools:
    """Which points (N, 2) lie within the floor's outline."""
    x, y = points[:, 0], points[:, 1]
    result = np.zeros(len(points), dtype=bool)
    for (ax, ay), (bx, by) in zip(floor, np.roll(floor, -1, axis=0), strict=True):
        crosses = (ay > y) != (by > y)
        with np.errstate(divide="ignore", invalid="ignore"):
            at = (bx - ax) * (y - ay) / (by - ay) + ax
        result ^= crosses & (x < at)
    return result


def from_walls(floor: Floats, points: Floats) -> Floats:
    """Distance of points (N, 2) from the floor's outline, metres."""
    best = np.full(len(points), FAR)
    for a, b in zip(floor, np.roll(floor, -1, axis=0), strict=True):
        edge = b - a
        t = np.clip(((points - a) @ edge) / max(float(edge @ edge), 1e-12), 0.0, 1.0)
        best = np.minimum(best, np.linalg.norm(points - a - t[:, None] * edge, axis=1))
    return best
