# SPDX-License-Identifier: GPL-3.0-or-later
"""What the artist sees: the sidebar's tab "Room" and the preferences."""

from __future__ import annotations


def panel_classes() -> tuple[type, ...]:
    """The panels of the tab "Room"; parents before their sub-panels."""
    from . import by_hand, calibration, finish, objects, output, reference, rounds, stages, textures, views

    modules = (reference, calibration, objects, stages, rounds, textures, finish, views, output)
    return (stages.CODE_AS_ROOM_PT_running, *by_hand.CLASSES, *(cls for module in modules for cls in module.CLASSES))


def _classes() -> tuple[type, ...]:
    from . import objects, preferences, stages

    return (*preferences.classes(), *objects.PARTS, *stages.PARTS, *panel_classes())


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
