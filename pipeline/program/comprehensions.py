# SPDX-License-Identifier: GPL-3.0-or-later
"""Compiles comprehensions, generators and lambdas."""

from __future__ import annotations

import ast
from collections.abc import Callable, Iterator
from typing import Any

from ..errors import ProgramError
from .calls import Calls
from .limits import Meter
from .refusals import located
from .scopes import Comprehension, Scope
from .values import UNSET, Code, Frame, Function, check_key, too_many

STEPS_OF_DEFINITION = 16
"""A function object takes about as much time and memory as this many steps."""
Loop = Callable[[Frame, Iterator[Any]], Iterator[None]]
"""Runs the for parts of a comprehension; stops once for every element that is to be made."""


class Comprehensions(Calls):
    """Expressions with comprehensions and lambdas."""

    def on_ListComp(self, node: ast.ListComp, scope: Scope) -> Code:
        """[element for ...]"""
        inner = self.names.of[node]
        source, loop, (element,) = self.loop(node, inner, scope, [node.elt])
        limit = self.meter.limits.list_items
        meter = self.meter
        enter = self.enter(inner)

        def run(f: Frame) -> Any:
            first = iter(source(f))
            g = enter(f)
            found = [element(g) for _ in loop(g, first)]
            if len(found) > limit:
                raise too_many(meter)
            return found

        return run

    def on_GeneratorExp(self, node: ast.GeneratorExp, scope: Scope) -> Code:
        """(element for ...), which its only caller consumes at once"""
        inner = self.names.of[node]
        source, loop, (element,) = self.loop(node, inner, scope, [node.elt])
        enter = self.enter(inner)

        def generate(g: Frame, first: Iterator[Any]) -> Iterator[Any]:
            for _ in loop(g, first):
                yield element(g)

        return lambda f: generate(enter(f), iter(source(f)))

    def on_DictComp(self, node: ast.DictComp, scope: Scope) -> Code:
        """{key: value for ...}"""
        inner = self.names.of[node]
        source, loop, (key, value) = self.loop(node, inner, scope, [node.key, node.value])
        enter = self.enter(inner)
        meter = self.meter
        limit = self.meter.limits.list_items

        def run(f: Frame) -> Any:
            first = iter(source(f))
            g = enter(f)
            table: dict[Any, Any] = {}
            for _ in loop(g, first):
                k = key(g)
                v = value(g)
                check_key(meter, table, k)
                table[k] = v
                if len(table) > limit:
                    raise too_many(meter)
            return table

        return run

    def enter(self, inner: Scope) -> Callable[[Frame], Frame]:
        """The function from the frame around a comprehension to the frame that its variables lie in."""
        if inner.frame is inner:
            tail = inner.contents(2, UNSET)
            return lambda f: [UNSET, f, *tail]
        later = [inner.slots[name] for name in inner.names]
        if isinstance(inner.node, (ast.ListComp, ast.DictComp, ast.GeneratorExp)) and len(inner.node.generators) == 1:
            return lambda f: f

        def reset(f: Frame) -> Frame:
            for slot in later:
                f[slot] = UNSET
            return f

        return reset

    def loop(
        self, node: Comprehension, inner: Scope, scope: Scope, elements: list[ast.expr]
    ) -> tuple[Code, Loop, tuple[Code, ...]]:
        """The first iterable, the loops, and the elements of a comprehension. Each turn of a loop is counted."""
        source = self.compile(node.generators[0].iter, scope)
        outside = self.cost + 2
        self.cost = 0
        inner.surely.update(inner.names)
        compiled = self.compile_all(elements, inner)
        if len(node.generators) > 1:
            # An inner iterable may be read before the variables of later loops are set.
            inner.surely.clear()
        loop: Loop | None = None
        inside: Code | None = None
        for number, generator in reversed(list(enumerate(node.generators))):
            store = self.store(generator.target, inner)
            conditions = self.compile_all(generator.ifs, inner)
            turn = self.cost + 2
            if loop is None or inside is None:
                loop = innermost(self.meter, store, conditions, turn)
            else:
                loop = nested(self.meter, store, conditions, turn, inside, loop)
            self.cost = 0
            if number:
                inside = self.compile(generator.iter, inner)
        self.cost = outside
        assert loop is not None
        return source, loop, compiled

    def on_Lambda(self, node: ast.Lambda, scope: Scope) -> Code:
        """lambda a, b: value"""
        inner = self.names.of[node]
        defaults = self.compile_all(node.args.defaults, scope)
        outside, self.cost = self.cost, 0
        body = self.compile(node.body, inner)
        make = function_maker(self.meter, "lambda", inner, body, self.cost + 1, node.lineno)
        self.cost = outside + STEPS_OF_DEFINITION
        return lambda f: make(f, tuple([default(f) for default in defaults]))


def innermost(meter: Meter, store: Callable[[Frame, Any], None], conditions: tuple[Code, ...], cost: int) -> Loop:
    """The last for of a comprehension."""

    def run(f: Frame, values: Iterator[Any]) -> Iterator[None]:
        for value in values:
            meter.left -= cost
            if meter.left < 0:
                meter.refill()
            store(f, value)
            for condition in conditions:
                if not condition(f):
                    break
            else:
                yield None

    return run


def nested(
    meter: Meter,
    store: Callable[[Frame, Any], None],
    conditions: tuple[Code, ...],
    cost: int,
    source: Code,
    inside: Loop,
) -> Loop:
    """A for of a comprehension that has another for inside."""

    def run(f: Frame, values: Iterator[Any]) -> Iterator[None]:
        for value in values:
            meter.left -= cost
            if meter.left < 0:
                meter.refill()
            store(f, value)
            for condition in conditions:
                if not condition(f):
                    break
            else:
                yield from inside(f, iter(source(f)))

    return run


def function_maker(
    meter: Meter, name: str, inner: Scope, body: Code, cost: int, line: int
) -> Callable[[Frame, tuple[Any, ...]], Function]:
    """The function from a frame and default values to a Function whose body is one expression or compiled block."""
    parameters = inner.parameters
    rest = inner.contents(len(parameters) + 1, UNSET)
    deepest = meter.limits.depth

    def make(around: Frame, defaults: tuple[Any, ...]) -> Function:
        tail = [around, *rest]

        def enter(frame: Frame) -> Any:
            frame += tail
            depth = meter.depth + 1
            if depth > deepest:
                raise ProgramError(f"more than {deepest} calls inside each other")
            meter.depth = depth
            meter.left -= cost
            try:
                if meter.left < 0:
                    meter.refill()
                value = body(frame)
            except Exception as error:
                raise located(error, line) from None
            meter.depth = depth - 1
            return value

        return Function(name, parameters, defaults, enter)

    return make
