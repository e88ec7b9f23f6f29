# SPDX-License-Identifier: GPL-3.0-or-later
"""Ways of writing in Python that the room language has other words for: while, dict.get, str.format, map, *shapes, ...

Each is rewritten only where the room language can say exactly the same; anything else is left for the language's own
checks to refuse. Nothing is run, and what comes out is counted and limited as any program.
"""

from __future__ import annotations

import ast

from .idiom_calls import Calls
from .idiom_nodes import call_of, item_of, name_of, pair, simple, stored, table, targets
from .idiom_tables import Filling, own_nodes
from .idiom_texts import percent

_MOST_TURNS = 1_000_000
"""More than the steps of any program allow; so a while that would not end is stopped as one that goes on too long."""

_ONCE = frozenset({"reversed", "zip", "enumerate", "range"})


class Idioms(Calls):
    """Rewrites one program."""

    # ---- statements ----

    def visit_If(self, node: ast.If) -> ast.AST:
        """if __name__ == "__main__" is for whoever runs a file."""
        if any(isinstance(n, ast.Name) and n.id == "__name__" for n in ast.walk(node.test)):
            return ast.Pass()
        return self.generic_visit(node)

    def visit_Raise(self, node: ast.Raise) -> ast.AST:
        """What is refused would be refused by the shapes' own checks."""
        return ast.Pass()

    def visit_Try(self, node: ast.Try) -> list[ast.stmt]:
        """What cannot fail needs no handlers; what fails ends the program."""
        self.generic_visit(node)
        return [*node.body, *node.orelse, *node.finalbody]

    def visit_While(self, node: ast.While) -> ast.AST:
        """A for of more turns than any program can take, with the condition in it."""
        if node.orelse:
            return self.generic_visit(node)
        endless = isinstance(node.test, ast.Constant) and bool(node.test.value)
        stop = [] if endless else [ast.If(ast.UnaryOp(ast.Not(), node.test), [ast.Break()], [])]
        turns = call_of("range", ast.Constant(_MOST_TURNS))
        return self.generic_visit(ast.For(stored(self.fresh("once_more")), turns, [*stop, *node.body], []))

    def visit_Assign(self, node: ast.Assign) -> ast.AST | list[ast.stmt]:
        """first, *rest = values"""
        self.generic_visit(node)
        target = node.targets[0]
        if len(node.targets) > 1 or not isinstance(target, (ast.Tuple, ast.List)):
            return node
        stars = [i for i, t in enumerate(target.elts) if isinstance(t, ast.Starred)]
        if len(stars) != 1:
            return node
        held, star = self.fresh("unpacked"), stars[0]
        after = len(target.elts) - star - 1
        found: list[ast.stmt] = [ast.Assign([stored(held)], call_of("list", node.value))]
        for place, item in enumerate(target.elts):
            if isinstance(item, ast.Starred):
                end = ast.Constant(-after) if after else None
                index: ast.expr = ast.Slice(ast.Constant(star), end)
                item = item.value
            else:
                index = ast.Constant(place if place < star else place - len(target.elts))
            found.append(ast.Assign([item], ast.Subscript(name_of(held), index, ast.Load())))
        return found

    def visit_Expr(self, node: ast.Expr) -> ast.AST:
        """values.sort(), values.reverse(), values.insert(0, x), table.update(more), and a lone ..."""
        if isinstance(node.value, ast.Constant) and node.value.value is Ellipsis:
            return ast.Pass()
        self.generic_visit(node)
        call = node.value
        if not isinstance(call, ast.Call) or not isinstance(call.func, ast.Attribute):
            return node
        return self.changed_in_place(call, call.func.attr, call.func.value) or node

    def changed_in_place(self, call: ast.Call, word: str, held: ast.expr) -> ast.stmt | None:
        """A loop that puts items back into a list or dict, which stays the same one wherever else it is known."""
        if not simple(held):
            return None
        if word == "update" and len(call.args) + len(call.keywords) >= 1 and all(k.arg for k in call.keywords):
            key, value = self.fresh("key"), self.fresh("value")
            pairs: list[ast.expr] = [ast.Starred(call_of("items", more), ast.Load()) for more in call.args]
            pairs += [pair(ast.Constant(k.arg), k.value) for k in call.keywords]
            stored = ast.Assign([item_of(held, key, ast.Store())], name_of(value))
            return ast.For(targets(key, value), ast.List(pairs, ast.Load()), [stored], [])
        if word == "sort" and not call.args:
            order: ast.expr = ast.Call(name_of("sorted"), [held], call.keywords)
        elif word == "reverse" and not call.args and not call.keywords:
            order = ast.Subscript(held, ast.Slice(step=ast.Constant(-1)), ast.Load())
        elif word == "insert" and len(call.args) == 2 and simple(call.args[0]):
            place = call.args[0]
            before: list[ast.expr] = [ast.Starred(ast.Subscript(held, ast.Slice(upper=place), ast.Load()), ast.Load())]
            behind = ast.Starred(ast.Subscript(held, ast.Slice(lower=place), ast.Load()), ast.Load())
            order = ast.List([*before, call.args[1], behind], ast.Load())
        else:
            return None
        number, value = self.fresh("place"), self.fresh("value")
        put: ast.stmt = ast.Assign([item_of(held, number, ast.Store())], name_of(value))
        if word == "insert":
            fits = ast.Compare(name_of(number), [ast.Lt()], [call_of("len", held)])
            put = ast.If(fits, [put], [ast.Expr(call_of("append", held, name_of(value)))])
        return ast.For(targets(number, value), call_of("enumerate", order), [put], [])

    def visit_FunctionDef(self, node: ast.FunctionDef) -> ast.AST:
        """def with yield: a list is filled and returned."""
        own = list(own_nodes(node))
        asked = [n for n in own if isinstance(n, (ast.Yield, ast.YieldFrom))]
        alone = [n.value for n in own if isinstance(n, ast.Expr)]
        if asked and all(n in alone for n in asked) and not any(isinstance(n, ast.Return) and n.value for n in own):
            held = self.fresh("yielded")
            node = Filling(held, self.fresh("value")).filled(node)
        return self.generic_visit(node)

    # ---- expressions ----

    def visit_Compare(self, node: ast.Compare) -> ast.AST:
        """is True, is False"""
        for place, (sign, other) in enumerate(zip(node.ops, node.comparators, strict=True)):
            if isinstance(other, ast.Constant) and isinstance(other.value, bool):
                if isinstance(sign, ast.Is):
                    node.ops[place] = ast.Eq()
                elif isinstance(sign, ast.IsNot):
                    node.ops[place] = ast.NotEq()
        return self.generic_visit(node)

    def visit_BinOp(self, node: ast.BinOp) -> ast.AST:
        """i & 1, 1 << n, n >> 1, "leg_%d" % i, a + reversed(b)"""
        self.generic_visit(node)
        if isinstance(node.op, ast.BitAnd) and isinstance(node.right, ast.Constant) and node.right.value == 1:
            return ast.BinOp(node.left, ast.Mod(), ast.Constant(2))
        if isinstance(node.op, (ast.LShift, ast.RShift)):
            power = ast.BinOp(ast.Constant(2), ast.Pow(), node.right)
            return ast.BinOp(node.left, ast.Mult() if isinstance(node.op, ast.LShift) else ast.FloorDiv(), power)
        if isinstance(node.op, ast.Mod) and isinstance(node.left, ast.Constant) and isinstance(node.left.value, str):
            return percent(node.left.value, node.right) or node
        if isinstance(node.op, ast.Add):
            node.left, node.right = _as_list(node.left), _as_list(node.right)
        return node

    def visit_FormattedValue(self, node: ast.FormattedValue) -> ast.AST:
        """{name!s}"""
        if node.conversion == ord("s") and node.format_spec is None:
            node.conversion = -1
        return self.generic_visit(node)

    def visit_Dict(self, node: ast.Dict) -> ast.AST:
        """{**a, "b": 2}"""
        self.generic_visit(node)
        if all(node.keys):
            return node
        key, value = self.fresh("key"), self.fresh("value")
        pairs = [
            ast.Starred(call_of("items", v), ast.Load()) if k is None else pair(k, v)
            for k, v in zip(node.keys, node.values, strict=True)
        ]
        return table(key, value, ast.List(pairs, ast.Load()))

    def visit_SetComp(self, node: ast.SetComp) -> ast.AST:
        """{x for x in xs}: each once, in the order of their first."""
        self.generic_visit(node)
        return call_of("keys", ast.DictComp(node.elt, ast.Constant(True), node.generators))


def _as_list(node: ast.expr) -> ast.expr:
    """What is gone through once, as a list that something can be added to."""
    once = isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id in _ONCE
    return call_of("list", node) if once else node
