# SPDX-License-Identifier: GPL-3.0-or-later
"""Procedural materials by a short text: "wood:#8c7153:#b99d78", "plain:#dddddd:0.4", "glow:#ffd9a0:9".

The first word is the kind, what follows are its parameters; colours are sRGB as one picks them. Textures follow the
vertex attribute `grain`: metres in the part's own axes, the longest first.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import bpy

GRAIN = "grain"
Colour = tuple[float, float, float, float]

ROLES = {
    "wood": "wood:#94754f:#c0a076",
    "dark wood": "wood:#46301f:#6d4c33",
    "painted": "plain:#e9e6df:0.4",
    "fabric": "cloth:#98938a:#b7b2a8",
    "linen": "cloth:#d8d3c8:#eae6de",
    "velvet": "cloth:#3d5460:#5b7482",
    "accent": "cloth:#9a5038:#bd6c50",
    "leather": "cloth:#6b4229:#8f5d3d",
    "wicker": "wood:#94713f:#c39f66",
    "jute": "cloth:#8d7750:#b29a6c",
    "metal": "metal:#3a3b3d:0.4",
    "steel": "metal:#b4b7bb:0.32",
    "brass": "metal:#b8924a:0.3",
    "mirror": "metal:#dfe6ea:0.05",
    "glass": "glass",
    "screen": "plain:#12161c:0.12",
    "stone": "stone:#8f8b84:#b3afa7",
    "marble": "stone:#cfccc6:#f0eeea",
    "tile": "plain:#dcdfde:0.25",
    "ceramic": "plain:#efede8:0.25",
    "plastic": "plain:#dfddd7:0.4",
    "rubber": "plain:#232325:0.7",
    "bin": "plain:#4a4f55:0.6",
    "paper": "plain:#f3efe4:0.8",
    "foliage": "leaf:#3a6331:#6f9a4c",
    "soil": "plain:#35281c:1.0",
    "crust": "cloth:#9b6128:#cf9648",
    "terracotta": "plain:#b0664a:0.85",
    "shade": "sheer:#f0e2c4:0.5",
    "water": "plain:#9cc3d2:0.1",
    "rug": "cloth:#b9ae9c:#dcd3c4",
    "rug line": "cloth:#5c564f:#7b736a",
    "throw": "cloth:#7b5647:#9c7461",
    "felt": "cloth:#55645f:#6f807a",
    "cover a": "plain:#7c3b33:0.6",
    "cover b": "plain:#33506b:0.6",
    "cover c": "plain:#c9b48a:0.6",
    "cover d": "plain:#51624a:0.6",
    "front": "plain:#d9d5cc:0.5",
    "": "cloth:#98938a:#b7b2a8",
}
"""What a role is made of, unless the room or the item says otherwise."""


def linear(code: str) -> Colour:
    """Linear RGBA from "#rrggbb"."""
    values = [int(code[i : i + 2], 16) / 255 for i in (1, 3, 5)]
    r, g, b = (v / 12.92 if v <= 0.04045 else ((v + 0.055) / 1.055) ** 2.4 for v in values)
    return (r, g, b, 1.0)


class _Nodes:
    """A material's node tree, written with few words."""

    def __init__(self, name: str) -> None:
        self.material: Any = bpy.data.materials.new(name)
        self.material.use_nodes = True
        self.tree = self.material.node_tree
        self.tree.nodes.clear()

    def add(self, kind: str, inputs: dict[str, Any] | None = None, **settings: Any) -> Any:
        """A node; inputs are numbers, colours or sockets by name (or by number, written as text)."""
        node = self.tree.nodes.new("ShaderNode" + kind)
        for key, value in settings.items():
            setattr(node, key, value)
        for key, value in (inputs or {}).items():
            socket = node.inputs[int(key)] if key.isdigit() else node.inputs[key]
            if isinstance(value, bpy.types.NodeSocket):
                self.tree.links.new(value, socket)
            else:
                socket.default_value = value
        return node

    def grain(self, x: float, y: float, z: float) -> Any:
        """Coordinates along the part, scaled."""
        where = self.add("Attribute", attribute_name=GRAIN).outputs["Vector"]
        return self.add("Mapping", {"Vector": where, "Scale": (x, y, z)}).outputs[0]

    def noise(self, where: Any, scale: float, detail: float = 4.0, distortion: float = 0.0) -> Any:
        inputs = {"Vector": where, "Scale": scale, "Detail": detail, "Roughness": 0.62, "Distortion": distortion}
        return self.add("TexNoise", inputs).outputs[0]

    def ramp(self, factor: Any, dark: str, light: str, low: float = 0.32, high: float = 0.68) -> Any:
        node = self.add("ValToRGB", {"Fac": factor})
        ends = node.color_ramp.elements
        (ends[0].position, ends[0].color), (ends[1].position, ends[1].color) = (
            (low, linear(dark)),
            (high, linear(light)),
        )
        return node.outputs["Color"]

    def bump(self, height: Any, distance: float) -> Any:
        return self.add("Bump", {"Height": height, "Distance": distance, "Strength": 0.6}).outputs[0]

    def solid(self, colour: Any, roughness: float, **inputs: Any) -> Any:
        shader = self.add("BsdfPrincipled", {"Base Color": colour, "Roughness": roughness, **inputs})
        return self.surface(shader)

    def surface(self, shader: Any) -> Any:
        output = self.add("OutputMaterial")
        self.tree.links.new(shader.outputs[0], output.inputs["Surface"])
        return self.material

    def mixed(self, part: Any, one: Any, other: Any) -> Any:
        return self.surface(self.add("MixShader", {"0": part, "1": one.outputs[0], "2": other.outputs[0]}))


def _plain(n: _Nodes, colour: str, roughness: str = "0.5") -> Any:
    return n.solid(linear(colour), float(roughness))


def _metal(n: _Nodes, colour: str, roughness: str = "0.35") -> Any:
    return n.solid(linear(colour), float(roughness), Metallic=0.85)


def _wood(n: _Nodes, dark: str, light: str, roughness: str = "0.42") -> Any:
    where = n.grain(1.5, 22, 22)
    mix = n.add("Mix", {"0": 0.3, "2": n.noise(where, 1.0, distortion=0.9), "3": n.noise(where, 7.0)}).outputs[0]
    return n.solid(n.ramp(mix, dark, light), float(roughness), Normal=n.bump(mix, 0.002))


def _cloth(n: _Nodes, dark: str, light: str) -> Any:
    where = n.grain(1, 1, 1)
    patches = n.add("Mix", {"0": 0.45, "2": n.noise(where, 7.0), "3": n.noise(where, 85.0, 2.0)}).outputs[0]
    more = {"Sheen Weight": 0.25, "Normal": n.bump(n.noise(where, 120.0, 2.0), 0.002)}
    return n.solid(n.ramp(patches, dark, light), 0.92, **more)


def _stone(n: _Nodes, dark: str, light: str, roughness: str = "0.35") -> Any:
    veins = n.noise(n.grain(1, 1, 1), 4.0, 9.0, 1.4)
    return n.solid(n.ramp(veins, dark, light, 0.36, 0.6), float(roughness))


def _leaf(n: _Nodes, dark: str, light: str) -> Any:
    colour = n.ramp(n.noise(n.grain(1, 1, 1), 9.0), dark, light)
    front = n.add("BsdfPrincipled", {"Base Color": colour, "Roughness": 0.45})
    return n.mixed(0.2, front, n.add("BsdfTranslucent", {"Color": colour}))


def _sheer(n: _Nodes, colour: str, through: str) -> Any:
    back = n.add("BsdfTranslucent", {"Color": linear(colour)})
    return n.mixed(float(through), n.add("BsdfDiffuse", {"Color": linear(colour)}), back)


def _glow(n: _Nodes, colour: str, strength: str) -> Any:
    return n.surface(n.add("Emission", {"Color": linear(colour), "Strength": float(strength)}))


def _glass(n: _Nodes, tint: str = "#dfeaee") -> Any:
    clear = n.add("BsdfTransparent", {"Color": linear(tint)})
    return n.mixed(0.22, clear, n.add("BsdfPrincipled", {"Base Color": linear(tint), "Roughness": 0.06}))


def _pane(n: _Nodes, colour: str = "#bcd3e2", strength: str = "1.3") -> Any:
    """A window: light goes through, the camera sees a pale sky."""
    sky = n.add("Emission", {"Color": linear(colour), "Strength": float(strength)})
    camera = n.add("LightPath").outputs["Is Camera Ray"]
    seen = n.add("Math", {"0": camera, "1": 0.75}, operation="MULTIPLY").outputs[0]
    return n.mixed(seen, n.add("BsdfTransparent"), sky)


def _boards(n: _Nodes, dark: str, light: str, wide: str = "0.14", long: str = "1.3", turn: str = "0") -> Any:
    """Floor boards with joints; `turn` degrees of their direction from the picture's x."""
    place = n.add("TexCoord").outputs["Object"]
    inputs: dict[str, Any] = {"Vector": place, "Rotation": (0, 0, float(turn) * 3.14159265 / 180)}
    where = n.add("Mapping", inputs).outputs[0]
    bricks = n.add(
        "TexBrick",
        {"Vector": where, "Color1": (0.25, 0.25, 0.25, 1), "Color2": (0.75, 0.75, 0.75, 1), "Mortar": (0, 0, 0, 1)}
        | {"Scale": 1.0, "Mortar Size": 0.0016, "Bias": 0.0, "Brick Width": float(long), "Row Height": float(wide)},
        offset=0.37,
        offset_frequency=2,
    )
    tone = bricks.outputs["Color"]
    own = n.add("VectorMath", {"0": tone, "1": (9.0, 3.0, 5.0)}, operation="MULTIPLY").outputs[0]
    moved = n.add("VectorMath", {"0": where, "1": own}, operation="ADD").outputs[0]
    stretched = n.add("Mapping", {"Vector": moved, "Scale": (1.2, 14.0, 1.0)}).outputs[0]
    grain = n.noise(stretched, 1.0, distortion=1.1)
    mix = n.add("Mix", {"0": 0.42, "2": grain, "3": tone}).outputs[0]
    colours = {"0": bricks.outputs["Fac"], "6": n.ramp(mix, dark, light), "7": linear("#3b2d20")}
    joint = n.add("Mix", colours, data_type="RGBA")
    return n.solid(joint.outputs[2], 0.42, Normal=n.bump(grain, 0.002))


def _tiles(n: _Nodes, one: str, other: str, size: str = "0.4", mortar: str = "#8d8983") -> Any:
    """Square tiles of slightly differing colours with joints."""
    place = n.add("TexCoord").outputs["Object"]
    bricks = n.add(
        "TexBrick",
        {"Vector": place, "Color1": linear(one), "Color2": linear(other), "Mortar": linear(mortar)}
        | {"Scale": 1.0, "Mortar Size": 0.004, "Bias": 0.0, "Brick Width": float(size), "Row Height": float(size)},
        offset=0.0,
    )
    cloudy = n.ramp(n.noise(place, 5.0, 6.0, 0.8), "#c9c5be", "#ffffff", 0.25, 0.7)
    mix = n.add("Mix", {"0": 0.35, "6": bricks.outputs["Color"], "7": cloudy}, data_type="RGBA", blend_type="MULTIPLY")
    return n.solid(mix.outputs[2], 0.35)


def _checker(n: _Nodes, one: str, other: str, size: str = "0.3") -> Any:
    """A chequered floor, worn a little."""
    place = n.add("TexCoord").outputs["Object"]
    shifted = n.add("Mapping", {"Vector": place, "Location": (0.05, 0.05, 0.13)}).outputs[0]
    checks = n.add(
        "TexChecker", {"Vector": shifted, "Color1": linear(one), "Color2": linear(other), "Scale": 1 / float(size)}
    )
    worn = n.ramp(n.noise(place, 3.0, 7.0, 0.6), "#9d968c", "#ffffff", 0.3, 0.7)
    mix = n.add("Mix", {"0": 0.5, "6": checks.outputs[0], "7": worn}, data_type="RGBA", blend_type="MULTIPLY")
    return n.solid(mix.outputs[2], 0.38)


def _carpet(n: _Nodes, dark: str, light: str) -> Any:
    place = n.add("TexCoord").outputs["Object"]
    pile = n.add("Mix", {"0": 0.6, "2": n.noise(place, 3.0, 6.0), "3": n.noise(place, 95.0, 3.0)}).outputs[0]
    return n.solid(n.ramp(pile, dark, light), 1.0, Normal=n.bump(pile, 0.004))


_KINDS: dict[str, Callable[..., Any]] = {
    "plain": _plain, "metal": _metal, "wood": _wood, "cloth": _cloth, "stone": _stone, "leaf": _leaf, "sheer": _sheer,
    "glow": _glow, "glass": _glass, "pane": _pane, "boards": _boards, "tiles": _tiles, "checker": _checker,
    "carpet": _carpet,
}  # fmt: skip


def material(text: str) -> Any:
    """The material of a text, made on first use. Raises KeyError for a kind that there is not."""
    found = bpy.data.materials.get(text)
    if found is not None:
        return found
    kind, *parameters = text.split(":")
    return _KINDS[kind](_Nodes(text), *parameters)
