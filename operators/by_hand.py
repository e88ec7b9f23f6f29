# SPDX-License-Identifier: GPL-3.0-or-later
"""Any chat, by hand: the question that waits is copied, its pictures are opened, and the chat's answer is pasted."""

from __future__ import annotations

import contextlib
from typing import Any

import bpy

from ..pipeline.errors import RoomError
from ..pipeline.models.manual import Question
from . import driver
from .base import allow, manager
from .desk import DESK

_copied: int = 0
_problem: tuple[int, str] = (0, "")


# What the panel draws ---------------------------------------------------------------------------------------------


def waiting() -> tuple[Question, ...]:
    """The questions that wait for the artist, the one to be answered first."""
    return DESK.waiting


def is_copied(question: Question) -> bool:
    """Whether this question was copied last."""
    return question.number == _copied


def problem_of(question: Question) -> str:
    """Why the last text could not be taken for its answer, "" when it was not so."""
    number, sentence = _problem
    return sentence if number == question.number else ""


def forget() -> None:
    """The add-on is disabled."""
    global _copied, _problem
    _copied, _problem = 0, (0, "")


# What the buttons do ----------------------------------------------------------------------------------------------


class _QuestionOperator(bpy.types.Operator):
    """Base of the operators on the question that waits."""

    bl_options = {"REGISTER", "INTERNAL"}

    number: bpy.props.IntProperty(  # type: ignore[valid-type]
        name="Question", description="Which question; 0 for the one that waits first", options={"HIDDEN", "SKIP_SAVE"}
    )

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """A question must wait."""
        return allow(cls, "" if DESK.waiting else "No question waits for an answer")

    def question(self) -> Question:
        """The question that is meant.

        Raises:
            RoomError: it does not wait any more.
        """
        found = next((q for q in DESK.waiting if self.number in (0, q.number)), None)
        if found is None:
            raise RoomError("This question does not wait for an answer any more.")
        return found

    def perform(self, context: bpy.types.Context) -> None:
        """Do it; raises RoomError."""
        raise NotImplementedError

    def execute(self, context: bpy.types.Context) -> set[Any]:
        """Called by Blender. A refusal is shown at the question, not as the run's outcome."""
        global _problem
        number = self.number or (DESK.waiting[0].number if DESK.waiting else 0)
        try:
            self.perform(context)
        except RoomError as error:
            _problem = number, str(error)
            self.report({"WARNING"}, str(error))
            driver.redraw()
            return {"CANCELLED"}
        _problem = 0, ""
        driver.redraw()
        return {"FINISHED"}


class CODE_AS_ROOM_OT_copy_prompt(_QuestionOperator):
    """Copy the prompt, to be pasted into any chat that sees pictures"""

    bl_idname = "code_as_room.copy_prompt"
    bl_label = "Copy Prompt"

    def perform(self, context: bpy.types.Context) -> None:
        """Put it into the clipboard."""
        global _copied
        question = self.question()
        manager(context).clipboard = question.text
        _copied = question.number
        self.report({"INFO"}, "The prompt is in the clipboard: paste it into the chat")


class CODE_AS_ROOM_OT_open_pictures(_QuestionOperator):
    """Open the folder with the prompt's pictures, to be dragged into the chat"""

    bl_idname = "code_as_room.open_pictures"
    bl_label = "Open Pictures"

    def perform(self, context: bpy.types.Context) -> None:
        """Open it with the system's file browser; where there is none, its path is at least in the report."""
        folder = self.question().saved.folder
        if not folder.is_dir():
            raise RoomError("The pictures are not there any more.", "Stop, and run the stage again.")
        self.report({"INFO"}, str(folder))
        with contextlib.suppress(RuntimeError):
            bpy.ops.wm.path_open(filepath=str(folder))


class CODE_AS_ROOM_OT_paste_answer(_QuestionOperator):
    """Take the chat's answer from the clipboard; whatever the chat wrote around it is left aside"""

    bl_idname = "code_as_room.paste_answer"
    bl_label = "Paste Answer"

    def perform(self, context: bpy.types.Context) -> None:
        """Hand the clipboard in."""
        DESK.answer(self.question().number, str(manager(context).clipboard))


class CODE_AS_ROOM_OT_answer_from_text(_QuestionOperator):
    """Take the chat's answer from one of the file's texts, as an answer that is too long for the clipboard"""

    bl_idname = "code_as_room.answer_from_text"
    bl_label = "Answer from a Text"

    text: bpy.props.StringProperty(  # type: ignore[valid-type]
        name="Text", description="The text datablock that holds the chat's answer", options={"SKIP_SAVE"}
    )

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[Any]:
        """Let the artist choose a text."""
        result: set[Any] = manager(context).invoke_props_dialog(self, confirm_text="Take Answer")
        return result

    def draw(self, context: bpy.types.Context) -> None:
        """The text."""
        layout: Any = self.layout
        layout.prop_search(self, "text", bpy.data, "texts", icon="TEXT")

    def perform(self, context: bpy.types.Context) -> None:
        """Hand the text in."""
        found = bpy.data.texts.get(self.text)
        if found is None:
            raise RoomError("There is no such text.", "Choose the one that holds the chat's answer.")
        DESK.answer(self.question().number, found.as_string())


class CODE_AS_ROOM_OT_skip_question(_QuestionOperator):
    """Go without this answer: what can be done without it is done, such as a library piece; else the stage ends here"""

    bl_idname = "code_as_room.skip_question"
    bl_label = "Skip"

    def perform(self, context: bpy.types.Context) -> None:
        """Skip it."""
        DESK.skip(self.question().number)


CLASSES = (
    CODE_AS_ROOM_OT_copy_prompt,
    CODE_AS_ROOM_OT_open_pictures,
    CODE_AS_ROOM_OT_paste_answer,
    CODE_AS_ROOM_OT_answer_from_text,
    CODE_AS_ROOM_OT_skip_question,
)
