# SPDX-License-Identifier: GPL-3.0-or-later
"""What the shell is made of: pieces to show, walls made ready for building, and holes in them."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

from .shape import Shape


@dataclass(frozen=True)
class ShellPiece:
    """One piece of the shell.

    Attributes:
        kind: "floor", "wall", "partition", "door", "window" or "opening".
        shapes: in the piece's own frame, metres.
        origin, yaw: that frame in the room (x, y, z and degrees counter-clockwise).
        parent: id of the wall that a door, window or opening is in, of the door that a leaf hangs in, or None.
        part: "" for the piece itself, "leaf" for a door's leaf.
        inward: unit normal (x, y) into the room for outer walls, else None.
    """

    id: str
    kind: str
    shapes: list[Shape]
    origin: tuple[float, float, float] = (0.0, 0.0, 0.0)
    yaw: float = 0.0
    parent: str | None = None
    part: str = ""
    inward: tuple[float, float] | None = None


@dataclass(frozen=True)
class WallRun:
    """A wall made ready for building: directed so that the room is on its left, with its mitred ends.

    Attributes:
        start, end: (x, y) of the inner face's ends (outer walls) or the centre line's (partitions).
        left, right: y of its two faces in its own frame.
        ends: x at which (left, right) face begin, and (left, right) face end, in its own frame.
    """

    id: str
    start: tuple[float, float]
    end: tuple[float, float]
    height: float
    thickness: float
    partition: bool
    ends: tuple[tuple[float, float], tuple[float, float]]

    @property
    def length(self) -> float:
        """Length of the segment, metres."""
        return math.dist(self.start, self.end)

    @property
    def direction(self) -> tuple[float, float]:
        """Unit vector from start to end."""
        length = max(self.length, 1e-9)
        return (self.end[0] - self.start[0]) / length, (self.end[1] - self.start[1]) / length

    @property
    def left(self) -> float:
        """y of the face to the left of the segment."""
        return self.thickness / 2 if self.partition else 0.0

    @property
    def right(self) -> float:
        """y of the face to the right of the segment."""
        return -self.thickness / 2 if self.partition else -self.thickness

    def along(self, point: tuple[float, float]) -> float:
        """x of a point of the floor in the wall's own frame."""
        dx, dy = self.direction
        return (point[0] - self.start[0]) * dx + (point[1] - self.start[1]) * dy


@dataclass(frozen=True)
class Hole:
    """A clamped hole: x range along its wall, z range, and whether its line runs against the wall's direction."""

    line: dict[str, Any]
    kind: str
    x: tuple[float, float]
    z: tuple[float, float]
    against: bool
