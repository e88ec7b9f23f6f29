# SPDX-License-Identifier: GPL-3.0-or-later
"""The room language for a model that is to write object programs: short, and drawn from the constructors' docstrings."""

from __future__ import annotations

import functools
import inspect
import re
from collections.abc import Callable
from typing import Any

from .prelude import palette, registry

_COMMON = ("at", "seed", "segments", "rings", "axis", "smooth")
"""Parameters of constructors that the introduction speaks of, or that are best left alone."""
_OF_ROOMS = frozenset({"floor", "wall", "partition", "ceiling", "section", "frame", "door", "marker"})
"""Roles that only the room's own surfaces have."""
LONGEST = 8192
"""Bytes of the reference in UTF-8."""

_INTRODUCTION = """\
# Modelling language
One def per object returns a (nested) list of shapes.
Frame: metres, origin at the centre of the object's base, +X its width, FRONT = -Y, +Z up. Fill the given (width, depth,
height) and stand on z = 0.
Expressions (**, a if b else c), slices, if, for, comprehensions, defs in defs, lambda, f-strings. NO imports, attributes or methods, while,
try, classes, sets, *args, recursion, _names. Also: keys(dict) values(dict) items(dict) abs min max round sum
len range zip enumerate sorted reversed int float str bool list tuple any all; {math} (radians) pi tau.
A def must not call a function whose name it uses for a value.
Functions return new shapes; operations take one shape or a (nested) list. Makers take at= (the centre of solids, cushions
and curtains; the rest is moved by it), soft and random ones seed=, round ones segments= (sphere and torus
rings= too), {axial} axis= "x", "y" or "z".
Too large radii and edges are cut. Every shape needs part(name, shapes, material=role). Roles: {roles};
"wood #8A5A3C" has its own colour.
Parts touch or overlap by 1-2 mm. At most 12 000 vertices; segments 12-16 for legs, 32-48 for what is large.
"""

_SECTIONS: tuple[tuple[str, tuple[str, ...]], ...] = (
    ("Numbers and lists", ("lerp", "clamp", "smoothstep", "rand", "noise", "append")),
    ("Outlines (counter-clockwise points)", ("rectangle", "ellipse", "spline")),
    ("Solids", ("box", "rounded_box", "cylinder", "cone", "prism", "wedge", "sphere", "capsule", "torus", "panelled")),
    ("From outlines and sheets", ("lathe", "extrude", "tube", "sweep", "loft", "grid", "mesh")),
    ("Soft, growing", ("cushion", "pillow", "tufted", "pouf", "drape", "curtain", "rug", "leaves")),
    ("Operations", ()),
)

EXAMPLE = """\
def armchair_1(size=(0.8, 0.78, 0.85)):
    w, d, h = size
    arm, back, seat = 0.14, 0.16, 0.42
    base = rounded_box((w, d - 0.04, 0.16), at=(0, 0.02, 0.22))
    arms = [rounded_box((arm, d, 0.5), 0.05, at=(s * (w - arm) / 2, 0, 0.37)) for s in (-1, 1)]
    rest = rounded_box((w - 2 * arm + 0.02, back, h - 0.2), 0.05, at=(0, (d - back) / 2, (h + 0.2) / 2))
    pad = cushion((w - 2 * arm, d - back, seat - 0.28), at=(0, -back / 2, (seat + 0.28) / 2))
    x, y = w / 2 - 0.05, d / 2 - 0.06
    legs = [cone(0.016, 0.15, 0.024, at=(s * x, t * y, 0.075), segments=12) for s in (-1, 1) for t in (-1, 1)]
    body = part("frame", [base, arms, rest], material="fabric")
    return [body, part("cushion", pad, material="accent"), part("leg", legs, material="wood")]
"""
"""Ends the reference; a test evaluates it."""


@functools.lru_cache(maxsize=2)
def reference(example: bool = True) -> str:
    """What a model has to know of the language to model an object: rules, every constructor, an example; at most 8 kB.

    Args:
        example: whether it ends with one; who mends a program has that.
    """
    parts = [_introduction()]
    for title, names in _SECTIONS:
        shown = names or _operations()
        parts.append(f"## {title}\n" + "\n".join(entry(name, registry.CONSTRUCTORS[name]) for name in shown) + "\n")
    return "".join([*parts, "## Example\n", EXAMPLE] if example else parts)


def _introduction() -> str:
    roles = ", ".join(name for name in palette.ROLE_COLOURS if name not in _OF_ROOMS)
    axial = " ".join(
        name
        for name, f in registry.CONSTRUCTORS.items()
        if "at" in (p := inspect.signature(f).parameters) and "axis" in p and name != "mirror"
    )
    return _INTRODUCTION.format(math=" ".join(registry.MATH), roles=roles, axial=axial)


def _operations() -> tuple[str, ...]:
    """Constructors that no section names."""
    placed = {name for _, names in _SECTIONS for name in names} | {"keys", "values", "items"}
    return tuple(name for name in registry.CONSTRUCTORS if name not in placed)


def entry(name: str, function: Callable[..., Any]) -> str:
    """One constructor in a line: its signature, what it makes, and what its arguments mean."""
    first, *rest = inspect.cleandoc(function.__doc__ or "").split("\n\n")
    arguments = " ".join(p.removeprefix("Args:") for p in rest if p.startswith("Args:"))
    words = re.sub(r"\s+", " ", f"{first} {arguments}".replace("`", "")).strip()
    return f"{name}({signature(name, function)}) {words}"


def signature(name: str, function: Callable[..., Any]) -> str:
    """The parameters with their defaults, as short as they can be written; without those that the rules speak of."""
    given = inspect.signature(function).parameters.values()
    makes = "at" in inspect.signature(function).parameters and name != "mirror"
    return ", ".join(_parameter(p) for p in given if p.default is p.empty or not makes or p.name not in _COMMON)


def _parameter(parameter: inspect.Parameter) -> str:
    default = parameter.default
    return parameter.name if default is inspect.Parameter.empty else f"{parameter.name}={_short(default)}"


def _short(value: Any) -> str:
    if value == (0.0, 0.0, 0.0):
        return "origin"
    if isinstance(value, tuple):
        return "(" + ", ".join(map(_short, value)) + ")"
    return f"{value:g}" if isinstance(value, float) else f'"{value}"' if isinstance(value, str) else repr(value)
