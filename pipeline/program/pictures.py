# SPDX-License-Identifier: GPL-3.0-or-later
"""Which images a room's program shows."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from .prelude.maps import Map
from .prelude.record import Record


def picture_names(record: Record) -> list[str]:
    """The names of the images that the looks of a room show, each once, in the order in which they come."""
    looks = [look for finish in record.finishes.values() for look in finish.values()]
    return list(dict.fromkeys(name for look in looks for _, value in look.inputs for name in _names(value)))


def _names(value: Any) -> Iterator[str]:
    if not isinstance(value, Map):
        return
    if value.kind == "picture":
        yield str(value["name"])
    for _, inner in value.values:
        yield from _names(inner)
