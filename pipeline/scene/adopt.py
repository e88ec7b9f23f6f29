# SPDX-License-Identifier: GPL-3.0-or-later
"""Takes what an artist copied, added or renamed into the room: from now on it is found by its new id."""

from __future__ import annotations

from typing import Any

import numpy as np

from .boxes import parts_of
from .readback import Reading
from .tags import COPIED, DIGEST, FIELD, FINGERPRINT, GROUP, HELD, ID, KIND, LINE, NAME, PART, WAS


def adopt(reading: Reading) -> None:
    """Write the new ids on the objects. Reading again gives the same edits until the program was built with them.

    What the artist edited is held: its mesh and its place are left as they are by every build that agrees with them.
    The mesh of a copy stays as it is when the program could only replace it by a box.
    """
    for obj, identifier in reading.adopted:
        _adopt(obj, identifier)
    for obj, before, after in reading.renamed:
        if WAS not in obj:
            obj[WAS], obj[ID], obj[NAME] = before, after, obj.name
        obj[HELD] = True
    for obj in reading.held:
        # A lamp's line holds its size; a scale on top of that would count twice.
        if obj.type != "LIGHT" or np.abs(np.array(obj.scale) - 1.0).max() < 1e-4:
            obj[HELD] = True
    for obj in reading.put_back:
        obj[LINE] = ""


def _adopt(obj: Any, identifier: str) -> None:
    """Give an object of the artist's its id."""
    kind = str(obj.get(KIND, "")) or ("light" if obj.type == "LIGHT" else "proxy")
    if kind != "proxy" and ID in obj and obj.get(ID) != identifier and PART not in obj:
        obj[COPIED] = obj[ID]
    is_new = ID not in obj
    obj[ID], obj[KIND], obj[NAME] = identifier, kind, obj.name
    if LINE in obj:
        del obj[LINE]
    if kind == "light":
        obj[HELD] = True
    if kind != "proxy":
        return
    obj[HELD] = True
    if is_new and (obj.type != "MESH" or parts_of(obj)):
        obj[GROUP] = True
    if obj.get(FIELD + "furnished", False):
        if DIGEST in obj.data:
            if obj.data.users > 1:
                obj.data = obj.data.copy()
            for tag in (DIGEST, FINGERPRINT):
                del obj.data[tag]
        obj[FIELD + "furnished"] = False
