# SPDX-License-Identifier: GPL-3.0-or-later
"""What a fault and a mend are, and what every kind of fault may know."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

from ..artifacts.common import Metres3
from ..artifacts.correction import FaultKind
from .bodies import Room
from .columns import Floats


@dataclass(frozen=True)
class Fault:
    """Something wrong with a room.

    Attributes:
        other: what it is in conflict with, "" for nothing. amount: how bad, in the kind's own unit, above 0.
        means: a sentence about it for the artist.
    """

    kind: FaultKind
    id: str
    other: str
    amount: float
    means: str

    @property
    def key(self) -> tuple[str, str, str]:
        """Which fault it is, however bad."""
        return self.kind, self.id, self.other


@dataclass(frozen=True)
class Mend:
    """One way to mend a fault: the room after it, what was changed from what to what, and how much."""

    room: Room
    id: str
    before: str
    after: str
    amount: float
    means: str


@dataclass
class Knowledge:
    """What finding may use beside the room, and remembers of its meshes.

    Attributes:
        swings: for doors, "in" where the leaf comes into the room. reference: ids of cameras that show the picture's view.
        memo: results by what they depend on, so that looking again after one move is cheap.
    """

    swings: Mapping[str, str] = field(default_factory=dict)
    reference: frozenset[str] = frozenset({"reference"})
    locked: frozenset[str] = frozenset()
    memo: dict[Any, Any] = field(default_factory=dict)

    def remember(self, key: Any, make: Callable[[], Any]) -> Any:
        """The result for this key, worked out once."""
        if key not in self.memo:
            self.memo[key] = make()
        return self.memo[key]


Find = Callable[[Room, Knowledge], list[Fault]]
Fix = Callable[[Room, Fault, Knowledge], Iterator[Mend]]


def moved(room: Room, identifier: str, centre: Metres3, means: str) -> Mend:
    """The mend that puts an object (and what it carries) elsewhere."""
    body = room.bodies[identifier]
    after = room.with_moved(identifier, centre)
    now = after.bodies[identifier].line.centre
    distance = sum((a - b) ** 2 for a, b in zip(now, body.line.centre, strict=True)) ** 0.5
    return Mend(after, identifier, _written(body.line.centre), _written(now), round(distance, 4), means)


def _written(values: Metres3 | Floats) -> str:
    return "(" + ", ".join(f"{float(v):.4f}".rstrip("0").rstrip(".") for v in values) + ")"
