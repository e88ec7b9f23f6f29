"""Procedural materials of the sample, by name. Colours are given as sRGB hex, as one picks them."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import bpy

Colour = tuple[float, float, float, float]


def rgb(code: str) -> Colour:
    """Linear RGBA from '#rrggbb'."""
    c = [int(code[i : i + 2], 16) / 255 for i in (1, 3, 5)]
    lin = [v / 12.92 if v <= 0.04045 else ((v + 0.055) / 1.055) ** 2.4 for v in c]
    return (lin[0], lin[1], lin[2], 1.0)


class Nodes:
    """A thin wrapper that makes node trees readable."""

    def __init__(self, name: str) -> None:
        self.material = bpy.data.materials.new(name)
        self.material.use_nodes = True
        self.tree = self.material.node_tree
        self.tree.nodes.clear()
        self.output = self.tree.nodes.new("ShaderNodeOutputMaterial")

    def add(self, kind: str, inputs: dict[str, Any] | None = None, **settings: Any) -> Any:
        """A node; `inputs` are values or sockets by name, `settings` are its properties."""
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

    def surface(self, shader: Any) -> bpy.types.Material:
        self.tree.links.new(shader.outputs[0], self.output.inputs["Surface"])
        return self.material

    def ramp(self, factor: Any, stops: list[tuple[float, Colour]]) -> Any:
        node = self.add("ValToRGB", {"Fac": factor})
        elements = node.color_ramp.elements
        while len(elements) < len(stops):
            elements.new(0.5)
        for element, (place, colour) in zip(elements, stops, strict=True):
            element.position, element.color = place, colour
        return node.outputs["Color"]

    def place(self, scale: tuple[float, float, float], output: str = "Object") -> Any:
        coordinates = self.add("TexCoord").outputs[output]
        return self.add("Mapping", {"Vector": coordinates, "Scale": scale}).outputs[0]

    def bump(self, height: Any, distance: float, strength: float = 1.0) -> Any:
        return self.add("Bump", {"Height": height, "Distance": distance, "Strength": strength}).outputs[0]


def plain(name: str, colour: str, roughness: float = 0.5, metallic: float = 0.0, **inputs: Any) -> bpy.types.Material:
    n = Nodes(name)
    return n.surface(
        n.add("BsdfPrincipled", {"Base Color": rgb(colour), "Roughness": roughness, "Metallic": metallic, **inputs})
    )


def wood(name: str, dark: str, light: str, along: str = "x", roughness: float = 0.42) -> bpy.types.Material:
    """Wood grain along one axis of the object."""
    n = Nodes(name)
    long, cross = 1.5, 24.0
    scale = {"x": (long, cross, cross), "y": (cross, long, cross), "z": (cross, cross, long)}[along]
    where = n.place(scale)
    grain = n.add("TexNoise", {"Vector": where, "Scale": 1.0, "Detail": 4.0, "Roughness": 0.62, "Distortion": 0.9})
    fine = n.add("TexNoise", {"Vector": where, "Scale": 7.0, "Detail": 3.0})
    mixed = n.add("Mix", {"0": 0.3, "2": grain.outputs[0], "3": fine.outputs[0]}).outputs[0]
    colour = n.ramp(mixed, [(0.32, rgb(dark)), (0.66, rgb(light))])
    return n.surface(
        n.add("BsdfPrincipled", {"Base Color": colour, "Roughness": roughness, "Normal": n.bump(mixed, 0.002, 0.35)})
    )


def planks(name: str) -> bpy.types.Material:
    """Floor boards: UV runs along the grain and differs from board to board; the attribute `tone` is the board's own."""
    n = Nodes(name)
    uv = n.add("TexCoord").outputs["UV"]
    where = n.add("Mapping", {"Vector": uv, "Scale": (1.1, 13.0, 1.0)}).outputs[0]
    grain = n.add("TexNoise", {"Vector": where, "Scale": 1.0, "Detail": 4.0, "Roughness": 0.6, "Distortion": 1.2})
    fine = n.add("TexNoise", {"Vector": where, "Scale": 9.0, "Detail": 3.0})
    mixed = n.add("Mix", {"0": 0.28, "2": grain.outputs[0], "3": fine.outputs[0]}).outputs[0]
    colour = n.ramp(mixed, [(0.30, rgb("#7c6048")), (0.52, rgb("#9c7d5e")), (0.72, rgb("#b09272"))])
    tone = n.add("Attribute", attribute_name="tone").outputs["Fac"]
    toned = n.add(
        "HueSaturation",
        {
            "Color": colour,
            "Saturation": 0.92,
            "Value": n.add("MapRange", {"Value": tone, "To Min": 0.80, "To Max": 1.12}).outputs[0],
        },
    )
    return n.surface(
        n.add(
            "BsdfPrincipled", {"Base Color": toned.outputs[0], "Roughness": 0.40, "Normal": n.bump(mixed, 0.002, 0.25)}
        )
    )


def fabric(
    name: str, dark: str, light: str, sheen: float = 0.25, mottling: float = 7.0, depth: float = 0.0
) -> bpy.types.Material:
    """Cloth: a mottled colour, and with `depth` (metres) a slubby bump. The weave itself is finer than a pixel."""
    n = Nodes(name)
    patches = n.add("TexNoise", {"Vector": n.place((1, 1, 1)), "Scale": mottling, "Detail": 5.0, "Roughness": 0.75})
    inputs = {
        "Base Color": n.ramp(patches.outputs[0], [(0.30, rgb(dark)), (0.70, rgb(light))]),
        "Roughness": 0.92,
        "Sheen Weight": sheen,
        "Sheen Roughness": 0.4,
    }
    if depth:
        slub = n.add("TexNoise", {"Vector": n.place((1, 1, 1)), "Scale": 90.0, "Detail": 2.0})
        inputs["Normal"] = n.bump(slub.outputs[0], depth, 0.6)
    return n.surface(n.add("BsdfPrincipled", inputs))


def knit(name: str, dark: str, light: str) -> bpy.types.Material:
    """A chunky ribbed knit; UV x runs across the ribs."""
    n = Nodes(name)
    where = n.place((1, 1, 1), "UV")
    ribs = n.add(
        "TexWave",
        {"Vector": where, "Scale": 20.0, "Distortion": 1.6, "Detail": 2.0, "Detail Scale": 3.0},
        bands_direction="X",
    )
    colour = n.ramp(ribs.outputs["Fac"], [(0.1, rgb(dark)), (0.8, rgb(light))])
    return n.surface(
        n.add(
            "BsdfPrincipled",
            {
                "Base Color": colour,
                "Roughness": 0.95,
                "Sheen Weight": 0.3,
                "Normal": n.bump(ribs.outputs["Fac"], 0.004, 0.6),
            },
        )
    )


def sheer(name: str, colour: str, through: float) -> bpy.types.Material:
    """Cloth that lets some light through: curtains and lamp shades."""
    n = Nodes(name)
    weave = n.add("TexNoise", {"Vector": n.place((90, 90, 12)), "Scale": 1.0, "Detail": 2.0})
    tint = n.ramp(weave.outputs[0], [(0.2, tuple(v * 0.86 for v in rgb(colour)[:3]) + (1.0,)), (0.8, rgb(colour))])
    front = n.add("BsdfDiffuse", {"Color": tint})
    back = n.add("BsdfTranslucent", {"Color": tint})
    return n.surface(n.add("MixShader", {"0": through, "1": front.outputs[0], "2": back.outputs[0]}))


def glow(name: str, colour: str, strength: float) -> bpy.types.Material:
    n = Nodes(name)
    return n.surface(n.add("Emission", {"Color": rgb(colour), "Strength": strength}))


def rug(name: str) -> bpy.types.Material:
    """A cream pile with a wobbly lozenge lattice and a darker border; UV is 0..1 over the rug."""
    n = Nodes(name)
    uv = n.add("TexCoord").outputs["UV"]
    wobble = n.add("TexNoise", {"Vector": uv, "Scale": 9.0, "Detail": 3.0})
    bent = n.add(
        "VectorMath",
        {
            "0": uv,
            "1": n.add(
                "VectorMath",
                {
                    "0": n.add(
                        "VectorMath", {"0": wobble.outputs["Color"], "1": (0.5, 0.5, 0.5)}, operation="SUBTRACT"
                    ).outputs[0],
                    "Scale": 0.022,
                },
                operation="SCALE",
            ).outputs[0],
        },
        operation="ADD",
    ).outputs[0]
    parts = n.add("SeparateXYZ", {"0": bent}).outputs

    def math(operation: str, a: Any, b: Any = 0.0) -> Any:
        return n.add("Math", {"0": a, "1": b}, operation=operation).outputs[0]

    u, v = math("MULTIPLY", parts[0], 6.0), math("MULTIPLY", parts[1], 5.0)
    lines = []
    for diagonal in (math("ADD", u, v), math("SUBTRACT", u, v)):
        lines.append(math("ABSOLUTE", math("SUBTRACT", math("FRACT", diagonal), 0.5)))
    lattice = math("LESS_THAN", math("MINIMUM", *lines), 0.045)
    edge = math(
        "MINIMUM",
        math("MINIMUM", parts[0], math("SUBTRACT", 1.0, parts[0])),
        math("MINIMUM", parts[1], math("SUBTRACT", 1.0, parts[1])),
    )
    inside = math("GREATER_THAN", edge, 0.075)
    border = math("MULTIPLY", math("LESS_THAN", edge, 0.058), math("GREATER_THAN", edge, 0.040))
    mask = math("MAXIMUM", math("MULTIPLY", lattice, inside), border)
    pile = n.add("TexNoise", {"Vector": n.place((1, 1, 1)), "Scale": 110.0, "Detail": 3.0, "Roughness": 0.8})
    patches = n.add("TexNoise", {"Vector": n.place((1, 1, 1)), "Scale": 5.0, "Detail": 4.0})
    cream = n.ramp(
        math("ADD", math("MULTIPLY", pile.outputs[0], 0.7), math("MULTIPLY", patches.outputs[0], 0.3)),
        [(0.35, rgb("#b7ab98")), (0.62, rgb("#e2dacb"))],
    )
    ink = n.ramp(pile.outputs[0], [(0.3, rgb("#57514b")), (0.7, rgb("#7d756c"))])
    colour = n.add("Mix", {"0": mask, "6": cream, "7": ink}, data_type="RGBA").outputs[2]
    return n.surface(
        n.add(
            "BsdfPrincipled",
            {
                "Base Color": colour,
                "Roughness": 1.0,
                "Sheen Weight": 0.3,
                "Normal": n.bump(pile.outputs[0], 0.006, 0.7),
            },
        )
    )


def leaf(name: str, dark: str, light: str) -> bpy.types.Material:
    n = Nodes(name)
    patches = n.add("TexNoise", {"Vector": n.place((1, 1, 1)), "Scale": 7.0, "Detail": 3.0})
    colour = n.ramp(patches.outputs[0], [(0.35, rgb(dark)), (0.65, rgb(light))])
    front = n.add("BsdfPrincipled", {"Base Color": colour, "Roughness": 0.38})
    back = n.add("BsdfTranslucent", {"Color": colour})
    return n.surface(n.add("MixShader", {"0": 0.2, "1": front.outputs[0], "2": back.outputs[0]}))


def print_art(name: str) -> bpy.types.Material:
    """An abstract print of three soft hills and a sun; UV is 0..1 over the sheet."""
    n = Nodes(name)
    uv = n.add("TexCoord").outputs["UV"]
    parts = n.add("SeparateXYZ", {"0": uv}).outputs

    def math(operation: str, a: Any, b: Any = 0.0) -> Any:
        return n.add("Math", {"0": a, "1": b}, operation=operation).outputs[0]

    colour: Any = rgb("#e9dfcd")
    sun = n.add("VectorMath", {"0": uv, "1": (0.66, 0.68, 0.0)}, operation="SUBTRACT").outputs[0]
    sun = n.add("VectorMath", {"0": sun, "1": (1.5, 1.0, 0.0)}, operation="MULTIPLY").outputs[0]
    disc = math("LESS_THAN", n.add("VectorMath", {"0": sun}, operation="LENGTH").outputs["Value"], 0.17)
    colour = n.add("Mix", {"0": disc, "6": colour, "7": rgb("#cf8a4d")}, data_type="RGBA").outputs[2]
    for height, wave, phase, tint in (
        (0.56, 5.0, 0.6, "#b9b7a0"),
        (0.40, 6.5, 2.9, "#7f8d78"),
        (0.24, 4.2, 4.6, "#a85b3f"),
    ):
        hill = math(
            "ADD", height, math("MULTIPLY", math("SINE", math("ADD", math("MULTIPLY", parts[0], wave), phase)), 0.10)
        )
        colour = n.add(
            "Mix", {"0": math("LESS_THAN", parts[1], hill), "6": colour, "7": rgb(tint)}, data_type="RGBA"
        ).outputs[2]
    return n.surface(n.add("BsdfPrincipled", {"Base Color": colour, "Roughness": 0.6}))


def glass(name: str) -> bpy.types.Material:
    """A pane that lets the light through and shows the camera a pale sky."""
    n = Nodes(name)
    clear = n.add("BsdfTransparent", {"Color": (0.95, 0.98, 1.0, 1.0)})
    sky = n.add("Emission", {"Color": rgb("#bcd3e2"), "Strength": 1.6})
    seen = n.add("Math", {"0": n.add("LightPath").outputs["Is Camera Ray"], "1": 0.55}, operation="MULTIPLY").outputs[0]
    return n.surface(n.add("MixShader", {"0": seen, "1": clear.outputs[0], "2": sky.outputs[0]}))


MAKERS: dict[str, Callable[[str], bpy.types.Material]] = {
    "floor": planks,
    "oak_x": lambda m: wood(m, "#8c7153", "#b99d78", "x"),
    "oak_y": lambda m: wood(m, "#8c7153", "#b99d78", "y"),
    "oak_z": lambda m: wood(m, "#8c7153", "#b99d78", "z"),
    "walnut_x": lambda m: wood(m, "#4a3222", "#7a573b", "x"),
    "walnut_z": lambda m: wood(m, "#4a3222", "#7a573b", "z"),
    "lacquer": lambda m: plain(m, "#cfc8ba", 0.45),
    "lacquer_dark": lambda m: plain(m, "#a39b8c", 0.5),
    "headboard": lambda m: fabric(m, "#a2937d", "#b9aa93", depth=0.002),
    "cotton": lambda m: fabric(m, "#d6d2c9", "#e3dfd8", 0.1),
    "pillowcase": lambda m: fabric(m, "#d8d2c6", "#e6e1d7", 0.1),
    "duvet_fold": lambda m: fabric(m, "#a6a798", "#b7b7a9", 0.1),
    "terracotta": lambda m: knit(m, "#7d5848", "#98715d"),
    "velvet": lambda m: fabric(m, "#3a4a41", "#526356", 0.5),
    "bench": lambda m: fabric(m, "#8c8170", "#a69b88", depth=0.003),
    "seat": lambda m: fabric(m, "#c3baa9", "#d5cdbe", depth=0.002),
    "ceramic": lambda m: plain(m, "#d5cfc4", 0.3),
    "ceramic_blue": lambda m: plain(m, "#5d717a", 0.25),
    "clay": lambda m: plain(m, "#b06a4a", 0.85),
    "soil": lambda m: plain(m, "#2c211a", 1.0),
    "bark": lambda m: plain(m, "#5a4634", 0.9),
    "leaf": lambda m: leaf(m, "#35532f", "#5b7d48"),
    "eucalyptus": lambda m: leaf(m, "#5f7a68", "#8ba391"),
    "brass": lambda m: plain(m, "#b08d57", 0.3, 1.0),
    "black_metal": lambda m: plain(m, "#232323", 0.45, 0.6),
    "aluminium": lambda m: plain(m, "#a9acb0", 0.38, 0.9),
    "keys": lambda m: plain(m, "#26282b", 0.6),
    "screen": lambda m: glow(m, "#3f5f7a", 0.55),
    "shade": lambda m: sheer(m, "#efe3cb", 0.45),
    "bulb": lambda m: glow(m, "#ffd9a0", 9.0),
    "curtain": lambda m: sheer(m, "#ece5d8", 0.45),
    "rug": rug,
    "rug_side": lambda m: plain(m, "#b7ab98", 1.0),
    "print": print_art,
    "paper": lambda m: plain(m, "#efece4", 0.7),
    "mirror": lambda m: plain(m, "#e3eaee", 0.04, 0.62),
    "glass": glass,
    "wall": lambda m: plain(m, "#e4dfd5", 0.85),
    "wall_accent": lambda m: plain(m, "#9aa491", 0.85),
    "trim": lambda m: plain(m, "#eceae5", 0.5),
    "door": lambda m: plain(m, "#e2ded6", 0.45),
    "cut": lambda m: glow(m, "#dcdad6", 1.5),
}


def material(name: str) -> bpy.types.Material:
    """The material of that name, made on first use."""
    return bpy.data.materials.get(name) or MAKERS[name](name)
