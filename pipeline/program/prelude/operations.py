# SPDX-License-Identifier: GPL-3.0-or-later
"""From shapes to shapes. Each takes one shape or a list (also of lists); a list comes back as a flat list."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np

from .arguments import by_kind
from .budget import spend_vertices
from .checks import choice, fail, flag, is_number, number, point, text, whole
from .shape import Floats, Shape, flat_shapes, remeshed
from .solids import ORIGIN
from .unwrap import corner_uvs, refitted

Shapes = Shape | list[Shape]
AXIS_NUMBER = {"x": 0, "y": 1, "z": 2}


def each(where: str, shapes: Any, change: Callable[[Shape], Shape]) -> Shapes:
    """The change of one shape, or of each shape of a list."""
    found = flat_shapes(where, shapes)
    return change(found[0]) if isinstance(shapes, Shape) else [change(shape) for shape in found]


def moved(where: str, shape: Shape, vertices: Floats, flip: bool = False) -> Shape:
    """The shape with other vertices; with `flip` its faces are turned over, and their uvs with them."""
    if len(vertices) and not np.abs(vertices).max() <= 1e5:
        raise fail(where, "the result is too far from the origin")
    if not flip:
        return replace(shape, vertices=vertices)
    faces, uvs = tuple(face[::-1] for face in shape.faces), shape.uvs
    if uvs is not None:
        ends = np.cumsum([len(face) for face in shape.faces])[:-1]
        uvs = np.concatenate([corner[::-1] for corner in np.split(uvs, ends)])
    return replace(shape, vertices=vertices, faces=faces, uvs=uvs, flipped=not shape.flipped)


def copied(
    where: str, shapes: Any, change: Callable[[Floats], Floats], flip: bool = False, axes: Floats | None = None
) -> Shapes:
    """Shapes whose vertices are changed; every result counts as new vertices. `axes` turns their own axes along."""

    def one(shape: Shape) -> Shape:
        spend_vertices(shape.vertex_count)
        made = moved(where, shape, change(shape.vertices), flip)
        return made if axes is None else replace(made, axes=axes if shape.axes is None else axes @ shape.axes)

    return each(where, shapes, one)


def move(shapes: Any, by: Any) -> Shapes:
    """Move by (x, y, z)."""
    offset = np.array(point("move", "by", by))
    return copied("move", shapes, lambda vertices: vertices + offset)


def turn(shapes: Any, angle: Any, axis: Any = "z", about: Any = ORIGIN) -> Shapes:
    """Degrees round the axis through `about`, counter-clockwise seen against it."""
    radians = math.radians(number("turn", "angle", angle, -1e6, 1e6))
    first = (AXIS_NUMBER[choice("turn", "axis", axis, ("x", "y", "z"))] + 1) % 3
    second = (first + 1) % 3
    matrix = np.eye(3)
    matrix[first, first] = matrix[second, second] = math.cos(radians)
    matrix[second, first] = math.sin(radians)
    matrix[first, second] = -math.sin(radians)
    centre = np.array(point("turn", "about", about))
    return copied("turn", shapes, lambda vertices: (vertices - centre) @ matrix.T + centre, axes=matrix)


def scale(shapes: Any, factor: Any, about: Any = ORIGIN) -> Shapes:
    """By a number or (x, y, z), from the point `about`."""
    factors = np.array(point("scale", "factor", (factor, factor, factor) if is_number(factor) else factor))
    if not factors.all():
        raise fail("scale", "factor must not be 0")
    centre = np.array(point("scale", "about", about))

    def one(shape: Shape) -> Shape:
        spend_vertices(shape.vertex_count)
        vertices = (shape.vertices - centre) * factors + centre
        if shape.uvs is not None:
            shape = replace(shape, uvs=refitted(shape, vertices))
        return moved("scale", shape, vertices, bool(factors.prod() < 0))

    return each("scale", shapes, one)


def mirror(shapes: Any, axis: Any = "x", at: Any = 0.0) -> Shapes:
    """The image only, not the original, across axis = at."""
    column = AXIS_NUMBER[choice("mirror", "axis", axis, ("x", "y", "z"))]
    plane = number("mirror", "at", at)

    def reflect(vertices: Floats) -> Floats:
        result = vertices.copy()
        result[:, column] = 2 * plane - result[:, column]
        return result

    flipped = np.eye(3)
    flipped[column, column] = -1.0

    def one(shape: Shape) -> Shape:
        spend_vertices(shape.vertex_count)
        made = moved("mirror", shape, reflect(shape.vertices), flip=True)
        return made if shape.axes is None else replace(made, axes=flipped @ shape.axes)

    return each("mirror", shapes, one)


@by_kind
def array(shapes: Any, count: Any, step: Any) -> list[Shape]:
    """A list of copies, each moved on by step (x, y, z)."""
    found = flat_shapes("array", shapes)
    copies = whole("array", "count", count, 0, 10_000)
    offset = np.array(point("array", "step", step))
    spend_vertices(copies * sum(shape.vertex_count for shape in found))
    if copies * len(found) > 100_000:
        raise fail("array", "too many shapes")
    return [moved("array", shape, shape.vertices + offset * i) for i in range(copies) for shape in found]


def join(shapes: Any) -> Shape:
    """One shape of several of one material; named as the first."""
    found = flat_shapes("join", shapes)
    if not found:
        raise fail("join", "there are no shapes to join")
    materials = list(dict.fromkeys(shape.material for shape in found))
    if len(materials) > 1:
        words = ", ".join(name or "none" for name in materials)
        raise fail("join", f"the shapes have different materials ({words}); keep them in a list instead")
    spend_vertices(sum(shape.vertex_count for shape in found))
    faces: list[tuple[int, ...]] = []
    start = 0
    for shape in found:
        faces.extend(tuple(i + start for i in face) for face in shape.faces)
        start += shape.vertex_count
    plain = all(shape.uvs is None and not shape.rings and shape.axes is None for shape in found)
    uvs = None if plain and len(found) == 1 else np.concatenate([corner_uvs(shape) for shape in found])
    vertices = np.concatenate([shape.vertices for shape in found])
    creases = [shape.crease if shape.smooth else 60.0 for shape in found]
    looks: dict[str, Any] = {"smooth": any(shape.smooth for shape in found), "crease": min(creases)}
    return remeshed(found[0], vertices, faces, uvs=uvs, axes=None, **looks)


def part(name: Any, shapes: Any, material: Any = None, smooth: Any = None) -> Shapes:
    """Name shapes, by what they are."""
    changes: dict[str, Any] = {"part": text("part", "the name", name, 60, empty=False)}
    if material is not None:
        changes["material"] = text("part", "material", material, 60)
    if smooth is not None:
        changes["smooth"] = flag("part", "smooth", smooth)
    return each("part", shapes, lambda shape: replace(shape, **changes))


def material(name: Any, shapes: Any) -> Shapes:
    """Give a role only."""
    role = text("material", "the name", name, 60)
    return each("material", shapes, lambda shape: replace(shape, material=role))


def smooth(shapes: Any, on: Any = True, angle: Any = None) -> Shapes:
    """Or flat; edges over `angle` degrees, usually 35, stay sharp."""
    changes: dict[str, Any] = {"smooth": flag("smooth", "the second argument", on)}
    if angle is not None:
        changes["crease"] = number("smooth", "angle", angle, 0.0, 180.0)
    return each("smooth", shapes, lambda shape: replace(shape, **changes))


def bounds(shapes: Any) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """((x, y, z), (x, y, z)) of the lowest and highest corner."""
    found = [shape for shape in flat_shapes("bounds", shapes) if shape.vertex_count]
    if not found:
        raise fail("bounds", "there are no shapes")
    low = np.min([shape.vertices.min(axis=0) for shape in found], axis=0)
    high = np.max([shape.vertices.max(axis=0) for shape in found], axis=0)
    return tuple(low.tolist()), tuple(high.tolist())


def size_of(shapes: Any) -> tuple[float, ...]:
    """(width, depth, height) over all."""
    low, high = bounds(shapes)
    return tuple(b - a for a, b in zip(low, high, strict=True))
