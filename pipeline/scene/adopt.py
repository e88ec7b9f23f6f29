# SPDX-License-Identifier: GPL-3.0-or-later
"""Takes what an artist copied, added or renamed into the room: from now on it is found by its new id."""

from __future__ import annotations

from .readback import Reading
from .tags import DIGEST, FIELD, FINGERPRINT, ID, KIND, LINE, NAME, WAS


def adopt(reading: Reading) -> None:
    """Write the new ids on the objects. Reading again gives the same edits until the program was built with them.

    The mesh of a copy stays as it is when the program could only replace it by a box.
    """
    for obj, identifier in reading.adopted:
        plain = not obj.get(FIELD + "furnished", False)
        obj[ID], obj[KIND], obj[NAME] = identifier, "proxy", obj.name
        if LINE in obj:
            del obj[LINE]
        if not plain and DIGEST in obj.data:
            if obj.data.users > 1:
                obj.data = obj.data.copy()
            for tag in (DIGEST, FINGERPRINT):
                del obj.data[tag]
        if obj.get(FIELD + "furnished", False):
            obj[FIELD + "furnished"] = False
    for obj, before, after in reading.renamed:
        if WAS not in obj:
            obj[WAS], obj[ID], obj[NAME] = before, after, obj.name
