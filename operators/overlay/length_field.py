# SPDX-License-Identifier: GPL-3.0-or-later
"""The known length as a number in the panel.

The value lives in memory, so the field has a getter and a setter. Dragging a number sets it many times a second and each
change scales the whole room, so it is taken over once the artist pauses. The property belongs to the window manager
because Blender makes undo steps for what belongs to a scene, and the change has an undo step of its own.
"""

from __future__ import annotations

import logging
from typing import Any

import bpy

from ...pipeline.errors import RoomError
from ...pipeline.geometry.measuring import LENGTH_RANGE
from .. import driver, view_state
from . import shown
from .knowing_length import set_metres

log = logging.getLogger(__name__)
NAME = "code_as_room_known_length"
PAUSE = 0.35
_pending: dict[int, float] = {}


def _get(_: Any) -> float:
    scene = bpy.context.scene
    if scene is None:
        return LENGTH_RANGE[0]
    known = shown.peek(scene).known
    return _pending.get(scene.session_uid, known.metres if known is not None else LENGTH_RANGE[0])


def _set(_: Any, value: float) -> None:
    scene = bpy.context.scene
    if scene is None or driver.is_running():
        return
    _pending[scene.session_uid] = value
    if bpy.app.timers.is_registered(_take_over):
        bpy.app.timers.unregister(_take_over)
    if bpy.app.background:
        _take_over()
    else:
        bpy.app.timers.register(_take_over, first_interval=PAUSE)


def _take_over() -> None:
    """The timer: nothing may be raised here."""
    wanted = dict(_pending)
    _pending.clear()
    for scene in bpy.data.scenes:
        metres = wanted.get(scene.session_uid)
        if metres is None or driver.is_running():
            continue
        try:
            set_metres(scene, metres)
        except RoomError as error:
            driver.note_outcome(scene, "", view_state.Problem.of(error))
        except Exception as error:
            log.exception("The known length could not be set")
            driver.note_outcome(scene, "", view_state.Problem.of(error))


def register() -> None:
    """Add the property."""
    manager: Any = bpy.types.WindowManager
    number: Any = bpy.props.FloatProperty
    field = number(
        name="Known Length",
        description="How far the two points that you clicked are apart; the room and every size in it follow",
        subtype="DISTANCE",
        unit="LENGTH",
        min=LENGTH_RANGE[0],
        max=LENGTH_RANGE[1],
        step=5,
        precision=3,
        get=_get,
        set=_set,
        options={"SKIP_SAVE"},
    )
    setattr(manager, NAME, field)


def unregister() -> None:
    """Remove it, and what waits for the artist to pause."""
    _pending.clear()
    if bpy.app.timers.is_registered(_take_over):
        bpy.app.timers.unregister(_take_over)
    delattr(bpy.types.WindowManager, NAME)
