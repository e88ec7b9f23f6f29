# SPDX-License-Identifier: GPL-3.0-or-later
"""Functions of a room without what this room never asks of them.

A piece of the furniture library can do more than one room needs: a lamp has ten shades, and the room has one. Where every
call in the text gives a parameter the same plain value, the parameter goes, its value stands in its place, and branches
that cannot be reached any more are left out, with the functions and local names that only they used. What the text
builds stays the same.
"""

from __future__ import annotations

import ast
from collections import Counter
from collections.abc import Collection, Iterator
from dataclasses import dataclass, field
from typing import Any

from .folding import LITERALS, Folder, Ruler, drop_spare_locals

MOST_ROUNDS = 12


def narrowed(tree: ast.Module, untouched: Collection[str] = ()) -> set[str]:
    """Change the functions of a program, so that they do no more than is asked of them.

    Args:
        untouched: functions that stay word by word, and with them what they call as they call it.

    Returns:
        The names of those that are not what they were; functions that nothing uses are gone from the tree.
    """
    program = _Program(tree, untouched)
    for _ in range(MOST_ROUNDS):
        program.drop_unused()
        fixed = [program.settle(name) or program.rule_out(name) for name in program.calls.functions]
        if not any(fixed):
            break
    kept = {id(node) for node in program.calls.functions.values()}
    tree.body = [n for n in tree.body if not isinstance(n, ast.FunctionDef) or id(n) in kept]
    return program.changed


@dataclass
class _Facts:
    """What stands in a statement of the module: its calls by the name that is called, and names by their use."""

    calls: dict[str, list[ast.Call]] = field(default_factory=dict)
    open_calls: set[str] = field(default_factory=set)
    read: set[str] = field(default_factory=set)
    values: set[str] = field(default_factory=set)
    bound: Counter[str] = field(default_factory=Counter)

    @staticmethod
    def of(statement: ast.stmt) -> _Facts:
        found = _Facts()
        callees: set[int] = set()
        for node in ast.walk(statement):  # a call comes before what it is made of
            if isinstance(node, ast.Call) and isinstance(node.func, ast.Name):
                callees.add(id(node.func))
                found.calls.setdefault(node.func.id, []).append(node)
                if any(isinstance(a, ast.Starred) for a in node.args) or any(k.arg is None for k in node.keywords):
                    found.open_calls.add(node.func.id)
            elif isinstance(node, ast.Name):
                if not isinstance(node.ctx, ast.Load):
                    found.bound[node.id] += 1
                    continue
                found.read.add(node.id)
                if id(node) not in callees:
                    found.values.add(node.id)
            elif isinstance(node, ast.arg):
                found.bound[node.arg] += 1
        return found


@dataclass
class _Calls:
    """All functions of a module, and what is in them and in its other statements."""

    functions: dict[str, ast.FunctionDef]
    facts: dict[str, _Facts]
    outside: list[_Facts]
    furnished: set[str]

    def everywhere(self) -> Iterator[_Facts]:
        """The facts of every function and statement."""
        yield from self.facts.values()
        yield from self.outside


class _Program:
    """A module on its way to do less."""

    def __init__(self, tree: ast.Module, untouched: Collection[str]) -> None:
        functions = {n.name: n for n in tree.body if isinstance(n, ast.FunctionDef)}
        others = [n for n in tree.body if not isinstance(n, ast.FunctionDef)]
        outside = [_Facts.of(n) for n in others if not _handed_over(n)]
        furnished = {_handed_over(n) for n in others} - {""}
        self.calls = _Calls(functions, {n: _Facts.of(f) for n, f in functions.items()}, outside, furnished)
        for name in functions.keys() & set(untouched):
            facts = self.calls.facts[name]
            facts.open_calls |= {name, *facts.calls}
        self.changed: set[str] = set()
        self.ruled: dict[str, dict[str, list[Any]]] = {}
        # Two functions of one name, or a name that is something else elsewhere: better not to look closer.
        names = [n.name for n in tree.body if isinstance(n, ast.FunctionDef)]
        bound = set().union(*(facts.bound for facts in self.calls.everywhere()))
        self.unclear = {name for name in names if names.count(name) > 1 or name in bound}

    def drop_unused(self) -> None:
        """Leave out functions that nothing uses."""
        calls = self.calls
        waiting = [*calls.furnished, *self.unclear, *(n for facts in calls.outside for n in facts.read)]
        kept: set[str] = set()
        while waiting:
            name = waiting.pop()
            if name in calls.functions and name not in kept:
                kept.add(name)
                waiting += calls.facts[name].read
        for name in calls.functions.keys() - kept:
            del calls.functions[name], calls.facts[name]

    def _is_known(self, name: str) -> bool:
        """Whether all that call a function are seen."""
        given = self.calls.functions[name].args
        if name in self.unclear or given.vararg or given.kwarg or given.kwonlyargs or given.posonlyargs:
            return False
        return not any(name in facts.values or name in facts.open_calls for facts in self.calls.everywhere())

    def rule_out(self, name: str) -> bool:
        """Leave out what a function does for values of its parameters that no call gives; whether there was any."""
        function, given = self.calls.functions[name], self.calls.functions[name].args
        if not self._is_known(name):
            return False
        bound = self.calls.facts[name].bound
        found = {p.arg: v for p in given.args if bound[p.arg] == 1 and (v := self._values(name, p.arg)) is not None}
        if not found or found == self.ruled.get(name):
            return False
        self.ruled[name] = found
        before = ast.dump(function)
        Ruler(found).visit(function)
        if ast.dump(function) == before:
            return False
        Folder().visit(function)
        drop_spare_locals(function)
        ast.fix_missing_locations(function)
        self.calls.facts[name] = _Facts.of(function)
        self.changed.add(name)
        return True

    def _values(self, name: str, parameter: str) -> list[Any] | None:
        """The plain values that calls give a parameter, None where one of them gives another thing."""
        function = self.calls.functions[name]
        place = _place(function, parameter)
        default = _default(function, place)
        given = [default] if name in self.calls.furnished else []
        for facts in self.calls.outside:
            given += [_argument(call, place, parameter, default) for call in facts.calls.get(name, ())]
        found: list[Any] = []
        for owner, facts in self.calls.facts.items():
            for call in facts.calls.get(name, ()):
                value = _argument(call, place, parameter, default)
                handed_on = self.ruled.get(owner, {}).get(value.id) if isinstance(value, ast.Name) else None
                if handed_on is None:
                    given.append(value)
                elif owner != name:
                    found += handed_on
        if not all(isinstance(v, ast.Constant) and isinstance(v.value, LITERALS) for v in given):
            return None
        found += [v.value for v in given if isinstance(v, ast.Constant)]
        return list({repr(v): v for v in found}.values()) or None

    def settle(self, name: str) -> bool:
        """Take out the parameters of a function that every call gives one value; whether there were any."""
        function, given = self.calls.functions[name], self.calls.functions[name].args
        if not self._is_known(name):
            return False
        everywhere = list(self.calls.everywhere())
        callers = [owner for owner, facts in self.calls.facts.items() if name in facts.calls]
        calls = [call for facts in everywhere for call in facts.calls.get(name, ())]
        bound = self.calls.facts[name].bound
        fixed: dict[str, Any] = {}
        for parameter in [a.arg for a in given.args][int(name in self.calls.furnished) :]:
            value = self._only_value(name, parameter, calls)
            if value is not None and bound[parameter] == 1:
                place = _place(function, parameter)
                for call in calls:
                    _take_argument(call, place, parameter)
                _take_parameter(function, place)
                fixed[parameter] = value.value
        if fixed:
            _Putter(fixed).visit(function)
            Folder().visit(function)
            drop_spare_locals(function)
            ast.fix_missing_locations(function)
            self.calls.facts[name] = _Facts.of(function)
            self.changed |= {name, *callers}
        return bool(fixed)

    def _only_value(self, name: str, parameter: str, calls: Collection[ast.Call]) -> ast.Constant | None:
        function = self.calls.functions[name]
        place = _place(function, parameter)
        default = _default(function, place)
        values = [_argument(call, place, parameter, default) for call in calls]
        if name in self.calls.furnished:
            values.append(default)
        plain = [v for v in values if isinstance(v, ast.Constant) and isinstance(v.value, LITERALS)]
        return plain[0] if plain and len(plain) == len(values) and len({repr(v.value) for v in plain}) == 1 else None


def _handed_over(node: ast.stmt) -> str:
    """The function that a `furnish` statement is given, which it calls with a size; "" for all else."""
    if not isinstance(node, ast.Expr) or not isinstance(node.value, ast.Call) or len(node.value.args) != 2:
        return ""
    called, given = node.value.func, node.value.args[1]
    plain = isinstance(called, ast.Name) and called.id == "furnish" and isinstance(node.value.args[0], ast.Constant)
    return given.id if plain and isinstance(given, ast.Name) else ""


def _place(function: ast.FunctionDef, parameter: str) -> int:
    return [a.arg for a in function.args.args].index(parameter)


def _default(function: ast.FunctionDef, place: int) -> ast.expr | None:
    first = len(function.args.args) - len(function.args.defaults)
    return function.args.defaults[place - first] if place >= first else None


def _argument(call: ast.Call, place: int, parameter: str, default: ast.expr | None) -> ast.expr | None:
    if place < len(call.args):
        return call.args[place]
    return next((k.value for k in call.keywords if k.arg == parameter), default)


def _take_argument(call: ast.Call, place: int, parameter: str) -> None:
    if place < len(call.args):
        del call.args[place]
    else:
        call.keywords = [k for k in call.keywords if k.arg != parameter]


def _take_parameter(function: ast.FunctionDef, place: int) -> None:
    first = len(function.args.args) - len(function.args.defaults)
    if place >= first:
        del function.args.defaults[place - first]
    del function.args.args[place]


class _Putter(ast.NodeTransformer):
    """Puts values in the place of names."""

    def __init__(self, values: dict[str, Any]) -> None:
        self.values = values

    def visit_Name(self, node: ast.Name) -> ast.expr:
        """A use of a name."""
        return ast.Constant(self.values[node.id]) if node.id in self.values else node
