# SPDX-License-Identifier: GPL-3.0-or-later
"""The box that an object of the room stands for, whatever the artist did to it.

An artist may apply an object's rotation, or turn all vertices in Edit mode. So every object remembers a few vertices
of its mesh; where one matrix explains how they all moved, the object's own axes have moved with them.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from .measure import Box, affine_between, box_points, matrix_yaw, measure, mesh_points
from .meshes import mesh_fingerprint
from .tags import ASSET, FIELD, GROUP, ID, world_matrix

SEEN_MESH = FIELD + "seen_mesh"  # on an object: fingerprint of its mesh when it was built
INNER = FIELD + "inner"  # size of a furnished proxy's box in its mesh's metres
FRAME = FIELD + "frame"  # matrix from the proxy's own axes to its mesh's; absent where they are the same
BOUNDS = FIELD + "bounds"  # lowest and highest corner of its mesh when it was built
SAMPLE = FIELD + "sample"  # some vertices as they were built
_SAMPLES = 16
_BOUND = ("CURVE", "SURFACE", "FONT", "META", "CURVES", "POINTCLOUD", "VOLUME")


def object_box(obj: Any) -> Box | None:
    """The object's box as it stands, None for things without extent.

    A furnished proxy counts with its proxy's box, which its parts need not fill; a mesh that the artist edited counts
    with its own vertices; an object of the artist's with its parts counts with all of them.
    """
    matrix = np.array(world_matrix(obj), dtype=float)
    if obj.get(GROUP) or obj.type != "MESH":
        points = world_points(obj)
        return measure(points, np.eye(4), matrix_yaw(matrix)) if len(points) else None
    if not len(obj.data.vertices):
        return None
    edited = mesh_edited(obj)
    frame = own_frame(obj, edited)
    yaw = matrix_yaw(matrix @ frame)
    size = obj.get(INNER) or list(obj.get(FIELD + "box", ()))[3:6]
    if (obj.get(FIELD + "furnished") or ASSET in obj.data) and len(size) == 3:
        turned = not np.array_equal(frame, stored_frame(obj))
        if not edited or turned or _fills_the_same(obj):
            return measure(box_points(size), matrix @ frame, yaw)
    return measure(mesh_points(obj.data), matrix, yaw)


def mesh_edited(obj: Any) -> bool:
    """Whether the object's mesh is another one than when it was built."""
    return SEEN_MESH in obj and obj.type == "MESH" and bool(obj[SEEN_MESH] != mesh_fingerprint(obj.data))


def mesh_bounds(mesh: Any) -> list[float]:
    """Lowest and highest corner of a mesh in its own frame, [] for an empty one."""
    if not len(mesh.vertices):
        return []
    points = mesh_points(mesh)
    return [*map(float, points.min(axis=0)), *map(float, points.max(axis=0))]


def _fills_the_same(obj: Any) -> bool:
    """Whether an edited mesh reaches as far as it did when it was built; applying a scale of 1 moves the last bits."""
    before, now = list(obj.get(BOUNDS, ())), mesh_bounds(obj.data)
    return len(before) == len(now) and max((abs(a - b) for a, b in zip(before, now, strict=True)), default=0.0) < 1e-5


def stored_frame(obj: Any) -> Any:
    """The matrix from a proxy's own axes to its mesh's, as it was when it was built."""
    return np.array(obj[FRAME], dtype=float).reshape(4, 4) if FRAME in obj else np.eye(4)


def own_frame(obj: Any, edited: bool) -> Any:
    """The matrix from a proxy's own axes to its mesh's, with what the artist did to all vertices at once."""
    frame = stored_frame(obj)
    sample = obj.get(SAMPLE)
    if not edited or sample is None:
        return frame
    before, after = np.array(sample, dtype=float).reshape(-1, 3), sampled(obj.data)
    change = affine_between(before, after) if before.shape == after.shape else None
    if change is None or int(obj.get(SAMPLE + "_of", -1)) != len(obj.data.vertices):
        return frame
    return frame if np.abs(change - np.eye(4)).max() < 1e-5 else change @ frame


def sampled(mesh: Any) -> Any:
    """Some vertices of a mesh, evenly chosen, (N, 3)."""
    points = mesh_points(mesh)
    return points[np.unique(np.linspace(0, len(points) - 1, _SAMPLES).astype(int))] if len(points) else points


def parts_of(obj: Any) -> list[Any]:
    """The objects that count with one of the artist's: everything untagged below it, without itself."""
    found: list[Any] = []
    for child in obj.children:
        if ID not in child:
            found += [child, *parts_of(child)]
    return found


def world_points(obj: Any) -> Any:
    """Points that span an object and its parts, in the room, (N, 3)."""
    pieces = [_own_points(obj, 0), *(_own_points(part, 0) for part in parts_of(obj))]
    return np.concatenate(pieces)


def _own_points(obj: Any, depth: int) -> Any:
    """Points that span one object alone, in the room."""
    matrix = np.array(world_matrix(obj), dtype=float)
    if obj.type == "EMPTY" and obj.instance_type == "COLLECTION" and obj.instance_collection is not None and depth < 4:
        inner = [_own_points(o, depth + 1) for o in obj.instance_collection.all_objects]
        local = np.concatenate([np.zeros((0, 3)), *inner]) - np.array(obj.instance_collection.instance_offset)
    elif obj.type == "MESH":
        local = mesh_points(obj.data)
    elif obj.type in _BOUND:
        local = np.array(obj.bound_box, dtype=float)
        if np.ptp(local, axis=0).max() <= 0 or (local[0] == -1.0).all():  # nothing in it, or not worked out yet
            local = np.zeros((0, 3))
    else:
        local = np.zeros((0, 3))
    return local @ matrix[:3, :3].T + matrix[:3, 3]
