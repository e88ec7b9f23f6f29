# SPDX-License-Identifier: GPL-3.0-or-later
"""One simple material for each colour of the palette; made once, then left to the artist."""

from __future__ import annotations

from typing import Any

import bpy

from ..program.prelude.palette import FAMILY_COLOURS, ROLE_COLOURS, role_colour, split_role
from .nodes import ensure_node_tree
from .tags import COLOUR

_ROUGHNESS = {"glass": 0.05, "mirror": 0.05, "water": 0.05, "screen": 0.2, "metal": 0.35, "steel": 0.3, "brass": 0.3,
              "ceramic": 0.25, "marble": 0.3, "leather": 0.5}  # fmt: skip


def ensure_material(family: str, role: str) -> Any:
    """The material of a role on an object of this family. An existing one is returned as the artist left it."""
    own, code = split_role(role)
    named_role = role in ROLE_COLOURS or bool(code)
    known = family if family in FAMILY_COLOURS else "other"
    key = role if named_role else f"{known}/{'front' if role == 'front' else ''}"
    for material in bpy.data.materials:
        if material.get(COLOUR) == key and material.library is None:
            return material
    title = role if named_role else f"{known} front" if role == "front" else known
    material = bpy.data.materials.new(f"Room {title}")
    material[COLOUR] = key
    _paint(material, role_colour(role, family), _ROUGHNESS.get(own, 0.65))
    return material


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
