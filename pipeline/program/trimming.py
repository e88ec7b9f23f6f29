# SPDX-License-Identifier: GPL-3.0-or-later
"""Joined text without what only its authors need: type annotations, docstrings of private names, one line for each item.

Whoever looks a name up that a room is written with still finds all that is said of it.
"""

from __future__ import annotations

import ast
from collections.abc import Collection, Iterator

from .wrapping import WIDTH, wrapped, written

Edit = tuple[int, int, str]
"""From a byte to another, and what stands there instead."""


def trimmed(text: str) -> str:
    """A module's text without annotations, and with its statements in as few lines as they take."""
    source = text.encode()
    starts = _line_starts(source)
    edits: list[Edit] = []
    for node in ast.parse(text).body:
        for statement in _simple(node):
            edits += _plain_statement(statement, source, starts)
        for inner in ast.walk(node):
            if isinstance(inner, ast.FunctionDef):
                edits += _plain_signature(inner, source, starts)
    return _edited(source, edits)


def with_short_docs(text: str, public: Collection[str], docs: bool) -> str:
    """A module's text with shorter docstrings.

    Args:
        public: functions and classes whose docstrings count: they stay whole.
        docs: leave others the first paragraph of theirs; without, the public ones have that, and others none.
    """
    source = text.encode()
    starts = _line_starts(source)
    edits: list[Edit] = []
    for node in ast.parse(text).body:
        if not isinstance(node, (ast.FunctionDef, ast.ClassDef)) or (docs and node.name in public):
            continue
        for inner in ast.walk(node):
            if isinstance(inner, (ast.FunctionDef, ast.ClassDef)):
                edits += _short_doc(inner, source, starts, docs or node.name in public)
    return _edited(source, edits)


def without_remarks(text: str) -> str:
    """A module's text without what is said behind its private constants, and docstrings of one sentence."""
    source = text.encode()
    starts = _line_starts(source)
    edits: list[Edit] = []
    for node in ast.parse(text).body:
        start, end = _span(node, starts)
        if isinstance(node, ast.Assign) and all(isinstance(t, ast.Name) and t.id[0] == "_" for t in node.targets):
            if b"\n" not in source[start:end]:
                edits.append((end, source.index(b"\n", end), ""))
        elif isinstance(node, ast.FunctionDef) and ast.get_docstring(node):
            start, end = _span(node.body[0], starts)
            if (more := source.find(b". ", start, end)) >= 0:
                edits.append((more + 1, end, '"""'))
    return _edited(source, edits)


def _line_starts(source: bytes) -> list[int]:
    starts = [0]
    for line in source.split(b"\n"):
        starts.append(starts[-1] + len(line) + 1)
    return starts


def _edited(source: bytes, edits: list[Edit]) -> str:
    for start, end, new in sorted(edits, reverse=True):
        source = source[:start] + new.encode() + source[end:]
    return source.decode()


def _short_doc(node: ast.FunctionDef | ast.ClassDef, source: bytes, starts: list[int], docs: bool) -> Iterator[Edit]:
    first = node.body[0]
    if not (isinstance(first, ast.Expr) and isinstance(first.value, ast.Constant) and len(node.body) > 1):
        return
    start, end = _span(first, starts)
    if not isinstance(first.value.value, str) or source[start : start + 3] != b'"""':
        return
    if not docs:
        gap = end + 1
        while source[gap : gap + 1] == b"\n":
            gap += 1
        yield source.rindex(b"\n", 0, start) + 1, gap, ""
    elif (below := source.find(b"\n\n", start, end)) >= 0:
        yield below, end, '"""'


def _plain_signature(node: ast.FunctionDef, source: bytes, starts: list[int]) -> Iterator[Edit]:
    """The names of the arguments with their defaults, in one line where they fit into it."""
    words = written(ast.Lambda(_bare(node.args), ast.Constant(0))).removeprefix("lambda").removesuffix(": 0").strip()
    start = source.index(b"(", starts[node.lineno - 1] + node.col_offset)
    end = source.rindex(b":", start, _span(node.body[0], starts)[0])
    line = f"({words})"
    column = start - starts[node.lineno - 1]
    if column + len(line) + 1 > WIDTH:
        inner = " " * (node.col_offset + 4)
        line = f"(\n{_wrapped(words, inner)}\n{' ' * node.col_offset})"
    yield start, end, line


def _simple(node: ast.stmt) -> Iterator[ast.stmt]:
    """Assignments and the like inside a statement, but for the fields of a class."""
    blocks = [getattr(node, name, []) for name in ("body", "orelse", "finalbody")]
    blocks += [handler.body for handler in getattr(node, "handlers", [])]
    if isinstance(node, ast.ClassDef):
        blocks = [[child for child in node.body if isinstance(child, ast.FunctionDef)]]
    for child in (child for block in blocks for child in block):
        yield from _simple(child)
    if isinstance(node, (ast.Assign, ast.AnnAssign, ast.AugAssign, ast.Return, ast.Raise, ast.Expr)):
        yield node


def _plain_statement(node: ast.stmt, source: bytes, starts: list[int]) -> Iterator[Edit]:
    """A statement without its annotation, and in as few lines as it takes; one with comments in it stays."""
    start, end = _span(node, starts)
    if isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant):
        return
    old = source[start:end]
    if isinstance(node, ast.AnnAssign) and node.value is not None and (b"\n" not in old or b"# " in old):
        yield _span(node.target, starts)[1], _span(node.value, starts)[0], " = "
    if b"\n" not in old or b"# " in old:
        return
    if isinstance(node, ast.AnnAssign) and node.value is not None:
        node = ast.copy_location(ast.Assign([node.target], node.value), node)
    indent = " " * (start - source.rfind(b"\n", 0, start) - 1)
    line = written(node)
    holder = f"if 1:\n{indent}{line}" if indent else line
    new = wrapped(holder).removeprefix("if 1:\n").removeprefix(indent)
    if max(map(len, new.split("\n"))) <= WIDTH and len(new.encode()) < len(old):
        yield start, end, new


def _bare(arguments: ast.arguments) -> ast.arguments:
    def without(arg: ast.arg | None) -> ast.arg | None:
        return None if arg is None else ast.arg(arg.arg)

    return ast.arguments(
        posonlyargs=[ast.arg(a.arg) for a in arguments.posonlyargs],
        args=[ast.arg(a.arg) for a in arguments.args],
        vararg=without(arguments.vararg),
        kwonlyargs=[ast.arg(a.arg) for a in arguments.kwonlyargs],
        kw_defaults=arguments.kw_defaults,
        kwarg=without(arguments.kwarg),
        defaults=arguments.defaults,
    )


def _wrapped(words: str, indent: str) -> str:
    """Arguments in lines of at most `WIDTH` characters."""
    lines = [indent]
    depth, part, parts = 0, "", []
    for letter in words:
        depth += (letter in "([{") - (letter in ")]}")
        part += letter
        if letter == "," and not depth:
            parts.append(part.strip())
            part = ""
    for word in [*parts, part.strip() + ","]:
        if len(lines[-1]) + len(word) + 1 > WIDTH:
            lines.append(indent)
        lines[-1] += word if lines[-1] == indent else f" {word}"
    return "\n".join(lines)


def _span(node: ast.expr | ast.stmt, starts: list[int]) -> tuple[int, int]:
    """Where a node begins and ends, in bytes."""
    end_line, end = node.end_lineno or node.lineno, node.end_col_offset or node.col_offset
    return starts[node.lineno - 1] + node.col_offset, starts[end_line - 1] + end
