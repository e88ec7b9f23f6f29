# SPDX-License-Identifier: GPL-3.0-or-later
"""Layout lines of a room text written anew, one by one; every other byte stays as it was."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from ..artifacts.layout import Line
from .limits import FINISHED_ROOM_LIMITS
from .lines import layout_statements, print_line
from .parse_safe import parse

_SHELL = ("room", "wall", "door", "window", "opening")


def rewrite_lines(text: str, change: Callable[[Line], Line | None], added: Sequence[Line] = ()) -> str:
    """The text with each layout line replaced by what `change` makes of it.

    Args:
        change: called with each layout line in order; None takes the line away, an equal one leaves its text alone.
        added: lines that are written after the last one of the shell.

    Raises:
        ProgramError: the text cannot be parsed before or after, or a line would say something that no room can have.
    """
    mark = "\ufeff" if text.startswith("\ufeff") else ""
    text = text.removeprefix(mark)
    statements = layout_statements(parse(text, FINISHED_ROOM_LIMITS), text)
    # Places in a syntax tree are counted in bytes of a line.
    rows = text.encode().splitlines(keepends=True)
    starts = [0]
    for row in rows:
        starts.append(starts[-1] + len(row))
    data = text.encode()
    newline = "\r\n" if b"\r\n" in data else "\n"
    changes: list[tuple[int, int, str]] = []
    shell_end: int | None = None
    for statement in statements:
        node = statement.node
        begin = starts[node.lineno - 1] + node.col_offset
        end = starts[(node.end_lineno or node.lineno) - 1] + (node.end_col_offset or 0)
        if statement.name in _SHELL:
            shell_end = end
        new = change(statement.line)
        if new is None:
            first, last = starts[node.lineno - 1], starts[node.end_lineno or node.lineno]
            alone = not data[first:begin].strip() and not data[end:last].strip()
            changes.append((first, last, "") if alone else (begin, end, "pass"))
        elif new != statement.line:
            changes.append((begin, end, print_line(new)))
    if added:
        at = len(data) if shell_end is None else shell_end
        changes.append((at, at, "".join("\n" + print_line(line) for line in added)))
    for begin, end, new_text in sorted(changes, key=lambda c: (c[0], c[1]), reverse=True):
        data = data[:begin] + new_text.replace("\n", newline).encode() + data[end:]
    result = data.decode()
    layout_statements(parse(result, FINISHED_ROOM_LIMITS), result)
    return mark + result
