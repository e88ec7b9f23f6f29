# SPDX-License-Identifier: GPL-3.0-or-later
"""Rows of books and of clothes: one program makes them all, each with a seed of its own, so that no two are the same."""

from __future__ import annotations

import ast
import math
import re
from collections.abc import Sequence

from ..artifacts.layout import ProxyLine
from ..errors import ProgramError
from ..library import catalogue
from ..program.evaluate import evaluate_object
from .checks import check
from .text import library_names
from .written import Written

VARIED = re.compile(r"\b(books?|magazines|clothes|clothing|garments?)\b", re.IGNORECASE)
"""What is never twice the same: two rows of the same spines are seen to be copies at once."""
_SIZE = math.log(1.35)
SEED = "seed"


def is_varied(proxy: ProxyLine) -> bool:
    """Whether an object is a row of things that all differ."""
    return VARIED.search(proxy.category.replace("_", " ")) is not None


def rows(proxies: Sequence[ProxyLine]) -> dict[str, str]:
    """The id of each row that another row's program can make with another seed -> the id of that one, its first.

    Same category and placement, sizes within a third of each other. The first of each kind is not among the keys.
    """
    firsts: list[ProxyLine] = []
    found: dict[str, str] = {}
    for proxy in proxies:
        if not is_varied(proxy):
            continue
        first = next((f for f in firsts if _same_kind(f, proxy)), None)
        if first is None:
            firsts.append(proxy)
        else:
            found[proxy.id] = first.id
    return found


def _same_kind(a: ProxyLine, b: ProxyLine) -> bool:
    if (a.category.lower(), a.placement, a.shape) != (b.category.lower(), b.placement, b.shape):
        return False
    return all(abs(math.log(max(x, 1e-3) / max(y, 1e-3))) < _SIZE for x, y in zip(a.size, b.size, strict=True))


def another(first: Written, proxy: ProxyLine, name: str, seed: int) -> Written | None:
    """One more row by the first one's program; None where that cannot make one of this size.

    Args:
        name: of its def. seed: its own; a program that takes none makes the same row again.
    """
    maker = _maker(first.code)
    call = f"{maker}(size, {seed})" if maker else f"{first.name}(size)"
    code = f"{first.code}\n\n\ndef {name}(size):\n    return fill({call}, size)"
    size = tuple(float(v) for v in proxy.size)
    try:
        shapes = evaluate_object(f"{catalogue.source(sorted(library_names(code)))}\n\n{code}", name, args=(size,))
    except ProgramError:
        return None
    shapes = [shape for shape in shapes if len(shape.vertices)]
    return Written(name, code, tuple(shapes), check(shapes, size, proxy.placement)) if shapes else None


def _maker(code: str) -> str:
    """The def of a program that takes a seed after the size; "" for none."""
    for node in ast.parse(code).body:
        if isinstance(node, ast.FunctionDef) and [a.arg for a in node.args.args[1:]] == [SEED]:
            return node.name
    return ""
