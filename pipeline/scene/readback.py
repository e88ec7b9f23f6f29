# SPDX-License-Identifier: GPL-3.0-or-later
"""What an artist changed by hand since the last build, as typed edits.

Every object remembers how it stood when it was built, so the scene is compared with what was built and not with the
program's text: an artist may have edited that too, and both kinds of edits are kept. What nobody touched is not even
measured.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import bpy
import numpy as np

from ..artifacts.analysis import Finding
from ..artifacts.layout import LayoutEdit
from .boxes import mesh_edited, world_points
from .boxes import object_box as object_box
from .holding import SEEN, SEEN_PARENT
from .measure import Box, matrix_yaw, measure, turn_between
from .naming import free_id, id_from_name, next_id
from .placing import guess_placement, new_proxy_edit
from .read_lines import built_layout, followed, read_lines, touched
from .tags import BUILT_IDS, FIELD, GROUP, ID, KIND, LINE, NAME, WAS, tagged_objects, world_matrix

MOVED = 1e-4  # metres: smaller differences are float noise
TURNED = 1e-2  # degrees
_TIPPED = 1e-3  # how far the end of an axis one metre long is from where a turn about z would have it
_DEEPEST = 200  # parents above each other


@dataclass
class Reading:
    """What was read.

    Attributes:
        edits: in an order in which they can be applied one after the other.
        adopted: objects that the artist copied or added, with the ids that they are to get.
        renamed: objects that the artist renamed, with their ids before and after.
        held: objects whose place and mesh are the artist's. put_back: objects that a build puts where their line says.
        findings: what could not be taken over.
    """

    edits: list[LayoutEdit] = field(default_factory=list)
    adopted: list[tuple[Any, str]] = field(default_factory=list)
    renamed: list[tuple[Any, str, str]] = field(default_factory=list)
    held: list[Any] = field(default_factory=list)
    put_back: list[Any] = field(default_factory=list)
    findings: list[Finding] = field(default_factory=list)


class Boxes(dict[str, "Box | None"]):
    """Boxes of objects by id, measured when they are asked for."""

    def __init__(self, objects: dict[str, Any]) -> None:
        super().__init__()
        self._objects = dict(objects)

    def __missing__(self, name: str) -> Box | None:
        obj = self._objects.get(name)
        if obj is None:
            return None
        self[name] = object_box(obj)
        return self[name]

    def everything(self) -> dict[str, Box | None]:
        """All of them, measured."""
        return {name: self[name] for name in (*self._objects, *self)}


def read_back(room: Any, taken: set[str]) -> Reading:
    """Compare the collection with what was last built in it. Nothing is changed; see `adopt.adopt`.

    Args:
        taken: ids of all lines of the program, which new objects must not get.
    """
    _settle(room)
    tagged = tagged_objects(room)
    used = taken | {identifier for identifier, _ in tagged}
    originals, added = _sorted_objects(room, tagged, taken, used)
    names = {obj: name for name, obj in originals.items()} | dict(added)
    names |= {obj: str(obj[ID]) for obj in room.all_objects if ID in obj and obj not in names}
    reading = Reading(adopted=added)
    boxes = Boxes(originals)
    for obj, name in _parents_first(added, names):
        box = _added_box(obj)
        if box is not None:
            parent = names.get(obj.parent)
            reading.edits.append(new_proxy_edit(obj, name, box, parent, boxes, _height(room)))
    for name, obj in originals.items():
        edits = _box_edits(name, obj, boxes) + _parent_edits(name, obj, names, boxes, room)
        if any(edit.origin == "artist" for edit in edits):
            reading.held.append(obj)
        reading.edits += edits
    for built in room.get(BUILT_IDS, []):
        if str(built) in taken and (str(built) not in originals or _is_empty(originals[str(built)])):
            reading.edits.append(LayoutEdit(op="remove", id=str(built), reason="deleted by hand", origin="artist"))
    _read_lines(reading, room, tagged, taken, used)
    _read_names(reading, originals, used | set(names.values()))
    return reading


def _settle(room: Any) -> None:
    """Bring meshes up to date that are in Edit mode, and what constraints decide."""
    constrained = False
    for obj in room.all_objects:
        if obj.mode == "EDIT":
            obj.update_from_editmode()
        constrained = constrained or len(obj.constraints) > 0
    if constrained:
        for scene in bpy.data.scenes:
            if room in scene.collection.children_recursive:
                for layer in scene.view_layers:
                    layer.update()


def _sorted_objects(
    room: Any, tagged: dict[tuple[str, str], list[Any]], taken: set[str], used: set[str]
) -> tuple[dict[str, Any], list[tuple[Any, str]]]:
    """The proxies that were built, by the program's id, and what was copied or added, with new ids."""
    originals: dict[str, Any] = {}
    added: list[tuple[Any, str]] = []
    built = {str(i) for i in room.get(BUILT_IDS, [])}
    for (identifier, part), objects in tagged.items():
        if part or objects[0].get(KIND, "proxy") != "proxy":
            continue
        first = objects[0]
        before = str(first.get(WAS, identifier))
        if LINE in first and (before in built or before in taken):
            originals[before] = first
        else:  # the program has not been built with it yet, or not any more
            added.append((first, identifier))
        for copy in objects[1:]:
            name = next_id(identifier, used)
            used.add(name)
            added.append((copy, name))
    for obj in _new_roots(room):
        name = free_id(id_from_name(obj.name) or "object_1", used)
        used.add(name)
        added.append((obj, name))
    return originals, added


def _new_roots(room: Any) -> list[Any]:
    """The topmost of the artist's own objects, each standing for everything below it that has extent."""
    inside = set(room.all_objects)
    roots: dict[Any, None] = {}
    for obj in room.all_objects:
        if ID in obj or obj.type in ("LIGHT", "CAMERA", "SPEAKER", "LIGHT_PROBE"):
            continue
        top = obj
        for _ in range(_DEEPEST):
            if top.parent is None or ID in top.parent or top.parent not in inside:
                break
            top = top.parent
        if top.parent is None or not top.parent.get(GROUP):
            roots[top] = None
    return [obj for obj in roots if len(world_points(obj))]


def _added_box(obj: Any) -> Box | None:
    """The box of a copy, or of the artist's own object with its parts."""
    if ID in obj and not obj.get(GROUP):
        return object_box(obj)
    points = world_points(obj)
    return measure(points, np.eye(4), matrix_yaw(world_matrix(obj))) if len(points) else None


def _parents_first(added: list[tuple[Any, str]], names: dict[Any, str]) -> list[tuple[Any, str]]:
    """New objects ordered so that a parent among them comes before its children."""

    def depth(obj: Any) -> int:
        return 0 if obj.parent not in names else 1 + depth(obj.parent)

    return sorted(added, key=lambda item: depth(item[0]))


def _height(room: Any) -> float:
    """The room's height, 0 when it is not known."""
    return next((float(o.get(FIELD + "height", 0.0)) for o in room.all_objects if o.get(KIND) == "floor"), 0.0)


def _is_empty(obj: Any) -> bool:
    """Whether the artist deleted all there was of a mesh."""
    return bool(obj.type == "MESH" and not len(obj.data.vertices) and not obj.get(GROUP))


def _box_edits(name: str, obj: Any, boxes: Boxes) -> list[LayoutEdit]:
    """Edits for how the box differs from the one that was built."""
    if SEEN in obj and not obj.get(GROUP) and not touched(obj):
        return []
    built = [float(v) for v in obj.get(FIELD + "box", [])]
    if len(built) != 7:
        return []
    box = boxes[name]
    if box is None:
        return []
    who: dict[str, Any] = {"origin": "artist"}
    if followed(obj):
        who = {"origin": "parent", "reason": f"moved along with {obj.get(FIELD + 'parent')}"}
    edits = []
    moved = any(abs(a - b) > MOVED for a, b in zip(box.centre, built[:3], strict=True))
    scaled = any(abs(a - b) > MOVED for a, b in zip(box.size, built[3:6], strict=True))
    turned = abs(turn_between(built[6], box.yaw)) > TURNED
    centre, size = _rounded(box.centre), _rounded(tuple(max(v, 1e-4) for v in box.size))
    if scaled:
        edits.append(LayoutEdit(op="resize", id=name, size=size, centre=centre, **{"reason": "by hand", **who}))
    elif moved:
        edits.append(LayoutEdit(op="move", id=name, centre=centre, **{"reason": "moved by hand", **who}))
    if turned:
        edits.append(LayoutEdit(op="turn", id=name, yaw=round(box.yaw, 4), **{"reason": "turned by hand", **who}))
    if not edits and _tipped(obj, turn_between(built[6], box.yaw)):
        reason = {"reason": "was tipped over or mirrored by hand", **who}
        edits.append(LayoutEdit(op="turn", id=name, yaw=round(box.yaw, 4), **reason))
    return edits


def _tipped(obj: Any, turn: float) -> bool:
    """Whether an object fills its box in another way than a turn about z explains."""
    if SEEN not in obj or mesh_edited(obj):
        return False
    angle = np.radians(turn)
    c, s = np.cos(angle), np.sin(angle)
    before, now = (
        np.array(obj[SEEN], dtype=float).reshape(4, 4)[:3, :3],
        np.array(world_matrix(obj), dtype=float)[:3, :3],
    )
    axes = []
    for m in (np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]]) @ before, now):
        sides = np.linalg.norm(m, axis=0)
        axes.append(m / np.where(sides > 1e-9, sides, 1.0))
    return bool(np.abs(axes[0] - axes[1]).max() > _TIPPED)


def _parent_edits(name: str, obj: Any, names: dict[Any, str], boxes: Boxes, room: Any) -> list[LayoutEdit]:
    """An edit when the artist gave the object another parent, or none. A deleted parent is not the child's edit."""
    built = str(obj.get(SEEN_PARENT, obj.get(FIELD + "parent", ""))) or None
    now = names.get(obj.parent)
    if now == built or (obj.parent is None and built not in names.values()):
        return []
    if obj.parent is not None and now is None:
        return []  # under something that is not of the room
    box = boxes[name]
    if box is None:
        return []
    placement = guess_placement(box, now, boxes, _height(room))
    return [LayoutEdit(op="reparent", id=name, placement=placement, parent=now, reason="by hand", origin="artist")]


def _read_lines(
    reading: Reading, room: Any, tagged: dict[tuple[str, str], list[Any]], taken: set[str], used: set[str]
) -> None:
    """Walls and what is in them, lights and cameras."""
    found = built_layout(room)
    if found is None:
        return
    lines = read_lines(room, *found, tagged, taken, used)
    reading.edits += lines.edits
    reading.adopted += lines.adopted
    reading.held += lines.held
    reading.put_back += lines.put_back
    reading.findings += lines.findings


def _read_names(reading: Reading, originals: dict[str, Any], used: set[str]) -> None:
    """Renamed objects; last, because every other edit speaks of the ids before."""
    removed = {edit.id for edit in reading.edits if edit.op == "remove"}
    for name, obj in originals.items():
        if name in removed:
            continue
        if WAS in obj:
            new = str(obj[ID])
        elif obj.name != obj.get(NAME) and id_from_name(obj.name) not in ("", name):
            new = free_id(id_from_name(obj.name), used)
        else:
            continue
        used.add(new)
        reading.renamed.append((obj, name, new))
        reading.edits.append(
            LayoutEdit(op="rename", id=name, new_id=new, reason=f'renamed to "{obj.name}"', origin="artist")
        )


def _rounded(values: tuple[float, ...]) -> Any:
    return tuple(round(v, 4) + 0.0 for v in values)
