# SPDX-License-Identifier: GPL-3.0-or-later
"""The prelude without its checks: for a long room, which was checked when it was made, and where every kilobyte counts.

Wrong values that somebody writes into such a file later on are met by Python's own words for it. What the prelude makes of
sound values stays the same.
"""

from __future__ import annotations

import ast
import copy
from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field

from .folding import does_something, drop_spare_locals
from .reprinting import Reprinter

_MOST_ROUNDS = 12
_COUNTS_ONLY = "_spend_vertices"
"""What a room may take is counted where models write it."""
_PURE = frozenset({"_np", "_math"})
_PLAIN = frozenset({"float", "int", "str", "tuple"})
Named = ast.FunctionDef | ast.ClassDef


def unchecked(text: str) -> str:
    """A joined module's text without statements that only refuse wrong values, and without what only these needed.

    Functions and methods whose names begin with an underscore lose the arguments that they do not read any more, and those
    that do nothing any more are not called. What is not changed stays as it is written.
    """
    tree = ast.parse(text)
    printer = Reprinter(text, tree)
    module = _Module(tree)
    module.trust()
    for _ in range(_MOST_ROUNDS):
        if not any([module.simplify(), module.forget()]):
            break
    ast.fix_missing_locations(tree)
    return printer.printed(tree)


@dataclass
class _Facts:
    """What stands in a statement of the module.

    Attributes:
        calls: by what is called: a name, or ".name" of self. uses: how often names and attributes stand there.
        unclear: names that are bound there, or called with * or **.
    """

    calls: dict[str, list[ast.Call]] = field(default_factory=dict)
    uses: Counter[str] = field(default_factory=Counter)
    unclear: set[str] = field(default_factory=set)

    @staticmethod
    def of(statement: ast.stmt) -> _Facts:
        found = _Facts()
        for node in ast.walk(statement):
            if isinstance(node, ast.Call) and (name := _called(node)):
                found.calls.setdefault(name, []).append(node)
                if any(isinstance(a, ast.Starred) for a in node.args) or any(k.arg is None for k in node.keywords):
                    found.unclear.add(name)
            elif isinstance(node, ast.Name):
                found.uses[node.id] += 1
                if not isinstance(node.ctx, ast.Load):
                    found.unclear.add(node.id)
            elif isinstance(node, ast.Attribute):
                found.uses[f".{node.attr}"] += 1
            elif isinstance(node, ast.arg):
                found.unclear.add(node.arg)
        return found


class _Module:
    """A module on its way to trust what it is given."""

    def __init__(self, tree: ast.Module) -> None:
        self.statements = tree.body
        self.facts = {id(node): _Facts.of(node) for node in tree.body}
        found = [pair for node in tree.body for pair in _private_functions(node)]
        counts = Counter(name for name, _ in found)
        self.functions = {name: f for name, f in found if counts[name] == 1 and not f.decorator_list}
        self.owners = {name: node for node in tree.body for name, _ in _private_functions(node)}

    def trust(self) -> None:
        """Leave out all that only refuses."""
        refusing = {n for n, f in self.functions.items() if any(isinstance(part, ast.Raise) for part in ast.walk(f))}
        for node in self.statements:
            if isinstance(node, Named) and any(isinstance(part, ast.Raise) for part in ast.walk(node)):
                _Trusting().visit(node)
                self._changed(node)
        for name in refusing | {_COUNTS_ONLY}:
            function = self.functions.get(name)
            if function is not None and (name == _COUNTS_ONLY or _is_idle(function)):
                function.body = [ast.Pass()]

    def _changed(self, node: ast.stmt) -> None:
        """Put a statement in order that was changed."""
        for inner in ast.walk(node):
            if isinstance(inner, ast.FunctionDef):
                _drop_other_names(inner)
                drop_spare_locals(inner, _PURE)
                inner.body = inner.body or [ast.Pass()]
        self.facts[id(node)] = _Facts.of(node)

    def simplify(self) -> bool:
        """Leave out calls of what does nothing, and put what a function of one line does in its place."""
        bodies = {name: f.body for name, f in self.functions.items() if len(f.body) == 1}
        empty = {name for name, body in bodies.items() if isinstance(body[0], ast.Pass)}
        short = {name: made for name in bodies if (made := _one_step(self.functions[name])) is not None}
        found = False
        for node in self.statements:
            facts = self.facts[id(node)]
            here = short.keys() - {"." + n for n in facts.unclear} - facts.unclear
            if facts.calls.keys() & (empty | here):
                plain = _Plain(
                    empty, {n: short[n] for n in here if not short[n][0] or short[n][0] not in facts.unclear}
                )
                plain.visit(node)
                if plain.found:
                    found = True
                    self._changed(node)
        return found

    def forget(self) -> bool:
        """Take out the arguments that nothing reads; whether there were any."""
        uses: Counter[str] = Counter()
        for facts in self.facts.values():
            uses.update(facts.uses)
        unclear = set().union(*(facts.unclear for facts in self.facts.values()))
        found = False
        for name, function in self.functions.items():
            given = function.args
            if name in unclear or given.vararg or given.kwarg or given.kwonlyargs or given.posonlyargs:
                continue
            spare = [a.arg for a in given.args[name.startswith(".") :] if not self._reads(name, a.arg)]
            callers = [node for node in self.statements if name in self.facts[id(node)].calls] if spare else []
            calls = [call for node in callers for call in self.facts[id(node)].calls[name]]
            if len(calls) == uses[name] and sum(_without(function, parameter, calls, name) for parameter in spare):
                found = True
                for node in {id(n): n for n in (*callers, self.owners[name])}.values():
                    self._changed(node)
        return found

    def _reads(self, name: str, parameter: str) -> bool:
        """Whether a function reads a parameter."""
        if not self.facts[id(self.owners[name])].uses[parameter]:
            return False
        parts = self.functions[name].body
        return any(isinstance(n, ast.Name) and n.id == parameter for part in parts for n in ast.walk(part))


def _drop_other_names(function: ast.FunctionDef) -> None:
    """Put an argument in the place of another name for it, and a text that is read once where it is read."""
    names = [n for n in ast.walk(function) if isinstance(n, ast.Name)]
    inner = {
        a.arg for n in ast.walk(function) if isinstance(n, ast.arguments) and n is not function.args for a in n.args
    }
    stored = Counter(n.id for n in names if not isinstance(n.ctx, ast.Load))
    read = Counter(n.id for n in names if isinstance(n.ctx, ast.Load))
    given = {a.arg for a in function.args.args} - stored.keys() - inner
    other: dict[str, ast.expr] = {}
    for node in function.body:
        target = node.targets[0] if isinstance(node, ast.Assign) and len(node.targets) == 1 else None
        if not isinstance(node, ast.Assign) or not isinstance(target, ast.Name) or target.id in inner:
            continue
        value, alone = node.value, stored[target.id] == 1
        same = isinstance(value, ast.Name) and value.id in given
        once = isinstance(value, ast.Constant) and isinstance(value.value, str) and read[target.id] == 1
        if alone and (same or once):
            other[target.id] = value
    if other:
        _Renamed(other).visit(function)


class _Renamed(ast.NodeTransformer):
    """Puts what names stand for in their place."""

    def __init__(self, other: Mapping[str, ast.expr]) -> None:
        self.other = other

    def visit_Name(self, node: ast.Name) -> ast.expr:
        """A use of a name."""
        return copy.copy(self.other[node.id]) if node.id in self.other and isinstance(node.ctx, ast.Load) else node


def _private_functions(node: ast.stmt) -> Iterator[tuple[str, ast.FunctionDef]]:
    """A private function by its name, or the private methods of a class by ".name"."""
    if isinstance(node, ast.FunctionDef) and node.name.startswith("_"):
        yield node.name, node
    elif isinstance(node, ast.ClassDef):
        methods = [n for n in node.body if isinstance(n, ast.FunctionDef)]
        yield from ((f".{n.name}", n) for n in methods if n.name.startswith("_") and not n.name.endswith("__"))


def _called(call: ast.Call) -> str:
    """The name that is called, or ".name" of self; "" for all else."""
    func = call.func
    if isinstance(func, ast.Attribute) and isinstance(func.value, ast.Name) and func.value.id == "self":
        return f".{func.attr}"
    return func.id if isinstance(func, ast.Name) else ""


def _is_idle(function: ast.FunctionDef) -> bool:
    """Whether a function gives nothing back and leaves everything outside of it as it is."""
    own: set[str] = set()
    for node in ast.walk(function):
        if isinstance(node, (ast.Yield, ast.YieldFrom, ast.Global, ast.Nonlocal, ast.Raise, ast.Delete)):
            return False
        if isinstance(node, ast.Return) and node.value is not None:
            return False
        if isinstance(node, (ast.Attribute, ast.Subscript)) and not isinstance(node.ctx, ast.Load):
            return False
        if isinstance(node, ast.Assign):
            fresh = isinstance(node.value, ast.Call) and isinstance(node.value.func, ast.Name)
            fresh = fresh and node.value.func.id in ("set", "list", "dict") and not node.value.args  # type: ignore[attr-defined]
            own |= {t.id for t in node.targets if isinstance(t, ast.Name) and fresh}
    calls = [n.func for n in ast.walk(function) if isinstance(n, ast.Call)]
    on_own = [f for f in calls if isinstance(f, ast.Attribute) and isinstance(f.value, ast.Name) and f.value.id in own]
    fresh_ones = [f for f in calls if isinstance(f, ast.Name) and f.id in ("set", "list", "dict", "len")]
    return len(on_own) + len(fresh_ones) == len(calls)


_Step = tuple[str, ast.expr]


def _one_step(function: ast.FunctionDef) -> _Step | None:
    """What a function of one argument gives back, where that is the argument, or float(argument) or the like."""
    names, last = [a.arg for a in function.args.args], function.body[0]
    if len(names) != 1 or not isinstance(last, ast.Return) or last.value is None:
        return None
    value, what = last.value, ""
    if isinstance(value, ast.Call) and isinstance(value.func, ast.Name) and value.func.id in _PLAIN:
        if len(value.args) != 1 or value.keywords:
            return None
        what, value = value.func.id, value.args[0]
    return (what, value) if isinstance(value, ast.Name) and value.id == names[0] else None


def _without(function: ast.FunctionDef, parameter: str, calls: list[ast.Call], name: str) -> bool:
    """Take a parameter out of a function and its calls; False where working out what it is given may do something."""
    place = [a.arg for a in function.args.args].index(parameter)
    at = place - name.startswith(".")
    handed = [call.args[at] for call in calls if at < len(call.args)]
    handed += [k.value for call in calls for k in call.keywords if k.arg == parameter]
    if any(does_something(value) for value in handed):
        return False
    for call in calls:
        if at < len(call.args):
            del call.args[at]
        call.keywords = [k for k in call.keywords if k.arg != parameter]
    first = len(function.args.args) - len(function.args.defaults)
    if place >= first:
        del function.args.defaults[place - first]
    del function.args.args[place]
    return True


class _Trusting(ast.NodeTransformer):
    """Leaves out `if ...: raise ...` where finding out does nothing else."""

    def visit_If(self, node: ast.If) -> ast.stmt | None:
        """A branch that only refuses goes; so does such an `else`."""
        self.generic_visit(node)
        if len(node.orelse) == 1 and isinstance(node.orelse[0], ast.Raise):
            node.orelse = []
        refuses = len(node.body) == 1 and isinstance(node.body[0], ast.Raise) and not node.orelse
        names = any(isinstance(inner, ast.NamedExpr) for inner in ast.walk(node.test))
        return None if refuses and not names else _filled(node)

    def visit_FunctionDef(self, node: ast.FunctionDef) -> ast.stmt:
        """Whatever is left needs a statement."""
        self.generic_visit(node)
        return _filled(node)

    def visit_For(self, node: ast.For) -> ast.stmt | None:
        """A loop that only refused goes with what it did."""
        self.generic_visit(node)
        return _filled(node) if node.body or does_something(node.iter) and not _is_look(node.iter) else None


def _filled(node: ast.If | ast.For | ast.FunctionDef) -> ast.stmt:
    node.body = node.body or [ast.Pass()]
    return node


def _is_look(node: ast.expr) -> bool:
    """Whether something is name.items() or the like."""
    return isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute) and node.func.attr in ("items", "values")


class _Plain(_Trusting):
    """Leaves out calls of functions that do nothing any more, and puts those of one step in their place."""

    def __init__(self, empty: set[str], short: Mapping[str, _Step]) -> None:
        self.empty, self.short, self.found = empty, short, False

    def visit_Expr(self, node: ast.Expr) -> ast.stmt | None:
        """A call whose result nobody takes."""
        self.generic_visit(node)
        call = node.value
        if isinstance(call, ast.Call):
            given = [*call.args, *(k.value for k in call.keywords)]
            if _called(call) not in self.empty or any(map(does_something, given)):
                return node
        elif not isinstance(call, ast.Name):
            return node
        self.found = True
        return None

    def visit_Call(self, node: ast.Call) -> ast.expr:
        """A call that is as good as what it is given, or as another one."""
        self.generic_visit(node)
        step = self.short.get(_called(node))
        if step is None or len(node.args) != 1 or node.keywords or isinstance(node.args[0], ast.Starred):
            return node
        self.found = True
        return ast.Call(ast.Name(step[0], ast.Load()), node.args, []) if step[0] else node.args[0]

    def visit_IfExp(self, node: ast.IfExp) -> ast.expr:
        """`None if a is None else a`, which is a."""
        self.generic_visit(node)
        same = isinstance(node.orelse, ast.Name) and ast.unparse(node.test) == f"{node.orelse.id} is None"
        return node.orelse if same and isinstance(node.body, ast.Constant) and node.body.value is None else node
