# SPDX-License-Identifier: GPL-3.0-or-later
"""The values of the room language while it runs, and the guards that keep them small and sound.

Numbers, strings, tuples, lists and dicts are Python's own. What Python would do in C without end (comparing, printing
or hashing values that are very large, very deep or contain themselves) is measured here first.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Any

from ..errors import ProgramError
from .limits import Meter

Frame = list[Any]
"""The local variables of one call: parameters, the frame around, then the other variables."""
Code = Callable[[Frame], Any]
"""A compiled expression: a frame in, a value out."""

LARGEST_INT = 2**63
LARGEST_FLOAT = 1.7976931348623157e308
MOST_VALUE_DEPTH = 16
MOST_KEY_ITEMS = 8
STEPS_OF_SHAPE = 60
"""What a constructor that walks through a list of shapes does for each is counted as."""

NUMBERS: frozenset[Any] = frozenset({int, float, bool})
SCALARS: frozenset[Any] = frozenset({int, float, bool, str, type(None)})
CONTAINERS: frozenset[Any] = frozenset({list, tuple, dict})
PLAIN: frozenset[Any] = SCALARS | CONTAINERS
LONG: frozenset[Any] = frozenset({list, tuple, dict, str})
SIZED: frozenset[Any] = frozenset({list, tuple, dict, str, range})


class Unset:
    """The content of a variable before it is set."""


UNSET = Unset()


class Pairs(zip):  # type: ignore[type-arg]
    """zip, with the number of iterators inside it."""

    __slots__ = ("depth",)
    depth: int


class Numbered(enumerate):  # type: ignore[type-arg]
    """enumerate, with the number of iterators inside it."""

    __slots__ = ("depth",)
    depth: int


class Native:
    """A function of ours that programs may call.

    Args:
        name: its name in the language.
        call: the Python function.
        cost: steps that one call is counted as.
        guarded: whether arguments and result are checked around the call (functions that do not do it themselves).
    """

    __slots__ = ("name", "call", "cost", "guarded", "meter")

    def __init__(self, name: str, call: Callable[..., Any], cost: int, guarded: bool, meter: Meter) -> None:
        self.name = name
        self.call = call
        self.cost = cost
        self.guarded = guarded
        self.meter = meter

    def __call__(self, *args: Any, **keywords: Any) -> Any:
        """A call that does not come from a call by name: counted and checked here."""
        self.meter.spend(self.cost)
        if not self.guarded:
            return self.call(*args, **keywords)
        for value in (*args, *keywords.values()):
            if value.__class__ in LONG:
                spend_argument(self.meter, value)
        return settle(self.meter, self.call(*args, **keywords))


class Function:
    """A function that the program defines with def or lambda. Constructors may call it like any Python function.

    Args:
        name: its name, for messages.
        parameters: names in order.
        defaults: values of the last parameters.
        enter: runs the body on a list that holds exactly one value for each parameter.
    """

    __slots__ = ("name", "parameters", "defaults", "enter", "arity")

    def __init__(
        self, name: str, parameters: tuple[str, ...], defaults: tuple[Any, ...], enter: Callable[[list[Any]], Any]
    ) -> None:
        self.name = name
        self.parameters = parameters
        self.defaults = defaults
        self.enter = enter
        self.arity = len(parameters)

    def __call__(self, *args: Any, **keywords: Any) -> Any:
        """Called by a constructor."""
        values = [a if a.__class__ in SCALARS else plain(a) for a in args]
        if len(values) == self.arity and not keywords:
            return self.enter(values)
        return self.bind(values, {name: plain(value) for name, value in keywords.items()})

    def bind(self, args: list[Any], keywords: dict[str, Any]) -> Any:
        """Call with defaults and keyword arguments. Raises ProgramError for arguments that do not fit."""
        names = self.parameters
        if len(args) > len(names):
            raise self._misfit(f"{len(args)} were given")
        values = args + [UNSET] * (len(names) - len(args))
        for name, value in keywords.items():
            if name not in names:
                raise self._misfit(f"{name} is not one of them")
            position = names.index(name)
            if values[position] is not UNSET:
                raise self._misfit(f"{name} was given twice")
            values[position] = value
        first_default = len(names) - len(self.defaults)
        for position, value in enumerate(values):
            if value is UNSET:
                if position < first_default:
                    raise self._misfit(f"{names[position]} is missing")
                values[position] = self.defaults[position - first_default]
        return self.enter(values)

    def _misfit(self, reason: str) -> ProgramError:
        takes = ", ".join(self.parameters) or "no arguments"
        return ProgramError(f"{self.name}() takes {takes}: {reason}")


def plain(value: Any) -> Any:
    """A number that a constructor hands over as Python's own number (numpy's are not); anything else as it is."""
    if value.__class__ in SCALARS or value.__class__ in CONTAINERS:
        return value
    if isinstance(value, float):
        return float(value)
    if isinstance(value, str):
        return str(value)
    item = getattr(value, "item", None)
    return item() if callable(item) and getattr(value, "ndim", None) == 0 else value


def settle(meter: Meter, value: Any) -> Any:
    """The value, if it may exist: finite, in range, not too long. Long ones are counted as steps."""
    kind = value.__class__
    if kind is float:
        if -LARGEST_FLOAT <= value <= LARGEST_FLOAT:
            return value
        raise ProgramError("the result is not a finite number")
    if kind is int:
        if -LARGEST_INT <= value <= LARGEST_INT:
            return value
        raise ProgramError("a whole number is larger than 2**63", 0, "Use floats or smaller numbers.")
    if kind is str:
        if len(value) > meter.limits.string_chars:
            raise ProgramError(f"a text is longer than {meter.limits.string_chars:,} characters")
        meter.spend(len(value) >> 3)
    elif kind is list or kind is tuple or kind is dict:
        if len(value) > meter.limits.list_items:
            raise too_many(meter)
        meter.spend(len(value) >> 2)
    elif kind is complex:
        raise ProgramError("the result is not a real number", 0, "Do not take a power or root of a negative number.")
    elif kind is not bool and value is not None:
        other = plain(value)
        return value if other is value else settle(meter, other)
    return value


def too_many(meter: Meter) -> ProgramError:
    """The refusal of a list that has too many items."""
    return ProgramError(f"a list, tuple or dict has more than {meter.limits.list_items:,} items")


def measure(meter: Meter, value: Any) -> int:
    """What walking through a container and all containers in it takes: items as often as they are met, shapes more.

    Raises ProgramError for what is too large or too deep to be compared, printed or handed to a constructor; a list
    that contains itself is endlessly deep.
    """
    count = effort = 0
    most = 4 * meter.limits.list_items
    open_values: list[tuple[Any, int]] = [(value, 1)]
    while open_values:
        item, depth = open_values.pop()
        if depth > MOST_VALUE_DEPTH:
            raise ProgramError("a list is nested too deeply or contains itself")
        members = item.values() if item.__class__ is dict else item
        count += len(members) + 1
        if count + len(open_values) > most:
            raise ProgramError("a value has too many items in all")
        kinds = set(map(type, members))
        if str in kinds:
            count += sum(len(member) for member in members if member.__class__ is str)
        if not PLAIN.issuperset(kinds):
            effort += STEPS_OF_SHAPE * len(members)
        if not kinds.isdisjoint(CONTAINERS):
            open_values.extend((member, depth + 1) for member in members if member.__class__ in CONTAINERS)
    meter.spend(count >> 2)
    return count + effort


def spend_argument(meter: Meter, value: Any) -> None:
    """Count a container or text that a constructor is going to walk through, and refuse it when it is too large."""
    meter.spend(3 * len(value) if value.__class__ is str else measure(meter, value))


def screen(meter: Meter, values: Iterable[Any]) -> None:
    """Measure the containers among values that are going to be compared with each other."""
    for value in values:
        if value.__class__ in CONTAINERS:
            measure(meter, value)


def check_key(meter: Meter, table: Any, key: Any) -> None:
    """Refuse keys of a dict that are not numbers, texts or small tuples of them: hashing and finding them is quick."""
    if key.__class__ in SCALARS:
        return
    if key.__class__ is tuple:
        parts = [part for item in key for part in (item if item.__class__ is tuple else (item,))]
        if len(parts) <= MOST_KEY_ITEMS and all(part.__class__ in SCALARS for part in parts):
            meter.spend(2 + (len(table) >> 4))
            return
    raise ProgramError("a key of a dict must be a number, a text or a small tuple of them")


def plain_text(meter: Meter, value: Any) -> str:
    """str(value) for plain data. Raises ProgramError for functions and shapes, whose text would not be the same twice."""
    if value.__class__ is str:
        return str(value)
    if value.__class__ in CONTAINERS:
        measure(meter, value)
        if not only_plain(value):
            raise ProgramError("only numbers, texts and lists of them can be made into text")
    elif value.__class__ not in SCALARS and value.__class__ is not range:
        raise ProgramError("only numbers, texts and lists of them can be made into text")
    text: str = settle(meter, str(value))
    return text


def only_plain(value: Any) -> bool:
    """Whether a measured container holds nothing but plain data."""
    members = [*value, *value.values()] if value.__class__ is dict else value
    return all(m.__class__ in SCALARS or (m.__class__ in CONTAINERS and only_plain(m)) for m in members)
