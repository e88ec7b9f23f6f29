# SPDX-License-Identifier: GPL-3.0-or-later
"""One small example of each constructor in the room language, for the pictures in docs/geometry.md and its test."""

from __future__ import annotations

from code_as_room.pipeline.program.prelude import registry
from code_as_room.pipeline.program.reference import entry

_TWO = "box((0.2, 0.2, 0.3), at=(-0.3, 0, 0.15))"

SHEETS: dict[str, dict[str, str]] = {
    "solids": {
        "box": "box((0.6, 0.4, 0.3))",
        "rounded_box": "rounded_box((0.6, 0.4, 0.3), 0.06)",
        "cylinder": "cylinder(0.2, 0.4, edge=0.03)",
        "cone": "cone(0.25, 0.4, 0.12)",
        "prism": "prism(6, 0.25, 0.3, edge=0.02)",
        "wedge": "wedge((0.5, 0.5, 0.35), front=0.08)",
        "sphere": "sphere((0.3, 0.3, 0.2))",
        "capsule": "capsule(0.1, 0.5)",
        "torus": "[torus(0.2, 0.05), torus(0.2, 0.04, at=(0.55, 0, 0), angle=200)]",
        "panelled": 'panelled((0.5, 0.03, 0.9), rows=2, style="raised")',
        "box, carved": (
            "carve(box((0.8, 0.5, 0.1)), [box((0.4, 0.3, 0.2), at=(-0.1, 0, 0.08)), "
            "cylinder(0.06, 1, at=(0.28, 0, 0))])"
        ),
        "mesh": (
            "mesh([(0, 0, 0.4), (0.3, 0, 0), (0, 0.3, 0), (-0.3, 0, 0), (0, -0.3, 0)], [(0, 1, "
            "2), (0, 2, 3), (0, 3, 4), (0, 4, 1), (4, 3, 2, 1)])"
        ),
    },
    "profiles": {
        "lathe": "lathe([(0, 0), (0.12, 0), (0.18, 0.12), (0.1, 0.3), (0.06, 0.38), (0.09, 0.42)])",
        "extrude": "extrude(rectangle(0.6, 0.4, 0.1), 0.06, edge=0.015)",
        "extrude with holes": (
            "extrude(rectangle(0.6, 0.4, 0.05), 0.05, holes=[ellipse(0.15, 0.15, at=(-0.15, 0)), "
            "rectangle(0.15, 0.2, 0.03, at=(0.12, 0))])"
        ),
        "rectangle": "[sphere(0.012, at=(x, y, 0), segments=8, rings=6) for x, y in rectangle(0.6, 0.4, 0.1)]",
        "ellipse": "[sphere(0.012, at=(x, y, 0), segments=8, rings=6) for x, y in ellipse(0.6, 0.4)]",
        "spline": "tube(spline([(-0.4, 0, 0), (-0.2, 0, 0.3), (0.1, 0, 0.05), (0.4, 0, 0.3)]), 0.02)",
        "tube": "tube([(0, 0, 0), (0, 0, 0.4), (0.3, 0, 0.4), (0.3, 0.3, 0.4)], [0.04, 0.03, 0.03, 0.02])",
        "sweep": (
            "sweep([(0, 0), (0.06, 0), (0.06, 0.02), (0.03, 0.03), (0.02, 0.06), (0, 0.06)], "
            "[(-0.3, 0, -0.2), (0.3, 0, -0.2), (0.3, 0, 0.2), (-0.3, 0, 0.2)], closed=True)"
        ),
        "loft": (
            "loft([rectangle(0.4, 0.4, 0.02), rectangle(0.3, 0.3, 0.1), rectangle(0.1, 0.1, 0.04)], [0, 0.2, 0.45])"
        ),
        "grid": "grid(lambda u, v: 0.08 * sin(tau * u) * cos(tau * v), 24, 24, size=(0.8, 0.6))",
    },
    "soft": {
        "cushion": "cushion((0.6, 0.6, 0.16), sag=0.02)",
        "pillow": "turn(pillow((0.5, 0.4, 0.16)), 60, 'x')",
        "tufted": "tufted((1.4, 0.12, 0.7), 6, 3)",
        "drape": "[box((0.9, 0.6, 0.5), at=(0, 0, 0.25)), drape((0.9, 0.6), hang=0.28, at=(0, 0, 0.5))]",
        "drape as a duvet": "drape((1.5, 1.4), hang=(0.3, 0.3, 0.25, 0), thickness=0.04, puff=1, quilt=0.4, folds=0.3)",
        "drape as a throw": "drape((0.5, 1.1), hang=(0, 0, 0.3, 0), thickness=0.012, fringe=0.06, folds=0.3)",
        "curtain": "curtain((0.9, 0.12, 1.8))",
        "curtain with a tie": "curtain((0.8, 0.14, 1.8), gather=0.6, heading='rings')",
        "rug": "rug((1.4, 1.0, 0.015), fringe=0.06, border=0.12)",
        "rug of hide": "rug((1.4, 1.1, 0.012), 'hide')",
        "pouf": "pouf((0.55, 0.55, 0.38))",
    },
    "foliage": {
        "oval": "leaves(40, 0.16, 0.07, height=0.5)",
        "lance": "leaves(30, 0.3, 0.04, height=0.4, kind='lance')",
        "heart": "leaves(24, 0.2, 0.16, height=0.35, kind='heart', droop=0.8)",
        "round": "leaves(24, 0.16, 0.13, height=0.3, kind='round')",
        "strap": "leaves(20, 0.5, 0.05, height=0.05, kind='strap')",
        "grass": "leaves(90, 0.45, 0.012, height=0.02, kind='grass', spread=0.4)",
        "fern": "leaves(14, 0.5, 0.16, height=0.05, kind='fern', droop=0.8)",
        "succulent": "leaves(34, 0.12, 0.06, height=0.06, kind='succulent', spread=0.8)",
    },
    "operations": {
        "move": f"[{_TWO}, move({_TWO}, (0.4, 0, 0.1))]",
        "turn": f"[{_TWO}, turn(move({_TWO}, (0.6, 0, 0)), 35)]",
        "scale": f"[{_TWO}, scale(move({_TWO}, (0.5, 0, 0)), (1, 1, 1.6))]",
        "mirror": (
            "[wedge((0.2, 0.4, 0.3), at=(-0.2, 0, 0.15)), mirror(turn(wedge((0.2, 0.4, 0.3), "
            "at=(-0.2, 0, 0.15)), 20), 'x')]"
        ),
        "array": "array(cylinder(0.03, 0.4, at=(-0.4, 0, 0.2)), 6, (0.16, 0, 0))",
        "carve": (
            "carve(rounded_box((0.9, 0.5, 0.12), 0.02), extrude(rectangle(0.4, 0.3, 0.06), 0.2, at=(-0.1, 0, -0.04)))"
        ),
        "bevel": "bevel(box((0.5, 0.4, 0.3)), 0.04)",
        "subdivide": "subdivide(box((0.5, 0.4, 0.3)), 3)",
        "solidify": "solidify(grid(lambda u, v: 0.1 * sin(3 * u), 12, 4, size=(0.6, 0.4)), 0.03)",
        "displace": "displace(sphere(0.25, segments=48, rings=24), 0.03, 0.15)",
        "taper": "taper(cylinder(0.2, 0.6), 0.4)",
        "bend": "bend(loft([rectangle(0.5, 0.04)] * 13, [i * 0.06 for i in range(13)]), 50)",
        "join": f"join([{_TWO}, sphere(0.15, at=(-0.3, 0, 0.4))])",
        "smooth": "[smooth(prism(10, 0.2, 0.4), angle=45), prism(10, 0.2, 0.4, at=(0.5, 0, 0))]",
        "part, material": 'part("leg", cylinder(0.04, 0.5), material="brass")',
        "tint": 'tint(material("fabric", cushion((0.5, 0.5, 0.14))), {"fabric": "#3E6B5A"})',
    },
}
"""By sheet and title: an expression that gives shapes. A title begins with the name of what it shows, where it can."""


GROUPS: dict[str, tuple[str, ...]] = {
    "solids": ("box", "rounded_box", "cylinder", "cone", "prism", "wedge", "sphere", "capsule", "torus", "panelled", "mesh"),
    "profiles": ("rectangle", "ellipse", "spline", "lathe", "extrude", "tube", "sweep", "loft", "grid"),
    "soft": ("cushion", "pillow", "tufted", "pouf", "drape", "curtain", "rug"),
    "foliage": ("leaves",),
    "operations": (
        "move", "turn", "scale", "mirror", "array", "carve", "bevel", "subdivide", "solidify", "displace", "taper", "bend",
        "join", "part", "material", "tint", "smooth", "bounds", "size_of",
    ),
}  # fmt: skip
"""Which constructors each sheet shows, in the order of the documentation."""
MARKS = ("<!-- constructors: written by benchmark.constructor_sheets -->", "<!-- end of constructors -->")


def documentation() -> str:
    """The part of docs/geometry.md between its marks: a picture and the constructors of each group, from docstrings."""
    parts = []
    for name, constructors in GROUPS.items():
        parts += [f"### {name.capitalize()}", f"![{name}](pictures/geometry/{name}.png)", ""]
        for constructor in constructors:
            function = registry.CONSTRUCTORS[constructor]
            line = entry(constructor, function).removeprefix(f"{constructor}(")
            parts.append(f"- **{constructor}**({line}")
        parts.append("")
    return "\n".join(parts)


def program(expression: str) -> str:
    """An object program whose def `made` returns the example."""
    return f"def made():\n    return {expression}\n"
