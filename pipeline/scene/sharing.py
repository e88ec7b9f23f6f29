# SPDX-License-Identifier: GPL-3.0-or-later
"""Objects that are the same share one mesh, as Blender's linked duplicates do.

Eight chairs of one function, size and look are eight objects of one mesh. What the artist does to that mesh shows on all
of them, as on linked duplicates; Make Single User sets one apart, and it stays so. A build never writes into a mesh that
others use: an object whose line now asks for something else gets another mesh.
"""

from __future__ import annotations

from typing import Any

import bpy

from .meshes import is_hand_made
from .slots import artists_slots, redress
from .tags import ASSET, DIGEST
from .targets import Target


def may_share(target: Target) -> bool:
    """Whether a target's mesh may be that of other objects: only what is modelled, and not what lies as it does nowhere else."""
    return target.kind == "proxy" and bool(target.fields.get("furnished")) and target.plain is None


def shared_mesh(target: Target, digest: str, collection: Any, former: Any = None) -> Any | None:
    """A mesh in the collection that is just what a target asks for, untouched by the artist; None when there is none.

    Args:
        former: the mesh that it would replace; materials that the artist put into that one have to be in both.
    """
    if not may_share(target):
        return None
    own = {} if former is None else artists_slots(former)
    for obj in collection.objects:
        mesh = obj.data
        if obj.type != "MESH" or mesh.get(DIGEST) != digest or ASSET in mesh:
            continue
        if artists_slots(mesh) == own and not is_hand_made(mesh):
            return mesh
    return None


def use_mesh(obj: Any, mesh: Any) -> None:
    """Give an object a mesh that others use too; its former one goes when nothing uses it any more."""
    former = obj.data
    obj.data = mesh
    if former is not None and former != mesh and former.users == 0:
        bpy.data.meshes.remove(former)


def dress_own(obj: Any, target: Target) -> None:
    """Give an object's mesh the looks of the target's finishes, and not those of others that use the mesh."""
    if obj.data.users < 2:
        redress(obj.data, target.family, target.finishes)
        return
    mesh = obj.data.copy()
    redress(mesh, target.family, target.finishes)
    if list(mesh.materials) == list(obj.data.materials):
        bpy.data.meshes.remove(mesh)
    else:
        obj.data = mesh
