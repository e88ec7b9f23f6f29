# SPDX-License-Identifier: GPL-3.0-or-later
"""Lights that no room has: thousands of watts, none at all, or an exposure that shows nothing."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from ..artifacts.layout import LightLine, Line, ViewLine, WorldLine
from ..program.lines import name_of, print_line, rounded_line
from .bodies import Room
from .faults import Fault, Knowledge, Mend

RANGES: dict[str, tuple[float, float, float]] = {
    "sun": (0.05, 30.0, 4.0),
    "area": (0.5, 5000.0, 120.0),
    "point": (0.2, 1500.0, 40.0),
    "spot": (0.2, 3000.0, 80.0),
}
"""By kind, the least and the most energy in Blender's units, and the usual one."""
STRENGTH = (0.0, 20.0, 0.5)
"""The same for the world."""
EXPOSURE = 8.0
"""Stops, up or down, beyond which a picture is white or black."""


def find(room: Room, knowledge: Knowledge) -> list[Fault]:
    """Lights, world and view with values that no room has."""
    found = []
    for line, name, value, (low, high, _) in _values(room):
        if low <= value <= high:
            continue
        worst = value / high if value > high else low / max(value, 1e-9)
        found.append(Fault("light", line.id, "", abs(worst), f"Its {name} of {value:g} is absurd for a room."))
    return found


def fix(room: Room, fault: Fault, knowledge: Knowledge) -> Iterator[Mend]:
    """The usual value of its kind."""
    for line, name, value, (_, _, usual) in _values(room):
        if line.id == fault.id:
            after = rounded_line(line.model_copy(update={name: usual}))
            key = f"{name_of(line)}s"
            lines = [after if other.id == line.id else other for other in getattr(room.layout, key)]
            said = f"Its {name} set from {value:g} to {usual:g}."
            factor = round(usual / value, 9) if value else 0.0
            yield Mend(room.with_lines(**{key: lines}), line.id, print_line(line), print_line(after), factor, said)


def _values(room: Room) -> Iterator[tuple[Any, str, float, tuple[float, float, float]]]:
    """Each line that has a brightness, the field's name, its value, and what it may be."""
    lines: list[Line] = [*room.layout.lights, *room.layout.worlds, *room.layout.views]
    for line in lines:
        if isinstance(line, LightLine):
            yield line, "energy", line.energy, RANGES[line.kind]
        elif isinstance(line, WorldLine):
            yield line, "strength", line.strength, STRENGTH
        elif isinstance(line, ViewLine):
            yield line, "exposure", line.exposure, (-EXPOSURE, EXPOSURE, 0.0)
