# SPDX-License-Identifier: GPL-3.0-or-later
"""Compiles statements and blocks; see `control` for what the compiled ones do."""

from __future__ import annotations

import ast
from typing import Any

from .comprehensions import STEPS_OF_DEFINITION, Comprehensions, function_maker
from .control import (
    BREAK,
    CONTINUE,
    NOTHING,
    Block,
    Statement,
    assign,
    augment,
    augment_item,
    choose,
    full_loop,
    line_of,
    plain_loop,
    single,
    straight,
)
from .limits import Meter
from .refusals import located
from .scopes import Scope
from .values import Code, Frame


class Statements(Comprehensions):
    """Compiles whole programs."""

    def block(self, nodes: list[ast.stmt], scope: Scope) -> Block:
        """The statements of a block; what has no effect is left out."""
        outside, self.cost = self.cost, 0
        compiled, lines, simple = [], [], True
        before = set(scope.surely)
        for node in nodes:
            if isinstance(node, ast.Pass) or (isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant)):
                continue
            self.cost += 1
            statement, ends = getattr(self, f"run_{type(node).__name__}")(node, scope)
            compiled.append(statement)
            lines.append(node.lineno)
            simple = simple and not ends
            scope.surely.update(bound_by(node))
        scope.surely = before
        cost, self.cost = max(1, self.cost), outside
        return Block(tuple(compiled), tuple(lines), cost, simple)

    def run_Expr(self, node: ast.Expr, scope: Scope) -> tuple[Statement, bool]:
        """An expression for its effect."""
        value = self.compile(node.value, scope)

        def run(f: Frame) -> None:
            value(f)

        return run, False

    def run_Assign(self, node: ast.Assign, scope: Scope) -> tuple[Statement, bool]:
        """target = value"""
        value = self.compile(node.value, scope)
        if len(node.targets) == 1 and isinstance(node.targets[0], ast.Name):
            return assign(scope.slots[node.targets[0].id], value), False
        stores = [self.store(target, scope) for target in node.targets]

        def run(f: Frame) -> None:
            v = value(f)
            for store in stores:
                store(f, v)

        return run, False

    def run_AugAssign(self, node: ast.AugAssign, scope: Scope) -> tuple[Statement, bool]:
        """target op= value"""
        self.cost += 1
        name = type(node.op).__name__
        value = self.compile(node.value, scope)
        if isinstance(node.target, ast.Name):
            slot = scope.slots[node.target.id]
            return augment(self.meter, name, slot, self.load(node.target.id, scope), value), False
        assert isinstance(node.target, ast.Subscript)
        self.cost += 3
        container = self.compile(node.target.value, scope)
        index = self.compile(node.target.slice, scope)
        return augment_item(self.meter, name, container, index, value), False

    def run_Return(self, node: ast.Return, scope: Scope) -> tuple[Statement, bool]:
        """return value"""
        if node.value is None:
            return (lambda f: NOTHING), True
        value = self.compile(node.value, scope)
        return (lambda f: (value(f),)), True

    def run_Break(self, node: ast.Break, scope: Scope) -> tuple[Statement, bool]:
        """break"""
        return (lambda f: BREAK), True

    def run_Continue(self, node: ast.Continue, scope: Scope) -> tuple[Statement, bool]:
        """continue"""
        return (lambda f: CONTINUE), True

    def run_If(self, node: ast.If, scope: Scope) -> tuple[Statement, bool]:
        """if, elif, else"""
        branches = []
        rest: list[ast.stmt] = [node]
        while len(rest) == 1 and isinstance(rest[0], ast.If):
            branch = rest[0]
            self.cost += 1
            block = self.block(branch.body, scope)
            branches.append((self.compile(branch.test, scope), self.runner(block), block.cost, branch.lineno))
            rest = branch.orelse
        other = self.block(rest, scope)
        run_other = self.runner(other) if other.statements else None
        ends = not other.simple or any(not self.is_simple(branch.body) for branch in chain_of(node))
        return choose(self.meter, tuple(branches), run_other, other.cost), ends

    def is_simple(self, body: list[ast.stmt]) -> bool:
        """Whether no statement of the body, outside loops and defs, ends the block around it."""
        for node in body:
            if isinstance(node, (ast.Return, ast.Break, ast.Continue)):
                return False
            if isinstance(node, ast.If) and not all(
                self.is_simple(part.body) and self.is_simple(last_else(part)) for part in chain_of(node)
            ):
                return False
            if isinstance(node, ast.For) and not (self.returns_not(node.body) and self.is_simple(node.orelse)):
                return False
        return True

    def returns_not(self, body: list[ast.stmt]) -> bool:
        """Whether no return lies in the body, outside defs."""
        open_nodes: list[ast.stmt] = list(body)
        while open_nodes:
            node = open_nodes.pop()
            if isinstance(node, ast.Return):
                return False
            if isinstance(node, (ast.If, ast.For)):
                open_nodes += [*node.body, *node.orelse]
        return True

    def run_For(self, node: ast.For, scope: Scope) -> tuple[Statement, bool]:
        """for target in values, with else"""
        source = self.compile(node.iter, scope)
        outside, self.cost = self.cost, 0
        slot = scope.slots[node.target.id] if isinstance(node.target, ast.Name) else None
        store = self.store(node.target, scope)
        turn = 1 + self.cost
        self.cost = outside
        before = set(scope.surely)
        scope.surely.update(targets_of(node.target))
        body = self.block(node.body, scope)
        scope.surely = before
        other = self.block(node.orelse, scope) if node.orelse else None
        run_other = self.runner(other, charge=self.meter) if other is not None else None
        ends = not self.returns_not(node.body) or (other is not None and not other.simple)
        cost = turn + body.cost
        if body.simple and slot is not None and run_other is None:
            return plain_loop(self.meter, source, slot, body, cost), ends
        return full_loop(self.meter, source, store, self.runner(body), cost, run_other), ends

    def run_FunctionDef(self, node: ast.FunctionDef, scope: Scope) -> tuple[Statement, bool]:
        """def name(parameters)"""
        inner = self.names.of[node]
        self.cost += STEPS_OF_DEFINITION
        defaults = self.compile_all(node.args.defaults, scope)
        store = self.store(ast.Name(node.name, ast.Store()), scope)
        body, cost = self.body(node, inner)
        make = function_maker(self.meter, node.name, inner, body, cost, node.lineno)

        def run(f: Frame) -> None:
            store(f, make(f, tuple([default(f) for default in defaults])))

        return run, False

    def body(self, node: ast.FunctionDef, inner: Scope) -> tuple[Code, int]:
        """The body of a function as code that gives what it returns, and its steps."""
        last = node.body[-1]
        if isinstance(last, ast.Return) and last.value is not None:
            before = self.block(node.body[:-1], inner)
            inner.surely.update(name for statement in node.body[:-1] for name in bound_by(statement))
            if before.simple:
                outside, self.cost = self.cost, 0
                value = self.compile(last.value, inner)
                cost, self.cost = self.cost, outside
                return straight(before, value, last.lineno), before.cost + cost + 1
            inner.surely = set(inner.parameters)
        block = self.block(node.body, inner)
        run = self.runner(block)

        def general(f: Frame) -> Any:
            result = run(f)
            return None if result is None else result[0]

        return general, block.cost

    def runner(self, block: Block, charge: Meter | None = None) -> Statement:
        """One statement that runs a block. Errors get the line of the statement that raised them."""
        statements, lines, cost = block.statements, block.lines, block.cost

        def run(f: Frame) -> Any:
            if charge is not None:
                charge.spend(cost)
            statement = None
            try:
                for statement in statements:
                    result = statement(f)
                    if result is not None:
                        return result
            except Exception as error:
                raise located(error, line_of(block, statement)) from None
            return None

        if len(statements) == 1 and charge is None:
            return single(statements[0], lines[0])
        return run


def bound_by(node: ast.stmt) -> list[str]:
    """Names that surely have a value once the statement has run."""
    if isinstance(node, ast.FunctionDef):
        return [node.name]
    if isinstance(node, ast.Assign):
        return [name for target in node.targets for name in targets_of(target)]
    return []


def targets_of(target: ast.expr) -> list[str]:
    """Names that an assignment to the target binds."""
    if isinstance(target, (ast.Tuple, ast.List)):
        return [name for item in target.elts for name in targets_of(item)]
    return [target.id] if isinstance(target, ast.Name) else []


def chain_of(node: ast.If) -> list[ast.If]:
    """An if and its elifs."""
    found = [node]
    while len(node.orelse) == 1 and isinstance(node.orelse[0], ast.If):
        node = node.orelse[0]
        found.append(node)
    return found


def last_else(node: ast.If) -> list[ast.stmt]:
    """The else of an if that has no elif."""
    return [] if len(node.orelse) == 1 and isinstance(node.orelse[0], ast.If) else node.orelse
