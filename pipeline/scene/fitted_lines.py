# SPDX-License-Identifier: GPL-3.0-or-later
"""Layout lines of walls, fittings, lights and cameras as an artist left their objects."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from ..artifacts.layout import CameraLine, LightLine, WallLine
from ..program.prelude.kelvin import light_colour
from .holding import SEEN_LOCAL, local_matrix
from .measure import matrix_yaw, turn_between
from .tags import world_matrix

_CLOSE = 1e-4  # metres
_RELATIVE = 1e-4


def wall_line(line: WallLine, change: Any) -> WallLine:
    """A wall as it was moved, turned or stretched; it stands on the floor and is upright."""
    ends = {name: tuple(float(v) for v in (change @ (*getattr(line, name), 0.0, 1.0))[:2]) for name in ("start", "end")}
    middle = [(a + b) / 2 for a, b in zip(line.start, line.end, strict=True)]
    top = float((change @ (*middle, line.height, 1.0))[2])
    length = max(math.dist(line.start, line.end), 1e-9)
    normal = np.array([-(line.end[1] - line.start[1]), line.end[0] - line.start[0], 0.0]) / length
    thickness = line.thickness * float(np.linalg.norm(change[:3, :3] @ normal))
    return line.model_copy(update={**ends, "height": max(0.05, top), "thickness": max(0.01, thickness)})


def fitting_line(line: Any, walls: list[WallLine]) -> Any:
    """A door, window or opening in the wall it is nearest to, as wide as it is and within the wall's length.

    It keeps the side its hinge is on: it runs with the wall or against it as it was left, or as it did in its former
    wall when it stands across the new one.
    """
    wall = min(walls, key=lambda w: _distance(line, w) - (0.05 if w.id == line.wall else 0.0))
    length = max(math.dist(wall.start, wall.end), 1e-9)
    ux, uy = (wall.end[0] - wall.start[0]) / length, (wall.end[1] - wall.start[1]) / length
    dx, dy = line.end[0] - line.start[0], line.end[1] - line.start[1]
    width = min(max(math.hypot(dx, dy), 0.05), length)
    cosine = (dx * ux + dy * uy) / max(math.hypot(dx, dy), 1e-9)
    if abs(cosine) < 0.5:
        former = next((w for w in walls if w.id == line.wall), None)
        if former is not None:
            fx, fy = former.end[0] - former.start[0], former.end[1] - former.start[1]
            cosine = dx * fx + dy * fy
    sign = -1.0 if cosine < 0 else 1.0
    middle = [(a + b) / 2 for a, b in zip(line.start, line.end, strict=True)]
    along = (middle[0] - wall.start[0]) * ux + (middle[1] - wall.start[1]) * uy
    along = min(max(along, width / 2), length - width / 2)
    near, far = along - sign * width / 2, along + sign * width / 2
    start = (wall.start[0] + ux * near, wall.start[1] + uy * near)
    end = (wall.start[0] + ux * far, wall.start[1] + uy * far)
    return line.model_copy(update={"wall": wall.id, "start": start, "end": end})


def _distance(line: Any, wall: WallLine) -> float:
    """How far a fitting's ends are from a wall's segment."""
    length = max(math.dist(wall.start, wall.end), 1e-9)
    ux, uy = (wall.end[0] - wall.start[0]) / length, (wall.end[1] - wall.start[1]) / length
    total = 0.0
    for x, y in (line.start, line.end):
        along = min(max((x - wall.start[0]) * ux + (y - wall.start[1]) * uy, 0.0), length)
        total += math.dist((x, y), (wall.start[0] + ux * along, wall.start[1] + uy * along))
    return total


def door_swing(leaf: Any) -> float:
    """Degrees that a door's leaf was turned by hand since it was built, counter-clockwise."""
    built = np.array(leaf[SEEN_LOCAL], dtype=float).reshape(4, 4)
    return turn_between(matrix_yaw(built), matrix_yaw(local_matrix(leaf)))


# ---- lights ----


def light_line(line: LightLine, obj: Any) -> LightLine | None:
    """A lamp as it stands, None when it stands and shines as its line says."""
    now = new_light_line(line.id, obj)
    values: dict[str, Any] = {}
    built = _aim(line)
    turned = float(np.abs(np.array(_direction(obj)) - built).max()) > 1e-3 and now.kind != "point"
    if math.dist(now.at, line.at) > _CLOSE or turned:
        reach = math.dist(line.target, line.at) if line.target is not None else 1.0
        direction = np.array(_direction(obj)) if turned else built
        at = np.array(now.at)
        straight = line.target is None and not turned
        values = {"at": now.at, "target": None if straight else tuple(float(v) for v in at + direction * reach)}
        if now.kind == "point" and line.target is None:
            values["target"] = None
    if now.kind == "area" and not _near(now.size_y or now.size, max(line.size_y or line.size, 1e-3)):
        values["size_y"] = now.size_y
    if not _near(now.color, light_colour(line.color, line.kelvin)):
        values |= {"color": now.color, "kelvin": 0.0}
    for name in ("kind", "energy", "size"):
        given = getattr(line, name)
        floor = 1e-3 if name == "size" and line.kind == "area" else 0.0
        if not _near(getattr(now, name), max(given, floor) if floor else given):
            values[name] = getattr(now, name)
    return line.model_copy(update=values) if values else None


def new_light_line(identifier: str, obj: Any) -> LightLine:
    """The line of a lamp that the artist put there."""
    data = obj.data
    matrix = world_matrix(obj)
    at = tuple(float(v) for v in matrix.translation)
    direction = _direction(obj)
    kind: Any = data.type.lower()
    size = {"sun": "angle", "area": "size"}.get(kind, "shadow_soft_size")
    scale = float(np.linalg.norm(np.array(matrix, dtype=float)[:3, 0])) if kind == "area" else 1.0
    tall = float(np.linalg.norm(np.array(matrix, dtype=float)[:3, 1])) if kind == "area" else 1.0
    down = direction[2] < -1 + 1e-6 or kind == "point"
    return LightLine(
        id=identifier,
        kind=kind,
        at=(at[0], at[1], at[2]),
        energy=float(data.energy),
        color=(float(data.color[0]), float(data.color[1]), float(data.color[2])),
        size=float(getattr(data, size)) * scale,
        size_y=float(data.size_y) * tall if kind == "area" and data.shape in ("RECTANGLE", "ELLIPSE") else 0.0,
        target=None if down else tuple(a + d for a, d in zip(at, direction, strict=True)),
    )


def _aim(line: LightLine) -> Any:
    """The way a lamp's line says it shines, a unit vector."""
    way = np.array(line.target, dtype=float) - np.array(line.at) if line.target is not None else np.zeros(3)
    length = float(np.linalg.norm(way))
    return way / length if length > 1e-9 else np.array([0.0, 0.0, -1.0])


def _direction(obj: Any) -> tuple[float, float, float]:
    """The way a lamp shines: its -Z, a unit vector."""
    axis = -np.array(world_matrix(obj), dtype=float)[:3, 2]
    length = float(np.linalg.norm(axis))
    x, y, z = axis / length if length > 1e-9 else (0.0, 0.0, -1.0)
    return float(x), float(y), float(z)


def _near(a: Any, b: Any) -> bool:
    if isinstance(a, str):
        return bool(a == b)
    first, second = np.array(a, dtype=float), np.array(b, dtype=float)
    return bool(np.abs(first - second).max() <= _RELATIVE * max(1.0, float(np.abs(second).max())))


# ---- cameras ----


def camera_line(line: CameraLine, obj: Any) -> CameraLine | None:
    """A camera as it stands, None when it stands and looks as its line says."""
    now = np.array(world_matrix(obj), dtype=float)
    sides = np.linalg.norm(now[:3, :3], axis=0)
    now[:3, :3] /= np.where(sides > 1e-9, sides, 1.0)
    values: dict[str, Any] = {}
    if np.abs(now.ravel() - np.array(line.matrix)).max() > _CLOSE:
        values["matrix"] = tuple(float(v) for v in now.ravel())
    data = obj.data
    kind = {"ORTHO": "orthographic", "PERSP": "perspective"}.get(data.type)
    if kind is not None and kind != line.kind:
        values["kind"] = kind
    if kind == "orthographic" and not _near(data.ortho_scale, line.ortho_height):
        values["ortho_height"] = float(data.ortho_scale)
    fov = 2.0 * math.atan(data.sensor_height / (2.0 * max(data.lens, 1e-6)))
    if kind == "perspective" and not _near(fov, line.fov_y):
        values["fov_y"] = fov
    width, height = line.image_size
    x, y = 500.0 - data.shift_x * 1000.0 * height / width, 500.0 + data.shift_y * 1000.0
    if not _near((x, y), line.principal):
        values["principal"] = (x, y)
    return line.model_copy(update=values) if values else None
