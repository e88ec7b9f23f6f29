# SPDX-License-Identifier: GPL-3.0-or-later
"""Operators as closures: exactly Python's results, with the size of operands and results looked at.

Each function takes compiled operands and returns the compiled operation. Numbers take the short way; everything else,
and every result that is out of range, takes the long one.
"""

from __future__ import annotations

import operator
from collections.abc import Callable
from typing import Any

from ..errors import ProgramError
from .limits import Meter
from .values import (
    CONTAINERS,
    LARGEST_FLOAT,
    LARGEST_INT,
    NUMBERS,
    SIZED,
    Code,
    Frame,
    check_key,
    measure,
    settle,
    too_many,
)

Binary = Callable[[Meter, Code, Code], Code]
Values = Callable[[Meter, Any, Any], Any]
MOST_POWER_BITS = 80


def add(meter: Meter, left: Code, right: Code) -> Code:
    """left + right"""

    def run(f: Frame) -> Any:
        r = left(f) + right(f)
        if r.__class__ is float and -LARGEST_FLOAT <= r <= LARGEST_FLOAT:
            return r
        if r.__class__ is int and -LARGEST_INT <= r <= LARGEST_INT:
            return r
        return settle(meter, r)

    return run


def subtract(meter: Meter, left: Code, right: Code) -> Code:
    """left - right"""

    def run(f: Frame) -> Any:
        r = left(f) - right(f)
        if r.__class__ is float and -LARGEST_FLOAT <= r <= LARGEST_FLOAT:
            return r
        if r.__class__ is int and -LARGEST_INT <= r <= LARGEST_INT:
            return r
        return settle(meter, r)

    return run


def multiply(meter: Meter, left: Code, right: Code) -> Code:
    """left * right"""

    def run(f: Frame) -> Any:
        a = left(f)
        b = right(f)
        if a.__class__ is float or b.__class__ is float:
            r = a * b
            if -LARGEST_FLOAT <= r <= LARGEST_FLOAT:
                return r
            return settle(meter, r)
        return product(meter, a, b)

    return run


def divide(meter: Meter, left: Code, right: Code) -> Code:
    """left / right"""

    def run(f: Frame) -> Any:
        r = left(f) / right(f)
        if r.__class__ is float and -LARGEST_FLOAT <= r <= LARGEST_FLOAT:
            return r
        return settle(meter, r)

    return run


def floor_divide(meter: Meter, left: Code, right: Code) -> Code:
    """left // right"""

    def run(f: Frame) -> Any:
        return settle(meter, left(f) // right(f))

    return run


def modulo(meter: Meter, left: Code, right: Code) -> Code:
    """left % right"""

    def run(f: Frame) -> Any:
        return remainder(meter, left(f), right(f))

    return run


def raise_to(meter: Meter, left: Code, right: Code) -> Code:
    """left ** right"""

    def run(f: Frame) -> Any:
        return power(meter, left(f), right(f))

    return run


def sum_of(meter: Meter, a: Any, b: Any) -> Any:
    """a + b of values."""
    return settle(meter, a + b)


def difference(meter: Meter, a: Any, b: Any) -> Any:
    """a - b of values."""
    return settle(meter, a - b)


def product(meter: Meter, a: Any, b: Any) -> Any:
    """a * b of values; repetition is measured before it is done."""
    if a.__class__ in SIZED or b.__class__ in SIZED:
        many, times = (a, b) if a.__class__ in SIZED else (b, a)
        if (times.__class__ is int or times.__class__ is bool) and many.__class__ is not range:
            most = meter.limits.string_chars if many.__class__ is str else meter.limits.list_items
            if times > 0 and many.__class__ is not dict and len(many) * times > most:
                raise ProgramError(f"the repetition is longer than {most:,} items")
    return settle(meter, a * b)


def quotient(meter: Meter, a: Any, b: Any) -> Any:
    """a / b of values."""
    return settle(meter, a / b)


def floor_quotient(meter: Meter, a: Any, b: Any) -> Any:
    """a // b of values."""
    return settle(meter, a // b)


def remainder(meter: Meter, a: Any, b: Any) -> Any:
    """a % b of values; % does not format texts here."""
    if a.__class__ is str:
        raise ProgramError("% does not format text in the room language", 0, 'Use an f-string such as f"leg_{i}".')
    return settle(meter, a % b)


def power(meter: Meter, a: Any, b: Any) -> Any:
    """a ** b of values; the size of a whole result is estimated before it is computed."""
    if (
        a.__class__ in NUMBERS
        and b.__class__ in NUMBERS
        and a.__class__ is not float
        and b.__class__ is not float
        and b > 0
        and (a.bit_length() - 1) * b > MOST_POWER_BITS
    ):
        raise ProgramError("a whole number is larger than 2**63", 0, "Use floats or smaller numbers.")
    return settle(meter, a**b)


OPERATIONS: dict[str, tuple[Binary, Values]] = {
    "Add": (add, sum_of),
    "Sub": (subtract, difference),
    "Mult": (multiply, product),
    "Div": (divide, quotient),
    "FloorDiv": (floor_divide, floor_quotient),
    "Mod": (modulo, remainder),
    "Pow": (raise_to, power),
}
"""By the name of the operator's node: the closure over compiled operands, and the function of two values."""


def in_place(meter: Meter, name: str, a: Any, b: Any) -> Any:
    """a op= b: lists grow in place as in Python, everything else is a new value."""
    if a.__class__ is list and name == "Add":
        if b.__class__ not in SIZED:
            b = list(b)
        if len(a) + len(b) > meter.limits.list_items:
            raise too_many(meter)
        meter.spend(len(b) >> 1)
        a += b
        return a
    if a.__class__ is list and name == "Mult":
        product(meter, a, b)
        a *= b
        return a
    return OPERATIONS[name][1](meter, a, b)


def negative(meter: Meter, operand: Code) -> Code:
    """-operand"""

    def run(f: Frame) -> Any:
        return -operand(f)

    return run


def positive(meter: Meter, operand: Code) -> Code:
    """+operand"""

    def run(f: Frame) -> Any:
        return +operand(f)

    return run


def negation(meter: Meter, operand: Code) -> Code:
    """not operand"""

    def run(f: Frame) -> Any:
        return not operand(f)

    return run


UNARY: dict[str, Callable[[Meter, Code], Code]] = {"USub": negative, "UAdd": positive, "Not": negation}


def contains(meter: Meter, item: Any, place: Any) -> bool:
    """item in place."""
    kind = place.__class__
    if kind is dict:
        check_key(meter, place, item)
    else:
        size = len(place) if kind in SIZED else 0
        effort = size >> 2
        if item.__class__ in CONTAINERS:
            effort += size * (measure(meter, item) >> 2)
        meter.spend(effort)
    found: bool = item in place
    return found


def same(meter: Meter, a: Any, b: Any, compare: Callable[[Any, Any], Any]) -> Any:
    """A comparison of two values of any kind; containers are measured first."""
    if a.__class__ in CONTAINERS and b.__class__ in CONTAINERS:
        measure(meter, a)
    return compare(a, b)


def comparison_of(name: str, meter: Meter) -> Callable[[Any, Any], Any]:
    """The function of two values for a comparison operator's node name."""
    if name == "In":
        return lambda a, b: contains(meter, a, b)
    if name == "NotIn":
        return lambda a, b: not contains(meter, a, b)
    if name in ("Is", "IsNot"):
        return operator.is_ if name == "Is" else operator.is_not
    compare = COMPARISONS[name]
    return lambda a, b: same(meter, a, b, compare)


COMPARISONS: dict[str, Callable[[Any, Any], Any]] = {
    "Eq": operator.eq,
    "NotEq": operator.ne,
    "Lt": operator.lt,
    "LtE": operator.le,
    "Gt": operator.gt,
    "GtE": operator.ge,
}


def comparison(meter: Meter, name: str, left: Code, right: Code) -> Code:
    """left op right, for one operator."""
    compare = COMPARISONS.get(name)
    if compare is None:
        check = comparison_of(name, meter)
        return lambda f: check(left(f), right(f))

    def run(f: Frame) -> Any:
        a = left(f)
        b = right(f)
        if a.__class__ in CONTAINERS and b.__class__ in CONTAINERS:
            measure(meter, a)
        return compare(a, b)

    return run
