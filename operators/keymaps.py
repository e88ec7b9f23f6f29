# SPDX-License-Identifier: GPL-3.0-or-later
"""ESC stops a run. The operator's poll is "a run is going on", so that at all other times the key goes to whoever else
wants it."""

from __future__ import annotations

from typing import Any

import bpy

_items: list[tuple[Any, Any]] = []


def register() -> None:
    """Add the key; there are no keys in background mode."""
    manager: Any = bpy.context.window_manager
    configuration = manager.keyconfigs.addon if manager is not None else None
    if configuration is None:
        return
    keymap = configuration.keymaps.new(name="3D View", space_type="VIEW_3D")
    _items.append((keymap, keymap.keymap_items.new("code_as_room.stop", "ESC", "PRESS")))


def unregister() -> None:
    """Take the key away again."""
    for keymap, item in _items:
        keymap.keymap_items.remove(item)
    _items.clear()
