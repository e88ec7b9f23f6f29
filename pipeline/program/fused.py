# SPDX-License-Identifier: GPL-3.0-or-later
"""The four basic operations on operands that lie in slots of the frame: variables that are surely set, and constants.

Reading a slot here saves a call for each operand, which is most of the time that simple arithmetic takes. Results out
of range and everything that is not a number take the long way, as in `arithmetic`.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from .arithmetic import product
from .limits import Meter
from .values import LARGEST_FLOAT, LARGEST_INT, Code, Frame, settle


def add_slots(meter: Meter, left: int, right: int) -> Code:
    """slot + slot"""

    def run(f: Frame) -> Any:
        r = f[left] + f[right]
        if r.__class__ is float and -LARGEST_FLOAT <= r <= LARGEST_FLOAT:
            return r
        if r.__class__ is int and -LARGEST_INT <= r <= LARGEST_INT:
            return r
        return settle(meter, r)

    return run


def add_slot_any(meter: Meter, left: int, right: Code) -> Code:
    """slot + expression"""

    def run(f: Frame) -> Any:
        r = f[left] + right(f)
        if r.__class__ is float and -LARGEST_FLOAT <= r <= LARGEST_FLOAT:
            return r
        if r.__class__ is int and -LARGEST_INT <= r <= LARGEST_INT:
            return r
        return settle(meter, r)

    return run


def add_any_slot(meter: Meter, left: Code, right: int) -> Code:
    """expression + slot"""

    def run(f: Frame) -> Any:
        r = left(f) + f[right]
        if r.__class__ is float and -LARGEST_FLOAT <= r <= LARGEST_FLOAT:
            return r
        if r.__class__ is int and -LARGEST_INT <= r <= LARGEST_INT:
            return r
        return settle(meter, r)

    return run


def subtract_slots(meter: Meter, left: int, right: int) -> Code:
    """slot - slot"""

    def run(f: Frame) -> Any:
        r = f[left] - f[right]
        if r.__class__ is float and -LARGEST_FLOAT <= r <= LARGEST_FLOAT:
            return r
        if r.__class__ is int and -LARGEST_INT <= r <= LARGEST_INT:
            return r
        return settle(meter, r)

    return run


def subtract_slot_any(meter: Meter, left: int, right: Code) -> Code:
    """slot - expression"""

    def run(f: Frame) -> Any:
        r = f[left] - right(f)
        if r.__class__ is float and -LARGEST_FLOAT <= r <= LARGEST_FLOAT:
            return r
        if r.__class__ is int and -LARGEST_INT <= r <= LARGEST_INT:
            return r
        return settle(meter, r)

    return run


def subtract_any_slot(meter: Meter, left: Code, right: int) -> Code:
    """expression - slot"""

    def run(f: Frame) -> Any:
        r = left(f) - f[right]
        if r.__class__ is float and -LARGEST_FLOAT <= r <= LARGEST_FLOAT:
            return r
        if r.__class__ is int and -LARGEST_INT <= r <= LARGEST_INT:
            return r
        return settle(meter, r)

    return run


def multiply_slots(meter: Meter, left: int, right: int) -> Code:
    """slot * slot"""

    def run(f: Frame) -> Any:
        a = f[left]
        b = f[right]
        if a.__class__ is float or b.__class__ is float:
            r = a * b
            if -LARGEST_FLOAT <= r <= LARGEST_FLOAT:
                return r
            return settle(meter, r)
        return product(meter, a, b)

    return run


def multiply_slot_any(meter: Meter, left: int, right: Code) -> Code:
    """slot * expression"""

    def run(f: Frame) -> Any:
        a = f[left]
        b = right(f)
        if a.__class__ is float or b.__class__ is float:
            r = a * b
            if -LARGEST_FLOAT <= r <= LARGEST_FLOAT:
                return r
            return settle(meter, r)
        return product(meter, a, b)

    return run


def multiply_any_slot(meter: Meter, left: Code, right: int) -> Code:
    """expression * slot"""

    def run(f: Frame) -> Any:
        a = left(f)
        b = f[right]
        if a.__class__ is float or b.__class__ is float:
            r = a * b
            if -LARGEST_FLOAT <= r <= LARGEST_FLOAT:
                return r
            return settle(meter, r)
        return product(meter, a, b)

    return run


def divide_slots(meter: Meter, left: int, right: int) -> Code:
    """slot / slot"""

    def run(f: Frame) -> Any:
        r = f[left] / f[right]
        if r.__class__ is float and -LARGEST_FLOAT <= r <= LARGEST_FLOAT:
            return r
        return settle(meter, r)

    return run


def divide_slot_any(meter: Meter, left: int, right: Code) -> Code:
    """slot / expression"""

    def run(f: Frame) -> Any:
        r = f[left] / right(f)
        if r.__class__ is float and -LARGEST_FLOAT <= r <= LARGEST_FLOAT:
            return r
        return settle(meter, r)

    return run


def divide_any_slot(meter: Meter, left: Code, right: int) -> Code:
    """expression / slot"""

    def run(f: Frame) -> Any:
        r = left(f) / f[right]
        if r.__class__ is float and -LARGEST_FLOAT <= r <= LARGEST_FLOAT:
            return r
        return settle(meter, r)

    return run


BOTH: dict[str, Callable[[Meter, int, int], Code]] = {
    "Add": add_slots,
    "Sub": subtract_slots,
    "Mult": multiply_slots,
    "Div": divide_slots,
}
LEFT: dict[str, Callable[[Meter, int, Code], Code]] = {
    "Add": add_slot_any,
    "Sub": subtract_slot_any,
    "Mult": multiply_slot_any,
    "Div": divide_slot_any,
}
RIGHT: dict[str, Callable[[Meter, Code, int], Code]] = {
    "Add": add_any_slot,
    "Sub": subtract_any_slot,
    "Mult": multiply_any_slot,
    "Div": divide_any_slot,
}
"""By the name of the operator's node, for operands that are both, or only left, or only right, in slots."""
