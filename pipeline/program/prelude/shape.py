# SPDX-License-Identifier: GPL-3.0-or-later
"""The value that every modelling constructor returns: a mesh as arrays, with the name of the part it is."""

from __future__ import annotations

import functools
from dataclasses import dataclass, field, replace
from itertools import chain
from typing import Any

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Shape:
    """An immutable polygon mesh in metres.

    Attributes:
        vertices: float64 array (N, 3).
        faces: tuples of vertex indices, counter-clockwise seen from outside.
        part: semantic part name ("leg", "cushion"), "" when not named yet.
        material: material role ("wood", "fabric"), "" for the object's own colour.
        smooth: shade smooth; edges where faces meet at more than `crease` degrees stay sharp.
        uvs: None, or one (u, v) in metres for each face corner, float64 array (sum of face lengths, 2).
        axes: the part's own axes as columns, where it was turned since it was made; textures follow them.
        rings, loop, flipped: sizes of the rings that the faces were made from (`rings.skin`), whether the last ring
            meets the first, and whether the faces were turned over since; () for all other meshes.
    """

    vertices: Floats
    faces: tuple[tuple[int, ...], ...]
    part: str = ""
    material: str = ""
    smooth: bool = False
    uvs: Floats | None = None
    axes: Floats | None = None
    crease: float = 35.0
    rings: tuple[int, ...] = ()
    loop: bool = False
    flipped: bool = False
    extra: dict[str, Any] = field(default_factory=dict)

    @functools.cached_property
    def corners(self) -> tuple[Any, Any]:
        """The vertex of every face corner, and the number of corners of every face, as arrays."""
        lengths = np.fromiter(map(len, self.faces), dtype=np.int64, count=len(self.faces))
        return np.fromiter(chain.from_iterable(self.faces), dtype=np.int64, count=int(lengths.sum())), lengths

    @property
    def vertex_count(self) -> int:
        """Number of vertices."""
        return len(self.vertices)


def remeshed(shape: Shape, vertices: Floats, faces: Any, **more: Any) -> Shape:
    """The shape with a new mesh, without what was only true of the old one (its uvs and rings)."""
    changes = {"uvs": None, "rings": (), "loop": False, "flipped": False, **more}
    return replace(shape, vertices=vertices, faces=tuple(faces), **changes)


def flat_shapes(where: str, shapes: Any) -> list[Shape]:
    """The shapes of one shape or of a list of shapes and lists, in order; None in a list is nothing.

    Raises ValueError on anything else.
    """
    found: list[Shape] = []
    open_lists: list[Any] = [shapes]
    while open_lists:
        item = open_lists.pop()
        if isinstance(item, Shape):
            found.append(item)
        elif isinstance(item, (list, tuple)):
            open_lists.extend(reversed(item))
        elif item is not None or shapes is None:
            raise ValueError(f"{where}: expected a shape or a list of shapes, not {describe(item)}")
        if len(found) + len(open_lists) > 100_000:
            raise ValueError(f"{where}: too many shapes")
    return found


def describe(value: Any) -> str:
    """What kind of value it is, in a plain word for messages."""
    words = {type(None): "None", bool: "True or False", int: "a number", float: "a number", str: "text", dict: "a dict"}
    return words.get(type(value), "a list" if isinstance(value, (list, tuple)) else "a function")
