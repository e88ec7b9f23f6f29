# SPDX-License-Identifier: GPL-3.0-or-later
"""Which objects a `Record` asks for, and where: plain data, worked out before Blender is touched and in any thread."""

from __future__ import annotations

import hashlib
import math
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from ..program.prelude.dressing import dressed, finish_notes, shell_finishes
from ..program.prelude.enclosure import enclosure_pieces
from ..program.prelude.looks import Look
from ..program.prelude.palette import category_family
from ..program.prelude.proxies import proxy_shapes
from ..program.prelude.record import Record
from ..program.prelude.shape import Shape
from ..program.prelude.shell import shell_pieces
from ..program.prelude.skirting import skirting_pieces
from .arrays import MeshArrays, mesh_arrays


@dataclass(frozen=True)
class Target:
    """One object that should stand in the scene.

    Attributes:
        key: (id, part).
        role: which sub-collection it belongs to.
        line: the proxy, light or camera line, else {}.
        matrix: object-to-room matrix.
        parent: id of what it follows, or None.
        fields: plain values that are kept on the object, so that the scene can be read without the program.
        finishes: what the program says of its materials, the first counting most.
        plain: the shapes of a cloth before it was laid onto what carries it, None for all else.
    """

    key: tuple[str, str]
    kind: str
    role: str
    matrix: Any
    shapes: list[Shape] = field(default_factory=list)
    family: str = ""
    parent: str | None = None
    line: dict[str, Any] = field(default_factory=dict)
    fields: dict[str, Any] = field(default_factory=dict)
    finishes: tuple[dict[str, Look], ...] = ()
    plain: list[Shape] | None = None

    def dressed(self) -> list[Shape]:
        """Its shapes with the looks of its finishes behind their material roles."""
        return dressed(self.shapes, *self.finishes)


@dataclass
class Plan:
    """A record as Blender is to be made to show it.

    Attributes:
        targets: every parent before its children.
        digests: of everything that a target asks for, and of its shapes, by the target's key.
        record: what the plan was made from.
        notes: a plain sentence for each number of the shell that had to be clamped, and each finish of nothing.
        looks: every look that a finish names, by its key.
        arrays: meshes that were worked out already, by the digest of their shapes.
    """

    targets: list[Target]
    digests: dict[tuple[str, str], tuple[str, str]]
    record: Record
    notes: list[str]
    arrays: dict[str, MeshArrays] = field(default_factory=dict)
    looks: dict[str, Look] = field(default_factory=dict)

    def mesh(self, target: Target) -> MeshArrays:
        """The mesh of a target."""
        digest = self.digests[target.key][1]
        found = self.arrays.get(digest)
        if found is None:
            found = self.arrays[digest] = mesh_arrays(
                target.dressed(), furniture=target.key[0] in self.record.furnished
            )
        return found


def plan_record(record: Record, known: Callable[[Target], str | None] | None = None) -> Plan:
    """Everything about building a record that can be worked out without Blender.

    Args:
        known: the digest of a target's shapes where it is known already; they are not looked through again.
    """
    targets, notes = record_targets(record)
    targets = [_finished(target, record, notes) for target in targets]
    digests = {}
    for target in targets:
        shapes = known and known(target) or shapes_digest(target.dressed(), target.family)
        digests[target.key] = (target_digest(target, shapes), shapes)
    looks = {look.key: look for finish in record.finishes.values() for look in finish.values()}
    return Plan(parents_first(targets), digests, record, notes, looks=looks)


def _finished(target: Target, record: Record, notes: list[str]) -> Target:
    """The target with the finishes that are meant for it; what they name in vain is noted."""
    if not record.finishes or not target.shapes:
        return target
    if target.kind == "proxy":
        finish = record.finishes.get(target.key[0])
        if finish is None or target.key[0] not in record.furnished:
            return target
        notes += finish_notes(target.key[0], finish, target.shapes)
        return replace(target, finishes=(finish,))
    return replace(target, finishes=tuple(shell_finishes(record, target.kind, target.key[0])))


def record_targets(record: Record) -> tuple[list[Target], list[str]]:
    """The objects that a record asks for, in its order, and the notes on its shell."""
    pieces, notes = shell_pieces(record)
    lines = {
        line["id"]: line for group in (record.walls, record.doors, record.windows, record.openings) for line in group
    }
    targets = []
    for piece in pieces:
        fields: dict[str, Any] = {"wall": piece.parent or ""} if piece.kind in ("door", "window", "opening") else {}
        if piece.kind == "floor" and record.room is not None:
            fields = {"height": float(record.room["size"][2])}
        matrix = placed(piece.origin, piece.yaw)
        targets.append(
            Target((piece.id, piece.part), piece.kind, "shell", matrix, piece.shapes, "", piece.parent,
                   lines.get(piece.id, {}), fields)
        )  # fmt: skip
    for line in record.proxies:
        target = _proxy_target(line, record.furnished.get(line["id"]))
        targets.append(replace(target, plain=record.plain.get(line["id"])))
    for light in record.lights:
        matrix = aimed(light["at"], light["target"])
        targets.append(Target((light["id"], ""), "light", "lights", matrix, parent=light["parent"], line=light))
    for camera in record.cameras:
        rows = np.array(camera["matrix"], dtype=float).reshape(4, 4)
        targets.append(Target((camera["id"], ""), "camera", "cameras", rows, line=camera))
    taken = {target.key for target in targets}
    boards = skirting_pieces(record) if record.views and record.views[0]["ceiling"] > 0 else []
    for piece in [*enclosure_pieces(record), *boards]:
        if (piece.id, "") not in taken:
            matrix = placed(piece.origin, piece.yaw)
            targets.append(Target((piece.id, ""), piece.kind, "shell", matrix, piece.shapes))
    return targets, notes


def _proxy_target(line: dict[str, Any], furnished: list[Shape] | None) -> Target:
    """The proxy's box, or what the program furnished it with."""
    x, y, z = line["centre"]
    matrix = placed((x, y, z - line["size"][2] / 2), line["yaw"])
    shapes = proxy_shapes(line) if furnished is None else furnished
    names = ("category", "label", "placement", "parent", "salience", "shape")
    fields: dict[str, Any] = {name: line[name] if line[name] is not None else "" for name in names}
    fields |= {"furnished": furnished is not None, "box": [*line["centre"], *line["size"], line["yaw"]]}
    family = category_family(line["category"])
    return Target((line["id"], ""), "proxy", "layout", matrix, shapes, family, line["parent"], line, fields)


def placed(origin: tuple[float, float, float], yaw: float) -> Any:
    """The 4 x 4 matrix that turns by yaw degrees about z and moves to the origin."""
    c, s = math.cos(math.radians(yaw)), math.sin(math.radians(yaw))
    x, y, z = origin
    return np.array([[c, -s, 0, x], [s, c, 0, y], [0, 0, 1, z], [0, 0, 0, 1]], dtype=float)


def aimed(at: tuple[float, float, float], target: tuple[float, float, float] | None) -> Any:
    """The matrix of a lamp at a place that shines along its -Z towards the target, straight down without one."""
    matrix = np.eye(4)
    matrix[:3, 3] = at
    if target is None:
        return matrix
    back = np.array(at, dtype=float) - np.array(target, dtype=float)
    length = float(np.linalg.norm(back))
    if length < 1e-9:
        return matrix
    back /= length
    side = np.cross((0.0, 1.0, 0.0) if abs(back[2]) > 0.999 else (0.0, 0.0, 1.0), back)
    side /= np.linalg.norm(side)
    matrix[:3, 0], matrix[:3, 1], matrix[:3, 2] = side, np.cross(back, side), back
    return matrix


def parents_first(targets: list[Target]) -> list[Target]:
    """The same targets in an order in which every parent comes before its children; circles are cut."""
    owners = {target.key[0]: target for target in targets if not target.key[1]}
    ordered: dict[tuple[str, str], Target] = {}

    def add(target: Target, above: tuple[str, ...]) -> None:
        parent = owners.get(target.parent or "")
        if parent is not None and parent is not target and parent.key not in ordered and parent.key[0] not in above:
            add(parent, (*above, target.key[0]))
        ordered.setdefault(target.key, target)

    for target in targets:
        add(target, ())
    return list(ordered.values())


def target_digest(target: Target, shapes: str) -> str:
    """A digest of everything that a target asks for, from the digest of its shapes."""
    numbers = np.round(np.array(target.matrix, dtype=float), 7).tolist()
    parts = (target.kind, numbers, target.parent, sorted(target.line.items(), key=lambda item: item[0]), target.fields)
    return hashlib.sha1((shapes + repr(parts)).encode(), usedforsecurity=False).hexdigest()[:20]


def shapes_digest(shapes: list[Shape], family: str) -> str:
    """A short digest of everything that a mesh made from these shapes would hold."""
    digest = hashlib.sha1(family.encode(), usedforsecurity=False)
    for shape in shapes:
        digest.update(np.ascontiguousarray(shape.vertices, dtype=np.float64).tobytes())
        looks = (shape.smooth, shape.crease, shape.rings, shape.loop, shape.flipped, shape.extra)
        digest.update(repr((shape.part, shape.material, looks)).encode())
        for numbers in (*shape.corners, shape.uvs, shape.axes):
            if numbers is not None:
                digest.update(np.ascontiguousarray(numbers).tobytes())
    return digest.hexdigest()[:20]
