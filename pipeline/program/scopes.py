# SPDX-License-Identifier: GPL-3.0-or-later
"""Which variable each name means, by Python's rules, and the slot of the frame in which it lies.

A *scope* is the module, a function, a lambda or a comprehension. A *frame* is the list that holds variables while the
program runs: functions have one each; a comprehension shares the one around it, unless a lambda inside could keep its
variables for later.
"""

from __future__ import annotations

import ast
from dataclasses import dataclass, field

Definition = ast.FunctionDef | ast.Lambda
Comprehension = ast.ListComp | ast.DictComp | ast.GeneratorExp
NAMELESS = (ast.expr_context, ast.operator, ast.unaryop, ast.boolop, ast.cmpop)


@dataclass(eq=False)
class Scope:
    """Where names are bound.

    Attributes:
        node: the definition, None for the module.
        around: the enclosing scope.
        parameters: names in order, which take the first slots.
        names: names that are bound here, with the line of the first binding.
        slots: their places in the frame of `frame`.
        keeps: whether a lambda or def lies inside a comprehension.
        size: slots of the frame; meaningful where `frame is self`.
        constants: literals that lie in slots of the frame, by type and text, with their slots and values.
        surely: names that have a value wherever the code that is being compiled runs.
    """

    node: Definition | Comprehension | None
    around: Scope | None = None
    parameters: tuple[str, ...] = ()
    names: dict[str, int] = field(default_factory=dict)
    slots: dict[str, int] = field(default_factory=dict)
    keeps: bool = False
    size: int = 0
    constants: dict[tuple[type, str], tuple[int, object]] = field(default_factory=dict)
    surely: set[str] = field(default_factory=set)

    @property
    def is_comprehension(self) -> bool:
        """Whether it is one."""
        return isinstance(self.node, (ast.ListComp, ast.DictComp, ast.GeneratorExp))

    @property
    def frame(self) -> Scope:
        """The scope whose frame holds the variables of this one."""
        if self.is_comprehension and not self.keeps and self.around is not None:
            return self.around.frame
        return self

    @property
    def link(self) -> int:
        """The slot that holds the frame around this one."""
        return 1 if self.is_comprehension else len(self.parameters)

    def constant(self, value: object) -> int:
        """The slot that holds a literal."""
        frame = self.frame
        key = (type(value), repr(value))
        if key not in frame.constants:
            frame.constants[key] = (frame.size, value)
            frame.size += 1
        return frame.constants[key][0]

    def contents(self, start: int, empty: object) -> list[object]:
        """What the slots of the frame from `start` hold at first: literals, and `empty` elsewhere."""
        found = [empty] * (self.size - start)
        for slot, value in self.constants.values():
            if slot >= start:
                found[slot - start] = value
        return found

    def bind(self, name: str, line: int) -> None:
        """The name is bound in this scope."""
        self.names.setdefault(name, line)

    def owner(self, name: str) -> Scope | None:
        """The scope that a name means when it is read here; None when the program binds it nowhere."""
        scope: Scope | None = self
        while scope is not None and name not in scope.names:
            scope = scope.around
        return scope


@dataclass
class Names:
    """The scopes of one text.

    Attributes:
        module: the outermost scope.
        of: the scope that a function, lambda or comprehension opens.
        uses: names that are read, with the scope they are read in.
        bindings: names that are bound, with line and scope.
        definitions: defs and lambdas that a name of a scope is bound to.
    """

    module: Scope
    of: dict[ast.AST, Scope] = field(default_factory=dict)
    uses: list[tuple[ast.Name, Scope]] = field(default_factory=list)
    bindings: list[tuple[str, int, Scope]] = field(default_factory=list)
    definitions: dict[tuple[Scope, str], list[Definition]] = field(default_factory=dict)


class Binder:
    """Walks a checked tree and finds all scopes."""

    def __init__(self, module: Scope) -> None:
        self.names = Names(module)

    def run(self, tree: ast.Module) -> Names:
        """Find the scopes, then give every variable its slot."""
        for node in tree.body:
            self.visit(node, self.names.module)
        place(self.names.module)
        for scope in self.names.of.values():
            place(scope)
        return self.names

    def bind(self, name: str, line: int, scope: Scope) -> None:
        """Note that the name is bound in the scope."""
        scope.bind(name, line)
        self.names.bindings.append((name, line, scope))

    def visit(self, node: ast.AST, scope: Scope) -> None:
        """Any node that is read or run in the scope."""
        if isinstance(node, ast.Name):
            if isinstance(node.ctx, ast.Load):
                self.names.uses.append((node, scope))
            else:
                self.bind(node.id, node.lineno, scope)
        elif isinstance(node, ast.FunctionDef):
            self.bind(node.name, node.lineno, scope)
            self.names.definitions.setdefault((scope, node.name), []).append(node)
            self.function(node, node.body, scope)
        elif isinstance(node, ast.Lambda):
            self.function(node, [node.body], scope)
        elif isinstance(node, (ast.ListComp, ast.DictComp, ast.GeneratorExp)):
            self.comprehension(node, scope)
        elif isinstance(node, ast.If):
            self.conditional(node, scope)
        else:
            if isinstance(node, ast.Assign) and isinstance(node.value, ast.Lambda):
                for target in node.targets:
                    if isinstance(target, ast.Name):
                        self.names.definitions.setdefault((scope, target.id), []).append(node.value)
            for child in ast.iter_child_nodes(node):
                if child.__class__ is not ast.Constant and not isinstance(child, NAMELESS):
                    self.visit(child, scope)

    def conditional(self, node: ast.If, scope: Scope) -> None:
        """if and all its elifs, without going deeper for each."""
        while True:
            self.visit(node.test, scope)
            for child in node.body:
                self.visit(child, scope)
            if len(node.orelse) == 1 and isinstance(node.orelse[0], ast.If):
                node = node.orelse[0]
                continue
            for child in node.orelse:
                self.visit(child, scope)
            return

    def function(self, node: Definition, body: list[ast.stmt] | list[ast.expr], scope: Scope) -> None:
        """A def or lambda: its defaults are read outside, its body inside."""
        for default in node.args.defaults:
            self.visit(default, scope)
        inner = Scope(node, scope, tuple(argument.arg for argument in node.args.args))
        inner.surely.update(inner.parameters)
        for argument in node.args.args:
            self.bind(argument.arg, argument.lineno, inner)
        self.names.of[node] = inner
        around: Scope | None = scope
        while around is not None and around.is_comprehension:
            around.keeps = True
            around = around.around
        for child in body:
            self.visit(child, inner)

    def comprehension(self, node: Comprehension, scope: Scope) -> None:
        """The first iterable is read outside, everything else inside."""
        inner = Scope(node, scope)
        self.names.of[node] = inner
        for number, generator in enumerate(node.generators):
            self.visit(generator.iter, inner if number else scope)
            self.visit(generator.target, inner)
            for condition in generator.ifs:
                self.visit(condition, inner)
        parts = [node.key, node.value] if isinstance(node, ast.DictComp) else [node.elt]
        for part in parts:
            self.visit(part, inner)


def place(scope: Scope) -> None:
    """Give the names of a scope their slots: parameters, the link to the frame around, the rest."""
    frame = scope.frame
    if frame is scope and not scope.size and scope.node is not None:
        scope.slots = {name: number for number, name in enumerate(scope.parameters)}
        scope.size = scope.link + 1
    for name in scope.names:
        if name not in scope.slots:
            scope.slots[name] = frame.size
            frame.size += 1
