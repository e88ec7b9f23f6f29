# SPDX-License-Identifier: GPL-3.0-or-later
"""What the artist sees: the sidebar's tab "Room" and the preferences."""

from __future__ import annotations


def _classes() -> tuple[type, ...]:
    from . import preferences, sidebar

    return (*preferences.classes(), *sidebar.CLASSES)


def register() -> None:
    """Register the panels and the preferences."""
    import bpy

    for cls in _classes():
        bpy.utils.register_class(cls)


def unregister() -> None:
    """Undo `register`, in the reverse order."""
    import bpy

    for cls in reversed(_classes()):
        bpy.utils.unregister_class(cls)
