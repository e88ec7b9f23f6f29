# SPDX-License-Identifier: GPL-3.0-or-later
"""An asset of a .blend file as one mesh of this file.

What is appended is evaluated with its modifiers and instances in a scene of its own, joined, and taken away again: only
the mesh stays, with its materials and their pictures packed. So the .blend does not depend on the library, and neither
objects, empties, drivers nor texts of the library come along. Nothing is left behind when it fails.
"""

from __future__ import annotations

import warnings
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import bpy
import numpy as np
from mathutils import Matrix

from ..artifacts.assets import AssetRef
from ..errors import SceneError
from .asset_join import joined
from .compat import quiet
from .measure import mesh_points

MOST_FACES = 1_000_000
_SHAPED = ("MESH", "CURVE", "SURFACE", "FONT", "META")
_HELPERS = ("WIRE", "BOUNDS")
"""Objects that are shown so are cutters and cages of modifiers."""
_KEPT = (bpy.types.Material, bpy.types.Image, bpy.types.NodeTree, bpy.types.Texture)


def load_asset(path: Path, ref: AssetRef) -> tuple[Any, list[str]]:
    """The asset as a mesh that nothing uses yet, in metres in its own frame; and notes on what it lacks. Main thread.

    Raises:
        SceneError: the file is gone or cannot be read, or the asset is not in it, has no mesh, or is too heavy.
    """
    before = set(_ids())
    mesh, notes, keep = None, list[str](), set[Any]()
    try:
        asset = _appended(path, ref)
        mesh = joined(_evaluated(asset, ref), ref.name)
        _check(mesh, ref)
        keep = {mesh, *_used_by(mesh, before)}
        notes = _own(keep)
    except BaseException:
        keep = set()
        raise
    finally:
        _clear(before, keep)
    return mesh, notes


def _appended(path: Path, ref: AssetRef) -> Any:
    kind = f"{ref.kind}s"
    again = "Look for assets again."
    try:
        with quiet(), warnings.catch_warnings():
            warnings.simplefilter("ignore")  # a name that is not there is told by us
            libraries: Any = bpy.data.libraries
            with libraries.load(str(path), link=False, assets_only=True) as (source, target):
                if ref.name not in getattr(source, kind):
                    raise SceneError(f'"{ref.name}" is no asset of {path.name} any more.', again)
                setattr(target, kind, [ref.name])
    except (OSError, RuntimeError) as error:
        raise SceneError(f'"{path.name}" cannot be read by this Blender.', again) from error
    found = getattr(target, kind)
    if not found or found[0] is None:
        raise SceneError(f'"{ref.name}" could not be loaded from {path.name}.', again)
    return found[0]


def _evaluated(asset: Any, ref: AssetRef) -> list[Any]:
    """A mesh for everything of the asset that has faces, with modifiers and instances, in one frame."""
    scene = bpy.data.scenes.new("Code-as-Room Asset")
    meshes: list[Any] = []
    try:
        if isinstance(asset, bpy.types.Collection):
            asset.hide_viewport = False
            scene.collection.children.link(asset)
        else:
            asset.hide_viewport = False
            scene.collection.objects.link(asset)
        layer = scene.view_layers[0]
        layer.update()
        graph: Any = layer.depsgraph
        faces = 0
        for source, matrix in _shown(graph):
            mesh = _mesh_of(source, graph)
            meshes.append(mesh)
            faces += len(mesh.polygons)
            if faces > MOST_FACES:
                raise SceneError(
                    f'"{ref.name}" has more than {MOST_FACES // 1000} thousand faces.', "Use a lighter one."
                )
            mesh.transform(Matrix(matrix.tolist()))
            if np.linalg.det(matrix[:3, :3]) < 0:
                mesh.flip_normals()
        filled = [mesh for mesh in meshes if len(mesh.polygons)]
        if not filled:
            raise SceneError(f'"{ref.name}" has no mesh.', "Choose another asset.")
        bpy.data.batch_remove([mesh for mesh in meshes if not len(mesh.polygons)])
        return filled
    finally:
        bpy.data.scenes.remove(scene)


def _shown(graph: Any) -> list[tuple[Any, Any]]:
    """What has faces and is rendered: the object, or the mesh of an instance that is none's, and its matrix.

    An instance's own object is gone once its turn is over, so what it shows is noted by what lasts.
    """
    found: list[tuple[Any, Any]] = []
    for item in graph.object_instances:
        obj = item.object
        if not item.show_self or obj.type not in _SHAPED or _is_helper(obj):
            continue
        original = obj.original
        is_own = original.evaluated_get(graph).data == obj.data or obj.type != "MESH"
        found.append((original if is_own else obj.data, np.array(item.matrix_world, dtype=float)))
    return found


def _mesh_of(source: Any, graph: Any) -> Any:
    if isinstance(source, bpy.types.Mesh):
        return source.copy()
    evaluated = source.evaluated_get(graph)
    return bpy.data.meshes.new_from_object(evaluated, preserve_all_data_layers=True, depsgraph=graph)


def _is_helper(obj: Any) -> bool:
    return obj.hide_render or obj.display_type in _HELPERS


def _check(mesh: Any, ref: AssetRef) -> None:
    points = mesh_points(mesh)
    if not np.isfinite(points).all():
        raise SceneError(f'"{ref.name}" has points that are no numbers.', "Choose another asset.")
    if np.ptp(points, axis=0).max() < 1e-6:
        raise SceneError(f'"{ref.name}" has no extent.', "Choose another asset.")


def _ids() -> Iterable[Any]:
    for prop in bpy.data.bl_rna.properties:
        if prop.type == "COLLECTION":
            yield from (item for item in getattr(bpy.data, prop.identifier) if isinstance(item, bpy.types.ID))


def _used_by(mesh: Any, before: set[Any]) -> set[Any]:
    """What came along that the mesh's materials need."""
    users = bpy.data.user_map()
    uses: dict[Any, set[Any]] = {}
    for used, owners in users.items():
        for owner in owners:
            uses.setdefault(owner, set()).add(used)
    found: set[Any] = set()
    todo = [material for material in mesh.materials if material is not None]
    while todo:
        item = todo.pop()
        if item in found or not isinstance(item, _KEPT):
            continue
        found.add(item)
        todo += uses.get(item, set())
    return found - before


def _own(keep: set[Any]) -> list[str]:
    """Make everything this file's own: local, no asset of its own, pictures packed."""
    notes = []
    for item in keep:
        for tag in [key for key in item.keys() if key.startswith("code_as_room")]:  # noqa: SIM118 (an ID is not a dict)
            del item[tag]  # the library was made from a room of ours
        if item.library is not None:
            item.make_local()
        if item.asset_data is not None:
            item.asset_clear()
        item.use_fake_user = False
        if isinstance(item, bpy.types.Image) and item.source in ("FILE", "TILED") and item.packed_file is None:
            try:
                item.pack()
            except RuntimeError:
                notes.append(f"Its picture {Path(item.filepath).name} is missing")
    return notes


def _clear(before: set[Any], keep: set[Any]) -> None:
    """Take away what came along and is not kept."""
    gone = [item for item in _ids() if item not in before and item not in keep]
    libraries = [item for item in gone if isinstance(item, bpy.types.Library)]
    bpy.data.batch_remove([item for item in gone if not isinstance(item, bpy.types.Library)])
    bpy.data.batch_remove(libraries)
