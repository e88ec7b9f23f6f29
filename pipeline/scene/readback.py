# SPDX-License-Identifier: GPL-3.0-or-later
"""What an artist changed by hand since the last build, as typed edits.

Every proxy's object remembers the box it was built with, so the scene is compared with what was built, not with the
program's text: an artist may have edited that too, and both kinds of edits are kept.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np

from ..artifacts.common import Placement
from ..artifacts.layout import LayoutEdit
from .measure import Box, measure, mesh_points, turn_between
from .meshes import is_hand_made
from .naming import free_id, id_from_name, next_id
from .tags import (
    BUILT_IDS,
    DIGEST,
    FIELD,
    FINGERPRINT,
    ID,
    KIND,
    LINE,
    NAME,
    PART,
    WAS,
    tagged_objects,
    world_matrix,
)

MOVED = 1e-4  # metres: smaller differences are float noise
TURNED = 1e-2  # degrees


@dataclass
class Reading:
    """What was read: edits in an order in which they can be applied, and the ids that objects are to be given.

    Attributes:
        adopted: new ids for objects that the artist copied or added.
        renamed: (object, former id, new id).
    """

    edits: list[LayoutEdit] = field(default_factory=list)
    adopted: list[tuple[Any, str]] = field(default_factory=list)
    renamed: list[tuple[Any, str, str]] = field(default_factory=list)


def read_back(room: Any, taken: set[str]) -> Reading:
    """Compare the collection with what was last built in it. Nothing is changed; see `adopt`.

    Args:
        taken: ids of the program, which new objects must not get.
    """
    reading = Reading()
    tagged = tagged_objects(room)
    originals: dict[str, Any] = {}
    new: list[tuple[Any, str]] = []
    used = taken | {key[0] for key in tagged}
    for (identifier, part), objects in tagged.items():
        first = objects[0]
        if part or first.get(KIND, "proxy") != "proxy":
            new += [(obj, identifier) for obj in objects[1:] if obj.type == "MESH" and not part and False]
            continue
        if LINE in first:
            originals[str(first.get(WAS, identifier))] = first
        copies = objects[1:] if LINE in first else objects
        for index, obj in enumerate(copies):
            is_known = LINE not in obj and index == 0 and LINE not in first
            new.append((obj, identifier if is_known else next_id(identifier, used)))
            used.add(new[-1][1])
    for obj in room.all_objects:
        if obj.type == "MESH" and ID not in obj and PART not in obj and len(obj.data.vertices):
            new.append((obj, free_id(id_from_name(obj.name) or "object_1", used)))
            used.add(new[-1][1])
    names = {id(obj): name for name, obj in originals.items()}
    _read_new(reading, room, new)
    for name, obj in originals.items():
        reading.edits += _changes(name, obj, names, tagged)
    built = [str(name) for name in room.get(BUILT_IDS, [])]
    gone = [name for name in built if name not in originals and name in taken]
    reading.edits += [_edit("remove", name, "deleted by hand") for name in gone]
    _read_names(reading, originals, used)
    return reading
