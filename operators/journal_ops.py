# SPDX-License-Identifier: GPL-3.0-or-later
"""Deleting the answers that are kept on this computer."""

from __future__ import annotations

from typing import Any

import bpy

from ..pipeline.errors import OutputError
from . import driver, journals, reference, view_state
from .base import RoomOperator, allow, manager


class CODE_AS_ROOM_OT_forget_answers(RoomOperator):
    """Delete the answers about this picture that are kept on this computer. What is in the .blend file stays"""

    bl_idname = "code_as_room.forget_answers"
    bl_label = "Forget Answers"
    bl_options = {"REGISTER"}

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """There must be a picture, and no run."""
        if driver.is_running():
            return allow(cls, "A run is going on; wait for it, or stop it")
        return allow(cls, "" if reference.picture_mark(context.scene) else "Load a picture of a room first")

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[Any]:
        """Ask first: what was paid for cannot be brought back."""
        result: set[Any] = manager(context).invoke_confirm(self, event)
        return result

    def perform(self, context: bpy.types.Context) -> None:
        """Delete the journal of the scene's picture."""
        journal = journals.journal_of(reference.picture_mark(context.scene))
        count = 0
        if journal is not None:
            count = len(journal.answers())
            try:
                journal.forget()
            except OSError as error:
                raise OutputError(f"The answers cannot be deleted: {error.strerror or error}.") from error
        view_state.refresh(context.scene)
        said = (
            f"{count} answer{'' if count == 1 else 's'} deleted" if count else "No answers were kept on this computer"
        )
        driver.note_outcome(context.scene, said)
        self.report({"INFO"}, said)


CLASSES = (CODE_AS_ROOM_OT_forget_answers,)
