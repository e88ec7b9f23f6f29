# SPDX-License-Identifier: GPL-3.0-or-later
"""Small pieces of syntax trees."""

from __future__ import annotations

import ast


def simple(node: ast.expr) -> bool:
    """Whether it may be read twice: nothing in it is called."""
    return not any(isinstance(n, (ast.Call, ast.NamedExpr, ast.ListComp, ast.DictComp)) for n in ast.walk(node))


def name_of(name: str) -> ast.Name:
    """A variable that is read."""
    return ast.Name(name, ast.Load())


def stored(name: str) -> ast.Name:
    """A variable that is set."""
    return ast.Name(name, ast.Store())


def targets(*names: str) -> ast.expr:
    """Several variables that are set at once."""
    return ast.Tuple([stored(name) for name in names], ast.Store())


def pair(key: ast.expr, value: ast.expr) -> ast.expr:
    """(key, value)"""
    return ast.Tuple([key, value], ast.Load())


def at_key(name: str, key: str) -> ast.expr:
    """The value that a dict holds for a text."""
    return ast.Subscript(name_of(name), ast.Constant(key), ast.Load())


def item_of(held: ast.expr, index: str, context: ast.expr_context) -> ast.expr:
    """held[index]"""
    return ast.Subscript(held, name_of(index), context)


def loop(target: ast.expr, source: ast.expr) -> ast.comprehension:
    """for target in source, of a comprehension."""
    return ast.comprehension(target, source, [], 0)


def table(key: str, value: str, pairs: ast.expr) -> ast.expr:
    """{key: value for key, value in pairs}"""
    return ast.DictComp(name_of(key), name_of(value), [loop(targets(key, value), pairs)])


def call_of(name: str, *arguments: ast.expr) -> ast.Call:
    """name(arguments)"""
    return ast.Call(name_of(name), list(arguments), [])
