# SPDX-License-Identifier: GPL-3.0-or-later
"""Compiled reading and assigning of items and slices of lists, tuples, texts and dicts."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from ..errors import ProgramError
from .limits import Meter
from .values import Code, Frame, check_key, settle


def store_item(meter: Meter, container: Code, index: Code) -> Callable[[Frame, Any], None]:
    """Assigns to an item of a list or dict."""

    def run(f: Frame, value: Any) -> None:
        put_item(meter, container(f), index(f), value)

    return run


def put_item(meter: Meter, place: Any, key: Any, value: Any) -> None:
    """place[key] = value"""
    if place.__class__ is dict:
        check_key(meter, place, key)
        if len(place) >= meter.limits.list_items and key not in place:
            raise ProgramError(f"a dict has more than {meter.limits.list_items:,} items")
        meter.spend(4)
    elif place.__class__ is not list:
        raise TypeError(f"items of a {type(place).__name__} cannot be assigned; use a list or a dict")
    place[key] = value


def get_item(meter: Meter, place: Any, key: Any) -> Any:
    """place[key]"""
    if place.__class__ is dict:
        check_key(meter, place, key)
    return place[key]


def item_of(meter: Meter, container: Code, index: Code) -> Code:
    """container[index]"""

    def run(f: Frame) -> Any:
        place = container(f)
        key = index(f)
        if place.__class__ is dict:
            check_key(meter, place, key)
        return place[key]

    return run


def slice_of(meter: Meter, container: Code, bounds: tuple[Code | None, ...]) -> Code:
    """container[lower:upper:step]"""

    def run(f: Frame) -> Any:
        place = container(f)
        part = slice(*(None if bound is None else bound(f) for bound in bounds))
        if place.__class__ is dict:
            raise TypeError("a dict has no slices")
        return settle(meter, place[part])

    return run
