# SPDX-License-Identifier: GPL-3.0-or-later
"""A module's text after statements of its tree were changed or taken out; all others stay as they are written."""

from __future__ import annotations

import ast
import copy
from collections.abc import Sequence

from .wrapping import bare_tuples, wrapped, written

_BLOCKS = (ast.FunctionDef, ast.ClassDef, ast.For, ast.While, ast.With, ast.If)
Block = ast.FunctionDef | ast.ClassDef | ast.For | ast.While | ast.With | ast.If


class Reprinter:
    """Remembers what a tree was when it was parsed, and prints what became of it."""

    def __init__(self, text: str, tree: ast.Module) -> None:
        self._lines = text.split("\n")
        self._before = {id(node): _said(node) for node in ast.walk(tree) if isinstance(node, ast.stmt)}
        blocks = [node for node in ast.walk(tree) if isinstance(node, _BLOCKS)]
        self._counts = {id(node): (len(node.body), len(getattr(node, "orelse", ()))) for node in blocks}
        self._first = {id(node): _span(node.body[0])[0] for node in blocks}
        self._spans = [(node, *_span(node)) for node in tree.body]

    def printed(self, tree: ast.Module) -> str:
        """The text of the tree as it is now; statements at its top level are still there."""
        lines = list(self._lines)
        for node, start, end in reversed(self._spans):
            if not self._is_same(node):
                lines[start:end] = self._statement(node)
        return "\n".join(lines)

    def _is_same(self, node: ast.stmt) -> bool:
        """Whether a statement and all in it is what it was."""
        if self._before.get(id(node)) != _said(node):
            return False
        if not isinstance(node, _BLOCKS):
            return True
        inner = [*node.body, *getattr(node, "orelse", ())]
        return self._counts[id(node)] == (len(node.body), len(inner) - len(node.body)) and all(
            map(self._is_same, inner)
        )

    def _statement(self, node: ast.stmt, keyword: str = "") -> list[str]:
        """The lines of a statement. `keyword`: "elif", which an `if` in an `else` may be written as."""
        if self._is_same(node) and not keyword:
            return self._lines[slice(*_span(node))]
        column = node.col_offset if hasattr(node, "col_offset") else 0
        if not isinstance(node, _BLOCKS):
            return _indented(wrapped(bare_tuples(written(node)), 120 - column), column)
        lines = self._head(node, column)
        if keyword and not lines[0].lstrip().startswith(keyword):
            lines[0] = lines[0].replace("if", keyword, 1)
        lines += self._body(node.body, column + 4)
        rest = getattr(node, "orelse", [])
        if len(rest) == 1 and isinstance(rest[0], ast.If) and isinstance(node, ast.If) and self._was_elif(rest[0]):
            return lines + self._statement(rest[0], "elif")
        return lines + ([" " * column + "else:", *self._body(rest, column + 4)] if rest else [])

    def _was_elif(self, node: ast.If) -> bool:
        return hasattr(node, "lineno") and self._lines[node.lineno - 1].lstrip().startswith("elif ")

    def _head(self, node: Block, column: int) -> list[str]:
        """What stands above a statement's block."""
        start, end = _span(node)[0], self._first.get(id(node), 0)
        if self._before.get(id(node)) == _said(node) and end > start:
            while not self._lines[end - 1].strip() or self._lines[end - 1].lstrip().startswith("#"):
                end -= 1
            return self._lines[start:end]
        return _indented(wrapped(written(_headed(node)), 120 - column), column)[:-1]

    def _body(self, body: Sequence[ast.stmt], column: int) -> list[str]:
        lines: list[str] = []
        for node in body:
            if not hasattr(node, "lineno") or node.col_offset != column:
                lines += _indented(written(node), column)
                continue
            start = above = _span(node)[0]
            while above > 0 and self._lines[above - 1].lstrip().startswith("#"):
                above -= 1
            if lines and not self._lines[above - 1].strip():
                lines.append("")
            lines += self._lines[above:start] + self._statement(node)
        return lines


def _span(node: ast.stmt) -> tuple[int, int]:
    """The first line of a statement, with what decorates it, and the line after its last, from 0."""
    decorators = node.decorator_list if isinstance(node, (ast.FunctionDef, ast.ClassDef)) else []
    return min([node.lineno, *(d.lineno for d in decorators)]) - 1, node.end_lineno or node.lineno


def _headed(node: Block) -> ast.stmt:
    """A statement with nothing in its block."""
    bare = copy.copy(node)
    bare.body = [ast.Pass()]
    if isinstance(bare, (ast.For, ast.While, ast.If)):
        bare.orelse = []
    return bare


def _said(node: ast.stmt) -> str:
    """What a statement says, without the statements in it."""
    return ast.dump(_headed(node) if isinstance(node, _BLOCKS) else node)


def _indented(text: str, column: int) -> list[str]:
    return [" " * column + line if line else line for line in text.split("\n")]
