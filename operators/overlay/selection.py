# SPDX-License-Identifier: GPL-3.0-or-later
"""Which object is the active one: the row of the panel's object list."""

from __future__ import annotations

from typing import Any


def active_id(scene: Any) -> str:
    """Id of the active object, "" when there is none. Cheap."""
    settings = scene.code_as_room
    rows, index = settings.objects, settings.active_object
    return str(rows[index].name) if 0 <= index < len(rows) else ""


def activate(scene: Any, identifier: str) -> bool:
    """Make this object's row the active one; False when the list has no such row."""
    index = int(scene.code_as_room.objects.find(identifier))
    if index >= 0:
        scene.code_as_room.active_object = index
    return index >= 0
