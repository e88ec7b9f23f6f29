# SPDX-License-Identifier: GPL-3.0-or-later
"""How much a room program may use, and the meter that counts it while the program runs."""

from __future__ import annotations

import time
from dataclasses import dataclass

from ..errors import ProgramError

CHUNK = 20_000
"""Steps handed out at a time; the clock is looked at once a chunk."""


@dataclass(frozen=True)
class Limits:
    """What one evaluation may use. A step is one statement, operator, call or item; see `Meter`.

    Attributes:
        text_bytes: length of the program text in UTF-8.
        nesting: brackets inside brackets.
        operators: operators in one expression, between commas and brackets.
        blocks: blocks (def, for, if) inside blocks.
        tree_depth: depth of the syntax tree.
        steps: steps in total. They bound memory too: no step allocates more than about 80 bytes.
        depth: calls inside calls.
        list_items: items of one list, tuple or dict.
        range_items: length of one range.
        string_chars: characters of one string.
        vertices: vertices that constructors make in total.
        seconds: wall-clock time, the backstop behind the others.
    """

    text_bytes: int = 131_072
    nesting: int = 32
    operators: int = 100
    blocks: int = 12
    tree_depth: int = 120
    steps: int = 1_300_000
    depth: int = 24
    list_items: int = 100_000
    range_items: int = 1_000_000
    string_chars: int = 10_000
    vertices: int = 250_000
    seconds: float = 10.0


DEFAULT_LIMITS = Limits()
"""For one text from a model: a layout, an object program. Everything beyond is stopped within about a second."""

FINISHED_ROOM_LIMITS = Limits(text_bytes=1_048_576, steps=60_000_000, vertices=5_000_000, seconds=60.0)
"""For a finished room whose objects were each evaluated within DEFAULT_LIMITS before."""


class Meter:
    """Counts the steps, the depth and the time of one evaluation.

    Compiled code subtracts the static cost of a block from `left` itself, and calls `refill` when that goes below
    zero: one subtraction and one comparison for a whole block.

    Attributes:
        left: steps left of the current chunk.
        depth: language functions that are being called at the moment.
        vertices: one number, the vertices that constructors may still make; `prelude.budget` counts it down.
    """

    __slots__ = ("left", "depth", "vertices", "limits", "reserve", "deadline")

    def __init__(self, limits: Limits) -> None:
        self.limits = limits
        self.left = 0
        self.reserve = limits.steps
        self.depth = 0
        self.vertices = [limits.vertices]
        self.deadline = time.monotonic() + limits.seconds

    @property
    def used(self) -> int:
        """Steps used so far."""
        return self.limits.steps - self.reserve - self.left

    def refill(self) -> None:
        """Hand out the next chunk. Raises ProgramError when steps or time have run out."""
        grant = min(max(CHUNK, -self.left), self.reserve)
        self.reserve -= grant
        self.left += grant
        if self.left < 0:
            raise ProgramError(
                f"the program takes more than {self.limits.steps:,} steps", 0, "Use fewer or shorter loops."
            )
        self.watch()

    def watch(self) -> None:
        """Raise ProgramError when the time is over."""
        if time.monotonic() > self.deadline:
            raise ProgramError(
                f"the program takes longer than {self.limits.seconds:g} seconds", 0, "Use fewer shapes and segments."
            )

    def spend(self, steps: int) -> None:
        """Count steps that are only known while the program runs."""
        self.left -= steps
        if self.left < 0:
            self.refill()
