# SPDX-License-Identifier: GPL-3.0-or-later
"""Python's own functions that are in the room language, with Python's results and with their effort counted.

The keys of `metered_functions` are the language's built-in functions; those of Python's math module come from the
prelude's registry, everything else is a constructor.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from itertools import islice
from typing import Any

from ..errors import ProgramError
from .limits import Meter
from .values import (
    NUMBERS,
    SIZED,
    Function,
    Native,
    Numbered,
    Pairs,
    plain_text,
    screen,
    settle,
    too_many,
)

MOST_ITERATORS = 8
GENERATOR_TAKERS = frozenset({"list", "tuple", "sum", "any", "all", "min", "max", "sorted"})
"""Functions whose only positional argument may be written as a generator: tuple(x for x in xs)."""
NO_VALUE = object()


class Functions:
    """The built-in functions of one evaluation.

    Args:
        meter: counts what they do.
    """

    def __init__(self, meter: Meter) -> None:
        self.meter = meter

    def drain(self, values: Any) -> list[Any]:
        """All items of an iterable as a new list. Raises ProgramError when there are too many."""
        most = self.meter.limits.list_items
        if values.__class__ in SIZED:
            if len(values) > most:
                raise too_many(self.meter)
            self.meter.spend(len(values) >> (0 if values.__class__ is range else 2))
            return list(values)
        found = list(islice(iter(values), most + 1))
        if len(found) > most:
            raise too_many(self.meter)
        return found

    def list_of(self, values: Any = (), /) -> list[Any]:
        """list(values)"""
        return self.drain(values)

    def tuple_of(self, values: Any = (), /) -> tuple[Any, ...]:
        """tuple(values)"""
        return values if isinstance(values, tuple) else tuple(self.drain(values))

    def range_of(self, *bounds: Any) -> range:
        """range(stop), range(start, stop), range(start, stop, step)"""
        found = range(*bounds)
        most = self.meter.limits.range_items
        # A range in bounds by its length can still hold huge numbers, and len() of a huge one overflows.
        if any(abs(bound) > 2**62 for bound in bounds) or len(found) > most:
            raise ProgramError(f"a range has more than {most:,} numbers")
        return found

    def abs_of(self, value: Any, /) -> Any:
        """abs(value)"""
        return abs(value)

    def round_to(self, number: Any, ndigits: Any = None) -> Any:
        """round(number), round(number, digits)"""
        if ndigits is None:
            return settle(self.meter, round(number))
        if number.__class__ not in NUMBERS or ndigits.__class__ is not int:
            return settle(self.meter, round(number, ndigits))
        digits: int = max(-400, min(400, ndigits))
        return settle(self.meter, round(number, digits))

    def sum_of(self, values: Any, /, start: Any = 0) -> Any:
        """sum(values), sum(values, start)"""
        found = self.drain(values)
        self.meter.spend(len(found) >> 2)
        if start.__class__ in NUMBERS and NUMBERS.issuperset(map(type, found)):
            return settle(self.meter, sum(found, start))
        if start.__class__ is str:
            raise TypeError("sum() can't sum strings: use an f-string or +")
        total = start
        for value in found:
            total = settle(self.meter, total + value)
        return total

    def extreme(self, pick: Callable[..., Any], args: tuple[Any, ...], key: Any = None, default: Any = NO_VALUE) -> Any:
        """min or max of several values or of one iterable, with key and default as in Python."""
        if len(args) > 1 and default is not NO_VALUE:
            raise TypeError(f"{pick.__name__}() takes a default only with one list")
        if not args:
            raise TypeError(f"{pick.__name__}() needs at least one argument")
        found = list(args) if len(args) > 1 else self.drain(args[0])
        if not found:
            if default is NO_VALUE:
                raise ValueError(f"{pick.__name__}() of an empty list")
            return default
        self.meter.spend(len(found) >> 2)
        if key is None:
            screen(self.meter, found)
            return pick(found)
        keys = self.keys_of(found, key)
        return found[pick(range(len(found)), key=keys.__getitem__)]

    def keys_of(self, values: list[Any], key: Any) -> list[Any]:
        """The sort keys of values."""
        if not isinstance(key, (Function, Native)):
            raise TypeError("key must be a function, such as a def or lambda of one argument")
        keys = [key(value) for value in values]
        screen(self.meter, keys)
        return keys

    def min_of(self, *args: Any, **options: Any) -> Any:
        """min(...)"""
        return self.extreme(min, args, **options)

    def max_of(self, *args: Any, **options: Any) -> Any:
        """max(...)"""
        return self.extreme(max, args, **options)

    def sorted_of(self, values: Any, /, *, key: Any = None, reverse: Any = False) -> list[Any]:
        """sorted(values, key=..., reverse=...)"""
        found = self.drain(values)
        self.meter.spend(len(found))
        if key is None:
            screen(self.meter, found)
            return sorted(found, reverse=reverse)
        keys = self.keys_of(found, key)
        return [found[i] for i in sorted(range(len(found)), key=keys.__getitem__, reverse=reverse)]

    def zip_of(self, *iterables: Any, strict: Any = False) -> Any:
        """zip(a, b, ...)"""
        return self.wrapped(Pairs(*iterables, strict=strict), iterables)

    def enumerate_of(self, iterable: Any, start: Any = 0) -> Any:
        """enumerate(values, start)"""
        return self.wrapped(Numbered(iterable, settle(self.meter, start)), (iterable,))

    def wrapped(self, iterator: Any, inside: tuple[Any, ...]) -> Any:
        """Note how many iterators are inside each other (C code walks them without end), and pay for their items."""
        iterator.depth = 1 + max((getattr(value, "depth", 0) for value in inside), default=0)
        if iterator.depth > MOST_ITERATORS:
            raise ProgramError("too many zip and enumerate inside each other", 0, "Make a list of one with list(...).")
        sizes = [len(value) for value in inside if value.__class__ in SIZED]
        self.meter.spend(2 + (min(sizes) if sizes else 0) * (2 + len(inside)) // 2)
        return iterator

    def reversed_of(self, values: Any, /) -> Any:
        """reversed(values)"""
        self.meter.spend(2 + (len(values) >> 2 if values.__class__ in SIZED else 0))
        return reversed(values)

    def any_of(self, values: Any, /) -> bool:
        """any(values)"""
        self.meter.spend(len(values) >> 2 if values.__class__ in SIZED else 1)
        return any(values)

    def all_of(self, values: Any, /) -> bool:
        """all(values)"""
        self.meter.spend(len(values) >> 2 if values.__class__ in SIZED else 1)
        return all(values)

    def int_of(self, value: Any = 0, /) -> int:
        """int(value)"""
        if value.__class__ is str and len(value) > 100:
            raise ValueError("int() of a text that is too long")
        number: int = settle(self.meter, int(value))
        return number

    def float_of(self, value: Any = 0.0, /) -> float:
        """float(value)"""
        if value.__class__ is str and len(value) > 1000:
            raise ValueError("float() of a text that is too long")
        number: float = settle(self.meter, float(value))
        return number

    def str_of(self, value: Any = "", /) -> str:
        """str(value)"""
        return plain_text(self.meter, value)

    def append(self, items: Any, value: Any, /) -> None:
        """append(items, value), which is items.append(value)"""
        if items.__class__ is not list:
            raise ValueError("append: the first argument must be a list")
        if len(items) >= self.meter.limits.list_items:
            raise too_many(self.meter)
        items.append(value)

    def from_dict(self, name: str, take: Callable[[dict[Any, Any]], Iterable[Any]], cost: int) -> Callable[[Any], Any]:
        """keys, values or items: a list of what the dict holds."""

        def call(table: Any, /) -> list[Any]:
            if table.__class__ is not dict:
                raise ValueError(f"{name}: the argument must be a dict")
            self.meter.spend(cost * len(table) >> 2)
            return list(take(table))

        return call


def metered_functions(meter: Meter) -> dict[str, Native]:
    """The built-in functions by name."""
    of = Functions(meter)
    calls: dict[str, Callable[..., Any]] = {
        "abs": of.abs_of,
        "min": of.min_of,
        "max": of.max_of,
        "round": of.round_to,
        "sum": of.sum_of,
        "len": len,
        "range": of.range_of,
        "zip": of.zip_of,
        "enumerate": of.enumerate_of,
        "sorted": of.sorted_of,
        "reversed": of.reversed_of,
        "int": of.int_of,
        "float": of.float_of,
        "str": of.str_of,
        "bool": bool,
        "list": of.list_of,
        "tuple": of.tuple_of,
        "any": of.any_of,
        "all": of.all_of,
        "append": of.append,
        "keys": of.from_dict("keys", dict.keys, 1),
        "values": of.from_dict("values", dict.values, 1),
        "items": of.from_dict("items", dict.items, 6),
    }
    return {name: Native(name, call, 2, False, meter) for name, call in calls.items()}
