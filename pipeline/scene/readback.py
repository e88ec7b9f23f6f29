# SPDX-License-Identifier: GPL-3.0-or-later
"""What an artist changed by hand since the last build, as typed edits.

Every proxy's object remembers the box it was built with, so the scene is compared with what was built and not with the
program's text: an artist may have edited that too, and both kinds of edits are kept.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np

from ..artifacts.layout import LayoutEdit
from .measure import Box, box_points, measure, mesh_points, turn_between
from .meshes import is_hand_made
from .naming import free_id, id_from_name, next_id
from .placing import guess_placement, new_proxy_edit
from .tags import BUILT_IDS, FIELD, ID, KIND, LINE, NAME, WAS, tagged_objects, world_matrix

MOVED = 1e-4  # metres: smaller differences are float noise
TURNED = 1e-2  # degrees


@dataclass
class Reading:
    """What was read.

    Attributes:
        edits: in an order in which they can be applied one after the other.
        adopted: objects that the artist copied or added, with the ids that they are to get.
        renamed: objects that the artist renamed, with their ids before and after.
    """

    edits: list[LayoutEdit] = field(default_factory=list)
    adopted: list[tuple[Any, str]] = field(default_factory=list)
    renamed: list[tuple[Any, str, str]] = field(default_factory=list)


def read_back(room: Any, taken: set[str]) -> Reading:
    """Compare the collection with what was last built in it. Nothing is changed; see `adopt.adopt`.

    Args:
        taken: ids of all lines of the program, which new objects must not get.
    """
    for obj in room.all_objects:
        if obj.mode == "EDIT":
            obj.update_from_editmode()
    originals, added = _sorted_objects(room, taken)
    names = {obj: name for name, obj in originals.items()} | dict(added)
    names |= {obj: str(obj[ID]) for obj in room.all_objects if ID in obj and obj not in names}
    reading = Reading(adopted=added)
    boxes = {name: object_box(obj) for name, obj in originals.items()}
    for obj, name in _parents_first(added, names):
        box = object_box(obj)
        if box is not None:
            reading.edits.append(new_proxy_edit(obj, name, box, names.get(obj.parent), boxes, _height(room)))
    for name, obj in originals.items():
        reading.edits += _box_edits(name, obj, boxes[name]) + _parent_edits(name, obj, names, boxes, room)
    for built in room.get(BUILT_IDS, []):
        if str(built) in taken and str(built) not in originals:
            reading.edits.append(LayoutEdit(op="remove", id=str(built), reason="deleted by hand", origin="artist"))
    _read_names(reading, originals, taken | set(names.values()))
    return reading


def _sorted_objects(room: Any, taken: set[str]) -> tuple[dict[str, Any], list[tuple[Any, str]]]:
    """The proxies that were built, by the program's id, and what was copied or added, with new ids."""
    originals: dict[str, Any] = {}
    added: list[tuple[Any, str]] = []
    tagged = tagged_objects(room)
    used = taken | {identifier for identifier, _ in tagged}
    for (identifier, part), objects in tagged.items():
        if part or objects[0].get(KIND, "proxy") != "proxy":
            continue
        first = objects[0]
        if LINE in first:
            originals[str(first.get(WAS, identifier))] = first
        else:  # it was read before, and the program has not been built with it yet
            added.append((first, identifier))
        for copy in objects[1:]:
            name = next_id(identifier, used)
            used.add(name)
            added.append((copy, name))
    for obj in room.all_objects:
        if ID not in obj and obj.type == "MESH" and len(obj.data.vertices):
            name = free_id(id_from_name(obj.name) or "object_1", used)
            used.add(name)
            added.append((obj, name))
    return originals, added


def _parents_first(added: list[tuple[Any, str]], names: dict[Any, str]) -> list[tuple[Any, str]]:
    """New objects ordered so that a parent among them comes before its children."""

    def depth(obj: Any) -> int:
        return 0 if obj.parent not in names else 1 + depth(obj.parent)

    return sorted(added, key=lambda item: depth(item[0]))


def object_box(obj: Any) -> Box | None:
    """The object's box as it stands, None for things without extent.

    A furnished proxy counts with its proxy's box, which its parts need not fill; a mesh that the artist edited counts
    with its own vertices.
    """
    matrix = world_matrix(obj)
    if obj.type != "MESH":
        corners = np.array(obj.bound_box, dtype=float) if obj.type in ("CURVE", "SURFACE", "FONT") else np.zeros((0, 3))
        return measure(corners, matrix) if np.ptp(corners) > 0 else None
    if not len(obj.data.vertices):
        return None
    if obj.get(FIELD + "furnished") and FIELD + "box" in obj and not is_hand_made(obj.data):
        return measure(box_points(obj[FIELD + "box"][3:6]), matrix)
    return measure(mesh_points(obj.data), matrix)


def _height(room: Any) -> float:
    """The room's height, 0 when it is not known."""
    return next((float(o.get(FIELD + "height", 0.0)) for o in room.all_objects if o.get(KIND) == "floor"), 0.0)


def _box_edits(name: str, obj: Any, box: Box | None) -> list[LayoutEdit]:
    """Edits for how the box differs from the one that was built."""
    built = [float(v) for v in obj.get(FIELD + "box", [])]
    if box is None or len(built) != 7:
        return []
    edits = []
    moved = any(abs(a - b) > MOVED for a, b in zip(box.centre, built[:3], strict=True))
    scaled = any(abs(a - b) > MOVED for a, b in zip(box.size, built[3:6], strict=True))
    centre, size = _rounded(box.centre), _rounded(tuple(max(v, 1e-4) for v in box.size))
    if scaled:
        edits.append(LayoutEdit(op="resize", id=name, size=size, centre=centre, reason="by hand", origin="artist"))
    elif moved:
        edits.append(LayoutEdit(op="move", id=name, centre=centre, reason="moved by hand", origin="artist"))
    if abs(turn_between(built[6], box.yaw)) > TURNED:
        edits.append(LayoutEdit(op="turn", id=name, yaw=round(box.yaw, 4), reason="turned by hand", origin="artist"))
    return edits


def _parent_edits(
    name: str, obj: Any, names: dict[Any, str], boxes: dict[str, Box | None], room: Any
) -> list[LayoutEdit]:
    """An edit when the artist gave the object another parent, or none. A deleted parent is not the child's edit."""
    built = str(obj.get(FIELD + "parent", "")) or None
    now = names.get(obj.parent)
    box = boxes[name]
    if now == built or (obj.parent is None and built not in names.values()) or box is None:
        return []
    if obj.parent is not None and now is None:
        return []  # under something that is not of the room
    placement = guess_placement(box, now, boxes, _height(room))
    return [LayoutEdit(op="reparent", id=name, placement=placement, parent=now, reason="by hand", origin="artist")]


def _read_names(reading: Reading, originals: dict[str, Any], used: set[str]) -> None:
    """Renamed objects; last, because every other edit speaks of the ids before."""
    for name, obj in originals.items():
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
