# SPDX-License-Identifier: GPL-3.0-or-later
"""Enabling in two steps, so that neither Blender's start nor the tick of a check box waits for our imports.

The first step returns at once: a thread imports what the method is made of (no bpy in it), while the tab says that it is
starting. Then a timer registers the rest on the main thread. Without a window everything is done at once.

Where pydantic or Pillow are missing, as in a copy of the source instead of the built extension, the tab says so.
"""

from __future__ import annotations

import compileall
import importlib
import logging
import sys
import textwrap
import threading
from pathlib import Path
from typing import Any

import bpy

log = logging.getLogger(__name__)
PACKAGE = __package__.rpartition(".")[0]
HEAVY = ("pipeline.run", "pipeline.stages", "pipeline.report", "pipeline.models.registry", "pipeline.program.assemble")
INTERVAL = 0.02
NEEDED = ("numpy", "requests", "PIL", "pydantic")


class _Start:
    """Where enabling stands.

    Attributes:
        importer: the thread that imports; complete: everything is registered; missing: packages that are not there;
        failed: registering ended in an error that is in the console.
    """

    def __init__(self) -> None:
        self.importer: threading.Thread | None = None
        self.complete = False
        self.missing: tuple[str, ...] = ()
        self.failed = False


_start = _Start()


def missing_packages() -> tuple[str, ...]:
    """Names of the needed packages that cannot be imported."""
    missing = []
    for name in NEEDED:
        try:
            importlib.import_module(name)
        except ImportError:
            missing.append(name)
    return tuple(missing)


class CODE_AS_ROOM_PT_starting(bpy.types.Panel):
    """Shown until everything is registered, and where something is missing."""

    bl_idname = "CODE_AS_ROOM_PT_starting"
    bl_label = "Code-as-Room"
    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"
    bl_category = "Room"

    def draw(self, context: bpy.types.Context) -> None:
        """Say what goes on."""
        layout: Any = self.layout
        troubled = bool(_start.missing) or _start.failed
        for number, line in enumerate(textwrap.wrap(sentence(), 34)):
            layout.label(text=line, icon="NONE" if number or not troubled else "ERROR")


def sentence() -> str:
    """What the tab says before everything is registered."""
    if _start.failed:
        return "Code-as-Room could not start. The details are in Blender's console; please report them."
    if not _start.missing:
        return "Starting."
    names = " and ".join({"PIL": "Pillow"}.get(name, name) for name in _start.missing)
    return (
        f"Code-as-Room cannot start: {names} cannot be imported. This copy lacks what the installable extension brings. "
        "Install the zip for your system that was built with make extension, and restart Blender."
    )


def in_background() -> bool:
    """Whether Blender runs without a window."""
    return bool(bpy.app.background)


def register() -> None:
    """Enable the add-on."""
    global _start
    _start = _Start()
    bpy.utils.register_class(CODE_AS_ROOM_PT_starting)
    if in_background():
        _complete(missing_packages())
        return
    _start.importer = threading.Thread(target=_import, args=(_start,), name="code-as-room-imports", daemon=True)
    _start.importer.start()
    bpy.app.timers.register(_look, first_interval=INTERVAL, persistent=True)


def unregister() -> None:
    """Disable the add-on, however far it has started."""
    if bpy.app.timers.is_registered(_look):
        bpy.app.timers.unregister(_look)
    if _start.importer is not None:
        _start.importer.join()
    if _start.complete:
        from .. import operators, panels

        panels.unregister()
        operators.unregister()
        _start.complete = False
    else:
        bpy.utils.unregister_class(CODE_AS_ROOM_PT_starting)


def finish() -> None:
    """Wait until everything is registered: for scripts that go on at once."""
    if _start.importer is not None:
        _start.importer.join()
        _look()


def _import(start: _Start) -> None:
    """The thread: packages and modules without bpy, so that the main thread finds them ready."""
    start.missing = missing_packages()
    if start.missing:
        return
    for name in HEAVY:
        try:
            importlib.import_module(f"{PACKAGE}.{name}")
        except Exception:  # the main thread meets the same error, where it is shown
            return
    # What imports bpy is left to the main thread; after an installation it need not compile it as well.
    for folder in ("operators", "panels"):
        compileall.compile_dir(Path(__file__).resolve().parents[1] / folder, quiet=2)


def _look() -> float | None:
    """The timer: register the rest as soon as the imports are there."""
    start = _start
    if start.importer is None:
        return None
    if start.importer.is_alive():
        return INTERVAL
    start.importer = None
    try:
        _complete(start.missing)
    except Exception:
        start.failed = True
        log.exception("Code-as-Room could not be enabled")
    return None


def _complete(missing: tuple[str, ...]) -> None:
    """Register everything else, or leave the sentence that says what is missing."""
    if missing:
        _start.missing = missing
        print(sentence(), file=sys.stderr)
        return
    from .. import operators, panels

    operators.register()
    panels.register()
    bpy.utils.unregister_class(CODE_AS_ROOM_PT_starting)
    _start.complete = True
