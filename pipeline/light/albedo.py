# SPDX-License-Identifier: GPL-3.0-or-later
"""How much light floor, walls, ceiling and furniture give back, as the room's program says, 0..1: all of it, or one colour."""

from __future__ import annotations

from typing import Any

import numpy as np

from ..program.prelude.looks import UNKNOWN
from ..program.prelude.palette import category_family, linear_colour, role_colour
from ..program.prelude.record import Record
from ..program.prelude.shape import Shape

LUMINANCE = (0.2126, 0.7152, 0.0722)
Weights = tuple[float, float, float]
"""What linear red, green and blue count."""
_LEAST, _MOST = 0.02, 0.9


def room_albedo(record: Record, of: Weights = LUMINANCE) -> dict[str, float]:
    """By the id of an object or wall, and for "floor", "walls" and "ceiling"; what is not known is left out.

    Surfaces that show a picture have no colour of their own; theirs is left out too.

    Args:
        of: what the colours count: luminance, or (1, 0, 0) for how much red light is given back.
    """
    found: dict[str, float] = {}
    for name, role in (("floor", "floor"), ("walls", "wall"), ("ceiling", "ceiling")):
        looks = record.finishes.get(name, {})
        _put(found, name, _looked(looks, of, name, role) if looks else _light(role_colour(role, ""), of))
    for wall in record.walls:
        if wall["id"] in record.finishes:
            _put(found, wall["id"], _looked(record.finishes[wall["id"]], of, "wall", "wall"))
    for line in record.proxies:
        shapes = record.furnished.get(line["id"])
        if shapes:
            looks = record.finishes.get(line["id"], {})
            _put(found, line["id"], _mean(shapes, looks, category_family(line["category"]), of))
    return found


def _put(found: dict[str, float], name: str, value: float | None) -> None:
    if value is not None:
        found[name] = min(_MOST, max(_LEAST, value))


def _looked(looks: dict[str, Any], of: Weights, *keys: str) -> float | None:
    """Of the look that one of the keys has, or of that for everything else."""
    look = next((looks[key] for key in (*keys, "") if key in looks), None)
    if look is None or look.colour == UNKNOWN:
        return None
    return _light(linear_colour(look.colour.lstrip("#")), of)


def _mean(shapes: list[Shape], looks: dict[str, Any], family: str, of: Weights) -> float:
    """Of an object's parts, by the size of the boxes round them."""
    values, weights = [], []
    for shape in shapes:
        if shape.vertex_count:
            own = _looked(looks, of, shape.part, shape.material) if looks else None
            values.append(own if own is not None else _light(role_colour(shape.material, family), of))
            a, b, c = np.sort(np.ptp(shape.vertices, axis=0))
            weights.append(float(b * c + a * c) + 1e-6)
    return float(np.average(values, weights=weights)) if values else 0.4


def _light(colour: tuple[float, ...], of: Weights) -> float:
    return float(np.array(colour[:3], dtype=float) @ np.array(of))
