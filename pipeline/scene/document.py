# SPDX-License-Identifier: GPL-3.0-or-later
"""`scene.json` from what stands in Blender: measured on meshes and matrices, so that it proves the scene."""

from __future__ import annotations

from typing import Any

import numpy as np

from ..artifacts.camera import CameraModel
from ..artifacts.scene import SceneArchitecture, SceneDocument, SceneObject, SceneRoom
from ..errors import SceneError
from .measure import mesh_points
from .readback import object_box
from .tags import FIELD, ID, KIND, PART, tagged_objects, world_matrix

_ON_FACE = 1e-4  # metres


def scene_document(room: Any, image: str, camera: CameraModel) -> SceneDocument:
    """The room's collection as a document.

    Args:
        image: file name of the reference image.
        camera: the camera that the reference was seen through.

    Raises:
        SceneError: there is no floor in the collection.
    """
    objects = [same[0] for same in tagged_objects(room).values() if PART not in same[0]]
    by_kind: dict[str, list[Any]] = {}
    for obj in objects:
        by_kind.setdefault(str(obj.get(KIND, "")), []).append(obj)
    walls = [_wall(obj) for kind in ("wall", "partition") for obj in by_kind.get(kind, []) if _has_mesh(obj)]
    fittings = [_fitting(o) for kind in ("door", "window", "opening") for o in by_kind.get(kind, []) if _has_mesh(o)]
    proxies = [found for obj in by_kind.get("proxy", []) if (found := _object(obj)) is not None]
    return SceneDocument(
        image=image,
        room=_room(by_kind.get("floor", []), [wall.height for wall in walls if wall.kind == "wall"]),
        camera=camera,
        architecture=walls + fittings,
        objects=proxies,
    )


def _has_mesh(obj: Any) -> bool:
    return bool(obj.type == "MESH" and len(obj.data.vertices))


def _room(floors: list[Any], heights: list[float]) -> SceneRoom:
    """Outline from the upper face of the floor; height from the walls, else as it was built."""
    if not floors or not _has_mesh(floors[0]) or not floors[0].data.polygons:
        raise SceneError("The room has no floor in the scene.", "Undo its deletion, or run the layout stage again.")
    mesh, matrix = floors[0].data, np.array(world_matrix(floors[0]), dtype=float)
    points = mesh_points(mesh) @ matrix[:3, :3].T + matrix[:3, 3]
    upper = max(mesh.polygons, key=lambda face: (round(float(points[list(face.vertices), 2].mean()), 4), face.area))
    outline = [(_exact(points[i, 0]), _exact(points[i, 1])) for i in upper.vertices]
    width, depth = (float(v) for v in np.ptp(np.array(outline), axis=0))
    height = max(heights) if heights else float(floors[0].get(FIELD + "height", 0.0))
    return SceneRoom(size=(_exact(width), _exact(depth), height), floor=outline)


def _wall(obj: Any) -> SceneArchitecture:
    """A wall's segment: the ends of its inner face; of a partition, the middle between the ends of both faces."""
    points = mesh_points(obj.data)
    faces = [points[:, 1].max()] if obj[KIND] == "wall" else [points[:, 1].max(), points[:, 1].min()]
    ends = []
    for y in faces:
        on_face = points[np.abs(points[:, 1] - y) < _ON_FACE]
        ends.append([(on_face[:, 0].min(), y), (on_face[:, 0].max(), y)])
    start, end = np.mean(np.array(ends, dtype=float), axis=0)
    return SceneArchitecture(
        id=str(obj[ID]),
        kind=str(obj[KIND]),
        start=_on_floor(obj, start),
        end=_on_floor(obj, end),
        height=_heights(obj, points)[1],
    )


def _fitting(obj: Any) -> SceneArchitecture:
    """A door, window or opening: the rim of its frame, which fills its hole."""
    points = mesh_points(obj.data)
    low, high = _heights(obj, points)
    sill = 0.0 if obj[KIND] == "door" else low
    return SceneArchitecture(
        id=str(obj[ID]),
        kind=str(obj[KIND]),
        start=_on_floor(obj, (points[:, 0].min(), 0.0)),
        end=_on_floor(obj, (points[:, 0].max(), 0.0)),
        height=_exact(high - sill),
        sill=sill,
        wall=str(obj.parent[ID]) if obj.parent is not None and ID in obj.parent else obj.get(FIELD + "wall") or None,
    )


def _object(obj: Any) -> SceneObject | None:
    """A proxy as its oriented box, None when nothing of it has extent."""
    box = object_box(obj)
    if box is None:
        return None
    parent = str(obj.parent[ID]) if obj.parent is not None and ID in obj.parent else None
    return SceneObject(
        id=str(obj[ID]),
        category=str(obj.get(FIELD + "category", "object")),
        label=str(obj.get(FIELD + "label", "")),
        centre=tuple(_exact(v) for v in box.centre),
        size=tuple(_exact(v) for v in box.size),
        yaw=_exact(box.yaw),
        placement=obj.get(FIELD + "placement", "floor"),
        parent=parent,
        salience=obj.get(FIELD + "salience", "major"),
    )


def _on_floor(obj: Any, point: Any) -> tuple[float, float]:
    """A point (x, y) of an object's frame as (x, y) in the room."""
    matrix = np.array(world_matrix(obj), dtype=float)
    x, y, _, _ = matrix @ np.array((float(point[0]), float(point[1]), 0.0, 1.0))
    return _exact(x), _exact(y)


def _heights(obj: Any, points: Any) -> tuple[float, float]:
    """Lowest and highest z in the room of points of an object's frame."""
    matrix = np.array(world_matrix(obj), dtype=float)
    z = points @ matrix[2, :3] + matrix[2, 3]
    return _exact(z.min()), _exact(z.max())


def _exact(value: Any) -> float:
    """A number as it is written: to a hundredth of a millimetre, which is where Blender's floats end."""
    return round(float(value), 5) + 0.0
