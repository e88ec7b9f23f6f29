# SPDX-License-Identifier: GPL-3.0-or-later
"""How far the boxes and the metres of one picture's analysis can be trusted."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from .common import Artifact

Sources = Literal["both", "metres", "boxes"]
Part = Annotated[float, Field(gt=0, allow_inf_nan=False)]
Edges = tuple[Part, Part, Part, Part]
Pair = tuple[float, float]


class Trust(Artifact):
    """Usual errors of the two measurements, and what is wrong with all of one of them alike.

    The defaults are what holds for a picture that nothing was learnt from. Metres of the room enter as parts of its longer
    side only, so a change of scale leaves this as it is.

    Attributes:
        evidence: which measurements placements are made from.
        objects: how many objects it was learnt from.
        box_sigma: usual error of a box's edge, in thousandths of the picture's longer side.
        centre_sigma: usual error of a centre in metres, as a part of the room's longer side.
        size_sigma, height_sigma: usual relative errors of width and depth, and of height.
        metres_stretch, metres_shift: centres lie at true * (1 + stretch) + shift; the shift is a part of the room's longer
            side. To the right and up in the picture.
        metres_size: logarithms by which sizes to the right and up are too large.
        box_stretch, box_shift: the same for boxes, about the middle of the floor; the shift in thousandths of the longer
            side, right and down.
        box_inset: how far boxes lie inside of what they should enclose, in thousandths of the longer side.
        edges: for objects that are partly covered: by how much the errors of x_min, y_min, x_max, y_max are larger than
            usual.
    """

    evidence: Sources = "both"
    objects: int = 0
    box_sigma: Part = 5.0
    centre_sigma: Part = 0.005
    size_sigma: Part = 0.045
    height_sigma: Part = 0.08
    metres_stretch: Pair = (0.0, 0.0)
    metres_shift: Pair = (0.0, 0.0)
    metres_size: Pair = (0.0, 0.0)
    box_stretch: Pair = (0.0, 0.0)
    box_shift: Pair = (0.0, 0.0)
    box_inset: float = 0.0
    edges: dict[str, Edges] = {}
