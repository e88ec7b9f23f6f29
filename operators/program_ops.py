# SPDX-License-Identifier: GPL-3.0-or-later
"""The program as text: what the artist edited in it is applied, and a mistake is shown at its line."""

from __future__ import annotations

from typing import Any

import bpy

from ..pipeline.artifacts.hand import HandEdits
from ..pipeline.errors import ProgramError, RoomError
from ..pipeline.program.words import edits_taken_over
from ..pipeline.scene.tags import find_room_collection
from ..pipeline.scene.texts import PROGRAM, is_hand_edited
from . import driver, fitted_view, own_room, room_memory, rooms, view_state
from .base import RoomOperator, allow, busy_blocker, manager
from .scene_backend import ResolvedScene

_LINES_ABOVE = 8
"""Lines that are shown above the one with the mistake."""


class CODE_AS_ROOM_OT_apply_program(RoomOperator):
    """Build the room from the program as you edited it. Your edits are kept, and locked like edits by hand"""

    bl_idname = "code_as_room.apply_program"
    bl_label = "Apply Edited Program"
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """The text must have been edited, and nothing else be going on."""
        busy = busy_blocker(context)
        if busy:
            return allow(cls, busy)
        room = find_room_collection(context.scene)
        if room is None or rooms.room_text(context.scene, "PROGRAM") is None:
            return allow(cls, "There is no program yet; run the stages up to the layout first")
        return allow(cls, "" if is_hand_edited(room, PROGRAM) else "The program was not edited since it was built")

    def perform(self, context: bpy.types.Context) -> None:
        """Take the text over; the room stays as it is when the text has a mistake."""
        scene = context.scene
        own_room.prepare(scene)
        run = room_memory.run_of(scene)
        known = len(run.memory.entries)
        try:
            edits = run.take_over_edits()
        except ProgramError as error:
            show_line(context, rooms.room_text(scene, "PROGRAM"), error.line)
            place = f"Line {error.line} of {PROGRAM}: " if error.line else f"{PROGRAM}: "
            fix = error.fix or "Mend it, then apply again; the room was left as it is."
            raise RoomError(f"{place}{error.message.rstrip('.')}.", fix) from error
        if isinstance(run.backend, ResolvedScene):
            run.backend.flush()
        fitted_view.follow(scene)
        view_state.refresh(scene)
        text = edits_taken_over(edits) or "Program applied"
        notices: list[str] = []
        for entry in run.memory.entries[known:]:
            if entry.type == HandEdits.__name__:
                notices += [f"{f.about}: {f.message}" for f in HandEdits.model_validate(entry.output).findings]
        notices += run.backend.notices if isinstance(run.backend, ResolvedScene) else []
        driver.note_outcome(scene, text, notices=tuple(notices))
        self.report({"WARNING" if notices else "INFO"}, "\n".join([text, *notices]))


def show_line(context: Any, text: Any, line: int) -> None:
    """Put the cursor of a text on a line, and scroll the text editors that show it there.

    Args:
        line: 1-based; 0 leaves the cursor where it is.
    """
    if text is None or not line:
        return
    line = min(line, len(text.lines))
    text.select_set(line - 1, 0, line - 1, len(text.lines[line - 1].body))
    for window in manager(context).windows if manager(context) is not None else ():
        for area in window.screen.areas:
            if area.type == "TEXT_EDITOR" and area.spaces.active.text == text:
                area.spaces.active.top = max(0, line - 1 - _LINES_ABOVE)
                area.tag_redraw()


CLASSES = (CODE_AS_ROOM_OT_apply_program,)
