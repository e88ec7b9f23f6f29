# SPDX-License-Identifier: GPL-3.0-or-later
"""One material for each look; made once, then left to the artist."""

from __future__ import annotations

from typing import Any

import bpy

from ..program.prelude.dressing import MARK, usual_look
from ..program.prelude.looks import Look
from ..program.prelude.palette import FAMILY_COLOURS, ROLE_COLOURS, linear_colour, role_colour, split_role
from .nodes import ensure_node_tree
from .shading.surfaces import shade_look
from .tags import COLOUR

_ROUGHNESS = {"glass": 0.05, "mirror": 0.05, "water": 0.05, "screen": 0.2, "metal": 0.35, "steel": 0.3, "brass": 0.3,
              "ceramic": 0.25, "marble": 0.3, "leather": 0.5}  # fmt: skip


def ensure_material(family: str, role: str, looks: dict[str, Look] | None = None) -> Any:
    """The material of a role on an object of this family. An existing one is returned as the artist left it.

    Args:
        role: a material role, with the key of a look behind it where a `finish` gave it one.
        looks: those looks by their keys.
    """
    named, _, key = role.partition(MARK)
    finish = (looks or {}).get(key)
    if finish is not None:
        shown = linear_colour(finish.colour[1:], _OPACITY.get(finish.name, 1.0))
        return ensure_look(finish, shown, _VIEW.get(finish.name, 0.65))
    own, code = split_role(named)
    look = usual_look(named, family)
    if look is not None:
        return ensure_look(look, role_colour(named, family), _ROUGHNESS.get(own, 0.65))
    known = family if family in FAMILY_COLOURS else "other"
    flat = named if named in ROLE_COLOURS or code else f"{known}/{'front' if named == 'front' else ''}"
    found = _known(flat)
    if found is None:
        title = flat if "/" not in flat else f"{known} front" if named == "front" else known
        found = bpy.data.materials.new(f"Room {title}")
        found[COLOUR] = flat
        _paint(found, role_colour(named, family), _ROUGHNESS.get(own, 0.65))
    return found


_OPACITY = {"glass": 0.35, "water": 0.6}
_VIEW = {"glass": 0.05, "mirror_glass": 0.05, "water": 0.05, "screen": 0.2, "metal": 0.35, "ceramic": 0.25, "marble": 0.3,
         "leather": 0.5}  # fmt: skip


def ensure_look(look: Look, shown: tuple[float, float, float, float], roughness: float) -> Any:
    """The material of a look; `shown` is its linear colour in the viewport and in pictures for the critic."""
    found = _known(look.key)
    if found is None:
        found = bpy.data.materials.new(f"Room {look.name.replace('_', ' ')} {look.colour}")
        found[COLOUR] = look.key
        found.diffuse_color = shown
        found.roughness = roughness
        shade_look(found, look)
    return found


def _known(key: str) -> Any:
    """Our material of this key, None when there is none yet."""
    return next((m for m in bpy.data.materials if m.get(COLOUR) == key and m.library is None), None)


def _paint(material: Any, colour: tuple[float, float, float, float], roughness: float) -> None:
    """The same colour for the viewport and for the Principled shader; sockets are found by name."""
    material.diffuse_color = colour
    material.roughness = roughness
    tree = ensure_node_tree(material)
    shader = next((node for node in tree.nodes if node.type == "BSDF_PRINCIPLED"), None)
    if shader is None:
        return
    values = {"Base Color": (*colour[:3], 1.0), "Roughness": roughness, "Alpha": colour[3]}
    for name, value in values.items():
        if name in shader.inputs:
            shader.inputs[name].default_value = value
    if colour[3] < 1.0 and hasattr(material, "surface_render_method"):
        material.surface_render_method = "BLENDED"
