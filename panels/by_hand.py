# SPDX-License-Identifier: GPL-3.0-or-later
"""The question that waits for the artist, who asks any chat: three steps, in the order in which they are done."""

from __future__ import annotations

from typing import Any

import bpy

from ..operators import by_hand, driver
from ..operators.view_state import RoomState
from ..pipeline.models.manual import Question
from ..pipeline.models.manual_pictures import TOGETHER
from .base import RoomPanel
from .sentences import draw_sentence, plural


class CODE_AS_ROOM_PT_by_hand(RoomPanel):
    """What is to be copied into a chat, and pasted from it."""

    bl_idname = "CODE_AS_ROOM_PT_by_hand"
    bl_label = "Ask Your Chat"
    bl_order = 0

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Only while a question of this scene's run waits."""
        progress = driver.progress_of(context.scene)
        return bool(by_hand.waiting()) and progress is not None and not progress.stopping

    def draw_state(self, layout: Any, context: Any, state: RoomState) -> None:
        """The first question that waits."""
        waiting = by_hand.waiting()
        if waiting:
            draw_question(layout, context, waiting[0], len(waiting))


def draw_question(layout: Any, context: Any, question: Question, count: int) -> None:
    """One question: copy the prompt, attach the pictures, paste the answer."""
    title = question.prompt.key.partition("_")[2].replace("_", " ").replace("/", " ").capitalize() or "Question"
    draw_sentence(layout, f"{title} ({count} wait)" if count > 1 else title, context, icon="QUESTION")
    if question.prompt.repair:
        text = "The last answer could not be used. This prompt tells the chat why; send it like the first one."
        draw_sentence(layout, text, context, icon="ERROR", alert=True)
    column = layout.column(align=True)
    _step(column, "code_as_room.copy_prompt", "1. Copy Prompt", "COPYDOWN", question)
    pictures = column.row(align=True)
    pictures.enabled = question.count > 0
    said = f"2. Open {plural(question.count, 'Picture')}" if question.count else "2. No Pictures"
    _step(pictures, "code_as_room.open_pictures", said, "FILE_FOLDER", question)
    paste = column.row(align=True)
    paste.scale_y = 1.3
    _step(paste, "code_as_room.paste_answer", "3. Paste Answer", "PASTEDOWN", question)
    _step(paste, "code_as_room.answer_from_text", "", "TEXT", question)
    problem = by_hand.problem_of(question)
    if problem:
        draw_sentence(layout, problem, context, icon="ERROR", alert=True)
    elif not by_hand.is_copied(question):
        draw_sentence(layout, "Paste the prompt into any chat that sees pictures.", context, icon="INFO")
    else:
        draw_sentence(layout, _what_next(question), context, icon="INFO")
    _step(layout.row(), "code_as_room.skip_question", "Skip This Question", "FORWARD", question)


def _what_next(question: Question) -> str:
    if question.saved.together is not None:
        return f"Attach the {question.count} pictures in their order, or {TOGETHER} alone. Then copy the chat's answer."
    return "Attach the picture. Then copy the chat's answer." if question.count else "Then copy the chat's answer."


def _step(layout: Any, name: str, text: str, icon: str, question: Question) -> None:
    layout.operator(name, text=text, icon=icon).number = question.number


CLASSES = (CODE_AS_ROOM_PT_by_hand,)
