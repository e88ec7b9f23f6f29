# SPDX-License-Identifier: GPL-3.0-or-later
"""Names and parameters that the room language does not have: _helper, *shapes."""

from __future__ import annotations

import ast
import re

from ..program.prelude import registry


def with_own_names(tree: ast.Module) -> None:
    """Give what a program calls _so, itself, a name without the underscore. Names that it does not bind stay."""
    nodes = list(ast.walk(tree))
    bound = {n.id for n in nodes if isinstance(n, ast.Name) and isinstance(n.ctx, ast.Store)}
    bound |= {n.arg for n in nodes if isinstance(n, ast.arg)} | {
        n.name for n in nodes if isinstance(n, ast.FunctionDef)
    }
    taken = {n.id for n in nodes if isinstance(n, ast.Name)} | bound
    names: dict[str, str] = {}
    for old in sorted(name for name in bound if name.startswith("_") and name != "_"):
        base = re.sub(r"^_+", "", old) or "unused"
        base = base if base.isidentifier() else f"unused_{base}"
        number, new = 0, base
        while new in taken or new in registry.RESERVED:
            number += 1
            new = f"{base}_{number}"
        taken.add(new)
        names[old] = new
    for node in nodes:
        if isinstance(node, ast.Name):
            node.id = names.get(node.id, node.id)
        elif isinstance(node, (ast.arg, ast.keyword)):
            node.arg = names.get(node.arg or "", node.arg)
        elif isinstance(node, ast.FunctionDef):
            node.name = names.get(node.name, node.name)


def without_stars(tree: ast.Module) -> None:
    """def both(*shapes) as def both(shapes), where all its calls can be given one list."""
    nodes = list(ast.walk(tree))
    for node in [n for n in nodes if isinstance(n, ast.FunctionDef)]:
        given = node.args
        alone = not (given.kwonlyargs or given.kwarg or given.defaults or given.posonlyargs)
        if given.vararg is None or not alone:
            continue
        uses = [n for n in nodes if isinstance(n, ast.Name) and n.id == node.name]
        calls = [n for n in nodes if isinstance(n, ast.Call) and n.func in uses]
        count = len(given.args)
        others = [n for n in nodes if isinstance(n, ast.FunctionDef) and n.name == node.name]
        plain = all(
            not c.keywords and len(c.args) >= count and not any(isinstance(a, ast.Starred) for a in c.args[:count])
            for c in calls
        )
        if len(uses) != len(calls) or len(others) != 1 or not plain:
            continue
        for call in calls:
            call.args = [*call.args[:count], ast.Tuple(call.args[count:], ast.Load())]
        given.args.append(given.vararg)
        given.vararg = None
