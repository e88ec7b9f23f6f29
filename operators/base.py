# SPDX-License-Identifier: GPL-3.0-or-later
"""What all operators share: errors become one sentence, and polls say why in one sentence."""

from __future__ import annotations

import logging
from typing import Any

import bpy

from ..pipeline.errors import RoomError
from . import driver, view_state

log = logging.getLogger(__name__)


class RoomOperator(bpy.types.Operator):
    """Base of the operators. `perform` does the work; what it raises reaches the artist as a sentence."""

    def execute(self, context: bpy.types.Context) -> set[Any]:
        """Called by Blender; scripts get the sentence as a RuntimeError."""
        try:
            self.perform(context)
        except RoomError as error:
            return self.refuse(context, error)
        except Exception as error:
            log.exception("%s failed unexpectedly", type(self).__name__)
            return self.refuse(context, error)
        return {"FINISHED"}

    def perform(self, context: bpy.types.Context) -> None:
        """Do the work; raises RoomError with a sentence for the artist."""
        raise NotImplementedError

    def refuse(self, context: bpy.types.Context, error: BaseException) -> set[Any]:
        """Show an error in the panel and in Blender's status bar."""
        problem = view_state.Problem.of(error)
        driver.note_outcome(context.scene, "", problem)
        self.report({"ERROR"}, f"{problem.message} {problem.fix}".strip())
        return {"CANCELLED"}


def manager(context: Any) -> Any:
    """Blender's window manager, for pop-ups and file selectors."""
    return context.window_manager


def busy_blocker(context: Any) -> str:
    """Why the room cannot be changed now, "" when it can: a run, or Edit mode. No I/O: polls call it on every redraw."""
    if driver.is_running():
        return "A run is going on; wait for it, or stop it"
    return "" if context.mode == "OBJECT" else "Go back to Object mode first"


def stage_blocker(context: Any) -> str:
    """Why no stage can run now, "" when one can. No I/O: polls call it on every redraw."""
    busy = busy_blocker(context)
    if busy:
        return busy
    state = view_state.peek(context.scene)
    return state.blocker if state is not None else ""


def allow(cls: Any, blocker: str) -> bool:
    """A poll's result: False with the reason as its message. Blender adds the full stop."""
    if blocker:
        cls.poll_message_set(blocker)
    return not blocker
