# SPDX-License-Identifier: GPL-3.0-or-later
"""From text to a syntax tree, with Python's own parser and without its ways to crash."""

from __future__ import annotations

import ast
import contextlib
import gc
import re
from collections.abc import Iterator
from functools import lru_cache

from ..errors import ProgramError
from .limits import FINISHED_ROOM_LIMITS, Limits
from .scan import Scanner, normal_text

INNER = (ast.BinOp, ast.UnaryOp, ast.stmt, ast.expr, ast.comprehension, ast.arguments, ast.keyword, ast.excepthandler)
"""Nodes that can hold others."""
TOO_DEEP = "the program is nested too deeply"


def parse(text: str, limits: Limits) -> ast.Module:
    """The syntax tree of a program. Nothing is compiled or run. Nobody may change the tree of a finished room: it is shared.

    Raises ProgramError with the line for text that is not Python, too long, too deeply nested, or that holds
    characters no program needs.
    """
    if limits is FINISHED_ROOM_LIMITS and isinstance(text, str):
        return _parsed_room(text)
    return _parsed(text, limits)


@lru_cache(maxsize=4)
def _parsed_room(text: str) -> ast.Module:
    """A stage reads one and the same text many times: its lines, its functions, its materials, what it evaluates to."""
    return _parsed(text, FINISHED_ROOM_LIMITS)


def _parsed(text: str, limits: Limits) -> ast.Module:
    text = normal_text(text, limits)
    if limits is not FINISHED_ROOM_LIMITS or not _scanned_before(text):
        Scanner(text, limits).run()
    try:
        with uncollected():
            tree = ast.parse(text)
    except SyntaxError as error:
        words = str(error.msg or "this is not Python").replace("f-string: ", "")
        line = error.lineno or 0
        raise ProgramError(f"this is not Python: {words}", min(line, text.count("\n") + 1)) from None
    except (RecursionError, MemoryError):
        raise ProgramError(TOO_DEEP, 0, "Give parts of it a name in statements before.") from None
    except ValueError as error:
        raise ProgramError(f"this is not Python: {error}") from None
    measure_depth(_not_measured(tree, text) if limits is FINISHED_ROOM_LIMITS else tree, limits)
    return tree


class _Seen:
    """Functions of rooms that were looked through: a room is parsed anew after every change, and few of its lines differ."""

    def __init__(self, most: int) -> None:
        self._most = most
        self._texts: set[str] = set()

    def __contains__(self, text: str) -> bool:
        return text in self._texts

    def add(self, text: str) -> None:
        """Remember a text; all are forgotten when there are too many."""
        if len(self._texts) >= self._most:
            self._texts = set()
        self._texts.add(text)


_SCANNED, _MEASURED = _Seen(4096), _Seen(4096)
_DEF = re.compile(r"^(?=def )", re.MULTILINE)


def _scanned_before(text: str) -> bool:
    """Scan a room's text function by function; False where it has to be scanned as a whole.

    A text that is refused is one of these, and so is one in which a bracket or a string goes on past the start of a def.
    """
    for block in _DEF.split(text):
        if block in _SCANNED:
            continue
        scanner = Scanner(block, FINISHED_ROOM_LIMITS)
        try:
            scanner.run()
        except ProgramError:
            return False
        if len(scanner.operators) > 1 or block.endswith("\\\n"):
            return False
        _SCANNED.add(block)
    return True


def _not_measured(tree: ast.Module, text: str) -> ast.Module:
    """The tree without those functions whose depth was measured before."""
    lines = text.split("\n")
    kept: list[ast.stmt] = []
    for node in tree.body:
        if isinstance(node, ast.FunctionDef) and not node.decorator_list:
            source = "\n".join(lines[node.lineno - 1 : node.end_lineno])
            if source in _MEASURED:
                continue
            measure_depth(ast.Module([node], []), FINISHED_ROOM_LIMITS)
            _MEASURED.add(source)
        else:
            kept.append(node)
    return ast.Module(kept, [])


@contextlib.contextmanager
def uncollected() -> Iterator[None]:
    """Without Python's garbage collector, which would look through a large tree many times while it grows."""
    was_on = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if was_on:
            gc.enable()


def measure_depth(tree: ast.Module, limits: Limits) -> None:
    """Raise ProgramError when the tree is deeper than the limit. An elif is not deeper than its if."""
    open_nodes: list[tuple[ast.AST, int, int]] = [(tree, 0, 1)]
    while open_nodes:
        node, depth, line = open_nodes.pop()
        line = getattr(node, "lineno", line)
        if depth > limits.tree_depth:
            raise ProgramError(TOO_DEEP, line, "Give parts of it a name in statements before.")
        chained = isinstance(node, ast.If) and len(node.orelse) == 1 and isinstance(node.orelse[0], ast.If)
        for field in node._fields:
            value = getattr(node, field, None)
            if value.__class__ is list:
                below = depth if chained and field == "orelse" else depth + 1
                open_nodes += [(item, below, line) for item in value if isinstance(item, INNER)]
            elif isinstance(value, INNER):
                open_nodes.append((value, depth + 1, line))


@lru_cache(maxsize=4096)
def names_read(source: str) -> frozenset[str]:
    """The names that a function reads, by its text, which must be Python."""
    tree = ast.parse(source)
    return frozenset(n.id for n in ast.walk(tree) if isinstance(n, ast.Name) and isinstance(n.ctx, ast.Load))
