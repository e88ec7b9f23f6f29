# SPDX-License-Identifier: GPL-3.0-or-later
"""The complete top-level statements of a program that is still being written, among prose and code fences."""

from __future__ import annotations

import re
from dataclasses import dataclass

from ..errors import ReplyError
from ..models.tolerant import read_json

LINES = ("room", "wall", "door", "window", "opening", "proxy", "light", "world", "view", "camera", "furnish", "finish",
         "lighting", "build")  # fmt: skip
"""What the lines of a draft call."""
_FENCE = re.compile(r"^[ \t]*(```+|~~~+)[ \t]*([\w+-]*)[ \t]*$", re.MULTILINE)
_STARTS = re.compile(rf"(?:def\s+\w+\s*\(|(?:{'|'.join(LINES)})\s*\(|[A-Za-z_]\w* = |for\s+\w|if\s+\w|#)")
"""What a line at the left margin begins with that is a new statement even where brackets are still open before it."""
_GOES_ON = re.compile(r"(?:else|elif|except|finally)\b|[)\]}]")
_BLOCK = re.compile(r"(?:def|for|if|while|with|class|try|async)\b|@")
_CODE = re.compile(
    rf"(?:def\s+\w+\s*\(|(?:{'|'.join(LINES)})\s*\(|[A-Za-z_]\w*\s*=[^=]|(?:from|import)\s+\w+|(?:for|if)\b.*:\s*$|@\w|\w+\()"
)
_STYLE = re.compile(r"#\s*style\s*:\s*(.+)", re.IGNORECASE)
_STRINGS = re.compile(
    r'"""(?:\\.|[^\\])*?(?:"""|\Z)|\'\'\'(?:\\.|[^\\])*?(?:\'\'\'|\Z)|"(?:\\.|[^"\\\n])*"?|\'(?:\\.|[^\'\\\n])*\'?|#[^\n]*',
    re.DOTALL,
)
MOST_BYTES = 1_000_000
"""Of an answer; what is longer is cut."""


@dataclass(frozen=True)
class Statement:
    """One statement as it was written.

    Attributes:
        text: its lines, without what surrounds them. first, last: 1-based numbers of its lines in the program.
        cut: whether the answer ended in the middle of it, as far as that can be told.
    """

    text: str
    first: int
    last: int
    cut: bool = False


@dataclass(frozen=True)
class Split:
    """A program taken apart.

    Attributes:
        statements: those that are complete. style: what a comment at its head says of the room's style, "" for nothing.
    """

    statements: tuple[Statement, ...]
    style: str = ""


def split(text: str, whole: bool = True) -> Split:
    """The statements of an answer.

    Args:
        whole: whether the answer has ended. If not, what may still go on is left out.
    """
    program, ended = program_in(text[:MOST_BYTES], whole)
    rows = program.split("\n")
    found: list[Statement] = []
    begun: list[int] = []
    for number, row in enumerate(rows):
        if not row.strip() or row[0] in " \t" or (row[0] == "#" and not begun):
            continue
        if begun and _continues(row, rows, begun[0], number):
            continue
        if row[0] == "#":
            continue
        if begun:
            found.append(_statement(rows, begun[0], number))
        begun = [number]
    if begun:
        last = _statement(rows, begun[0], len(rows), cut=ended is False)
        if whole or ended or _is_complete(last, rows):
            found.append(last)
    if not whole:
        found = [statement for statement in found if not is_prose(statement.text)]
    styles = [m.group(1).strip() for row in rows[:40] if (m := _STYLE.match(row))]
    return Split(tuple(found), styles[0][:160] if styles else "")


def _continues(row: str, rows: list[str], first: int, number: int) -> bool:
    """Whether a line at the left margin belongs to the statement before it."""
    if _GOES_ON.match(row):
        return True
    if _STARTS.match(row):
        # A text over several lines may hold anything but the beginning of a def or a line of the room.
        return False
    return open_brackets("\n".join(rows[first:number])) > 0


def _statement(rows: list[str], first: int, end: int, cut: bool = False) -> Statement:
    while end > first + 1 and (not rows[end - 1].strip() or rows[end - 1].startswith("#")):
        end -= 1
    return Statement("\n".join(rows[first:end]), first + 1, end, cut and open_brackets("\n".join(rows[first:end])) > 0)


def _is_complete(statement: Statement, rows: list[str]) -> bool:
    """Whether the last statement of a text that goes on is complete: a call that is closed, and its line ended."""
    return (
        len(rows) > statement.last
        and not _BLOCK.match(statement.text)
        and open_brackets(statement.text) == 0
        and not statement.text.endswith("\\")
    )


def open_brackets(text: str) -> int:
    """How many brackets are still open, strings and comments apart."""
    bare = _STRINGS.sub("", text)
    return sum(bare.count(c) for c in "([{") - sum(bare.count(c) for c in ")]}")


def program_in(text: str, whole: bool = True) -> tuple[str, bool | None]:
    """The program in an answer, and whether its end was seen (None where nothing tells)."""
    text = text.removeprefix("\ufeff").replace("\r\n", "\n").replace("\r", "\n").replace("\t", "    ")
    text = "\n".join(row if row.isprintable() else _printable(row) for row in text.split("\n"))
    if whole and text.lstrip().startswith("{"):
        text = _in_json(text) or text
    blocks, open_block = _fenced(text)
    coded = [block for block in blocks if _looks_like_code(block)]
    if coded:
        return _left("\n".join(coded)), not open_block
    if _FENCE.search(text) and not whole:
        return "", None
    return _left(text), None


def _printable(row: str) -> str:
    return "".join(c if c.isprintable() else " " for c in row)


def _fenced(text: str) -> tuple[list[str], bool]:
    """What stands between fences, and whether the last one is still open."""
    blocks: list[str] = []
    start: int | None = None
    for match in _FENCE.finditer(text):
        if start is None:
            start = match.end() + 1
        elif match.group(2):
            # Another one begins before this one was closed.
            blocks.append(text[start : match.start()])
            start = match.end() + 1
        else:
            blocks.append(text[start : match.start()])
            start = None
    if start is not None:
        blocks.append(text[start:])
    return blocks, start is not None


def _looks_like_code(text: str) -> bool:
    return any(_CODE.match(row.lstrip()) for row in text.split("\n"))


def _left(text: str) -> str:
    """The text moved to the left margin where all of its code is indented."""
    rows = text.split("\n")
    coded = [row for row in rows if row.strip() and not row.lstrip().startswith("#")]
    starts = [row for row in coded if _STARTS.match(row.lstrip())]
    indent = min((len(row) - len(row.lstrip()) for row in starts), default=0)
    if not indent:
        return text
    return "\n".join(row[indent:] if not row[:indent].strip() else row for row in rows)


def _in_json(text: str) -> str:
    """The longest text in an answer that was given as JSON, "" when it is none."""
    try:
        data = read_json(text)
    except (ReplyError, RecursionError):
        return ""
    texts, waiting = [""], [data]
    while waiting:
        item = waiting.pop()
        if isinstance(item, str):
            texts.append(item)
        elif isinstance(item, dict):
            waiting += list(item.values())
        elif isinstance(item, list):
            waiting += item
    longest = max(texts, key=len)
    return longest if _looks_like_code(longest) else ""


def is_prose(text: str) -> bool:
    """Whether a statement that cannot be read is a sentence rather than code."""
    return _CODE.match(text) is None
