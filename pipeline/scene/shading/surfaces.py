# SPDX-License-Identifier: GPL-3.0-or-later
"""A look as the node tree of a material: Principled, and where light goes straight through, a mix with transparency."""

from __future__ import annotations

from typing import Any

from ...program.prelude.looks import Look
from ...program.prelude.maps import Map, linear
from ..nodes import ensure_node_tree
from .patterns import Patterns
from .sockets import new_node, out, put

_SOCKETS = {
    "base": "Base Color", "roughness": "Roughness", "metallic": "Metallic", "specular": "Specular IOR Level",
    "transmission": "Transmission Weight", "ior": "IOR", "coat": "Coat Weight", "sheen": "Sheen Weight",
    "emission": "Emission Color", "strength": "Emission Strength", "alpha": "Alpha", "bump": "Normal",
    "subsurface": "Subsurface Weight",
}  # fmt: skip
_COLUMN, _ROW = 220.0, 260.0


def shade_look(material: Any, look: Look) -> None:
    """Replace a material's nodes by those of a look.

    Sockets that a map is linked to hold the look's mean as their own value, for exports that know no nodes.
    """
    tree = ensure_node_tree(material)
    tree.nodes.clear()
    patterns = Patterns(tree)
    inputs = dict(look.inputs)
    shader = new_node(tree, "BsdfPrincipled")
    put(tree, shader, "Base Color", linear(look.colour))
    for name, value in inputs.items():
        target = _SOCKETS.get(name)
        if target is not None:
            if isinstance(value, Map) and name == "roughness":
                put(tree, shader, target, 0.5)
            put(tree, shader, target, patterns.value(value))
    _soften(tree, shader, inputs, linear(look.colour))
    surface = out(shader, "BSDF")
    if "clear" in inputs:
        surface = _clear(tree, surface, linear(look.colour), inputs["clear"])
    if "through" in inputs:
        surface = _through(tree, surface, inputs["through"])
    end = new_node(tree, "OutputMaterial", {"Surface": surface})
    _lay_out(tree, end)
    if hasattr(material, "surface_render_method"):
        blended = "clear" in inputs or isinstance(inputs.get("alpha"), Map) or inputs.get("alpha", 1.0) < 1
        material.surface_render_method = "BLENDED" if blended else "DITHERED"


def _soften(tree: Any, shader: Any, inputs: dict[str, Any], colour: tuple[float, float, float]) -> None:
    """What belongs to sheen and to light below the surface."""
    if "sheen" in inputs:
        put(tree, shader, "Sheen Roughness", 0.4)
        put(tree, shader, "Sheen Tint", tuple(0.5 + 0.5 * c for c in colour))
    if "coat" in inputs:
        put(tree, shader, "Coat Roughness", 0.08)
    if "subsurface" in inputs:
        put(tree, shader, "Subsurface Scale", 0.004)


def _clear(tree: Any, surface: Any, colour: tuple[float, float, float], share: float) -> Any:
    """Thin glass: most is seen straight through it, in EEVEE too, and shadow rays pass; at grazing angles it mirrors."""
    straight = new_node(tree, "BsdfTransparent", {"Color": tuple(c**0.12 for c in colour)})
    glossy = new_node(tree, "BsdfGlossy", {"Color": (1.0, 1.0, 1.0), "Roughness": 0.01})
    # A Fresnel node takes the far side of a pane for the inside of solid glass, which is black at its rims.
    facing = out(new_node(tree, "LayerWeight", {"Blend": 0.1}), "Facing")
    edge = new_node(tree, "MapRange", {"Value": facing, "To Min": 0.02, "To Max": 0.3})
    clear = _mixed(tree, out(edge, "Result"), out(straight, "BSDF"), out(glossy, "BSDF"))
    return _mixed(tree, share, surface, clear)


def _through(tree: Any, surface: Any, share: float) -> Any:
    """Thin cloth: this share of a lamp's light passes."""
    straight = new_node(tree, "BsdfTransparent")
    path = new_node(tree, "LightPath")
    part = new_node(tree, "Math", operation="MULTIPLY")
    tree.links.new(out(path, "Is Shadow Ray"), part.inputs[0])
    part.inputs[1].default_value = share
    return _mixed(tree, out(part, "Value"), surface, out(straight, "BSDF"))


def _mixed(tree: Any, share: Any, first: Any, second: Any) -> Any:
    node = new_node(tree, "MixShader")
    for target, value in zip(node.inputs, (share, first, second), strict=False):
        if isinstance(value, float):
            target.default_value = value
        else:
            tree.links.new(value, target)
    return out(node, "Shader")


def _lay_out(tree: Any, end: Any) -> None:
    """Put the nodes in columns, so that an artist can read them."""
    sources: dict[str, list[Any]] = {}
    for link in tree.links:  # asking each socket for its links looks through all of them every time
        sources.setdefault(link.to_node.name, []).append(link.from_node)
    columns = {end.name: 0}
    waiting = [end.name]
    while waiting:
        name = waiting.pop()
        for node in sources.get(name, ()):
            if columns.get(node.name, -1) < columns[name] + 1:
                columns[node.name] = columns[name] + 1
                waiting.append(node.name)
    rows: dict[int, int] = {}
    for node in tree.nodes:
        column = columns.get(node.name, 0)
        node.location = (-_COLUMN * column, -_ROW * rows.get(column, 0))
        rows[column] = rows.get(column, 0) + 1
