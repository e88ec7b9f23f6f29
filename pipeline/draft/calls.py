# SPDX-License-Identifier: GPL-3.0-or-later
"""What the lines of a draft say: their names and arguments as plain values, read without running anything.

Literals are read as they are. Anything else (arithmetic, lines in loops) goes through the room language's interpreter.
"""

from __future__ import annotations

import ast
from collections.abc import Collection
from dataclasses import dataclass
from typing import Any

from ..errors import ProgramError
from ..program.evaluate import call_function
from ..program.limits import Limits
from ..program.prelude.registry import LOOKS
from .statements import LINES

LIMITS = Limits(text_bytes=131_072, steps=60_000, vertices=0, seconds=2.0)
MOST_CALLS = 400
"""Lines that one statement may make."""
_MADE = "lines_made"


@dataclass(frozen=True)
class Ref:
    """A name or an expression that stands in a line and is no value: a def, or a look."""

    text: str


@dataclass(frozen=True)
class Call:
    """One line: what it calls, and its arguments. `plain` where all of them were literals."""

    name: str
    args: tuple[Any, ...]
    keywords: dict[str, Any]
    plain: bool = True


def has_lines(node: ast.stmt) -> bool:
    """Whether a statement makes lines of the room."""
    if isinstance(node, ast.FunctionDef):
        return False
    return any(isinstance(n, ast.Call) and isinstance(n.func, ast.Name) and n.func.id in LINES for n in ast.walk(node))


def calls_of(node: ast.stmt, preamble: str, known: Collection[str], named_looks: Collection[str]) -> list[Call]:
    """The lines that a statement makes.

    Args:
        preamble: the draft's numbers, as statements. known: names of the draft's defs. named_looks: of its palette.

    Raises:
        ProgramError: an argument cannot be worked out.
    """
    if isinstance(node, ast.Expr) and isinstance(node.value, ast.Call) and isinstance(node.value.func, ast.Name):
        call = node.value
        if not any(isinstance(a, ast.Starred) for a in call.args) and all(k.arg for k in call.keywords):
            reader = _Reader(preamble, known, named_looks)
            args = tuple(reader.value(a) for a in call.args)
            keywords = {str(k.arg): reader.value(k.value) for k in call.keywords}
            return [Call(node.value.func.id, args, keywords, reader.plain)]
    return _through_interpreter(node, preamble, known, named_looks)


class _Reader:
    def __init__(self, preamble: str, known: Collection[str], named_looks: Collection[str]) -> None:
        self._preamble, self._known, self._looks = preamble, known, named_looks
        self.plain = True

    def value(self, node: ast.expr) -> Any:
        """The value of an argument."""
        if isinstance(node, ast.Constant) and not isinstance(node.value, (bytes, complex)) and node.value is not ...:
            return node.value
        if isinstance(node, (ast.Tuple, ast.List)):
            return [self.value(item) for item in node.elts]
        if isinstance(node, ast.Dict) and all(key is not None for key in node.keys):
            return {str(self.value(k)): self.value(v) for k, v in zip(node.keys, node.values, strict=True) if k}
        if isinstance(node, ast.UnaryOp) and isinstance(node.op, (ast.USub, ast.UAdd)):
            inner = self.value(node.operand)
            if isinstance(inner, (int, float)) and not isinstance(inner, bool):
                return -inner if isinstance(node.op, ast.USub) else inner
        if isinstance(node, ast.Name) and (node.id in self._known or node.id in self._looks):
            return Ref(node.id)
        if isinstance(node, ast.Lambda) or _is_look(node) or _calls(node, self._known):
            return Ref(_source(node))
        self.plain = False
        return _worked_out(node, self._preamble)


def _is_look(node: ast.expr) -> bool:
    return isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id in LOOKS


def _calls(node: ast.expr, known: Collection[str]) -> bool:
    return isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id in known


def _source(node: ast.AST) -> str:
    try:
        return ast.unparse(node)
    except (RecursionError, ValueError):
        raise ProgramError("it is nested too deeply", getattr(node, "lineno", 0)) from None


def _worked_out(node: ast.expr, preamble: str) -> Any:
    """The value of an expression by the interpreter."""
    text = f"{preamble}\ndef worked_out():\n    return [{_source(node)}]\n"
    try:
        (value,) = call_function(text, "worked_out", (), LIMITS)
    except ProgramError as error:
        raise ProgramError(error.message, node.lineno, error.fix) from None
    except (TypeError, ValueError):
        raise ProgramError("an argument cannot be worked out", node.lineno) from None
    return value


class _Collecting(ast.NodeTransformer):
    """Lines of the room as entries of a list."""

    def __init__(self, known: Collection[str], looks: Collection[str]) -> None:
        self._known, self._looks = known, looks

    def visit_Expr(self, node: ast.Expr) -> ast.AST:
        call = node.value
        if not (isinstance(call, ast.Call) and isinstance(call.func, ast.Name) and call.func.id in LINES):
            return self.generic_visit(node)
        if any(isinstance(a, ast.Starred) for a in call.args) or not all(k.arg for k in call.keywords):
            raise ProgramError(f"{call.func.id}: write every argument out, without * or **", node.lineno)
        args: list[ast.expr] = [self._as_text(a) for a in call.args]
        pairs = [ast.Tuple([ast.Constant(k.arg), self._as_text(k.value)], ast.Load()) for k in call.keywords]
        entry = ast.Tuple(
            [ast.Constant(call.func.id), ast.List(args, ast.Load()), ast.List(list(pairs), ast.Load())], ast.Load()
        )
        made = ast.Call(ast.Name("append", ast.Load()), [ast.Name(_MADE, ast.Load()), entry], [])
        return ast.copy_location(ast.Expr(made), node)

    def _as_text(self, node: ast.expr) -> ast.expr:
        named = isinstance(node, ast.Name) and (node.id in self._known or node.id in self._looks)
        if named or isinstance(node, ast.Lambda) or _is_look(node) or _calls(node, self._known):
            return ast.Tuple([ast.Constant("\x00"), ast.Constant(_source(node))], ast.Load())
        return node


def _through_interpreter(
    node: ast.stmt, preamble: str, known: Collection[str], named_looks: Collection[str]
) -> list[Call]:
    """The lines of a loop or a condition."""
    body = ast.fix_missing_locations(_Collecting(known, named_looks).visit(node))
    inner = "\n".join(f"    {row}" for row in _source(body).split("\n"))
    text = f"{preamble}\ndef make_lines():\n    {_MADE} = []\n{inner}\n    return {_MADE}\n"
    try:
        found = call_function(text, "make_lines", (), LIMITS)
    except ProgramError as error:
        raise ProgramError(error.message, node.lineno, error.fix) from None
    if len(found) > MOST_CALLS:
        raise ProgramError(f"it makes more than {MOST_CALLS} lines", node.lineno)
    return [
        Call(str(name), tuple(_ref(a) for a in args), {str(k): _ref(v) for k, v in pairs}, False)
        for name, args, pairs in found
    ]


def _ref(value: Any) -> Any:
    if isinstance(value, (list, tuple)) and len(value) == 2 and value[0] == "\x00":
        return Ref(str(value[1]))
    return value
