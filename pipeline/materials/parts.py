# SPDX-License-Identifier: GPL-3.0-or-later
"""The parts of a built object that may have a look each, and how much of the object each of them is."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from ..objects.tinting import seen_from_above
from ..program.prelude.palette import split_role
from ..program.prelude.shape import Shape

_UPRIGHT = np.array(((1.0, 0.0, 0.0), (0.0, 0.0, -1.0), (0.0, 1.0, 0.0)))
"""Turns an object so that its front looks up."""


@dataclass(frozen=True)
class Cell:
    """All shapes of an object that have one part name and one material.

    Attributes:
        part, material: as they are on the shapes; "" for none.
        share: of what a camera above the object, or before what hangs on a wall, sees of it, 0..1.
    """

    part: str
    material: str
    share: float = 0.0

    @property
    def role(self) -> str:
        """The material role without its colour."""
        return split_role(self.material)[0]

    @property
    def code(self) -> str:
        """The colour that the program gives it, six sRGB digits, "" for none."""
        return split_role(self.material)[1]


def cells_of(shapes: Sequence[Shape], from_front: bool = False) -> list[Cell]:
    """The cells of an object in the order of its shapes, weighed from above or `from_front`."""
    names = list(dict.fromkeys((shape.part, shape.material) for shape in shapes))
    numbers = {name: str(number) for number, name in enumerate(names)}
    marked = [replace(s, material=numbers[s.part, s.material]) for s in shapes]
    if from_front:
        marked = [replace(s, vertices=s.vertices @ _UPRIGHT) for s in marked]
    seen = seen_from_above(marked)
    return [Cell(part, material, round(seen.get(numbers[part, material], 0.0), 4)) for part, material in names]
