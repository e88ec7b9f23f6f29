# SPDX-License-Identifier: GPL-3.0-or-later
"""Other ways to write a text with values in it, as the f-strings that the room language has."""

from __future__ import annotations

import ast
import re
import string
from collections.abc import Sequence

_SIGN = re.compile(r"%(?:(%)|(0?[0-9]*(?:\.[0-9]+)?)([dsfgi]))")


def percent(text: str, values: ast.expr) -> ast.expr | None:
    """ "leg_%d" % i; None where it says more than f-strings of the language can."""
    given = list(values.elts) if isinstance(values, ast.Tuple) else [values]
    parts: list[ast.expr] = []
    last = 0
    for sign in _SIGN.finditer(text):
        parts.append(ast.Constant(text[last : sign.start()] + (sign.group(1) or "")))
        last = sign.end()
        if sign.group(1):
            continue
        if not given:
            return None
        spec, kind = sign.group(2), sign.group(3)
        if kind == "s" and spec:
            return None
        parts.append(field(given.pop(0), "" if kind == "s" else f"{spec}{'d' if kind == 'i' else kind}"))
    if given or "%" in text[last:]:
        return None
    return ast.JoinedStr([*parts, ast.Constant(text[last:])])


def formatted(text: str, values: Sequence[ast.expr]) -> ast.expr | None:
    """ "leg_{}".format(i); None where fields have names, or say more than f-strings of the language can."""
    parts: list[ast.expr] = []
    try:
        fields = list(string.Formatter().parse(text))
    except ValueError:
        return None
    for at, (words, name, spec, conversion) in enumerate(fields):
        parts.append(ast.Constant(words))
        if name is None:
            continue
        number = name or str(sum(1 for f in fields[:at] if f[1] is not None))
        if conversion or not number.isdigit() or int(number) >= len(values) or "{" in (spec or ""):
            return None
        parts.append(field(values[int(number)], spec or ""))
    return ast.JoinedStr(parts)


def field(value: ast.expr, spec: str) -> ast.FormattedValue:
    """{value:spec}"""
    return ast.FormattedValue(value, -1, ast.JoinedStr([ast.Constant(spec)]) if spec else None)
