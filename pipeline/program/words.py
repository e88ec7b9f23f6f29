# SPDX-License-Identifier: GPL-3.0-or-later
"""Typed edits in words, for the artist."""

from __future__ import annotations

from collections.abc import Sequence

from ..artifacts.layout import LayoutEdit
from ..errors import ProgramError
from .lines import name_of, parse_line


def edit_in_words(edit: LayoutEdit) -> str:
    """One short sentence on what an edit did, such as "Moved bed_1 to 0.20, 0.70 m."."""
    if edit.origin == "parent":
        return f"{edit.id} {edit.reason or 'moved along'}."
    if edit.line is not None:
        verb = {"add": "Added"}.get(edit.op, "Changed")
        return "Changed the room's floor or height." if edit.id == "room" else f"{verb} {_kind(edit.line)}{edit.id}."
    if edit.op == "move" and edit.centre is not None:
        return f"Moved {edit.id} to {edit.centre[0]:.2f}, {edit.centre[1]:.2f} m."
    if edit.op == "resize" and edit.size is not None:
        return f"Resized {edit.id} to {' × '.join(f'{v:.2f}' for v in edit.size)} m."
    if edit.op == "turn" and edit.yaw is not None:
        return f"Turned {edit.id} to {edit.yaw:.0f}°." if "turned" in edit.reason else f"{edit.id} {edit.reason}."
    if edit.op == "add":
        return f"{'Copied' if 'copied' in edit.reason else 'Added'} {edit.id}."
    if edit.op == "rename":
        return f"Renamed {edit.id} to {edit.new_id}."
    if edit.op == "recategorise":
        return f"Changed {edit.id} to {edit.category}."
    if edit.op == "reparent":
        return f"{edit.id} now belongs to {edit.parent}." if edit.parent else f"{edit.id} now belongs to nothing."
    return f"{'Removed' if edit.op == 'remove' else 'Changed'} {edit.id}."


def edits_taken_over(edits: Sequence[LayoutEdit]) -> str:
    """ "3 edits taken over", "" for none. What only moved along is not counted."""
    count = sum(edit.origin == "artist" for edit in edits)
    return f"{count} edit{'' if count == 1 else 's'} taken over" if count else ""


def _kind(line: str) -> str:
    try:
        return f"{name_of(parse_line(line))} "
    except ProgramError:
        return ""
