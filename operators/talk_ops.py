# SPDX-License-Identifier: GPL-3.0-or-later
"""The prompts and answers of a room as a text to read. Pictures are in it by their hashes only, and no key ever is."""

from __future__ import annotations

from typing import Any

import bpy

from ..pipeline.ask_talk import TALK, talk_text
from ..pipeline.errors import RoomError
from ..pipeline.models.faults import without_key
from . import clients, reference, room_memory
from .base import RoomOperator
from .result_ops import show_text

NAME = "Code-as-Room Prompts.txt"
"""With an ending, so that the text editor does not colour it as Python."""


class CODE_AS_ROOM_OT_show_prompts(RoomOperator):
    """Show what the model was asked about this room and what it answered, in a text editor; pictures by their hash only"""

    bl_idname = "code_as_room.show_prompts"
    bl_label = "Prompts and Answers"
    bl_options = {"REGISTER"}

    def perform(self, context: bpy.types.Context) -> None:
        """Write the text anew, and show it."""
        scene = context.scene
        exchanges = TALK.of_room(reference.picture_mark(scene))
        answers = [entry for entry in room_memory.memory_of(scene).entries if entry.type == "Answer"]
        if not exchanges and not answers:
            raise RoomError("Nothing was asked about this room yet.", "Run a stage first.")
        text: Any = bpy.data.texts.get(NAME) or bpy.data.texts.new(NAME)
        text.from_string(without_key(talk_text(exchanges, answers), _key()))
        # It is made anew from what is known; the file need not keep it.
        text.use_fake_user = False
        show_text(context, text)


def _key() -> str:
    """The key that must be in no text; services were never sent it in a prompt, but an artist may have typed it into one."""
    try:
        return clients.client_settings().api_key.strip()
    except RoomError:
        return ""


CLASSES = (CODE_AS_ROOM_OT_show_prompts,)
