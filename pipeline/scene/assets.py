# SPDX-License-Identifier: GPL-3.0-or-later
"""Objects of the room that look like assets of the artist's libraries.

An object keeps its id, its place and its box; only its mesh is another one. So whatever reads, moves, locks or rebuilds
the room does with it as with any other object. The mesh remembers which asset it is, and by which matrix it came from
the asset's own metres, so that it can be fitted to another box, and lent to another object, without its library.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from pathlib import Path
from typing import Any

import bpy
import numpy as np
from mathutils import Matrix

from ..artifacts.assets import AssetRef, ChosenAsset
from ..errors import SceneError
from ..retrieval.fit import placing
from .asset_file import load_asset
from .boxes import FRAME, INNER, object_box
from .holding import SEEN, SEEN_LOCAL, away, local_matrix, remember_mesh
from .measure import Box, mesh_points
from .tags import ASSET, COLOUR, FIELD, GROUP, HELD, ID, KIND, LINE, PART, world_matrix
from .targets import Plan, placed

_INTO = ASSET + "_into"  # on a mesh: matrix from the asset's own metres to the mesh's, 16 numbers
_BOUNDS = ASSET + "_bounds"  # on a mesh: lowest and highest corner in the asset's own metres
_TURN = ASSET + "_turn"  # on a mesh: quarter turns
_ALIKE = 2e-4  # metres
Size = tuple[float, float, float]


def asset_of(obj: Any) -> str:
    """Key of the asset that an object looks like, "" for none."""
    return str(obj.data.get(ASSET, "")) if obj is not None and obj.type == "MESH" else ""


def dressed(room: Any) -> dict[str, Any]:
    """The objects of the room that look like assets, by id."""
    return {name: obj for name, obj in _proxies(room).items() if asset_of(obj)}


def prepare(ref: AssetRef, file: Path | None) -> tuple[Size, list[str]]:
    """Have an asset's mesh in this file, unseen and unused until `dress`; returns its size and notes on it.

    Raises:
        SceneError: it cannot be had, see `load_asset`.
    """
    mesh, notes = _source(ref.key), list[str]()
    if mesh is None:
        if file is None:
            library = f'The asset library "{ref.library}" does not have {ref.file}'
            raise SceneError(f"{library} on this computer.", "Set it up in Preferences, File Paths, Asset Libraries.")
        mesh, notes = load_asset(file, ref)
        points = mesh_points(mesh)
        mesh[ASSET] = ref.key
        mesh[_INTO] = _flat(np.eye(4))
        mesh[_BOUNDS] = [float(v) for v in (*points.min(axis=0), *points.max(axis=0))]
    low, high = _bounds(mesh)
    x, y, z = (float(v) for v in high - low)
    return (x, y, z), notes


def dress(room: Any, chosen: Sequence[ChosenAsset], files: Mapping[str, Path]) -> dict[str, str]:
    """Let objects look like assets, each in its own box and place. Main thread.

    Args:
        files: where the assets' files are, by key; not needed for what was prepared or stands in the room already.

    Returns:
        A sentence for each object, by id, that stays as it was.
    """
    objects, failed = _proxies(room), dict[str, str]()
    for choice in chosen:
        obj = objects.get(choice.id)
        try:
            if obj is None:
                raise SceneError("It does not stand in the room.")
            if asset_of(obj) != choice.asset.key or obj.data.get(_TURN) != choice.turn:
                prepare(choice.asset, files.get(choice.asset.key))
                _put_on(obj, choice)
        except SceneError as error:
            failed[choice.id] = str(error)
    drop_unused()
    return failed


def undress(room: Any, ids: Collection[str]) -> list[str]:
    """Take assets off these objects; the next build gives them their own geometry again. Returns which had one."""
    found = [name for name in dressed(room) if name in ids]
    objects = _proxies(room)
    for name in found:
        obj = objects[name]
        obj.data = bpy.data.meshes.new(name)
        obj[LINE] = ""  # it is not what its line says until it is built
    drop_unused()
    return found


def follow(room: Any, plan: Plan) -> None:
    """Before a build: fit assets to the boxes that their objects are about to get."""
    kept = {key[0]: obj for key, obj in away(room).items() if not key[1] and asset_of(obj)}
    worn = {**kept, **dressed(room)}
    for target in plan.targets if worn else ():
        obj = worn.get(target.key[0]) if target.kind == "proxy" else None
        if obj is None or HELD in obj:
            continue
        mesh = obj.data
        low, high = _bounds(mesh)
        size, placement = target.line["size"], target.line["placement"]
        into = placing(low, high, size, int(mesh.get(_TURN, 0)), placement)
        former = np.array(mesh[_INTO], dtype=float).reshape(4, 4)
        if np.abs(into - former).max() > 1e-6 * max(1.0, np.abs(into).max()):
            if mesh.users > 1:
                obj.data = mesh = mesh.copy()
            _transform(mesh, into @ np.linalg.inv(former))
            mesh[_INTO] = _flat(into)
            remember_mesh(obj)


def drop_unused() -> None:
    """Remove asset meshes that no object uses."""
    meshes: Any = bpy.data.meshes
    unused = [mesh for mesh in meshes if ASSET in mesh and mesh.users == 0]
    materials = {material for mesh in unused for material in mesh.materials if material is not None}
    bpy.data.batch_remove(unused)
    bpy.data.batch_remove([material for material in materials if material.users == 0 and COLOUR not in material])


def _put_on(obj: Any, choice: ChosenAsset) -> None:
    """Give an object the asset's mesh, in the box that it fills now."""
    box = object_box(obj)
    if obj.type != "MESH" or obj.get(GROUP) or box is None:
        raise SceneError("It is an object of your own making.", "Replace it by hand, or delete it first.")
    source: Any = _source(choice.asset.key)
    low, high = _bounds(source)
    fit = placing(low, high, box.size, choice.turn, str(obj.get(FIELD + "placement", "floor")))
    mesh = source.copy()
    mesh.name = f"{obj.name} {choice.asset.name}"[:60]
    former = np.array(source[_INTO], dtype=float).reshape(4, 4)
    pose = _pose(box)
    into: Any = np.linalg.inv(_rows(world_matrix(obj))) @ pose @ fit
    _transform(mesh, into @ np.linalg.inv(former))
    mesh[_INTO], mesh[_TURN] = _flat(into), choice.turn
    worn, obj.data = obj.data, mesh
    if worn.users == 0:
        bpy.data.meshes.remove(worn)
    remember_mesh(obj)
    if not _is_box(object_box(obj), box):
        _stand_plain(obj, mesh, box, pose, fit)


def _stand_plain(obj: Any, mesh: Any, box: Box, pose: Any, fit: Any) -> None:
    """An object whose former mesh was the artist's own: its box is said by its place and size from now on."""
    former = np.array(mesh[_INTO], dtype=float).reshape(4, 4)
    _transform(mesh, fit @ np.linalg.inv(former))
    mesh[_INTO] = _flat(fit)
    inverse = np.eye(4)
    if obj.parent is not None:
        above = world_matrix(obj.parent) @ obj.matrix_parent_inverse
        inverse = np.linalg.inv(_rows(above))
    obj.matrix_basis = Matrix((inverse @ pose).tolist())
    obj[INNER] = [float(v) for v in box.size]
    if FRAME in obj:
        del obj[FRAME]
    remember_mesh(obj)
    obj[SEEN], obj[SEEN_LOCAL] = _flat(np.array(world_matrix(obj))), _flat(np.array(local_matrix(obj)))


def _source(key: str) -> Any | None:
    """A mesh of this file that is this asset, in whatever box."""
    return next((mesh for mesh in bpy.data.meshes if mesh.get(ASSET) == key and mesh.library is None), None)


def _proxies(room: Any) -> dict[str, Any]:
    found: dict[str, Any] = {}
    for obj in room.all_objects if room is not None else ():
        is_proxy = ID in obj and PART not in obj and obj.get(KIND, "proxy") == "proxy"
        if is_proxy and (str(obj[ID]) not in found or LINE in obj):  # of copies, the one that was built counts
            found[str(obj[ID])] = obj
    return found


def _pose(box: Box) -> Any:
    x, y, z = box.centre
    return placed((x, y, z - box.size[2] / 2), box.yaw)


def _is_box(found: Box | None, wanted: Box) -> bool:
    if found is None:
        return False
    numbers = zip((*found.centre, *found.size), (*wanted.centre, *wanted.size), strict=True)
    return all(abs(a - b) < _ALIKE for a, b in numbers)


def _bounds(mesh: Any) -> tuple[Any, Any]:
    low, high = np.array(mesh[_BOUNDS], dtype=float).reshape(2, 3)
    return low, high


def _transform(mesh: Any, matrix: Any) -> None:
    mesh.transform(Matrix(matrix.tolist()))
    if np.linalg.det(matrix[:3, :3]) < 0:
        mesh.flip_normals()
    mesh.update()


def _rows(matrix: Any) -> Any:
    return np.array(matrix, dtype=float)


def _flat(matrix: Any) -> list[float]:
    return [float(v) for v in np.asarray(matrix, dtype=float).ravel()]
