# SPDX-License-Identifier: GPL-3.0-or-later
"""What of a function is known from plain values alone: worked out beforehand, and the branches left out that it rules out."""

from __future__ import annotations

import ast
from collections.abc import Callable, Mapping, Sequence
from typing import Any, TypeVar

Block = TypeVar("Block", ast.If, ast.For, ast.FunctionDef)
LITERALS = (str, int, float, bool, type(None))
_COMPARE: dict[type[ast.cmpop], Callable[[Any, Any], bool]] = {
    ast.Eq: lambda a, b: a == b,
    ast.NotEq: lambda a, b: a != b,
    ast.In: lambda a, b: a in b,
    ast.NotIn: lambda a, b: a not in b,
    ast.Is: lambda a, b: a is b,
    ast.IsNot: lambda a, b: a is not b,
    ast.Gt: lambda a, b: a > b,
    ast.Lt: lambda a, b: a < b,
    ast.GtE: lambda a, b: a >= b,
    ast.LtE: lambda a, b: a <= b,
}


class Folder(ast.NodeTransformer):
    """Works out comparisons and choices between plain values, and leaves out statements that are never reached."""

    def visit_Compare(self, node: ast.Compare) -> ast.expr:
        """A comparison of two plain values."""
        self.generic_visit(node)
        left, right = value_of(node.left), value_of(node.comparators[0])
        if len(node.comparators) > 1 or left is None or right is None:
            return node
        try:
            return ast.Constant(_COMPARE[type(node.ops[0])](left[0], right[0]))
        except TypeError:
            return node

    def visit_BoolOp(self, node: ast.BoolOp) -> ast.expr:
        """`and`, `or` as far as they are known from the left."""
        self.generic_visit(node)
        stops = isinstance(node.op, ast.Or)
        values = list(node.values)
        while len(values) > 1 and (known := value_of(values[0])) is not None:
            if bool(known[0]) == stops:
                return values[0]
            del values[0]
        return values[0] if len(values) == 1 else ast.BoolOp(node.op, values)

    def visit_UnaryOp(self, node: ast.UnaryOp) -> ast.expr:
        """`not` of a plain value."""
        self.generic_visit(node)
        known = value_of(node.operand)
        return ast.Constant(not known[0]) if known is not None and isinstance(node.op, ast.Not) else node

    def visit_IfExp(self, node: ast.IfExp) -> ast.expr:
        """One of two values."""
        self.generic_visit(node)
        known, node.test = _truth(node.test), _condition(node.test)
        return node if known is None else node.body if known else node.orelse

    def visit_Subscript(self, node: ast.Subscript) -> ast.expr:
        """A value of a dict that is written out."""
        self.generic_visit(node)
        known = value_of(node.slice)
        if known is None or not isinstance(node.value, ast.Dict) or not isinstance(node.ctx, ast.Load):
            return node
        keys = [None if key is None else value_of(key) for key in node.value.keys]
        return node.value.values[keys.index(known)] if None not in keys and keys.count(known) == 1 else node

    def visit_JoinedStr(self, node: ast.JoinedStr) -> ast.expr:
        """A text with plain texts put into it."""
        self.generic_visit(node)
        values: list[ast.expr] = []
        for value in node.values:
            if isinstance(value, ast.FormattedValue) and value.conversion < 0 and value.format_spec is None:
                known = value_of(value.value)
                value = ast.Constant(str(known[0])) if known is not None and isinstance(known[0], LITERALS) else value
            if isinstance(value, ast.Constant) and values and isinstance(values[-1], ast.Constant):
                value = ast.Constant(str(values.pop().value) + str(value.value))  # type: ignore[attr-defined]
            values.append(value)
        return values[0] if len(values) == 1 and isinstance(values[0], ast.Constant) else ast.JoinedStr(values)

    def visit_If(self, node: ast.If) -> Any:
        """A branch."""
        self.generic_visit(node)
        known, node.test = _truth(node.test), _condition(node.test)
        if known is None:
            return _whole(node)
        return node.body if known else node.orelse or None

    def visit_For(self, node: ast.For) -> ast.stmt:
        """A loop."""
        self.generic_visit(node)
        return _whole(node)

    def visit_FunctionDef(self, node: ast.FunctionDef) -> ast.stmt:
        """A function."""
        self.generic_visit(node)
        return _whole(node)


class Ruler(ast.NodeTransformer):
    """Works out what is known of names that have one of a few plain values each."""

    def __init__(self, values: Mapping[str, Sequence[Any]]) -> None:
        self.values = values

    def _of(self, node: ast.expr) -> Sequence[Any]:
        return self.values.get(node.id, ()) if isinstance(node, ast.Name) else ()

    def visit_Compare(self, node: ast.Compare) -> ast.expr:
        """A comparison that comes out the same for all values that a name may have."""
        self.generic_visit(node)
        known = value_of(node.comparators[0]) if len(node.comparators) == 1 else None
        try:
            found = {_COMPARE[type(node.ops[0])](value, known[0]) for value in self._of(node.left)} if known else set()
        except TypeError:
            return node
        return ast.Constant(found.pop()) if len(found) == 1 else node

    def visit_Subscript(self, node: ast.Subscript) -> ast.expr:
        """A dict that is written out, without the keys that are never asked for."""
        self.generic_visit(node)
        values = self._of(node.slice)
        if values and isinstance(node.value, ast.Dict):
            keys = [None if key is None else value_of(key) for key in node.value.keys]
            if None not in keys and not any(map(does_something, node.value.values)):
                pairs = zip(node.value.keys, node.value.values, keys, strict=True)
                kept = [(k, v) for k, v, known in pairs if known is not None and known[0] in values]
                node.value = ast.Dict([k for k, _ in kept], [v for _, v in kept])
        return node

    def visit_If(self, node: ast.If) -> ast.stmt:
        """A branch on what a name is."""
        self.generic_visit(node)
        node.test = self._truth(node.test)
        return node

    def visit_IfExp(self, node: ast.IfExp) -> ast.expr:
        """One of two values by what a name is."""
        self.generic_visit(node)
        node.test = self._truth(node.test)
        return node

    def _truth(self, test: ast.expr) -> ast.expr:
        found = {bool(value) for value in self._of(test)}
        return ast.Constant(found.pop()) if len(found) == 1 else test


def value_of(node: ast.expr) -> tuple[Any] | None:
    """The value of a literal, in a tuple; None for all else."""
    if isinstance(node, ast.Constant) and isinstance(node.value, LITERALS):
        return (node.value,)
    if isinstance(node, (ast.Tuple, ast.List)):
        inner = [value_of(item) for item in node.elts]
        return (tuple(v[0] for v in inner if v is not None),) if None not in inner else None
    return None


def _truth(test: ast.expr) -> bool | None:
    """Whether a condition holds, as far as that is known: `a and False` never does, whatever a is."""
    known = value_of(test)
    if known is not None:
        return bool(known[0])
    if isinstance(test, ast.BoolOp) and not does_something(test):
        stops = isinstance(test.op, ast.Or)
        parts = [value_of(value) for value in test.values]
        return stops if any(part is not None and bool(part[0]) == stops for part in parts) else None
    return None


def _condition(test: ast.expr) -> ast.expr:
    """The same condition without what does not count in it: `a and True` is `a` there."""
    if not isinstance(test, ast.BoolOp):
        return test
    stops = isinstance(test.op, ast.Or)
    values = [v for v in test.values if (known := value_of(v)) is None or bool(known[0]) == stops]
    return test if not values else values[0] if len(values) == 1 else ast.BoolOp(test.op, values)


def _whole(node: Block) -> Block:
    """A statement with blocks that end at their first return, and hold at least one statement where they must."""
    for name in ("body", "orelse"):
        block = getattr(node, name, None)
        if isinstance(block, list):
            ends = (at for at, inner in enumerate(block) if isinstance(inner, (ast.Return, ast.Break, ast.Continue)))
            setattr(node, name, block[: next(ends, len(block)) + 1])
    node.body = node.body or [ast.Pass()]
    return node


def drop_spare_locals(function: ast.FunctionDef, pure: frozenset[str] = frozenset()) -> None:
    """Leave out assignments to names that nothing reads, where working them out does nothing else.

    Args:
        pure: modules whose functions only give something back.
    """
    while True:
        read = {n.id for n in ast.walk(function) if isinstance(n, ast.Name) and isinstance(n.ctx, ast.Load)}
        sparer = _Sparer(read, pure)
        sparer.visit(function)
        if not sparer.found:
            return


class _Sparer(ast.NodeTransformer):
    def __init__(self, read: set[str], pure: frozenset[str]) -> None:
        self.read, self.pure, self.found = read, pure, False

    def visit_Assign(self, node: ast.Assign) -> ast.stmt | None:
        """name = value, or a, b = value, where no name is read."""
        self._split(node)
        parts = [n for target in node.targets for n in ast.walk(target)]
        plain = all(isinstance(n, (ast.Name, ast.Tuple, ast.expr_context)) for n in parts)
        if (
            not plain
            or any(isinstance(n, ast.Name) and n.id in self.read for n in parts)
            or does_something(node.value, self.pure)
        ):
            return node
        self.found = True
        return None

    def _split(self, node: ast.Assign) -> None:
        """a, b = 1, 2 without those that nothing reads."""
        target, value = node.targets[0], node.value
        if len(node.targets) > 1 or not isinstance(target, ast.Tuple) or not isinstance(value, ast.Tuple):
            return
        pairs = list(zip(target.elts, value.elts, strict=False))
        if len(target.elts) != len(value.elts) or any(isinstance(n, ast.Starred) for pair in pairs for n in pair):
            return
        kept = [
            (t, v) for t, v in pairs if not isinstance(t, ast.Name) or t.id in self.read or does_something(v, self.pure)
        ]
        if 0 < len(kept) < len(pairs):
            self.found = True
            alone = len(kept) == 1
            node.targets = [kept[0][0] if alone else ast.Tuple([t for t, _ in kept], ast.Store())]
            node.value = kept[0][1] if alone else ast.Tuple([v for _, v in kept], ast.Load())

    def visit_FunctionDef(self, node: ast.FunctionDef) -> ast.stmt:
        """A function."""
        self.generic_visit(node)
        return _whole(node)

    def visit_For(self, node: ast.For) -> ast.stmt:
        """A loop."""
        self.generic_visit(node)
        return _whole(node)

    def visit_If(self, node: ast.If) -> ast.stmt | None:
        """A branch, which goes when there is nothing left of it."""
        self.generic_visit(node)
        return _whole(node) if node.body or node.orelse else None


def does_something(node: ast.expr, pure: frozenset[str] = frozenset()) -> bool:
    """Whether working a value out may change something: `append` does, and what is called on a value may.

    Args:
        pure: modules whose functions only give something back.
    """
    called = [n.func for n in ast.walk(node) if isinstance(n, ast.Call)]
    of_modules = [f for f in called if isinstance(f, ast.Attribute) and isinstance(f.value, ast.Name)]
    known = {id(f) for f in of_modules if isinstance(f.value, ast.Name) and f.value.id in pure}
    return any(id(f) not in known and (not isinstance(f, ast.Name) or f.id == "append") for f in called)
