# SPDX-License-Identifier: GPL-3.0-or-later
"""f-strings: which formats of numbers are in the language, and how a field becomes text."""

from __future__ import annotations

import ast
import re
from typing import Any

from ..errors import ProgramError
from .limits import Meter
from .values import NUMBERS, Code, Frame, plain_text, settle

FORMAT = re.compile(r"0?[0-9]{0,2}(?:\.[0-9]{1,2})?[dfg]?")
"""[0][width of at most two digits][.precision of at most two digits][d, f or g]"""


def spec_of(node: ast.expr) -> str | None:
    """The constant text of a format, None when it is computed."""
    if not isinstance(node, ast.JoinedStr):
        return None
    texts = [part.value for part in node.values if isinstance(part, ast.Constant) and isinstance(part.value, str)]
    return "".join(texts) if len(texts) == len(node.values) else None


def field(meter: Meter, value: Code, spec: str) -> Code:
    """One field of an f-string."""
    if not spec:
        return lambda f: plain_text(meter, value(f))

    def run(f: Frame) -> Any:
        v = value(f)
        if v.__class__ not in NUMBERS:
            raise ProgramError(f"only numbers can have the format :{spec}")
        return format(v, spec)

    return run


def joined(meter: Meter, parts: tuple[Code, ...]) -> Code:
    """A whole f-string."""
    return lambda f: settle(meter, "".join([part(f) for part in parts]))
