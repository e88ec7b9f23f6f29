# SPDX-License-Identifier: GPL-3.0-or-later
"""Small value types that several artifacts share."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import BaseModel, ConfigDict, Field

Placement = Literal["floor", "wall", "ceiling", "surface"]
Salience = Literal["major", "minor"]
Shape = Literal["box", "round", "l_shape"]
Finite = Annotated[float, Field(allow_inf_nan=False)]
Metres2 = tuple[Finite, Finite]
Metres3 = tuple[Finite, Finite, Finite]


class Artifact(BaseModel):
    """Base of everything that memory keeps: unknown fields and non-finite numbers are refused."""

    model_config = ConfigDict(extra="forbid", allow_inf_nan=False, validate_assignment=True)


class ImagePoint(Artifact):
    """A point of the picture: 0-1000 of its width (x, right) and of its height (y, down)."""

    x: float
    y: float


class ImageBox(Artifact):
    """An axis-aligned box of the picture, in 0-1000 of its width and height, x right, y down."""

    x_min: float
    y_min: float
    x_max: float
    y_max: float

    @property
    def centre(self) -> tuple[float, float]:
        """Centre (x, y) in the same units."""
        return (self.x_min + self.x_max) / 2, (self.y_min + self.y_max) / 2

    @property
    def area(self) -> float:
        """Area in squared units, never negative."""
        return max(0.0, self.x_max - self.x_min) * max(0.0, self.y_max - self.y_min)

    def iou(self, other: ImageBox) -> float:
        """Intersection over union with another box, 0..1."""
        width = min(self.x_max, other.x_max) - max(self.x_min, other.x_min)
        height = min(self.y_max, other.y_max) - max(self.y_min, other.y_min)
        if width <= 0 or height <= 0:
            return 0.0
        shared = width * height
        return shared / (self.area + other.area - shared)
