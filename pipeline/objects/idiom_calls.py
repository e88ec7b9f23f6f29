# SPDX-License-Identifier: GPL-3.0-or-later
"""Functions and methods of Python that the room language has other words for."""

from __future__ import annotations

import ast
import math

from ..program.prelude import registry
from .idiom_nodes import at_key, call_of, loop, name_of, simple, stored, table, targets
from .idiom_tables import constant_tables
from .idiom_texts import formatted

_MODULES = frozenset({"math", "np", "numpy", "itertools"})
_WORDS: dict[str, str] = {"clip": "clamp", "deg2rad": "radians", "rad2deg": "degrees", "arctan2": "atan2", "arctan": "atan",
                          "arcsin": "asin", "arccos": "acos", "trunc": "int", "absolute": "abs"}  # fmt: skip
_NUMBERS = {"e": math.e, "inf": 1e9, "infty": 1e9}
"""Endless is larger than anything that fits into a room."""
_OPERATIONS = frozenset({"move", "turn", "scale", "mirror", "array", "bevel", "subdivide", "solidify", "displace", "taper",
                         "bend", "smooth", "translate", "rotate", "tint"})  # fmt: skip


class Calls(ast.NodeTransformer):
    """Rewrites the calls and names of one program.

    Args:
        tree: the whole program, for the names in it.
    """

    def __init__(self, tree: ast.Module) -> None:
        names = {n.id for n in ast.walk(tree) if isinstance(n, ast.Name)} | {
            n.arg for n in ast.walk(tree) if isinstance(n, ast.arg)
        }
        bound = {n.id for n in ast.walk(tree) if isinstance(n, ast.Name) and isinstance(n.ctx, ast.Store)}
        self.bound = bound | {n.arg for n in ast.walk(tree) if isinstance(n, ast.arg)}
        self.taken = names | {n.name for n in ast.walk(tree) if isinstance(n, ast.FunctionDef)}
        self.modules = set(_MODULES)
        self.aliases: dict[str, str] = {}
        self.tables = constant_tables(tree)
        for node in ast.walk(tree):
            if isinstance(node, (ast.Import, ast.ImportFrom)):
                self.imported(node)

    def imported(self, node: ast.Import | ast.ImportFrom) -> None:
        """What modules and their functions are called here."""
        for alias in node.names:
            if isinstance(node, ast.Import) and alias.name in _MODULES and alias.asname:
                self.modules.add(alias.asname)
            elif isinstance(node, ast.ImportFrom) and node.module in _MODULES:
                name = alias.asname or alias.name
                if name not in self.bound:
                    self.aliases[name] = alias.name

    def fresh(self, name: str) -> str:
        """A name that nothing in the program has."""
        found = name
        number = 0
        while found in self.taken or found in registry.RESERVED:
            number += 1
            found = f"{name}_{number}"
        self.taken.add(found)
        return found

    def visit_Name(self, node: ast.Name) -> ast.AST:
        """What was imported under another name."""
        if isinstance(node.ctx, ast.Load) and node.id in self.aliases:
            return self.module_word(self.aliases[node.id])
        return node

    def visit_Attribute(self, node: ast.Attribute) -> ast.AST:
        """math.e, m.sin"""
        if isinstance(node.value, ast.Name) and node.value.id in self.modules:
            return self.module_word(node.attr)
        return self.generic_visit(node)

    def module_word(self, word: str) -> ast.expr:
        """A word of Python's math or of numpy."""
        if word in _NUMBERS:
            return ast.Constant(_NUMBERS[word])
        return name_of(_WORDS.get(word, word))

    def visit_Call(self, node: ast.Call) -> ast.AST:
        """Functions and methods that the language has other words for."""
        self.generic_visit(node)
        self.spread(node)
        if isinstance(node.func, ast.Attribute):
            return self.method(node, node.func) or node
        if isinstance(node.func, ast.Name):
            return self.function(node, node.func.id) or node
        return node

    def spread(self, node: ast.Call) -> None:
        """f(**options) of a dict that is written out once, key by key."""
        found: list[ast.keyword] = []
        for keyword in node.keywords:
            held = keyword.value
            if keyword.arg is None and isinstance(held, ast.Name) and held.id in self.tables:
                found += [ast.keyword(key, at_key(held.id, key)) for key in self.tables[held.id]]
            else:
                found.append(keyword)
        node.keywords = found

    def method(self, node: ast.Call, func: ast.Attribute) -> ast.expr | None:
        """table.get(key, other), "leg_{}".format(i), name.startswith("leg"), shapes.move(...)"""
        held, word, given = func.value, func.attr, node.args
        if word == "get" and 1 <= len(given) <= 2 and simple(held) and simple(given[0]) and not node.keywords:
            other = given[1] if len(given) == 2 else ast.Constant(None)
            known = ast.Compare(given[0], [ast.In()], [held])
            return ast.IfExp(known, ast.Subscript(held, given[0], ast.Load()), other)
        if isinstance(held, ast.Constant) and isinstance(held.value, str) and word == "format" and not node.keywords:
            return formatted(held.value, given)
        if word in ("startswith", "endswith") and len(given) == 1 and isinstance(given[0], ast.Constant):
            size = len(str(given[0].value))
            part = ast.Slice(upper=ast.Constant(size)) if word == "startswith" else ast.Slice(ast.Constant(-size))
            return ast.Compare(ast.Subscript(held, part, ast.Load()), [ast.Eq()], [given[0]]) if size else None
        if word in _OPERATIONS and not isinstance(held, ast.Constant):
            return ast.Call(name_of(word), [held, *given], node.keywords)
        return None

    def function(self, node: ast.Call, name: str) -> ast.expr | None:
        """map, filter, divmod, set, dict, float("inf"), and functions of math, numpy and itertools."""
        given = node.args
        if name in ("product", "chain") and given and name not in self.taken - set(self.aliases):
            return self.iterated(name, given, node.keywords)
        if node.keywords or any(isinstance(a, ast.Starred) for a in given):
            return None
        if name == "map" and len(given) >= 2:
            return self.mapped(given[0], given[1:])
        if name == "filter" and len(given) == 2:
            return self.filtered(given[0], given[1])
        if name in ("set", "frozenset", "dict") and len(given) == 1:
            key, value = self.fresh("key"), self.fresh("value")
            if name == "dict":
                return table(key, value, given[0])
            return call_of("keys", ast.DictComp(name_of(key), ast.Constant(True), [loop(stored(key), given[0])]))
        if name == "dist" and len(given) == 2:
            one, other = self.fresh("one"), self.fresh("other")
            apart = ast.BinOp(name_of(one), ast.Sub(), name_of(other))
            sides = ast.ListComp(apart, [loop(targets(one, other), call_of("zip", *given))])
            return call_of("hypot", ast.Starred(sides, ast.Load()))
        if name == "linspace" and len(given) == 3 and all(map(simple, given)):
            step = self.fresh("step")
            most = call_of("max", ast.BinOp(given[2], ast.Sub(), ast.Constant(1)), ast.Constant(1))
            share = ast.BinOp(name_of(step), ast.Div(), most)
            return ast.ListComp(
                call_of("lerp", given[0], given[1], share), [loop(stored(step), call_of("range", given[2]))]
            )
        return worked_out(name, given)

    def iterated(self, name: str, given: list[ast.expr], keywords: list[ast.keyword]) -> ast.expr | None:
        """itertools.product and chain."""
        if name == "chain" and not keywords:
            return ast.List([ast.Starred(a, ast.Load()) for a in given], ast.Load())
        times = keywords[0].value if len(keywords) == 1 and keywords[0].arg == "repeat" else None
        if (
            isinstance(times, ast.Constant)
            and isinstance(times.value, int)
            and 2 <= times.value <= 4
            and len(given) == 1
            and simple(given[0])
        ):
            given = given * times.value
        elif keywords:
            return None
        names = [self.fresh("item") for _ in given]
        loops = [loop(stored(n), a) for n, a in zip(names, given, strict=True)]
        return ast.ListComp(ast.Tuple([name_of(n) for n in names], ast.Load()), loops)

    def mapped(self, call: ast.expr, values: list[ast.expr]) -> ast.expr | None:
        """map(f, xs)"""
        names = [self.fresh("item") for _ in values]
        target = stored(names[0]) if len(names) == 1 else targets(*names)
        source = values[0] if len(values) == 1 else call_of("zip", *values)
        if isinstance(call, ast.Lambda) and len(call.args.args) == len(values) and not call.args.defaults:
            given = [a.arg for a in call.args.args]
            target = stored(given[0]) if len(given) == 1 else targets(*given)
            return ast.ListComp(call.body, [loop(target, source)])
        if not isinstance(call, ast.Name):
            return None
        return ast.ListComp(call_of(call.id, *map(name_of, names)), [loop(target, source)])

    def filtered(self, call: ast.expr, values: ast.expr) -> ast.expr | None:
        """filter(f, xs)"""
        item = self.fresh("item")
        test: ast.expr = name_of(item)
        if isinstance(call, ast.Lambda) and len(call.args.args) == 1 and not call.args.defaults:
            item, test = call.args.args[0].arg, call.body
        elif isinstance(call, ast.Name):
            test = call_of(call.id, name_of(item))
        elif not (isinstance(call, ast.Constant) and call.value is None):
            return None
        loop = ast.comprehension(stored(item), values, [test], 0)
        return ast.ListComp(name_of(item), [loop])


def worked_out(name: str, given: list[ast.expr]) -> ast.expr | None:
    """Functions of one or two numbers."""
    if name in ("log10", "log2") and len(given) == 1:
        return call_of("log", given[0], ast.Constant(int(name[3:])))
    if name == "copysign" and len(given) == 2:
        size = call_of("abs", given[0])
        sign = ast.Compare(given[1], [ast.GtE()], [ast.Constant(0)])
        return ast.IfExp(sign, size, ast.UnaryOp(ast.USub(), size))
    if name == "divmod" and len(given) == 2 and all(map(simple, given)):
        return ast.Tuple([ast.BinOp(given[0], sign, given[1]) for sign in (ast.FloorDiv(), ast.Mod())], ast.Load())
    word = given[0].value if name == "float" and len(given) == 1 and isinstance(given[0], ast.Constant) else None
    if isinstance(word, str) and word.strip().lower() in ("inf", "infinity", "+inf", "-inf", "-infinity"):
        return ast.Constant(-1e9 if word.strip().startswith("-") else 1e9)
    return None
