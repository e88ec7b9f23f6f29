# SPDX-License-Identifier: GPL-3.0-or-later
"""What a build remembers of each object, and how it leaves alone what the artist did.

Every object remembers how it stood after the last build, so that reading the scene back compares with that. What the
artist edited, copied, added or locked is *held*: its mesh and its place stay bit for bit for as long as they agree with
its line, and a build that has no place for it (a new layout without the small things) sets it aside instead of deleting
it. It comes back with the same data when a later build has its line again.
"""

from __future__ import annotations

import json
from typing import Any

import bpy
import numpy as np

from ..program.prelude.palette import FAMILY_COLOURS
from .boxes import (
    BOUNDS,
    FRAME,
    INNER,
    SAMPLE,
    SEEN_MESH,
    mesh_bounds,
    mesh_edited,
    object_box,
    own_frame,
    parts_of,
    sampled,
)
from .materials import ensure_material
from .measure import EXACT, fit_box
from .meshes import is_hand_made, mesh_fingerprint
from .tags import (
    ASSET,
    AWAY,
    BUILT_IDS,
    BUILT_LINES,
    COLOUR,
    COPIED,
    DIGEST,
    FIELD,
    GROUP,
    HELD,
    ID,
    LINE,
    PART,
    world_matrix,
)
from .targets import Target, shapes_digest

SEEN = FIELD + "seen"  # on an object: its matrix in the room when it was built, 16 numbers
SEEN_LOCAL = FIELD + "seen_local"  # the same below its parent
SEEN_PARENT = FIELD + "seen_parent"  # id of its parent in Blender, "" for none
LOOK = FIELD + "look"  # what its mesh was made from, whatever its size and its colour
_GROUPS = ("walls", "doors", "windows", "openings", "proxies", "lights", "worlds", "views", "cameras")


# ---- remembering ----


def remember(obj: Any, target: Target, held: bool) -> None:
    """Keep how an object stands now, so that it is seen later what the artist changed."""
    frame, inner = np.eye(4), None
    if held and target.kind == "proxy" and obj.type == "MESH":
        frame, inner = own_frame(obj, mesh_edited(obj)), obj.get(INNER)
    remember_built(obj, target)
    if not np.array_equal(frame, np.eye(4)):
        obj[FRAME] = _flat(frame)
    if inner is not None:
        obj[INNER] = list(inner)


def remember_built(obj: Any, target: Target) -> None:
    """Keep how an object stands that was just made from its line."""
    obj[SEEN] = _flat(world_matrix(obj))
    obj[SEEN_LOCAL] = _flat(local_matrix(obj))
    obj[SEEN_PARENT] = str(obj.parent.get(ID, "")) if obj.parent is not None else ""
    if COPIED in obj:
        del obj[COPIED]
    if target.kind == "proxy":
        obj[LOOK] = _look(target)
    if obj.type != "MESH":
        return
    if target.kind == "proxy":
        if FRAME in obj:
            del obj[FRAME]
        obj[INNER] = [float(v) for v in target.line["size"]]
        remember_mesh(obj)
    else:
        obj[SEEN_MESH] = mesh_fingerprint(obj.data)
        obj[BOUNDS] = mesh_bounds(obj.data)


def remember_mesh(obj: Any) -> None:
    """Keep what an object's mesh is now: it is none that the artist edited."""
    obj[SEEN_MESH] = mesh_fingerprint(obj.data)
    obj[BOUNDS] = mesh_bounds(obj.data)
    obj[SAMPLE] = [float(v) for v in sampled(obj.data).ravel()]
    obj[SAMPLE + "_of"] = len(obj.data.vertices)


def remember_record(room: Any, record: Any, built: set[str]) -> None:
    """Keep the layout lines that a room was built with, and which of them have no object."""
    lines: dict[str, Any] = {name: getattr(record, name) for name in _GROUPS}
    left_out = [line["id"] for name in _GROUPS for line in lines[name] if line["id"] not in built]
    room[BUILT_LINES] = json.dumps({"room": record.room, **lines, "left_out": left_out}, ensure_ascii=True)
    room[BUILT_IDS] = [line["id"] for line in record.proxies]


def local_matrix(obj: Any) -> Any:
    """The object's matrix below its parent; in the room when it has none."""
    return obj.matrix_parent_inverse @ obj.matrix_basis if obj.parent is not None else obj.matrix_basis


def _flat(matrix: Any) -> list[float]:
    return [float(v) for row in matrix for v in row]


# ---- leaving alone ----


def held_matrix(obj: Any, target: Target) -> Any | None:
    """Where a held object should be with its mesh as it is, None when a build may do with it as with any other."""
    if HELD not in obj:
        return None
    if target.kind == "light":
        return world_matrix(obj) if _shines_the_same(world_matrix(obj), target.matrix) else None
    if target.kind != "proxy":
        return None
    ours = obj.type == "MESH" and DIGEST in obj.data
    if ours and obj.get(LOOK, _look(target)) != _look(target):
        del obj[HELD]  # it becomes something else: what was held is not there any more
        return None
    box = object_box(obj)
    if box is None:
        return world_matrix(obj) if obj.type != "MESH" else None
    now = np.array(world_matrix(obj), dtype=float)
    wanted = fit_box(box, now, target.line)
    if not np.array_equal(wanted, now):
        built = list(obj.get(FIELD + "box", ()))
        if SEEN in obj and built == [*target.line["centre"], *target.line["size"], target.line["yaw"]]:
            # Something else moved it, such as its parent: back to where it was, not to the line's rounded numbers.
            return np.array(obj[SEEN], dtype=float).reshape(4, 4)
        if ours and not is_hand_made(obj.data) and FRAME not in obj and _is_plain(now):
            return None  # what a build makes of its line is just this
    if ours:
        _recolour(obj, target.family)
    return wanted


def kept_parent(obj: Any, parent: Any) -> Any:
    """The parent that a build gives an object: what the artist left without one has none, which would shift its bits."""
    return None if HELD in obj and obj.parent is None else parent


def _is_plain(matrix: Any) -> bool:
    """Whether a matrix only moves, and turns about z, as a line does."""
    m = np.array(matrix, dtype=float)[:3, :3]
    c, s = m[0, 0], m[1, 0]
    return bool(np.abs(m - [[c, -s, 0], [s, c, 0], [0, 0, 1]]).max() < 1e-5 and abs(c * c + s * s - 1) < 1e-5)


def _shines_the_same(first: Any, second: Any) -> bool:
    """Whether two lamps are at one place and shine one way; a line does not say how they are turned about that way."""
    a, b = np.array(first, dtype=float), np.array(second, dtype=float)
    along = a[:3, 2] / max(float(np.linalg.norm(a[:3, 2])), 1e-9)
    return bool(np.abs(a[:3, 3] - b[:3, 3]).max() < EXACT and np.abs(along - b[:3, 2]).max() < 1e-3)


def _look(target: Target) -> str:
    if target.fields.get("furnished"):
        # A cloth that lies a little differently, since what carries it moved, is still the same cloth.
        return shapes_digest(target.shapes if target.plain is None else target.plain, "")
    return str(target.line.get("shape", "box"))


def _recolour(obj: Any, family: str) -> None:
    """Give our own materials the colours of another family of categories; the artist's materials stay."""
    for index, material in enumerate(list(obj.data.materials)):
        former, _, role = str(material.get(COLOUR, "")).partition("/") if material is not None else ("", "", "")
        if former in FAMILY_COLOURS and "/" in str(material[COLOUR]) and former != family:
            wanted = ensure_material(family, role or "body")
            if wanted != material:
                if obj.data.users > 1:  # the others stay what they are
                    obj.data = obj.data.copy()
                obj.data.materials[index] = wanted


# ---- setting aside ----


def is_artists(obj: Any) -> bool:
    """Whether there is more to an object than its line says: it is held, or has something that only an artist adds."""
    if HELD in obj or obj.get(GROUP) or len(obj.modifiers) or len(obj.constraints) or obj.animation_data is not None:
        return True
    if obj.type == "MESH" and ASSET in obj.data:
        return True
    return any(slot.material is not None and COLOUR not in slot.material for slot in obj.material_slots)


def away(room: Any) -> dict[tuple[str, str], Any]:
    """What was set aside, by (id, part)."""
    kept = place_aside(room)
    if kept is None:
        return {}
    return {(str(obj[ID]), str(obj.get(PART, ""))): obj for obj in kept.objects if AWAY in obj and ID in obj}


def place_aside(room: Any) -> Any | None:
    """The collection of what was set aside, None when nothing was.

    It points to the room and not the other way round: what a room points to, Blender would evaluate with it.
    """
    return next((c for c in bpy.data.collections if c.library is None and c.get(AWAY) == room), None)


def set_aside(room: Any, obj: Any) -> None:
    """Take an object out of the room without deleting it. It keeps its place below its parent."""
    kept = place_aside(room)
    if kept is None:
        kept = bpy.data.collections.new("Room Set Aside")
        kept[AWAY] = room
        kept.use_fake_user = True
    former = away(room).get((str(obj[ID]), str(obj.get(PART, ""))))
    if former is not None:
        bpy.data.objects.remove(former, do_unlink=True)
    obj[AWAY] = True
    free_children(obj)
    inside = {room, *room.children_recursive}
    for thing in (obj, *parts_of(obj)):
        for collection in list(thing.users_collection):
            if collection in inside:
                collection.objects.unlink(thing)
        kept.objects.link(thing)


def bring_back(obj: Any, parent: Any, room: Any, collection: Any) -> Any:
    """Put an object that was set aside into the room again, below the parent that it had."""
    kept = place_aside(room)
    for thing in (obj, *parts_of(obj)):
        if kept is not None and any(owner == kept for owner in thing.users_collection):
            kept.objects.unlink(thing)
        collection.objects.link(thing)
    del obj[AWAY]
    if obj.parent is None and parent is not None and obj.get(SEEN_PARENT) == parent.get(ID):
        obj.parent = parent  # its own place and the parent's inverse are as they were
    return obj


def forget_aside(room: Any, ids: set[str] | None = None) -> None:
    """Delete what was set aside: these ids, such as what the artist removed, or all of it when the room goes."""
    kept = place_aside(room)
    if kept is None:
        return
    for key, obj in away(room).items():
        if ids is None or key[0] in ids:
            for thing in (*parts_of(obj), obj):
                bpy.data.objects.remove(thing, do_unlink=True)
    if not len(kept.objects):
        bpy.data.collections.remove(kept)


def free_children(obj: Any) -> None:
    """Before an object goes: what was parented to it stays where it is; what is set aside keeps its place below it."""
    for child in list(obj.children):
        if ID not in child and obj.get(GROUP):
            continue
        if AWAY in child:
            if AWAY not in obj:
                child.parent = None
            continue
        matrix = world_matrix(child)
        child.parent = None
        child.matrix_basis = matrix


def is_pending(obj: Any) -> bool:
    """Whether the artist copied or added it, and the program has not been built with it yet."""
    return ID in obj and LINE not in obj
