# SPDX-License-Identifier: GPL-3.0-or-later
"""The room text of a draft, or of as much of it as there is: what the scene shows while it is written."""

from __future__ import annotations

import re

from ..artifacts.layout import CameraLine
from ..errors import ProgramError, RoomError
from ..objects.text import function_name
from ..program.evaluate import evaluate
from ..program.finishes import with_materials
from ..program.limits import FINISHED_ROOM_LIMITS
from ..program.lines import parse_layout
from .layout import room_of
from .parts import Composed, RoomParts
from .reading import Draft

_TRIES = 12


def room_text(draft: Draft, camera: CameraLine | None = None, parts: RoomParts | None = None) -> str:
    """The room as it is by now; "" while there is nothing of which a room could be made. It can always be evaluated.

    Args:
        parts: those of the draft that were made before.
    """
    room = draft.room or room_of(draft)
    if room is None:
        return ""
    parts = parts or RoomParts()
    left_out: set[str] = set()
    for _ in range(_TRIES):
        text = _finished(parts.composed(draft, room, camera, left_out))
        try:
            evaluate(text, FINISHED_ROOM_LIMITS)
            parse_layout(text)
            return text
        except ProgramError as error:
            culprit = _culprit(text, error.line, set(draft.made) | set(draft.pieces), left_out)
            if culprit is None:
                break
            left_out.add(culprit)
    bare = parts.composed(draft, room, camera, {*draft.made, *draft.pieces}, False).text
    try:
        evaluate(bare, FINISHED_ROOM_LIMITS)
    except ProgramError:
        return ""
    return bare


def _finished(composed: Composed) -> str:
    try:
        return with_materials(composed.text, composed.materials)
    except RoomError:
        return composed.text


def _culprit(text: str, line: int, furnished: set[str], gone: set[str]) -> str | None:
    """The object in whose def or statement a line of the text is; else any that is furnished."""
    rows = text.split("\n")[: max(0, line)]
    for row in reversed(rows):
        if match := re.match(r"furnish\(\"([^\"]+)\"", row):
            return match.group(1) if match.group(1) not in gone else None
        if match := re.match(r"def (\w+)", row):
            name = match.group(1)
            found = [
                i for i in sorted(furnished - gone, key=len, reverse=True) if name.startswith(function_name(i, ()))
            ]
            if found:
                return found[0]
            break
    return max(furnished - gone, default=None)
