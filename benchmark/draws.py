# SPDX-License-Identifier: GPL-3.0-or-later
"""The errors of a weaker model, drawn so that runs can be compared.

Errors are drawn from the seed and the name of what they disturb, never from a running generator: the same thing errs in the
same direction at every strength, only further. What is read in metres errs half alike with the box, and a later answer half
alike with the first.
"""

from __future__ import annotations

import hashlib
import math
import random
from dataclasses import dataclass

from code_as_room.pipeline.artifacts.replies import AnalysisReply

from .strengths import Strength

ALIKE = 0.5
"""How alike the errors of a thing's box and of its metres are, as a correlation: who misjudges a place misjudges it in both.
With none, two measurements would be averaged to something better than any real model allows."""
PERSISTS = 0.5
"""How alike the errors of a thing's box or metres are from one answer to the next: a model tends to repeat itself."""


class Draws:
    """Random numbers by name: the same name always draws the same, whatever was drawn before."""

    def __init__(self, seed: int) -> None:
        self.seed = seed

    def share(self, *name: object) -> float:
        """A number of 0..1, evenly."""
        return self._source(name).random()

    def normal(self, *name: object) -> float:
        """A standard normal number within 2.5: what is further off counts as overlooked, not as misjudged."""
        return max(-2.5, min(2.5, self._source(name).gauss(0.0, 1.0)))

    def error(self, look: str, *name: object) -> float:
        """The error of an answer, standard normal: the first answer's own, and partly it again in later ones."""
        first = self.normal("first", *name)
        if look == "first":
            return first
        return PERSISTS * first + math.sqrt(1 - PERSISTS**2) * self.normal(look, *name)

    def edges(self, look: str, name: str) -> dict[str, float]:
        """The errors of a box's four edges."""
        return {edge: self.error(look, edge, name) for edge in ("x_min", "y_min", "x_max", "y_max")}

    def pick(self, count: int, *name: object) -> int:
        """One of `count`, counted from 0."""
        return min(count - 1, int(self.share(*name) * count))

    def _source(self, name: tuple[object, ...]) -> random.Random:
        text = "/".join((str(self.seed), *map(str, name)))
        return random.Random(int.from_bytes(hashlib.sha256(text.encode()).digest()[:8], "big"))


@dataclass(frozen=True)
class Errors:
    """The errors that one picture's answers share: how coordinates are read, and how large the room is taken to be."""

    offset: tuple[float, float]
    scale: tuple[float, float]
    metres: tuple[float, float]
    mean_side: float

    @classmethod
    def of(cls, reply: AnalysisReply, strength: Strength, draws: Draws) -> Errors:
        """Drawn for one picture."""
        room = strength.room * draws.normal("room")
        aspect = strength.aspect * draws.normal("aspect") / 2
        return cls(
            offset=(strength.reading * draws.normal("read", "x"), strength.reading * draws.normal("read", "y")),
            scale=tuple(strength.reading * 0.002 * draws.normal("read", "scale", axis) for axis in "xy"),  # type: ignore[arg-type]
            metres=(math.exp(room + aspect), math.exp(room - aspect)),
            mean_side=math.sqrt(abs(reply.room_width_m * reply.room_depth_m)) or 4.0,
        )

    def read(self, x: float, y: float) -> tuple[float, float]:
        """A point of the picture as it is misread; written so that no error leaves it as it was, to the last digit."""
        return x + (x - 500) * self.scale[0] + self.offset[0], y + (y - 500) * self.scale[1] + self.offset[1]


def alike(own: float, shared: float) -> float:
    """An error of its own that is partly another one; standard normal when both are."""
    return ALIKE * shared + math.sqrt(1 - ALIKE**2) * own
