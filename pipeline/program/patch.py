# SPDX-License-Identifier: GPL-3.0-or-later
"""Typed edits of a room text: only the affected statements change, every other byte stays as it was."""

from __future__ import annotations

import ast
import re
from dataclasses import dataclass

from ..artifacts.analysis import Finding
from ..artifacts.layout import Layout, LayoutEdit, ProxyLine, RoomLine
from ..errors import ProgramError
from .edits import LISTS, Edited, apply_edits, edit_layout
from .finishes import finish_argument, finished
from .limits import FINISHED_ROOM_LIMITS
from .lines import Statement, called_name, layout_of, layout_statements, name_of, parse_layout, print_line, quoted
from .parse_safe import parse

__all__ = ["apply_edits", "patch_text"]

_SHELL = ("wall", "door", "window", "opening")
_LINE = re.compile(r"[^\r\n]*(?:\r\n|\r|\n|$)")


@dataclass(frozen=True)
class _Change:
    """Replace the characters from start to end by text."""

    start: int
    end: int
    text: str


def patch_text(text: str, edits: list[LayoutEdit]) -> tuple[str, list[Finding]]:
    """The room text after the edits (as `apply_edits` does them), and what could not be done.

    A changed line is printed anew in canonical form, a removed one goes with the comment on its line, a new one comes
    after the line it follows in the layout. `furnish` statements follow a rename or go with a removed object. Comments,
    functions and spacing elsewhere are not touched.

    Raises:
        ProgramError: the text cannot be parsed (see `parse_layout`).
    """
    mark = "\ufeff" if text.startswith("\ufeff") else ""
    text = text.removeprefix(mark)
    tree = parse(text, FINISHED_ROOM_LIMITS)
    statements = layout_statements(tree, text)
    edited = edit_layout(layout_of(statements), edits)
    source = _Source(text, tree)
    changes = _proxy_changes(source, statements, edited) + _line_changes(source, statements, edited)
    changes += _furnish_changes(source, tree, edited)
    for change in sorted(changes, key=lambda c: (c.start, c.end), reverse=True):
        text = text[: change.start] + change.text + text[change.end :]
    if _sorted(parse_layout(text)) != _sorted(edited.layout()):
        raise ProgramError("the edits cannot be written into this text", 0, "Put each layout line on its own line.")
    return mark + text, edited.findings


def _sorted(layout: Layout) -> Layout:
    """The layout with all lines but proxies in the order of their ids: a text may have them in any."""
    groups = {name: sorted(getattr(layout, name), key=lambda line: str(line.id)) for name in LISTS}
    return layout.model_copy(update=groups)


class _Source:
    """Where the nodes of a syntax tree are in the text, in characters."""

    def __init__(self, text: str, tree: ast.Module) -> None:
        self.text = text
        self.body = tree.body
        self.lines = _LINE.findall(text)
        self.starts = [0]
        for line in self.lines:
            self.starts.append(self.starts[-1] + len(line))
        self.newline = "\r\n" if "\r\n" in text else "\n"

    def offset(self, line: int, column: int) -> int:
        """Character position of a 1-based line and a column in UTF-8 bytes."""
        return self.starts[line - 1] + len(self.lines[line - 1].encode()[:column].decode())

    def span(self, node: ast.stmt | ast.expr) -> tuple[int, int]:
        """First character of a node and the one after its last."""
        end_line, end_column = node.end_lineno or node.lineno, node.end_col_offset or 0
        return self.offset(node.lineno, node.col_offset), self.offset(end_line, end_column)

    def whole_lines(self, node: ast.stmt) -> tuple[int, int] | None:
        """From the start of a statement's first line to the end of its last, None if another statement is there."""
        start, end = self.span(node)
        first, last = self.starts[node.lineno - 1], self.starts[node.end_lineno or node.lineno]
        rest = self.text[end:last].strip()
        return None if self.text[first:start].strip() or (rest and not rest.startswith("#")) else (first, last)

    def replaced(self, node: ast.stmt | ast.expr, text: str) -> _Change:
        """A node with another text."""
        start, end = self.span(node)
        return _Change(start, end, text.replace("\n", self.newline))

    def removed(self, node: ast.stmt) -> _Change:
        """A statement taken out with its line; `pass` stays where another statement shares the line."""
        span = self.whole_lines(node)
        return _Change(*span, "") if span else self.replaced(node, "pass")

    def inserted_after(self, node: ast.stmt, text: str) -> _Change:
        """A new line below a statement."""
        last = node.end_lineno or node.lineno
        for other in self.body:
            if other.lineno <= last < (other.end_lineno or other.lineno):
                last = other.end_lineno or other.lineno
        at = self.starts[last]
        ended = self.text[:at].endswith(("\n", "\r"))
        new = (text + "\n" if ended else "\n" + text).replace("\n", self.newline)
        return _Change(at, at, new)

    def inserted_before(self, node: ast.stmt, text: str) -> _Change:
        """A new line above a statement."""
        first = node.lineno
        for other in reversed(self.body):
            if other.lineno < first <= (other.end_lineno or other.lineno):
                first = other.lineno
        at = self.starts[first - 1]
        return _Change(at, at, (text + "\n").replace("\n", self.newline))


def _proxy_changes(source: _Source, statements: list[Statement], edited: Edited) -> list[_Change]:
    old = {s.line.id: s for s in statements if isinstance(s.line, ProxyLine)}
    changes = [source.removed(old[gone].node) for gone in edited.before - set(edited.origins.values())]
    new_lines: dict[str | None, list[str]] = {}
    before: str | None = None
    for proxy in edited.proxies:
        origin = edited.origins[proxy.id]
        if origin is None:
            new_lines.setdefault(before, []).append(print_line(proxy))
            continue
        before = origin
        if old[origin].line != proxy:
            changes.append(source.replaced(old[origin].node, print_line(proxy)))
    for after, lines in new_lines.items():
        text = "\n".join(lines)
        if after is not None:
            changes.append(source.inserted_after(old[after].node, text))
        elif old:
            changes.append(source.inserted_before(next(iter(old.values())).node, text))
        else:
            changes.append(source.inserted_after(_last_of_shell(statements), text))
    return changes


def _line_changes(source: _Source, statements: list[Statement], edited: Edited) -> list[_Change]:
    """What happens to the lines that are no proxies; a new one comes after the last of its kind."""
    changes: list[_Change] = []
    new_lines: dict[str, list[str]] = {}
    for statement in statements:
        if isinstance(statement.line, ProxyLine):
            continue
        line = edited.room if isinstance(statement.line, RoomLine) else edited.lines.get(statement.line.id)
        if line is None:
            changes.append(source.removed(statement.node))
        elif line != statement.line:
            changes.append(source.replaced(statement.node, print_line(line)))
    for identifier, line in edited.lines.items():
        if identifier not in edited.lines_before:
            new_lines.setdefault(name_of(line), []).append(print_line(line))
    for kind, lines in new_lines.items():
        same = [s.node for s in statements if s.name == kind]
        after = same[-1] if same else _last_of_shell(statements) if kind in _SHELL else statements[-1].node
        changes.append(source.inserted_after(after, "\n".join(lines)))
    return changes


def _last_of_shell(statements: list[Statement]) -> ast.Expr:
    """The statement that the first object of a room without objects comes after."""
    shell = [s for s in statements if s.name not in ("light", "world", "view", "camera", "proxy")]
    return shell[-1].node


def _furnish_changes(source: _Source, tree: ast.Module, edited: Edited) -> list[_Change]:
    renamed = {old: new for new, old in edited.origins.items() if old is not None and old != new}
    gone = edited.before - set(edited.origins.values())
    changes = _finish_changes(source, tree, renamed, gone | (set(edited.lines_before) - set(edited.lines)))
    for node in tree.body:
        if called_name(node) != "furnish" or not isinstance(node, ast.Expr) or not isinstance(node.value, ast.Call):
            continue
        argument = _furnished(node.value)
        if argument is None or not isinstance(argument.value, str):
            message = f"The furnish statement in line {node.lineno} does not name its object in quotes; it was left."
            edited.findings.append(Finding(about="furnish", message=message, severity="warning"))
        elif argument.value in renamed:
            changes.append(source.replaced(argument, quoted(renamed[argument.value])))
        elif argument.value in gone:
            changes.append(source.removed(node))
            message = "Its furnish statement was removed with it; its function, if it has one, was kept."
            edited.findings.append(Finding(about=argument.value, message=message))
    return changes


def _finish_changes(source: _Source, tree: ast.Module, renamed: dict[str, str], gone: set[str]) -> list[_Change]:
    """Finishes follow a rename, and go with what they are for."""
    changes = []
    for node in tree.body:
        name, argument = finished(node), finish_argument(node)
        if name in renamed and argument is not None:
            changes.append(source.replaced(argument, quoted(renamed[name])))
        elif name in gone:
            changes.append(source.removed(node))
    return changes


def _furnished(call: ast.Call) -> ast.Constant | None:
    """The literal that says which proxy is furnished."""
    arguments = call.args[:1] + [keyword.value for keyword in call.keywords if keyword.arg == "id"]
    return arguments[0] if arguments and isinstance(arguments[0], ast.Constant) else None
