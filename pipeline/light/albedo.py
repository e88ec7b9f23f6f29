# SPDX-License-Identifier: GPL-3.0-or-later
"""How much light floor, walls, ceiling and furniture give back, as the room's program says: luminance, 0..1."""

from __future__ import annotations

from typing import Any

import numpy as np

from ..program.prelude.looks import UNKNOWN
from ..program.prelude.palette import category_family, linear_colour, role_colour
from ..program.prelude.record import Record
from ..program.prelude.shape import Shape
from .tone import luminance

_LEAST, _MOST = 0.02, 0.9


def room_albedo(record: Record) -> dict[str, float]:
    """By the id of an object or wall, and for "floor", "walls" and "ceiling"; what is not known is left out.

    Surfaces that show a picture have no colour of their own; theirs is left out too.
    """
    found: dict[str, float] = {}
    for name, role in (("floor", "floor"), ("walls", "wall"), ("ceiling", "ceiling")):
        looks = record.finishes.get(name, {})
        _put(found, name, _looked(looks, name, role) if looks else _light(role_colour(role, "")))
    for wall in record.walls:
        if wall["id"] in record.finishes:
            _put(found, wall["id"], _looked(record.finishes[wall["id"]], "wall", "wall"))
    for line in record.proxies:
        shapes = record.furnished.get(line["id"])
        if shapes:
            _put(
                found, line["id"], _mean(shapes, record.finishes.get(line["id"], {}), category_family(line["category"]))
            )
    return found


def _put(found: dict[str, float], name: str, value: float | None) -> None:
    if value is not None:
        found[name] = min(_MOST, max(_LEAST, value))


def _looked(looks: dict[str, Any], *keys: str) -> float | None:
    """Of the look that one of the keys has, or of that for everything else."""
    look = next((looks[key] for key in (*keys, "") if key in looks), None)
    if look is None or look.colour == UNKNOWN:
        return None
    return _light(linear_colour(look.colour.lstrip("#")))


def _mean(shapes: list[Shape], looks: dict[str, Any], family: str) -> float:
    """Of an object's parts, by the size of the boxes round them."""
    values, weights = [], []
    for shape in shapes:
        if shape.vertex_count:
            own = _looked(looks, shape.part, shape.material) if looks else None
            values.append(own if own is not None else _light(role_colour(shape.material, family)))
            a, b, c = np.sort(np.ptp(shape.vertices, axis=0))
            weights.append(float(b * c + a * c) + 1e-6)
    return float(np.average(values, weights=weights)) if values else 0.4


def _light(colour: tuple[float, ...]) -> float:
    return float(luminance(np.array(colour[:3], dtype=float)))
