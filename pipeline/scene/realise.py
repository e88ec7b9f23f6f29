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
from .lenses import write_camera, write_light
from .measure import fit_matrix
from .meshes import is_hand_made, write_shapes
from .tags import (
    BUILT_IDS,
    DIGEST,
    FIELD,
    ID,
    KIND,
    LINE,
    NAME,
    PART,
    WAS,
    ensure_collections,
    tagged_objects,
    world_matrix,
)
from .targets import Target, parents_first, record_targets, shapes_digest, target_digest

_MATRIX_TOLERANCE = 1e-5  # metres and radians: above float32 noise, far below what an artist sees


def realise_record(record: Record, collection_name: str = "Code-as-Room", scene: Any = None) -> list[str]:
    """Make or update the room in the scene (the current one unless another is given).

    Objects are found by their ids; those that did not change keep their datablocks untouched, those whose ids are gone
    are removed, copies and additions of the artist stay.

    Returns:
        One plain sentence for each number of the shell that had to be clamped.
    """
    scene = scene or bpy.context.scene
    collections = ensure_collections(scene, collection_name)
    targets, notes = record_targets(record)
    existing = tagged_objects(collections["room"])
    wanted = {target.key for target in targets}
    _restore_refused_names(existing, wanted)
    for key, objects in existing.items():
        obj = objects[0]
        if key not in wanted and LINE in obj and obj.get(NAME) == obj.name:  # copies and renamed ones are the artist's
            _remove(obj)
    done: dict[str, Any] = {}
    for target in parents_first(targets):
        obj = existing.get(target.key, [None])[0]
        obj = _realise(target, obj, done.get(target.parent or ""), collections[target.role])
        if not target.key[1]:
            done[target.key[0]] = obj
    collections["room"][BUILT_IDS] = [line["id"] for line in record.proxies]
    if scene.camera is None:
        scene.camera = next((done[line["id"]] for line in record.cameras if line["id"] in done), None)
    for layer in scene.view_layers:
        layer.update()
    return notes


def _realise(target: Target, obj: Any, parent: Any, collection: Any) -> Any:
    """Make or update one object; returns it."""
    digest = target_digest(target)
    is_same = obj is not None and obj.get(LINE) == digest
    if is_same and target.kind != "proxy" and obj.parent == parent:
        return obj
    if obj is None:
        obj = _new_object(target, collection)
    if target.role == "shell" or target.kind == "proxy":
        matrix = _update_mesh(target, obj)
    else:
        (write_light if target.kind == "light" else write_camera)(obj.data, target.line)
        matrix = target.matrix
    _place(obj, matrix, parent)
    if not is_same:
        _write_fields(obj, target, digest)
    return obj


def _new_object(target: Target, collection: Any) -> Any:
    """An object of the right type with its tags, linked to its collection."""
    name = " ".join(part for part in target.key if part)
    data: Any
    if target.kind == "light":
        data = bpy.data.lights.new(name, target.line["kind"].upper())
    elif target.kind == "camera":
        data = bpy.data.cameras.new(name)
    else:
        data = bpy.data.meshes.new(name)
    obj = bpy.data.objects.new(name, data)
    obj[ID] = target.key[0]
    if target.key[1]:
        obj[PART] = target.key[1]
    obj[NAME] = obj.name
    collection.objects.link(obj)
    return obj


def _write_fields(obj: Any, target: Target, digest: str) -> None:
    """Keep the line's plain values on the object."""
    obj[LINE] = digest
    obj[KIND] = target.kind
    if WAS in obj:
        del obj[WAS]
    for name, value in target.fields.items():
        obj[FIELD + name] = value


def _update_mesh(target: Target, obj: Any) -> Any:
    """Bring the object's mesh up to date; returns the matrix that the object should have with it.

    A mesh that the artist made is kept. Its object is fitted to the line's box when it does not fill it.
    """
    if obj.type != "MESH":
        return world_matrix(obj)
    digest = shapes_digest(target.shapes, target.family)
    mesh = obj.data
    if mesh.get(DIGEST) is not None and not is_hand_made(mesh):
        if mesh.get(DIGEST) == digest:
            return target.matrix
        if mesh.users > 1:  # an artist's linked copy shares it and must not change with it
            obj.data = mesh = bpy.data.meshes.new(obj.name)
    elif len(mesh.vertices) and target.kind == "proxy":
        return fit_matrix(mesh, world_matrix(obj), target.line)
    elif DIGEST in mesh and mesh.get(DIGEST) == digest:
        return target.matrix
    write_shapes(mesh, target.shapes, target.family, digest)
    return target.matrix


def _place(obj: Any, matrix: Any, parent: Any) -> None:
    """Put the object at a place in the room under its parent, unless it is there already."""
    if obj.parent == parent and np.abs(np.array(world_matrix(obj)) - matrix).max() < _MATRIX_TOLERANCE:
        return
    obj.parent = parent
    if parent is not None:
        obj.parent_type = "OBJECT"
        obj.matrix_parent_inverse = world_matrix(parent).inverted_safe()
    obj.matrix_basis = [[float(v) for v in row] for row in np.asarray(matrix).T]  # Blender takes columns


def _remove(obj: Any) -> None:
    """Delete an object of ours; whatever was parented to it stays where it is."""
    for child in list(obj.children):
        matrix = world_matrix(child)
        child.parent = None
        child.matrix_basis = matrix
    data = obj.data
    bpy.data.objects.remove(obj, do_unlink=True)
    if data is not None and data.users == 0:
        bpy.data.batch_remove([data])


def _restore_refused_names(existing: dict[tuple[str, str], list[Any]], wanted: set[tuple[str, str]]) -> None:
    """Objects whose new name never reached the program get their former id back, so that they are not removed."""
    for key in list(existing):
        obj = existing[key][0]
        former = (str(obj.get(WAS, "")), key[1])
        if WAS in obj and key not in wanted and former in wanted and former not in existing:
            obj[ID] = former[0]
            del obj[WAS]
            existing[former] = existing.pop(key)
