# SPDX-License-Identifier: GPL-3.0-or-later
"""Argument checks with plain sentences. `where` is the name of the function that was called, for the message."""

from __future__ import annotations

import math
from typing import Any

COORDINATE_LIMIT = 10_000.0
"""Metres; nothing in a room is farther from its origin or larger than this."""


def fail(where: str, sentence: str) -> ValueError:
    """The error to raise: "box: size must be three positive numbers"."""
    return ValueError(f"{where}: {sentence}")


def is_number(value: Any) -> bool:
    """Whether it is a finite int or float (True and False are not numbers here)."""
    if type(value) is float:
        return math.isfinite(value)
    return isinstance(value, (int, float)) and not isinstance(value, bool) and math.isfinite(value)


def number(where: str, name: str, value: Any, low: float = -COORDINATE_LIMIT, high: float = COORDINATE_LIMIT) -> float:
    """A finite number between low and high."""
    if not is_number(value):
        raise fail(where, f"{name} must be a finite number")
    if not low <= value <= high:
        raise fail(where, f"{name} must be between {low:g} and {high:g}{told(value)}")
    return float(value)


def positive(where: str, name: str, value: Any) -> float:
    """A finite number above zero."""
    if not is_number(value) or not 0 < value <= COORDINATE_LIMIT:
        raise fail(where, f"{name} must be a positive number of at most {COORDINATE_LIMIT:g}{told(value)}")
    return float(value)


def whole(where: str, name: str, value: Any, low: int, high: int) -> int:
    """A whole number between low and high, both included."""
    if isinstance(value, float) and value.is_integer():
        value = int(value)
    if isinstance(value, bool) or not isinstance(value, int) or not low <= value <= high:
        raise fail(where, f"{name} must be a whole number between {low} and {high}{told(value)}")
    return value


def told(value: Any) -> str:
    """ ", and is -0.2" for a number or a few of them, for whoever computed it; "" for anything else."""
    values = value if isinstance(value, (tuple, list)) else (value,)
    if not 1 <= len(values) <= 4 or not all(isinstance(v, (int, float)) and abs(v) < 1e15 for v in values):
        return ""
    words = ", ".join(f"{v:.6g}" for v in values)
    return f", and is {words if values is not value else f'({words})'}"


def point(where: str, name: str, value: Any, size: int = 3) -> tuple[float, ...]:
    """A tuple or list of `size` finite numbers, as a tuple of floats."""
    words = {2: "(x, y), two", 3: "(x, y, z), three", 16: "16"}
    if not isinstance(value, (tuple, list)) or len(value) != size or not all(is_number(v) for v in value):
        raise fail(where, f"{name} must be {words[size]} finite numbers")
    if any(abs(v) > COORDINATE_LIMIT for v in value):
        raise fail(where, f"{name} must lie within {COORDINATE_LIMIT:g} of the origin")
    return tuple(float(v) for v in value)


def sizes(where: str, name: str, value: Any) -> tuple[float, float, float]:
    """Three positive numbers."""
    if not isinstance(value, (tuple, list)) or len(value) != 3:
        raise fail(where, f"{name} must be three positive numbers{told(value)}")
    if not all(is_number(v) and 0 < v <= COORDINATE_LIMIT for v in value):
        raise fail(where, f"{name} must be three positive numbers of at most {COORDINATE_LIMIT:g}{told(value)}")
    return float(value[0]), float(value[1]), float(value[2])


def text(where: str, name: str, value: Any, longest: int = 300, empty: bool = True) -> str:
    """A string of at most `longest` characters."""
    if not isinstance(value, str):
        raise fail(where, f'{name} must be text in quotes, such as "bed_1"')
    if not value and not empty:
        raise fail(where, f"{name} must not be empty")
    if len(value) > longest:
        raise fail(where, f"{name} must have at most {longest} characters")
    return value


def choice(where: str, name: str, value: Any, allowed: tuple[str, ...]) -> str:
    """One of the allowed strings, whatever its case."""
    if isinstance(value, str) and value not in allowed and value.lower() in allowed:
        return value.lower()
    if not isinstance(value, str) or value not in allowed:
        raise fail(where, f"{name} must be one of {', '.join(allowed)}")
    return value


def flag(where: str, name: str, value: Any) -> bool:
    """True or False."""
    if not isinstance(value, bool):
        raise fail(where, f"{name} must be True or False")
    return value
