# SPDX-License-Identifier: GPL-3.0-or-later
"""Colours of their own for the material roles of one object."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from .checks import fail, text
from .operations import Shapes, each
from .palette import coloured_role, split_role
from .shape import Shape

_MOST = 40


def tint(shapes: Any, colors: Any) -> Shapes:
    """Give material roles a colour or another role: tint(shapes, {"fabric": "#8A5A3C"}).

    A colour is "#RRGGBB" (sRGB, as in a colour picker); "role #RRGGBB" changes both. "" stands for shapes without a role.
    """
    if not isinstance(colors, dict) or len(colors) > _MOST:
        raise fail("tint", 'the colours must be a dict such as {"wood": "#B58B5E"}')
    wanted: dict[str, tuple[str, str]] = {}
    for role, value in colors.items():
        name, colour = split_role(text("tint", "each colour", value, 60))
        if "#" in name:
            raise fail("tint", f'{value!r} is not a colour; write it as "#RRGGBB"')
        wanted[text("tint", "each role", role, 60)] = (name, colour)

    def tinted(shape: Shape) -> Shape:
        role, colour = split_role(shape.material)
        key = shape.material if shape.material in wanted else role  # "wood #8A5A3C" is one colour of wood only
        if key not in wanted:
            return shape
        other, new = wanted[key]
        return replace(shape, material=coloured_role(other or role, new or colour))

    return each("tint", shapes, tinted)
