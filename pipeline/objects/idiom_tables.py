# SPDX-License-Identifier: GPL-3.0-or-later
"""Dicts of options, and defs that yield: what has to be known of a whole program or def before it is rewritten."""

from __future__ import annotations

import ast

from .idiom_nodes import call_of, name_of, stored


def constant_tables(tree: ast.Module) -> dict[str, tuple[str, ...]]:
    """Names that are bound once, to a dict whose keys are written out, and that nothing changes: their keys."""
    bound: dict[str, int] = {}
    found: dict[str, tuple[str, ...]] = {}
    for node in ast.walk(tree):
        if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store):
            bound[node.id] = bound.get(node.id, 0) + 1
        elif isinstance(node, ast.arg):
            bound[node.arg] = bound.get(node.arg, 0) + 2
        elif isinstance(node, ast.Subscript) and isinstance(node.ctx, ast.Store) and isinstance(node.value, ast.Name):
            bound[node.value.id] = 2
        elif isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name):
            if node.attr in ("update", "pop", "setdefault", "clear"):
                bound[node.value.id] = 2
        elif isinstance(node, ast.Assign) and len(node.targets) == 1 and isinstance(node.targets[0], ast.Name):
            keys = keys_of(node.value)
            if keys is not None:
                found[node.targets[0].id] = keys
    return {name: keys for name, keys in found.items() if bound.get(name) == 1}


def keys_of(node: ast.expr) -> tuple[str, ...] | None:
    """The keys of a dict that is written out, where all are texts."""
    if isinstance(node, ast.Dict):
        keys = [k.value for k in node.keys if isinstance(k, ast.Constant) and isinstance(k.value, str)]
        return tuple(keys) if len(keys) == len(node.keys) else None
    if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id == "dict" and not node.args:
        given = [k.arg for k in node.keywords if k.arg]
        return tuple(given) if len(given) == len(node.keywords) else None
    return None


def own_nodes(node: ast.FunctionDef) -> list[ast.AST]:
    """The nodes of a def outside of the defs and lambdas in it."""
    waiting: list[ast.AST] = list(node.body)
    found: list[ast.AST] = []
    while waiting:
        part = waiting.pop()
        if not isinstance(part, (ast.FunctionDef, ast.Lambda)):
            found.append(part)
            waiting += ast.iter_child_nodes(part)
    return found


class Filling(ast.NodeTransformer):
    """Puts append in the place of yield, in one def."""

    def __init__(self, held: str, value: str) -> None:
        self.held, self.value = held, value

    def filled(self, node: ast.FunctionDef) -> ast.FunctionDef:
        """The def with its list made first and returned last."""
        body = [self.visit(n) for n in node.body]
        node.body = [ast.Assign([stored(self.held)], ast.List([], ast.Load())), *body, ast.Return(name_of(self.held))]
        return node

    def visit_FunctionDef(self, node: ast.FunctionDef) -> ast.AST:
        """Defs inside have their own."""
        return node

    def visit_Lambda(self, node: ast.Lambda) -> ast.AST:
        """And so have lambdas."""
        return node

    def visit_Return(self, node: ast.Return) -> ast.AST:
        """return ends it."""
        return ast.Return(name_of(self.held))

    def visit_Expr(self, node: ast.Expr) -> ast.AST:
        """yield x, yield from xs"""
        asked = node.value
        if isinstance(asked, ast.Yield):
            return ast.Expr(call_of("append", name_of(self.held), asked.value or ast.Constant(None)))
        if isinstance(asked, ast.YieldFrom):
            added = ast.Expr(call_of("append", name_of(self.held), name_of(self.value)))
            return ast.For(stored(self.value), asked.value, [added], [])
        return node
