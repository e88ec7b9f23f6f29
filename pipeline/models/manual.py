# SPDX-License-Identifier: GPL-3.0-or-later
"""Any chat, by hand: a question waits until the artist has pasted a chat's answer to it. Nothing is sent from here.

The client is asked from worker threads, several at once. Each lays its question on the desk and waits there; the
artist's side takes the questions one after the other. What is pasted is an answer like any other: it is read, validated
and, where it does not fit, asked for once more.
"""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

from ..errors import Cancelled, CutReplyError, NotRecordedError, ReplyError, RoomError
from .base import Prompt, Reply
from .hearing import Hearing
from .manual_pictures import SavedPictures, remove_pictures, save_pictures
from .schema import shape_text
from .tolerant import read_json

NAME = "manual"
_TICK = 0.05
_MOST_CHARACTERS = 2_000_000
_LIKE = 400
"""Characters at a question's beginning by which it is known again."""


@dataclass(frozen=True)
class Question:
    """A question that waits for the artist.

    Attributes:
        number: its own in this session; text: what is to be pasted into the chat.
        saved: where its pictures lie; count: how many they are.
    """

    number: int
    prompt: Prompt
    text: str
    saved: SavedPictures
    count: int
    _ended: threading.Event = field(default_factory=threading.Event, repr=False, compare=False)


class Desk:
    """The questions that wait. Thread-safe.

    Attributes:
        waiting: in the order in which they are to be answered; the first one stays first until it is answered. A new
            tuple whenever something changes, so that drawing can read it.
    """

    def __init__(self) -> None:
        self.waiting: tuple[Question, ...] = ()
        self._lock = threading.Lock()
        self._made = 0
        self._answers: dict[int, str | None] = {}
        self._last = ""
        self._doubted = ""

    def ask(self, prompt: Prompt, saved: SavedPictures) -> Question:
        """Lay a question on the desk. One that is asked again, since its answer did not fit, comes next."""
        with self._lock:
            self._made += 1
            question = Question(self._made, prompt, question_text(prompt), saved, len(prompt.images))
            place = 1 if prompt.repair and self.waiting else len(self.waiting)
            self.waiting = (*self.waiting[:place], question, *self.waiting[place:])
            return question

    def wait(self, question: Question, cancel: threading.Event) -> str:
        """The answer, once it is there.

        Raises:
            NotRecordedError: the artist skipped the question. Cancelled: `cancel` was set.
        """
        while not question._ended.wait(_TICK):
            if cancel.is_set():
                raise Cancelled
        with self._lock:
            answer = self._answers.pop(question.number, None)
        if answer is None:
            raise NotRecordedError("The question was skipped.", "Run the stage again to answer it.")
        return answer

    def answer(self, number: int, text: str) -> None:
        """Hand in what the chat said.

        What cannot be an answer is refused, and the question goes on waiting. What looks like a slip, such as a broken
        answer, is refused once; the same text again is taken, and what is wrong with it is told to the chat.

        Raises:
            RoomError: says what is wrong with it and what to do.
        """
        question = self._find(number)
        text = text.replace("\x00", "").strip()
        if text != self._doubted or not text:
            self._doubted = ""
            try:
                check_answer(question, text, self._last)
            except ReplyError as error:
                self._doubted = text
                raise RoomError(f"{error.message} {error.fix}", "Paste it once more to use it as it is.") from None
        self._end(question, text)
        self._last, self._doubted = text, ""

    def skip(self, number: int) -> None:
        """Go without an answer. Raises RoomError when the question does not wait any more."""
        self._end(self._find(number), None)

    def withdraw(self, question: Question) -> None:
        """The question does not wait any more, whether it was answered or not."""
        with self._lock:
            self.waiting = tuple(other for other in self.waiting if other.number != question.number)
            self._answers.pop(question.number, None)

    def _find(self, number: int) -> Question:
        found = next((question for question in self.waiting if question.number == number), None)
        if found is None:
            raise RoomError("This question does not wait for an answer any more.")
        return found

    def _end(self, question: Question, answer: str | None) -> None:
        with self._lock:
            self._answers[question.number] = answer
            self.waiting = tuple(other for other in self.waiting if other.number != question.number)
        question._ended.set()


class ManualClient:
    """Asks the artist, who asks any chat.

    Args:
        desk: where questions wait; folder: where their pictures are saved while they do.
    """

    name = NAME
    describes = "Any chat, by hand: you copy each prompt into a chat and paste its answer here"

    def __init__(self, desk: Desk, folder: Path) -> None:
        self._desk, self._folder = desk, folder

    def answer(self, prompt: Prompt, cancel: threading.Event, progress: Callable[[str], None] | None = None) -> Reply:
        """Wait for the artist's answer; see `ModelClient.answer`.

        Raises:
            OutputError: the pictures cannot be saved.
            NotRecordedError: the artist skipped the question.
            Cancelled: `cancel` was set.
        """
        if cancel.is_set():
            raise Cancelled
        started = time.monotonic()
        saved = save_pictures(self._folder, prompt.key, prompt.images)
        try:
            question = self._desk.ask(prompt, saved)
            try:
                if progress:
                    progress("waiting for your chat's answer")
                text = self._desk.wait(question, cancel)
            finally:
                self._desk.withdraw(question)
        finally:
            remove_pictures(saved)
        Hearing(prompt).whole(text)
        return Reply(text=text, model="a chat, by hand", seconds=time.monotonic() - started)


def question_text(prompt: Prompt) -> str:
    """What is pasted into the chat: which pictures belong to it, the prompt, and the answer's shape."""
    count = len(prompt.images)
    if not count:
        head = ""
    elif count == 1:
        head = "Picture 1 is attached.\n\n"
    else:
        head = (
            f"Pictures 1 to {count} are attached, in this order. Where only one is attached, it shows all of them, each "
            "under its number; coordinates in a picture then still mean that picture alone.\n\n"
        )
    if prompt.plain:
        return f"{head}{prompt.text}"
    shape = shape_text(prompt.schema)
    tail = f"Answer with one JSON object that fits this JSON schema, in full, and write nothing else:\n{shape}"
    return f"{head}{prompt.text}\n\n{tail}"


def check_answer(question: Question, text: str, last: str = "") -> None:
    """Whether a text can be an answer to a question.

    Args:
        last: the text that was handed in before, for another question.

    Raises:
        RoomError: it is none. ReplyError: it looks like a slip.
    """
    if not text:
        raise RoomError("The clipboard holds no text.", "Copy the chat's whole answer, then paste it here.")
    if len(text) > _MOST_CHARACTERS:
        raise RoomError("The text is too long for an answer.", "Copy the chat's answer only.")
    if text[:_LIKE] in (question.text[:_LIKE], question.prompt.text[:_LIKE]):
        raise RoomError("This is the prompt itself.", "Paste it into the chat; then copy the chat's answer.")
    if last and text == last:
        raise ReplyError("This is the answer to the question before.", "Copy the answer to this one.")
    if question.prompt.plain:
        return
    try:
        read_json(text)
    except CutReplyError:
        raise ReplyError(
            "The answer ends in the middle.", "Let the chat go on, and copy both parts as one text."
        ) from None
    except ReplyError:
        raise ReplyError("There is no readable JSON in this text.", "Copy the chat's whole answer.") from None
