# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender's handlers: what the panel shows is worked out anew whenever Blender changed the file behind our back."""

from __future__ import annotations

from typing import Any

import bpy
from bpy.app.handlers import persistent

from . import asset_search, driver, fitted_view, journals, own_room, room_memory, rooms, state_reading, view_state


@persistent  # type: ignore[untyped-decorator]
def _before_load(*_: Any) -> None:
    """A run belongs to the file that is open."""
    driver.cancel_for_load()
    asset_search.cancel()
    room_memory.forget_all()
    rooms.forget_all()
    view_state.forget_all()
    state_reading.forget_all()
    fitted_view.forget_views()


@persistent  # type: ignore[untyped-decorator]
def _before_save(*_: Any) -> None:
    """What was answered so far is in the file that is saved."""
    driver.keep_answers()


@persistent  # type: ignore[untyped-decorator]
def _after_change(*_: Any) -> None:
    """A file was loaded, or undo or redo changed the scene and its memory together."""
    view_state.refresh_all()


def _first_look() -> None:
    """Run once after the add-on was enabled, when Blender allows access to the open file, and when a scene is new."""
    if not driver.is_running():
        own_room.look_after_copies()
    view_state.refresh_all()
    driver.redraw()


def _lists() -> tuple[tuple[Any, Any], ...]:
    handlers = bpy.app.handlers
    return (
        (handlers.load_pre, _before_load),
        (handlers.save_pre, _before_save),
        (handlers.load_post, _after_change),
        (handlers.undo_post, _after_change),
        (handlers.redo_post, _after_change),
    )


def look_soon() -> None:
    """Have the state worked out as soon as Blender is idle: `draw` asks for it when a scene is new."""
    if not bpy.app.timers.is_registered(_first_look):
        bpy.app.timers.register(_first_look, first_interval=0.0)


def register() -> None:
    """Add the handlers."""
    for handlers, function in _lists():
        handlers.append(function)
    look_soon()


def unregister() -> None:
    """Remove the handlers, and end what is running."""
    driver.cancel_for_load()
    asset_search.cancel()
    for handlers, function in reversed(_lists()):
        if function in handlers:
            handlers.remove(function)
    if bpy.app.timers.is_registered(_first_look):
        bpy.app.timers.unregister(_first_look)
    view_state.forget_all()
    rooms.forget_all()
    journals.forget_all()
