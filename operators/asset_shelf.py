# SPDX-License-Identifier: GPL-3.0-or-later
"""The asset libraries that are set up in Blender's preferences, as a `Shelf` that any thread may look through."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import bpy

from ..pipeline.retrieval.index import Library, Shelf
from . import clients

FILE = "asset-libraries.json"
_OWN = "User Library"
"""Blender sets this one up for everybody, and most have no such folder."""
_shelf: Shelf | None = None


def shelf() -> Shelf | None:
    """The artist's libraries, None when there are none; the same object for as long as they are. Main thread, cheap."""
    global _shelf
    found = _libraries()
    if not found:
        return None
    if _shelf is None or _shelf.libraries != found:
        folder = clients.user_folder()
        version = (bpy.app.version[0], bpy.app.version[1])
        _shelf = Shelf(found, version, folder / FILE if folder is not None else None)
    return _shelf


def _libraries() -> tuple[Library, ...]:
    preferences: Any = bpy.context.preferences
    found = []
    for library in preferences.filepaths.asset_libraries:
        if not getattr(library, "enabled", True):  # from 5.1
            continue
        # From 5.2 a library may be a place in the web, whose files Blender fetches one by one.
        if getattr(library, "use_remote_url", False):
            found.append(Library(library.name, Path(), "is online; only folders of this computer are searched"))
            continue
        text = bpy.path.abspath(library.path) if library.path else ""
        folder = Path(text)
        if not text or (library.name == _OWN and not folder.is_dir()):
            continue
        found.append(Library(library.name, folder))
    return tuple(found)
