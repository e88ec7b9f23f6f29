# SPDX-License-Identifier: GPL-3.0-or-later
"""Makes Blender show a `Record`: in the add-on's own collection only, and touching only what differs.

This module and those it imports are also inlined in `room.py` and run in plain Blender, so they use only bpy, math,
numpy and the prelude.

Where things are: a proxy's object has its origin at the centre of its base, its mesh in metres in the proxy's local
frame, yaw as its z rotation and scale 1. A child keeps a Blender parent, so that a lamp follows its nightstand; the
parent inverse makes the child's own location its place in the room.

What an artist did by hand stays: an edited mesh is fitted to the line's box instead of being replaced, and walls,
fittings, lights and cameras are left alone for as long as their line does not change.
"""

from __future__ import annotations

from typing import Any

import bpy
import numpy as np

from ..program.prelude.record import Record
from .holding import (
    away,
    bring_back,
    free_children,
    held_matrix,
    is_artists,
    is_pending,
    kept_parent,
    remember,
    remember_record,
    set_aside,
)
from .lenses import write_camera, write_light
from .lighting import dress_light, light_scene
from .measure import EXACT, fit_matrix
from .meshes import is_hand_made, write_arrays
from .sharing import dress_own, may_share, shared_mesh, use_mesh
from .slots import artists_slots, put_artists_slots
from .tags import (
    ASSET,
    AWAY,
    DIGEST,
    FIELD,
    HELD,
    ID,
    KIND,
    LINE,
    NAME,
    PART,
    ROLE,
    WAS,
    ensure_collections,
    tagged_objects,
    world_matrix,
)
from .targets import Plan, Target, plan_record

_CAMERA_TOLERANCE = 1e-5  # metres and radians: above float32 noise; a camera's line says more than 0.1 mm


def realise_record(record: Record, collection_name: str = "Code-as-Room", scene: Any = None) -> list[str]:
    """Make or update the room in the scene (the current one unless another is given).

    Objects are found by their ids; those that did not change keep their datablocks untouched, those whose ids are gone
    are removed, copies and additions of the artist stay.

    Returns:
        One plain sentence for each number of the shell that had to be clamped.
    """
    plan = plan_record(record)
    realise_plan(plan, collection_name, scene or bpy.context.scene, {})
    return plan.notes


def realise_plan(plan: Plan, collection_name: str, scene: Any, made: dict[tuple[str, str], Any]) -> None:
    """Make or update the room in the scene, as `realise_record` does.

    Args:
        made: meshes that `new_mesh` made beforehand, by the key of their target. They are taken out as they are used.
    """
    collections = ensure_collections(scene, collection_name)
    room = collections["room"]
    existing = tagged_objects(room)
    wanted = {target.key for target in plan.targets}
    _restore_refused_names(existing, wanted)
    # Copies and renamed ones are the artist's.
    gone = [o[0] for k, o in existing.items() if k not in wanted and LINE in o[0] and o[0].get(NAME) == o[0].name]
    for obj in filter(is_artists, gone):
        obj[AWAY] = True
    for obj in gone:
        if AWAY in obj:
            set_aside(room, obj)
    _remove([obj for obj in gone if AWAY not in obj])
    aside = away(room)
    done: dict[str, Any] = {}
    spent: list[tuple[int, Any]] = []
    for target in plan.targets:
        obj, parent = existing.get(target.key, [None])[0], done.get(target.parent or "")
        if obj is None and target.key in aside:
            obj = bring_back(aside[target.key], parent, room, collections[target.role])
        obj = _realise(target, plan, obj, parent, collections[target.role], made, spent)
        if not target.key[1]:
            done[target.key[0]] = obj
    _take_away(spent)
    remember_record(room, plan.record, set(done))
    light_scene(scene, room, plan.record)
    if scene.camera is None:
        scene.camera = next((done[line["id"]] for line in plan.record.cameras if line["id"] in done), None)
    for layer in scene.view_layers:
        layer.update()


def lacking(plan: Plan, room: Any) -> list[Target]:
    """The targets whose meshes would have to be written to show a plan, as things stand; nothing is changed."""
    existing = tagged_objects(room) if room is not None else {}
    aside = away(room) if room is not None else {}
    found: list[Target] = []
    once: set[str] = set()
    for target in plan.targets:
        obj, digest = existing.get(target.key, [aside.get(target.key)])[0], plan.digests[target.key][1]
        if not has_mesh(target) or not (obj is None or (HELD not in obj and _lacks(obj, target, digest))):
            continue
        if may_share(target):  # the next ones take the mesh of the first
            if digest in once or (room is not None and shared_mesh(target, digest, layout_of(room)) is not None):
                continue
            once.add(digest)
        found.append(target)
    return found


def layout_of(room: Any) -> Any:
    """The collection that holds the room's furniture; the room's own where it is missing."""
    return next((c for c in room.children_recursive if c.get(ROLE) == "layout"), room)


def new_mesh(target: Target, plan: Plan) -> Any:
    """A mesh for a target that no object uses yet."""
    mesh = bpy.data.meshes.new(_name(target))
    write_arrays(mesh, plan.mesh(target), target.family, plan.digests[target.key][1], plan.looks)
    return mesh


def _realise(
    target: Target,
    plan: Plan,
    obj: Any,
    parent: Any,
    collection: Any,
    made: dict[tuple[str, str], Any],
    spent: list[tuple[int, Any]],
) -> Any:
    """Make or update one object; returns it."""
    digest, shapes = plan.digests[target.key]
    is_same = obj is not None and obj.get(LINE) == digest
    if is_same and target.kind != "proxy" and obj.parent == parent:
        return obj
    if obj is None:
        mesh = made.pop(target.key, None) or shared_mesh(target, shapes, collection)
        obj = new_object(target, collection, mesh)
    matrix = held_matrix(obj, target)
    held = matrix is not None or (target.kind == "proxy" and is_pending(obj))
    if target.kind in ("light", "camera"):
        (write_light if target.kind == "light" else write_camera)(obj.data, target.line)
        matrix = target.matrix if matrix is None else matrix
    elif matrix is None:
        matrix = _update_mesh(target, plan, obj, shapes, made, collection, spent)
    elif target.kind == "proxy" and obj.type == "MESH" and not is_same:
        dress_own(obj, target)
    place(obj, matrix, kept_parent(obj, parent), _CAMERA_TOLERANCE if target.kind == "camera" else EXACT)
    if not is_same:
        write_fields(obj, target, digest)
    if not is_same or HELD in obj:
        remember(obj, target, held)
    return obj


def has_mesh(target: Target) -> bool:
    """Whether a target is shown by a mesh."""
    return target.role == "shell" or target.kind == "proxy"


def _name(target: Target) -> str:
    return " ".join(part for part in target.key if part)


def new_object(target: Target, collection: Any, mesh: Any) -> Any:
    """An object of the right type with its tags, linked to its collection."""
    name = _name(target)
    data: Any
    if target.kind == "light":
        data = bpy.data.lights.new(name, target.line["kind"].upper())
    elif target.kind == "camera":
        data = bpy.data.cameras.new(name)
    else:
        data = bpy.data.meshes.new(name) if mesh is None else mesh
    obj = bpy.data.objects.new(name, data)
    obj[ID] = target.key[0]
    if target.key[1]:
        obj[PART] = target.key[1]
    obj[NAME] = obj.name
    if target.kind == "light":
        dress_light(obj)
    collection.objects.link(obj)
    return obj


def write_fields(obj: Any, target: Target, digest: str) -> None:
    """Keep the line's plain values on the object."""
    obj[LINE] = digest
    obj[KIND] = target.kind
    if WAS in obj:
        del obj[WAS]
    for name, value in target.fields.items():
        obj[FIELD + name] = value


def _lacks(obj: Any, target: Target, digest: str) -> bool:
    """Whether the object's mesh has to be written: it is not the target's, and not one that the artist made."""
    if obj.type != "MESH" or obj.data.get(DIGEST) == digest:
        return False
    mesh = obj.data
    if mesh.get(DIGEST) is not None and not is_hand_made(mesh):
        return True
    return not (len(mesh.vertices) and target.kind == "proxy")


def _update_mesh(
    target: Target,
    plan: Plan,
    obj: Any,
    digest: str,
    made: dict[tuple[str, str], Any],
    collection: Any,
    spent: list[tuple[int, Any]],
) -> Any:
    """Bring the object's mesh up to date; returns the matrix that the object should have with it.

    A mesh that the artist made is kept. Its object is fitted to the line's box when it does not fill it.

    Args:
        spent: takes the `session_uid` of each mesh that was exchanged, with the one that stands in its place.
    """
    if obj.type != "MESH":
        return world_matrix(obj)
    mesh = obj.data
    if ASSET in mesh:  # the artist's asset, which was fitted to the line's box before
        return target.matrix
    if _lacks(obj, target, digest):
        if target.key in made:
            spent.append((obj.data.session_uid, made[target.key]))
            _exchange(obj, made.pop(target.key))
            return target.matrix
        shared = shared_mesh(target, digest, collection, mesh)
        if shared is not None:
            use_mesh(obj, shared)
            return target.matrix
        if mesh.users > 1:  # what shares it must not change with it
            own = artists_slots(mesh)
            obj.data = mesh = bpy.data.meshes.new(obj.name)
            write_arrays(mesh, plan.mesh(target), target.family, digest, plan.looks)
            put_artists_slots(mesh, own)
        else:
            write_arrays(mesh, plan.mesh(target), target.family, digest, plan.looks)
    elif target.kind == "proxy" and len(mesh.vertices) and (mesh.get(DIGEST) is None or is_hand_made(mesh)):
        dress_own(obj, target)
        return fit_matrix(obj.data, world_matrix(obj), target.line)
    return target.matrix


def _exchange(obj: Any, mesh: Any) -> None:
    """Give the object a mesh that was made beforehand."""
    put_artists_slots(mesh, artists_slots(obj.data))
    obj.data = mesh


def _take_away(spent: list[tuple[int, Any]]) -> None:
    """Remove meshes that nobody uses any more; their names stay. At once, since Blender looks through all it has each time."""
    if not spent:
        return
    meshes = {mesh.session_uid: mesh for mesh in bpy.data.meshes if mesh.users == 0}
    unused = {meshes[uid].name: (meshes[uid], mesh) for uid, mesh in spent if uid in meshes}
    if unused:
        bpy.data.batch_remove([former for former, _ in unused.values()])
    for name, (_, mesh) in unused.items():
        mesh.name = name


def place(obj: Any, matrix: Any, parent: Any, tolerance: float) -> None:
    """Put the object at a place in the room under its parent, unless it is there already."""
    if obj.parent == parent and np.abs(np.array(world_matrix(obj)) - matrix).max() < tolerance:
        return
    obj.parent = parent
    if parent is not None:
        obj.parent_type = "OBJECT"
        obj.matrix_parent_inverse = world_matrix(parent).inverted_safe()
    obj.matrix_basis = [[float(v) for v in row] for row in np.asarray(matrix).T]  # Blender takes columns


def _remove(objects: list[Any]) -> None:
    """Delete objects of ours; whatever was parented to them stays where it is."""
    for obj in objects:
        free_children(obj)
    data = {obj.data for obj in objects if obj.data is not None}
    if objects:
        bpy.data.batch_remove(objects)
    if unused := [block for block in data if block.users == 0]:
        bpy.data.batch_remove(unused)


def _restore_refused_names(existing: dict[tuple[str, str], list[Any]], wanted: set[tuple[str, str]]) -> None:
    """Objects whose new name never reached the program get their former id back, so that they are not removed."""
    for key in list(existing):
        obj = existing[key][0]
        former = (str(obj.get(WAS, "")), key[1])
        if WAS in obj and key not in wanted and former in wanted and former not in existing:
            obj[ID] = former[0]
            del obj[WAS]
            existing[former] = existing.pop(key)
