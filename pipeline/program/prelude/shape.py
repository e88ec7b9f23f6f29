# SPDX-License-Identifier: GPL-3.0-or-later
"""The value that every modelling constructor returns: a mesh as arrays, with the name of the part it is."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np


@dataclass(frozen=True, eq=False)
class Shape:
    """An immutable polygon mesh in metres.

    Attributes:
        vertices: float64 array (N, 3).
        faces: tuples of vertex indices, counter-clockwise seen from outside.
        part: semantic part name ("leg", "cushion"), "" when not named yet.
        material: material role ("wood", "fabric"), "" for the object's own colour.
        smooth: shade smooth.
        uvs: None, or one (u, v) in metres for each face corner, float64 array (sum of face lengths, 2).
    """

    vertices: np.ndarray
    faces: tuple[tuple[int, ...], ...]
    part: str = ""
    material: str = ""
    smooth: bool = False
    uvs: np.ndarray | None = None
    extra: dict[str, Any] = field(default_factory=dict)

    @property
    def vertex_count(self) -> int:
        """Number of vertices."""
        return len(self.vertices)
