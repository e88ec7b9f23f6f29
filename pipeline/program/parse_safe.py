# SPDX-License-Identifier: GPL-3.0-or-later
"""From text to a syntax tree, with Python's own parser and without its ways to crash."""

from __future__ import annotations

import ast

from ..errors import ProgramError
from .limits import Limits
from .scan import Scanner, normal_text

INNER = (ast.BinOp, ast.UnaryOp, ast.stmt, ast.expr, ast.comprehension, ast.arguments, ast.keyword, ast.excepthandler)
"""Nodes that can hold others."""
TOO_DEEP = "the program is nested too deeply"


def parse(text: str, limits: Limits) -> ast.Module:
    """The syntax tree of a program. Nothing is compiled or run.

    Raises ProgramError with the line for text that is not Python, too long, too deeply nested, or that holds
    characters no program needs.
    """
    text = normal_text(text, limits)
    Scanner(text, limits).run()
    try:
        tree = ast.parse(text)
    except SyntaxError as error:
        words = str(error.msg or "this is not Python").replace("f-string: ", "")
        line = error.lineno or 0
        raise ProgramError(f"this is not Python: {words}", min(line, text.count("\n") + 1)) from None
    except (RecursionError, MemoryError):
        raise ProgramError(TOO_DEEP, 0, "Give parts of it a name in statements before.") from None
    except ValueError as error:
        raise ProgramError(f"this is not Python: {error}") from None
    measure_depth(tree, limits)
    return tree


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
