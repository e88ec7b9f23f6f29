# SPDX-License-Identifier: GPL-3.0-or-later
"""Arguments without a name, put where they can only be meant: a point is no edge, and a number no place.

Whoever writes cylinder(0.1, 0.4, 0.005, at=(0, 0, 1)) means an edge of 5 mm: `at` is given once already.
"""

from __future__ import annotations

import functools
import itertools
from collections.abc import Callable
from typing import Any, TypeVar

from .checks import is_number

Made = TypeVar("Made")
LAST = ("at", "seed", "segments", "rings", "axis", "smooth")
"""Parameters that nearly all makers have: a number in another's place is rather one of the others."""
LISTS = ("outline", "outlines", "points", "profile", "heights")
NUMBERS = ("height", "count", "nx", "ny", "sides", "thickness")
FEWEST_SEGMENTS = 3


def by_kind(make: Callable[..., Made]) -> Callable[..., Made]:
    """A maker that takes arguments out of their order where their kinds tell which is which.

    A call that fits as it stands is left as it is, and one that fits in no way too, for the error that it deserves.
    """
    function: Any = make
    names: tuple[str, ...] = function.__code__.co_varnames[: function.__code__.co_argcount]
    values = function.__defaults__ or ()
    count = len(names) - len(values)
    defaults = dict(zip(names[count:], values, strict=True))

    @functools.wraps(make)
    def made(*args: Any, **named: Any) -> Made:
        if len(args) > 1:
            args = in_order(names[:count], args, named)
        if len(args) > count:
            args, named = in_places(names[count:], defaults, args[:count], args[count:], named)
        return make(*args, **named)

    return made


def in_order(names: tuple[str, ...], args: tuple[Any, ...], named: dict[str, Any]) -> tuple[Any, ...]:
    """Required arguments in the order of their parameters: extrude(0.1, outline) has them the other way round."""
    given, rest = args[: len(names)], args[len(names) :]
    if any(name in named for name in names) or all(map(is_meant, names, given)):
        return args
    orders = (order for order in itertools.permutations(given) if all(map(is_meant, names, order)))
    return (*next(orders, given), *rest)


def is_meant(name: str, value: Any) -> bool:
    """Whether a required parameter may have the value, as far as its name tells."""
    if name in LISTS:
        return isinstance(value, (list, tuple))
    return name not in NUMBERS or is_number(value)


def in_places(
    names: tuple[str, ...],
    defaults: dict[str, Any],
    required: tuple[Any, ...],
    given: tuple[Any, ...],
    named: dict[str, Any],
) -> tuple[tuple[Any, ...], dict[str, Any]]:
    """Arguments for the parameters with defaults, each at the next place, else at the first that is of its kind."""
    free = [name for name in names if name not in named]
    own = free[: len(given)] == list(names[: len(given)]) and len(given) <= len(names)
    if own and all(fits(name, defaults[name], value) for name, value in zip(names, given, strict=False)):
        return (*required, *given), named
    others = [n for n in free if n not in LAST] + [n for n in LAST if n in free]
    found: dict[str, Any] = {}
    for value in given:
        expected = next((n for n in names if n not in found), "")  # what stood elsewhere takes no place here
        name = next(
            (n for n in (expected, *others) if n in free and n not in found and fits(n, defaults[n], value)), None
        )
        if name is None:
            return (*required, *given), named
        found[name] = value
    return required, {**named, **found}


def fits(name: str, default: Any, value: Any) -> bool:
    """Whether a value is of the kind that a parameter takes, which its default tells."""
    if name == "seed":
        return is_number(value) or isinstance(value, str)
    if isinstance(default, bool):
        return isinstance(value, bool)
    if isinstance(default, str):
        return isinstance(value, str)
    several = isinstance(value, (list, tuple))
    if isinstance(default, tuple):
        numbers = several and all(map(is_number, value))
        return numbers and len(value) == len(default) if default else several and not numbers or value == ()
    if name == "hang" and several:
        return len(value) == 4
    if default is None and value is None:
        return True
    if not is_number(value):
        return False
    whole = float(value).is_integer()
    if name in ("segments", "rings"):
        return whole and value >= FEWEST_SEGMENTS
    return whole if isinstance(default, int) else bool(name != "edge" or value < FEWEST_SEGMENTS)
