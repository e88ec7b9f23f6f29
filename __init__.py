# SPDX-License-Identifier: GPL-3.0-or-later
"""Code-as-Room: one picture of a room seen from above becomes an editable Blender room.

This file only registers the add-on. Everything that needs `bpy` is imported inside the functions, so that
the method in `pipeline/` can be imported and tested in plain Python.
"""


def register() -> None:
    """Register every class, property, handler and command of the add-on with Blender."""
    from .operators import starting

    starting.register()


def unregister() -> None:
    """Undo `register`, in the reverse order."""
    from .operators import starting

    starting.unregister()
