# SPDX-License-Identifier: GPL-3.0-or-later
"""The things of a built room as Blender shows them: evaluated meshes in room coordinates, with a tree to cast rays at."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import bpy
import numpy as np
from code_as_room.pipeline.scene.tags import FIELD, ID, KIND, PART, find_room_collection
from mathutils import Vector
from mathutils.bvhtree import BVHTree
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
NUDGE = 5e-4
"""Metres that a ray starts before its point, so that faces which touch exactly are hit."""


@dataclass(frozen=True)
class Body:
    """One thing, in metres in the room's frame (Z up).

    Attributes:
        points: vertices (N, 3); triangles: indices of their corners (T, 3).
        matrix: its object-to-room matrix.
        box: centre, size and yaw of its proxy as seven numbers; empty for what has none.
    """

    id: str
    kind: str
    category: str
    placement: str
    parent: str
    points: Floats
    triangles: Ints
    matrix: Floats
    box: tuple[float, ...] = ()
    furnished: bool = False

    @cached_property
    def tree(self) -> Any:
        """What rays are cast at."""
        return BVHTree.FromPolygons(self.points.tolist(), self.triangles.tolist(), all_triangles=True)

    @cached_property
    def low(self) -> Floats:
        """Lowest corner of the box around it."""
        return np.asarray(self.points.min(axis=0))

    @cached_property
    def high(self) -> Floats:
        """Highest corner of the box around it."""
        return np.asarray(self.points.max(axis=0))

    @cached_property
    def skin(self) -> Floats:
        """Its vertices, and points all over its faces."""
        corners = self.points[self.triangles]
        cross = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        area = np.linalg.norm(cross, axis=1)
        return np.concatenate([self.points, scattered(corners, area, 1500)]) if area.sum() > 0 else self.points

    @property
    def flat(self) -> bool:
        """Whether it lies flat on the floor, as rugs do."""
        return self.placement == "floor" and bool(self.high[2] - self.low[2] < 0.04)

    def direction(self, local: Sequence[float]) -> Floats:
        """A direction of its own frame in the room's."""
        found = self.matrix[:3, :3] @ np.asarray(local, dtype=float)
        return np.asarray(found / np.linalg.norm(found))


@dataclass(frozen=True)
class BuiltRoom:
    """A room as it stands in a scene: its things, its walls with what is in them, its floor, its height in metres."""

    things: dict[str, Body]
    walls: list[Body]
    floor: list[Body]
    height: float

    def children(self, name: str) -> list[Body]:
        """What stands on, hangs from or lies on a thing."""
        return [body for body in self.things.values() if body.parent == name]

    def below(self, name: str) -> set[str]:
        """A thing's children, theirs, and so on."""
        found: set[str] = set()
        waiting = [name]
        while waiting:
            for child in self.children(waiting.pop()):
                if child.id not in found:
                    found.add(child.id)
                    waiting.append(child.id)
        return found


def read_room(scene: Any) -> BuiltRoom:
    """The room that stands in a scene.

    Raises:
        ValueError: there is none.
    """
    collection = find_room_collection(scene)
    if collection is None:
        raise ValueError("There is no room of Code-as-Room in this file.")
    graph = bpy.context.evaluated_depsgraph_get()
    bodies = [b for o in collection.all_objects if o.type == "MESH" and ID in o and (b := _body(o, graph)) is not None]
    floors = [o for o in collection.all_objects if o.get(KIND) == "floor"]
    return BuiltRoom(
        {b.id: b for b in bodies if b.kind == "proxy"},
        [b for b in bodies if b.kind not in ("proxy", "floor")],
        [b for b in bodies if b.kind == "floor"],
        max((float(o.get(FIELD + "height", 0.0)) for o in floors), default=0.0),
    )


def _body(obj: Any, graph: Any) -> Body | None:
    evaluated = obj.evaluated_get(graph)
    mesh = evaluated.to_mesh()
    try:
        mesh.calc_loop_triangles()
        points = np.empty(3 * len(mesh.vertices))
        mesh.vertices.foreach_get("co", points)
        triangles = np.empty(3 * len(mesh.loop_triangles), dtype=np.int32)
        mesh.loop_triangles.foreach_get("vertices", triangles)
    finally:
        evaluated.to_mesh_clear()
    if not len(triangles):
        return None
    matrix = np.array(evaluated.matrix_world, dtype=float)
    return Body(
        id=str(obj[ID]) + (f" {obj[PART]}" if PART in obj else ""),
        kind=str(obj.get(KIND, "")),
        category=str(obj.get(FIELD + "category", "")),
        placement=str(obj.get(FIELD + "placement", "")),
        parent=str(obj.get(FIELD + "parent", "")),
        points=points.reshape(-1, 3) @ matrix[:3, :3].T + matrix[:3, 3],
        triangles=triangles.reshape(-1, 3).astype(np.int64),
        matrix=matrix,
        box=tuple(float(v) for v in obj.get(FIELD + "box", ())),
        furnished=bool(obj.get(FIELD + "furnished", False)),
    )


def scattered(corners: Floats, weight: Floats, count: int) -> Floats:
    """Points on triangles (T, 3, 3), as many on each as its weight says. Always the same."""
    dice = np.random.default_rng(7)
    picked = corners[dice.choice(len(weight), count, p=weight / weight.sum())]
    a, b = dice.random((2, count, 1))
    over = a + b > 1
    a, b = np.where(over, 1 - a, a), np.where(over, 1 - b, b)
    return np.asarray(picked[:, 0] + a * (picked[:, 1] - picked[:, 0]) + b * (picked[:, 2] - picked[:, 0]))


def cast(tree: Any, start: Floats, direction: Floats, reach: float) -> tuple[float, bool] | None:
    """Distance in metres to the first face along a ray, and whether that face turns its back; None when there is none."""
    _, normal, _, distance = tree.ray_cast(Vector(start), Vector(direction), reach)
    if distance is None:
        return None
    return float(distance), bool(normal.dot(Vector(direction)) > 0)


def is_inside(tree: Any, point: Floats, reach: float = 10.0) -> bool:
    """Whether a point lies inside of a solid: nearly every way out meets a face from behind first."""
    backs = 0
    for axis in range(3):
        for sign in (1.0, -1.0):
            way = np.zeros(3)
            way[axis] = sign
            hit = cast(tree, point, way, reach)
            backs += hit is not None and hit[1]
    return backs >= 5
