# SPDX-License-Identifier: GPL-3.0-or-later
"""A room text as it is handed out in a file: what it builds stays, and it says no more than that takes.

Library pieces do only what this room asks of them, long lines are broken, and docstrings say what a thing is.
"""

from __future__ import annotations

import ast
import functools
import re
from itertools import pairwise

from ..errors import ProgramError
from .lines import WIDTH as LINE_WIDTH
from .lines import layout_statements, parse_line, print_line, rounded_line
from .narrowing import narrowed
from .wrapping import bare_tuples, has_comment, wrapped, written


@functools.lru_cache(maxsize=2)
def finished(text: str) -> str:
    """The room text for `room.py`. Its layout lines are the same, and its functions make the same shapes.

    A text that is not Python stays as it is, and so does every function and line with a comment in it.
    """
    try:
        tree = ast.parse(text)
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        return text
    lines = text.split("\n")
    if "\r" in text or "\f" in text or _share_lines(tree):
        return text
    said = [has_comment(line) for line in lines]
    functions = [n for n in tree.body if isinstance(n, ast.FunctionDef)]
    if len({n.name for n in functions}) < len(functions):
        return text  # a name given twice
    new: dict[tuple[int, int], str | None] = {
        (start, end): printed for start, end, printed in _brief_lines(tree) if not any(said[start:end])
    }
    for span in (_span(n) for n in tree.body if not isinstance(n, ast.FunctionDef)):
        if span not in new and max(map(len, lines[slice(*span)])) > LINE_WIDTH:
            new[span] = wrapped("\n".join(lines[slice(*span)]))
    spans = [(n.name, _span(n)) for n in functions]
    changed = narrowed(tree, [name for name, span in spans if any(said[slice(*span)])])
    kept = {n.name: n for n in tree.body if isinstance(n, ast.FunctionDef)}
    for name, (start, end) in spans:
        if name in kept:
            source = "\n".join(lines[start:end])
            if name in changed:
                source = _briefly(bare_tuples(written(kept[name])))
            new[start, end] = wrapped(_titled(source))
            continue
        while end < len(lines) and not lines[end].strip():
            end += 1
        new[start, end] = None
    for (start, end), result in sorted(new.items(), reverse=True):
        lines[start:end] = [] if result is None else result.split("\n")
    return "\n".join(lines)


def _span(node: ast.stmt) -> tuple[int, int]:
    """The first line of a statement and the line after its last, from 0."""
    return node.lineno - 1, node.end_lineno or node.lineno


def _share_lines(tree: ast.Module) -> bool:
    """Whether two statements stand in one line."""
    return any(b.lineno <= (a.end_lineno or a.lineno) for a, b in pairwise(tree.body))


def _brief_lines(tree: ast.Module) -> list[tuple[int, int, str]]:
    """(first line, line after the last, text) of the layout lines, without what is the default of the language."""
    try:
        return [
            (*_span(s.node), printed)
            for s in layout_statements(tree)
            if parse_line(printed := print_line(s.line, brief=True)) == rounded_line(s.line) == s.line
        ]
    except ProgramError:
        return []


def _briefly(source: str) -> str:
    """A function that does less than it did: what its docstring begins with, as the rest may be of what is gone."""
    return re.sub(r'(\n    """[^"\n]*)\n\n(?:[^"]|"(?!""))*"""', r'\1"""', source, count=1)


def _titled(source: str) -> str:
    """A library piece's docstring without what the library's catalogue reads off it."""
    return re.sub(r'("""[^"\n]*)\n\n\s*words: (?:[^"]|"(?!""))*"""', r'\1"""', source, count=1)
