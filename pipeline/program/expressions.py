# SPDX-License-Identifier: GPL-3.0-or-later
"""Compiles expressions to Python closures: one closure for each operation, chosen by the shape of its operands."""

from __future__ import annotations

import ast
from collections.abc import Callable
from typing import Any

from . import arithmetic, fused, text
from .items import item_of, slice_of, store_item
from .limits import Meter
from .scopes import Names, Scope
from .values import Code, Frame, Native, check_key, settle
from .variables import load_global, load_local, load_outer, load_parameter, store_slot, unpack


class Expressions:
    """Compiles the expressions of one program.

    Args:
        names: where each variable lies.
        meter: what the compiled code is counted by.
        natives: functions that programs may call.
        constants: names with a fixed value.
        top: the module's frame.

    Attributes:
        cost: steps of what was compiled since it was set to 0.
    """

    def __init__(
        self, names: Names, meter: Meter, natives: dict[str, Native], constants: dict[str, Any], top: Frame
    ) -> None:
        self.names = names
        self.meter = meter
        self.natives = natives
        self.constants = constants
        self.top = top
        self.cost = 0

    def compile(self, node: ast.expr, scope: Scope) -> Code:
        """The closure for an expression that is read in the scope."""
        compiled: Code = getattr(self, f"on_{type(node).__name__}")(node, scope)
        return compiled

    def compile_all(self, nodes: list[ast.expr], scope: Scope) -> tuple[Code, ...]:
        """The closures for several expressions."""
        return tuple(self.compile(node, scope) for node in nodes)

    def on_Constant(self, node: ast.Constant, scope: Scope) -> Code:
        """A literal."""
        value = node.value
        return lambda f: value

    def on_Name(self, node: ast.Name, scope: Scope) -> Code:
        """A variable, a constant or a function as a value."""
        return self.load(node.id, scope)

    def load(self, name: str, scope: Scope) -> Code:
        """The closure that reads a variable, chosen by where it lies."""
        owner = scope.owner(name)
        if owner is None:
            value = self.natives[name] if name in self.natives else self.constants[name]
            return lambda f: value
        slot = owner.slots[name]
        frame, target = scope.frame, owner.frame
        if frame is target:
            return load_parameter(slot) if name in owner.surely else load_local(slot, name, name in self.natives)
        if target is self.names.module:
            return load_global(self.top, slot, name)
        links = []
        while frame is not target:
            links.append(frame.link)
            assert frame.around is not None
            frame = frame.around.frame
        return load_outer(tuple(links), slot, name)

    def slot(self, node: ast.expr, scope: Scope) -> int | None:
        """The slot of this frame that surely holds the value of a variable or literal, if there is one."""
        if isinstance(node, ast.UnaryOp):
            value = negative_literal(node)
            return None if value is None else scope.constant(value)
        if isinstance(node, ast.Constant):
            return scope.constant(node.value)
        if not isinstance(node, ast.Name):
            return None
        owner = scope.owner(node.id)
        if owner is None or owner.frame is not scope.frame or node.id not in owner.surely:
            return None
        return owner.slots[node.id]

    def store(self, node: ast.expr, scope: Scope) -> Callable[[Frame, Any], None]:
        """The function of frame and value that assigns to a target."""
        if isinstance(node, ast.Name):
            return store_slot(scope.slots[node.id])
        if isinstance(node, (ast.Tuple, ast.List)):
            self.cost += 1 + len(node.elts)
            return unpack(tuple(self.store(item, scope) for item in node.elts))
        assert isinstance(node, ast.Subscript)
        self.cost += 2
        return store_item(self.meter, self.compile(node.value, scope), self.compile(node.slice, scope))

    def on_BinOp(self, node: ast.BinOp, scope: Scope) -> Code:
        """left op right"""
        self.cost += 1
        name = type(node.op).__name__
        left, right = self.slot(node.left, scope), self.slot(node.right, scope)
        if name in fused.BOTH:
            if left is not None and right is not None:
                return fused.BOTH[name](self.meter, left, right)
            if left is not None:
                return fused.LEFT[name](self.meter, left, self.compile(node.right, scope))
            if right is not None:
                return fused.RIGHT[name](self.meter, self.compile(node.left, scope), right)
        make = arithmetic.OPERATIONS[name][0]
        return make(self.meter, self.compile(node.left, scope), self.compile(node.right, scope))

    def on_UnaryOp(self, node: ast.UnaryOp, scope: Scope) -> Code:
        """op operand"""
        value = negative_literal(node)
        if value is not None:
            return lambda f: value
        self.cost += 1
        return arithmetic.UNARY[type(node.op).__name__](self.meter, self.compile(node.operand, scope))

    def on_BoolOp(self, node: ast.BoolOp, scope: Scope) -> Code:
        """and, or"""
        self.cost += len(node.values) - 1
        values = self.compile_all(node.values, scope)
        return all_of(values) if isinstance(node.op, ast.And) else any_of(values)

    def on_Compare(self, node: ast.Compare, scope: Scope) -> Code:
        """Comparisons, chained or not"""
        self.cost += len(node.ops)
        operands = self.compile_all([node.left, *node.comparators], scope)
        kinds = [type(operation).__name__ for operation in node.ops]
        if len(kinds) == 1:
            return arithmetic.comparison(self.meter, kinds[0], *operands)
        return chain(operands, tuple(arithmetic.comparison_of(kind, self.meter) for kind in kinds))

    def on_IfExp(self, node: ast.IfExp, scope: Scope) -> Code:
        """a if condition else b"""
        self.cost += 1
        test, then, other = self.compile_all([node.test, node.body, node.orelse], scope)
        return lambda f: then(f) if test(f) else other(f)

    def on_Tuple(self, node: ast.Tuple, scope: Scope) -> Code:
        """(a, b, *c)"""
        return self.display(node.elts, scope, tuple)

    def on_List(self, node: ast.List, scope: Scope) -> Code:
        """[a, b, *c]"""
        return self.display(node.elts, scope, list)

    def display(self, nodes: list[ast.expr], scope: Scope, kind: type[list[Any]] | type[tuple[Any, ...]]) -> Code:
        """A list or tuple that is written out."""
        self.cost += 2 + len(nodes) // 2
        if any(isinstance(node, ast.Starred) for node in nodes):
            collect = self.spread(nodes, scope)
            return (lambda f: tuple(collect(f))) if kind is tuple else collect
        if kind is tuple and all(isinstance(node, ast.Constant) for node in nodes):
            value = tuple(node.value for node in nodes if isinstance(node, ast.Constant))
            return lambda f: value
        items = self.compile_all(nodes, scope)
        return list_of(items) if kind is list else tuple_of(items)

    def spread(self, nodes: list[ast.expr], scope: Scope) -> Code:
        """A list of values some of which are *sequences."""
        parts = tuple(
            (isinstance(node, ast.Starred), self.compile(node.value if isinstance(node, ast.Starred) else node, scope))
            for node in nodes
        )
        drain = self.natives["list"].call
        meter = self.meter

        def run(f: Frame) -> list[Any]:
            values: list[Any] = []
            for starred, part in parts:
                if starred:
                    values += drain(part(f))
                else:
                    values.append(part(f))
            settle(meter, values)
            return values

        return run

    def on_Dict(self, node: ast.Dict, scope: Scope) -> Code:
        """{key: value}"""
        self.cost += 2 + 2 * len(node.keys)
        keys = tuple(self.compile(key, scope) for key in node.keys if key is not None)
        pairs = tuple(zip(keys, self.compile_all(node.values, scope), strict=True))
        meter = self.meter

        def run(f: Frame) -> dict[Any, Any]:
            table: dict[Any, Any] = {}
            for key, value in pairs:
                k = key(f)
                v = value(f)
                check_key(meter, table, k)
                table[k] = v
            return table

        return run

    def on_Subscript(self, node: ast.Subscript, scope: Scope) -> Code:
        """values[index], values[from:to:step]"""
        self.cost += 1
        value = self.compile(node.value, scope)
        if not isinstance(node.slice, ast.Slice):
            return item_of(self.meter, value, self.compile(node.slice, scope))
        bounds = tuple(
            None if bound is None else self.compile(bound, scope)
            for bound in (node.slice.lower, node.slice.upper, node.slice.step)
        )
        return slice_of(self.meter, value, bounds)

    def on_JoinedStr(self, node: ast.JoinedStr, scope: Scope) -> Code:
        """f"..." """
        self.cost += 1 + len(node.values)
        parts = []
        for part in node.values:
            if isinstance(part, ast.FormattedValue):
                spec = text.spec_of(part.format_spec) if part.format_spec is not None else ""
                parts.append(text.field(self.meter, self.compile(part.value, scope), spec or ""))
            else:
                parts.append(self.compile(part, scope))
        return text.joined(self.meter, tuple(parts))


def negative_literal(node: ast.UnaryOp) -> int | float | None:
    """The number that -literal is."""
    if isinstance(node.op, ast.USub) and isinstance(node.operand, ast.Constant):
        value = node.operand.value
        if isinstance(value, (int, float)) and not isinstance(value, bool):
            return -value
    return None


def all_of(values: tuple[Code, ...]) -> Code:
    """a and b and c"""
    *first, last = values

    def run(f: Frame) -> Any:
        for value in first:
            v = value(f)
            if not v:
                return v
        return last(f)

    return run


def any_of(values: tuple[Code, ...]) -> Code:
    """a or b or c"""
    *first, last = values

    def run(f: Frame) -> Any:
        for value in first:
            v = value(f)
            if v:
                return v
        return last(f)

    return run


def chain(operands: tuple[Code, ...], compares: tuple[Callable[[Any, Any], Any], ...]) -> Code:
    """a < b < c"""
    first, *rest = operands
    steps = tuple(zip(compares, rest, strict=True))

    def run(f: Frame) -> Any:
        left = first(f)
        for compare, operand in steps:
            right = operand(f)
            result = compare(left, right)
            if not result:
                return result
            left = right
        return result

    return run


def list_of(items: tuple[Code, ...]) -> Code:
    """[a, b, c]"""
    return lambda f: [item(f) for item in items]


def tuple_of(items: tuple[Code, ...]) -> Code:
    """(a, b, c)"""
    if len(items) == 2:
        a, b = items
        return lambda f: (a(f), b(f))
    if len(items) == 3:
        c, d, e = items
        return lambda f: (c(f), d(f), e(f))
    return lambda f: tuple([item(f) for item in items])
