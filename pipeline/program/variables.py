# SPDX-License-Identifier: GPL-3.0-or-later
"""Compiled reading and assigning of variables, chosen by where in the frames they lie."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from ..errors import ProgramError
from .values import UNSET, Code, Frame


def unset(name: str, ours: bool = False) -> ProgramError:
    """The refusal of a variable that is read before it is set.

    Args:
        ours: whether the language has something of this name, which the def has taken for a variable of its own.
    """
    if not ours:
        return ProgramError(f"{name} is used before it is set")
    fix = f"Call the variable something else, such as {name}_1."
    return ProgramError(f"this def uses {name} for a value of its own, so it cannot call the language's {name}", 0, fix)


def load_parameter(slot: int) -> Code:
    """A variable that always has a value."""
    return lambda f: f[slot]


def load_local(slot: int, name: str, ours: bool = False) -> Code:
    """A variable of this frame."""

    def run(f: Frame) -> Any:
        value = f[slot]
        if value is UNSET:
            raise unset(name, ours)
        return value

    return run


def load_global(top: Frame, slot: int, name: str) -> Code:
    """A variable of the module."""

    def run(f: Frame) -> Any:
        value = top[slot]
        if value is UNSET:
            raise unset(name)
        return value

    return run


def load_outer(links: tuple[int, ...], slot: int, name: str) -> Code:
    """A variable of a function around this one."""

    def run(f: Frame) -> Any:
        for link in links:
            f = f[link]
        value = f[slot]
        if value is UNSET:
            raise unset(name)
        return value

    return run


def store_slot(slot: int) -> Callable[[Frame, Any], None]:
    """Assigns to a variable of this frame."""

    def run(f: Frame, value: Any) -> None:
        f[slot] = value

    return run


def unpack(targets: tuple[Callable[[Frame, Any], None], ...]) -> Callable[[Frame, Any], None]:
    """Assigns the items of a value to several targets."""
    count = len(targets)

    def run(f: Frame, value: Any) -> None:
        found = []
        for item in value:
            found.append(item)
            if len(found) > count:
                raise ValueError(f"too many values to unpack (expected {count})")
        if len(found) < count:
            raise ValueError(f"not enough values to unpack (expected {count}, got {len(found)})")
        for target, item in zip(targets, found, strict=True):
            target(f, item)

    return run
