# SPDX-License-Identifier: GPL-3.0-or-later
"""One look that was decided for a part, before it has a name; and looks checked by evaluating them."""

from __future__ import annotations

import re
from dataclasses import dataclass, replace

from ..artifacts.materials import MaterialSource
from ..errors import ProgramError
from ..program.evaluate import call_function
from ..program.limits import Limits
from ..program.prelude.looks import Look
from ..program.prelude.registry import LOOKS

MAPS = frozenset({"noise_map", "wave_map", "voronoi_map", "brick_map", "picture", "ramp", "mix", "bump"})
FAMILIES = tuple(name for name in LOOKS if name not in MAPS and name != "principled")
"""Families of looks that a part may be made of."""
LIMITS = Limits(text_bytes=6000, steps=50_000, vertices=0, seconds=2.0)
"""For one look that a model wrote."""


@dataclass(frozen=True)
class Choice:
    """What a part is made of.

    Attributes:
        family: one of `FAMILIES`, or "principled" for a material program.
        code: its colour, six sRGB digits; with a program the mean of what it makes.
        options: parameters as they are written, in alphabetical order. program: the expression of a look of its own.
        word: what to name it by, such as "oak"; "" for the family.
    """

    family: str
    code: str
    options: tuple[tuple[str, str], ...] = ()
    program: str = ""
    word: str = ""
    why: str = ""
    source: MaterialSource = "measured"

    @property
    def expression(self) -> str:
        """How it is written in the room language."""
        if self.program:
            return self.program
        given = "".join(f", {name}={value}" for name, value in self.options)
        return f'{self.family}("#{self.code}"{given})'

    def because(self, why: str, source: MaterialSource) -> Choice:
        """The same, for another reason."""
        return replace(self, why=why, source=source)


def look_of(expression: str) -> Look:
    """The look that an expression of the room language means; it is read by the interpreter, never run as Python.

    Statements may come before a last expression.

    Raises:
        ProgramError: it is outside of the language, over a limit, or no look.
    """
    lines = expression.strip().splitlines()
    if not lines:
        raise ProgramError("the material program is empty")
    # The last statement begins at the last line that is not indented and closes nothing.
    last = max(n for n, line in enumerate(lines) if n == 0 or (line[:1].strip() and line[0] not in ")]}#"))
    lines[last] = re.sub(r"^[A-Za-z_]\w*\s*=(?!=)\s*", "", lines[last])
    lines[last] = "return " + lines[last].removeprefix("return ").lstrip()
    text = "def made_look():\n" + "\n".join(f"    {line}" for line in lines) + "\n"
    found = call_function(text, "made_look", (), LIMITS)
    if not isinstance(found, Look):
        raise ProgramError("the material program must end in a look, such as principled(...)")
    return found
