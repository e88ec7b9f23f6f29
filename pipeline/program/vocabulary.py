# SPDX-License-Identifier: GPL-3.0-or-later
"""The names a program may use: Python's, those of the prelude's registry, and what a call of each is counted as."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

from .functions import metered_functions
from .limits import Meter
from .names import Known
from .values import Native, settle

FREE_LINES = frozenset({"furnish", "finish", "build"})
"""Lines whose arguments may be computed; all other lines are layout lines."""
STEPS: dict[str, int] = {"lerp": 4, "clamp": 4, "smoothstep": 4, "rand": 12, "noise": 12}
"""What a call of these constructors is counted as."""
STEPS_OF_CONSTRUCTOR = 60
FINITE = frozenset({"sin", "cos", "tan", "asin", "acos", "atan", "atan2", "sqrt", "exp", "log"})
"""Functions of math whose results are finite whenever their arguments are."""


@dataclass(frozen=True)
class Vocabulary:
    """What the language offers besides Python's own functions.

    Attributes:
        constructors: pure functions of the prelude by name.
        lines: names of layout lines, furnish and build.
        math: names of functions of Python's math module.
        constants: names with a fixed value.
        reserved: names that a program may not bind in the module.
    """

    constructors: Mapping[str, Callable[..., Any]]
    lines: tuple[str, ...] = ()
    math: tuple[str, ...] = ()
    constants: Mapping[str, Any] = field(default_factory=dict)
    reserved: frozenset[str] = frozenset()

    def natives(self, meter: Meter, lines: Mapping[str, Callable[..., Any]]) -> dict[str, Native]:
        """Everything that can be called, bound to one evaluation's meter and lines."""
        found = {
            name: Native(name, call, STEPS.get(name, STEPS_OF_CONSTRUCTOR), True, meter)
            for name, call in {**self.constructors, **lines}.items()
        }
        for name in self.math:
            call = getattr(math, name)
            found[name] = Native(name, call if name in FINITE else settled(meter, call), 1, False, meter)
        found.update(metered_functions(meter))
        return found

    def known(self, natives: Mapping[str, Native]) -> Known:
        """The names for the static checks."""
        lines = frozenset(self.lines)
        return Known(frozenset(natives) - lines, frozenset(self.constants), lines - FREE_LINES, lines, self.reserved)


def settled(meter: Meter, call: Callable[..., Any]) -> Callable[..., Any]:
    """The function with its result checked for size."""
    return lambda *args: settle(meter, call(*args))


def room_vocabulary() -> Vocabulary:
    """The room language as the prelude's registry defines it."""
    from .prelude import registry

    functions = {**registry.CONSTRUCTORS, **registry.LOOKS}
    return Vocabulary(functions, registry.LINE_NAMES, registry.MATH, registry.CONSTANTS, registry.RESERVED)
