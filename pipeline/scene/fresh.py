# SPDX-License-Identifier: GPL-3.0-or-later
"""Makes Blender show a `Record` without the add-on: what `room.py` ends with.

The scene is the one that `realise` makes, property by property, so that the add-on can go on with it. What `realise` does
for an artist who works on between two builds is not here: what was changed by hand since it was made stays as it is.
"""

from __future__ import annotations

from typing import Any

import bpy
import numpy as np

from ..program.prelude.record import Record
from .boxes import SEEN_MESH
from .holding import SEEN, free_children, is_artists, remember_built, remember_record
from .lenses import write_camera, write_light
from .lighting import light_scene
from .measure import EXACT
from .meshes import mesh_fingerprint
from .realise import has_mesh, new_mesh, new_object, place, write_fields
from .sharing import may_share
from .tags import LINE, NAME, ensure_collections, tagged_objects, world_matrix
from .targets import Plan, Target, plan_record


def make_record(record: Record) -> list[str]:
    """Make the room in the current scene, in a collection of its own; another run of it makes it anew.

    Returns:
        One plain sentence for each number of the shell that had to be clamped.
    """
    scene: Any = bpy.context.scene
    plan = plan_record(record)
    collections = ensure_collections(scene, "Code-as-Room")
    existing = tagged_objects(collections["room"])
    wanted = {target.key for target in plan.targets}
    _clear([same[0] for key, same in existing.items() if key not in wanted and not _by_hand(same[0])])
    done: dict[str, Any] = {}
    shared: dict[str, Any] = {}
    for target in plan.targets:
        obj = existing.get(target.key, [None])[0]
        if obj is None or not _by_hand(obj):
            obj = _make(target, plan, obj, done.get(target.parent or ""), collections[target.role], shared)
        if not target.key[1]:
            done[target.key[0]] = obj
    remember_record(collections["room"], record, set(done))
    light_scene(scene, collections["room"], record)
    if scene.camera is None:
        scene.camera = next((done[line["id"]] for line in record.cameras if line["id"] in done), None)
    for layer in scene.view_layers:
        layer.update()
    return plan.notes


def _make(target: Target, plan: Plan, obj: Any, parent: Any, collection: Any, shared: dict[str, Any]) -> Any:
    """Make one object, or an existing one anew; returns it.

    Args:
        shared: meshes that several objects may have, by the digest of their shapes.
    """
    digest, shapes = plan.digests[target.key]
    mesh = None
    if has_mesh(target):
        mesh = (shared.get(shapes) if may_share(target) else None) or new_mesh(target, plan)
        if may_share(target):
            shared[shapes] = mesh
    if obj is None:
        obj = new_object(target, collection, mesh)
    elif mesh is not None:
        former, obj.data = obj.data, mesh
        _drop(former)
        mesh.name = obj.name if mesh.users == 1 else mesh.name
    if mesh is None:
        (write_light if target.kind == "light" else write_camera)(obj.data, target.line)
    place(obj, target.matrix, parent, EXACT)
    write_fields(obj, target, digest)
    remember_built(obj, target)
    return obj


def _by_hand(obj: Any) -> bool:
    """Whether an object is not as it was made: it was copied, moved, edited, or got something that only an artist adds."""
    if LINE not in obj or obj.get(NAME) != obj.name or is_artists(obj):
        return True
    moved = SEEN not in obj or np.abs(np.array(world_matrix(obj)).ravel() - np.array(obj[SEEN])).max() > 1e-5
    return moved or (obj.type == "MESH" and obj.get(SEEN_MESH) != mesh_fingerprint(obj.data))


def _clear(objects: list[Any]) -> None:
    """Delete objects that the room has no more; what was parented to them stays where it is."""
    for obj in objects:
        free_children(obj)
        data = obj.data
        bpy.data.objects.remove(obj, do_unlink=True)
        _drop(data)


def _drop(data: Any) -> None:
    if data is not None and data.users == 0:
        bpy.data.batch_remove([data])
