# SPDX-License-Identifier: GPL-3.0-or-later
"""Compiles calls: of the language's own functions, and of functions that the program defines."""

from __future__ import annotations

import ast
from typing import Any

from ..errors import ProgramError
from .expressions import Expressions
from .limits import Meter
from .refusals import located, misfit
from .scopes import Scope
from .values import LONG, Code, Frame, Function, Native, settle, spend_argument

STEPS_OF_VERTEX = 6
"""What a vertex is counted as when a constructor has made it."""


class Calls(Expressions):
    """Expressions with calls."""

    def on_Call(self, node: ast.Call, scope: Scope) -> Code:
        """name(arguments)"""
        assert isinstance(node.func, ast.Name)
        name = node.func.id
        native = self.natives.get(name) if scope.owner(name) is None else None
        self.cost += 1 + (native.cost if native is not None else 2)
        keywords = tuple((k.arg or "", self.compile(k.value, scope)) for k in node.keywords)
        starred = any(isinstance(argument, ast.Starred) for argument in node.args)
        if native is None:
            if any(isinstance(argument, ast.GeneratorExp) for argument in node.args):
                raise ProgramError(
                    f"{name} is no function of the language here, and takes no generator", node.lineno, "Use [...]."
                )
            function = self.load(name, scope)
            if keywords or starred:
                return call_value(function, name, self.arguments(node, scope), keywords, node.lineno)
            return call_function(function, name, self.compile_all(node.args, scope), node.lineno)
        if native.guarded:
            return call_guarded(self.meter, native, self.arguments(node, scope), keywords, node.lineno)
        if not keywords and not starred and 1 <= len(node.args) <= 2:
            return call_short(native, self.compile_all(node.args, scope), node.lineno)
        return call_native(native, self.arguments(node, scope), keywords, node.lineno)

    def arguments(self, node: ast.Call, scope: Scope) -> Code:
        """The closure that makes the list of positional arguments."""
        if any(isinstance(argument, ast.Starred) for argument in node.args):
            return self.spread(node.args, scope)
        values = self.compile_all(node.args, scope)
        return lambda f: [value(f) for value in values]


def call_short(native: Native, values: tuple[Code, ...], line: int) -> Code:
    """A call of a built-in function with one or two plain arguments."""
    call = native.call
    if len(values) == 1:
        (only,) = values

        def run_one(f: Frame) -> Any:
            argument = only(f)
            try:
                return call(argument)
            except Exception as error:
                raise located(error, line) from None

        return run_one
    first, second = values

    def run_two(f: Frame) -> Any:
        a = first(f)
        b = second(f)
        try:
            return call(a, b)
        except Exception as error:
            raise located(error, line) from None

    return run_two


Keywords = tuple[tuple[str, Code], ...]


def call_native(native: Native, arguments: Code, keywords: Keywords, line: int) -> Code:
    """A call of a built-in function, which checks its arguments itself."""
    call = native.call

    def run(f: Frame) -> Any:
        args = arguments(f)
        named = {name: value(f) for name, value in keywords}
        try:
            return call(*args, **named)
        except Exception as error:
            raise located(error, line) from None

    return run


def call_guarded(meter: Meter, native: Native, arguments: Code, keywords: Keywords, line: int) -> Code:
    """A call of a constructor: containers are measured before, the result and the clock are looked at after."""
    call = native.call

    def run(f: Frame) -> Any:
        args = arguments(f)
        named = {name: value(f) for name, value in keywords}
        try:
            for value in args:
                if value.__class__ in LONG:
                    spend_argument(meter, value)
            for value in named.values():
                if value.__class__ in LONG:
                    spend_argument(meter, value)
            before = meter.vertices[0]
            result = call(*args, **named)
            made = before - meter.vertices[0]
            if made:
                meter.spend(STEPS_OF_VERTEX * made)
            if result.__class__ is float and -1e300 < result < 1e300:
                return result
            meter.watch()
            return settle(meter, result)
        except Exception as error:
            raise located(error, line, misfit(error, native.name, call)) from None

    return run


def not_callable(value: Any, name: str, line: int) -> ProgramError:
    """The refusal of a call of something that is no function."""
    kind = {"NoneType": "None"}.get(type(value).__name__, type(value).__name__)
    return ProgramError(f"{name} is not a function but {kind}", line)


def call_function(function: Code, name: str, values: tuple[Code, ...], line: int) -> Code:
    """A call of a function of the program with plain positional arguments."""
    count = len(values)

    def run(f: Frame) -> Any:
        called = function(f)
        args = [value(f) for value in values]
        if called.__class__ is Function:
            if called.arity == count:
                return called.enter(args)
            return bind(called, args, {}, line)
        if called.__class__ is Native:
            return call_late(called, args, {}, line)
        raise not_callable(called, name, line)

    return run


def call_value(function: Code, name: str, arguments: Code, keywords: Keywords, line: int) -> Code:
    """A call of a function of the program with keywords or *sequences."""

    def run(f: Frame) -> Any:
        called = function(f)
        args = arguments(f)
        named = {key: value(f) for key, value in keywords}
        if called.__class__ is Function:
            return bind(called, args, named, line)
        if called.__class__ is Native:
            return call_late(called, args, named, line)
        raise not_callable(called, name, line)

    return run


def bind(called: Function, args: list[Any], named: dict[str, Any], line: int) -> Any:
    """Call with defaults and keywords; arguments that do not fit are a problem of the calling line."""
    try:
        return called.bind(args, named)
    except ProgramError as error:
        raise located(error, line) from None


def call_late(called: Native, args: list[Any], named: dict[str, Any], line: int) -> Any:
    """Call one of the language's functions through a variable."""
    try:
        return called(*args, **named)
    except Exception as error:
        raise located(error, line) from None
