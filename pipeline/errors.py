# SPDX-License-Identifier: GPL-3.0-or-later
"""Errors an artist may see. Each carries one plain sentence and, where there is one, the next step."""

from __future__ import annotations


class RoomError(Exception):
    """Something went wrong that the artist can understand and mend.

    Args:
        message: one plain sentence that says what is wrong.
        fix: one plain sentence that says what to do next, or "".
    """

    def __init__(self, message: str, fix: str = "") -> None:
        super().__init__(message)
        self.message = message
        self.fix = fix

    def __str__(self) -> str:
        return f"{self.message} {self.fix}".strip()


class PictureError(RoomError):
    """The reference image cannot be used."""


class OutputError(RoomError):
    """A result cannot be written where it was asked for."""


class ModelError(RoomError):
    """The model service failed, refused or cannot be reached."""


class ReplyError(ModelError):
    """The model answered, and the answer cannot be used.

    Args:
        problems: the validation errors in words that can be quoted back to the model.
    """

    def __init__(self, message: str, fix: str = "", problems: tuple[str, ...] = ()) -> None:
        super().__init__(message, fix)
        self.problems = problems


class NotRecordedError(ModelError):
    """Recorded answers are played back, and none is recorded for this question."""


class CutReplyError(ReplyError):
    """The answer ends in the middle: the model hit its length limit, or the text was cut on its way."""


class ProgramError(RoomError):
    """A room program is outside the room language or over a limit.

    Args:
        message: the reason, without the line.
        line: 1-based line in the text that was given, 0 when no line applies.
    """

    def __init__(self, message: str, line: int = 0, fix: str = "") -> None:
        super().__init__(message, fix)
        self.line = line

    def __str__(self) -> str:
        place = f"line {self.line}: " if self.line else ""
        return f"{place}{self.message} {self.fix}".strip()


class MemoryFormatError(RoomError):
    """The memory text is not what this version can read."""


class SceneError(RoomError):
    """Blender's data cannot be read or changed as needed."""


class Cancelled(RoomError):
    """The artist stopped the run."""

    def __init__(self) -> None:
        super().__init__("Stopped.", "What was already answered is kept; run again to go on.")
