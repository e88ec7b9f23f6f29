# SPDX-License-Identifier: GPL-3.0-or-later
"""Which look a part has: what `finish` says of it, else what its material role looks like by itself."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from typing import Any

import numpy as np

from .looks import Look
from .looks_clear import glass, mirror_glass, screen, shade, water
from .looks_cloth import carpet, fabric, leather, linen, velvet
from .looks_grown import foliage, marble, soil, stone, wicker, wood
from .looks_made import ceramic, metal, painted_wood, paper, plaster, plastic, rubber, tile
from .maps import fills
from .palette import FAMILY_COLOURS, ROLE_COLOURS, split_role
from .record import Record
from .shape import Shape
from .unwrap import UNWRAPPED

MARK = "\x1f"
"""Between a material role and the key of the look that a `finish` gave it."""

_ROLE_LOOKS: dict[str, Any] = {
    "wall": plaster, "partition": plaster, "ceiling": plaster, "frame": painted_wood, "door": painted_wood, "metal": metal, "glass": glass,
    "wood": wood, "dark wood": wood, "painted": painted_wood, "fabric": fabric, "accent": fabric, "linen": linen,
    "velvet": velvet, "leather": leather, "wicker": wicker, "steel": metal, "brass": metal, "mirror": mirror_glass,
    "screen": screen, "stone": stone, "marble": marble, "tile": tile, "ceramic": ceramic, "plastic": plastic,
    "rubber": rubber, "paper": paper, "foliage": foliage, "soil": soil, "terracotta": ceramic, "shade": shade, "water": water,
}  # fmt: skip
_MORE: dict[str, dict[str, Any]] = {"brass": {"finish": "polished"}, "terracotta": {"gloss": 0.05}}
# What an object that only has a colour of its own is made of, by its family.
_FAMILY_LOOKS: dict[str, Any] = {
    "bed": fabric, "seating": fabric, "table": painted_wood, "storage": painted_wood, "rug": carpet, "textile": linen,
    "lamp": plastic, "plant": foliage, "wall": painted_wood, "electronics": plastic, "wet": ceramic, "decor": ceramic,
    "other": plastic,
}  # fmt: skip
_CLOTH = ("fabric", "linen", "accent")
_WORKED_OUT = ("corners", UNWRAPPED)


def usual_look(role: str, family: str) -> Look | None:
    """What a material role on an object of this family looks like where nothing else was said.

    None for what is shown in one flat colour: boxes that stand in for objects, and the floor that nobody described yet.
    """
    name, code = split_role(role)
    make = _ROLE_LOOKS.get(name)
    if make is None and code and name in ("", "front"):
        make = _FAMILY_LOOKS.get(family, plastic)
    if make is None:
        return None
    if family == "rug" and name in _CLOTH:
        make = carpet
    colour = code or (ROLE_COLOURS[name][0] if name in ROLE_COLOURS else FAMILY_COLOURS["other"])
    found: Look = make(f"#{colour}", **_MORE.get(name, {}))
    return found


def dressed(shapes: list[Shape], *finishes: dict[str, Look]) -> list[Shape]:
    """Shapes with the keys of the looks that finishes give them behind their material roles.

    A part's name counts before its role, a role before "", an earlier finish before a later one.
    """
    if not finishes:
        return shapes
    looks = [look_of_role(shape.material, finishes, shape.part) for shape in shapes]
    filling: dict[str, bool] = {}
    found = []
    for shape, look in zip(shapes, looks, strict=True):
        if look is not None:
            if look.key not in filling:
                filling[look.key] = any(fills(value) for _, value in look.inputs)
            if filling[look.key]:
                shape = filled(shape, [s for s, other in zip(shapes, looks, strict=True) if other == look])
            shape = recoloured(shape, f"{shape.material}{MARK}{look.key}")
        found.append(shape)
    return found


def filled(shape: Shape, together: list[Shape]) -> Shape:
    """The shape with places 0..1 over the bounds of all shapes that show one picture, seen along the thinnest axis.

    So a picture on a wall (thin along y) is seen upright from its front, one on a rug from above, its top to the back.
    """
    points = np.concatenate([other.vertices for other in together])
    low, extent = points.min(axis=0), np.maximum(np.ptp(points, axis=0), 1e-9)
    across = {0: [1, 2], 1: [0, 2], 2: [0, 1]}[int(extent.argmin())]
    corners, _ = shape.corners
    return replace(shape, uvs=((shape.vertices - low) / extent)[corners][:, across])


def look_of_role(material: str, finishes: Iterable[dict[str, Look]], part: str = "") -> Look | None:
    """What the first finish that knows the part, the material or its role, or has a look for all else, says."""
    names = (part, material, split_role(material)[0])
    keys = [*(name for name in names if name), ""]
    return next((finish[key] for finish in finishes for key in keys if key in finish), None)


def recoloured(shape: Shape, material: str) -> Shape:
    """The shape with another material, and all that was worked out for it."""
    made = replace(shape, material=material)
    made.__dict__.update((name, shape.__dict__[name]) for name in _WORKED_OUT if name in shape.__dict__)
    return made


def shell_finishes(record: Record, kind: str, identifier: str) -> list[dict[str, Look]]:
    """The finishes of a piece of the shell, its own before those of all of its kind."""
    names = (identifier, "walls" if kind == "partition" else kind, f"{kind}s")
    return [record.finishes[name] for name in dict.fromkeys(names) if name in record.finishes]


def finish_notes(name: str, finish: dict[str, Look], shapes: list[Shape]) -> list[str]:
    """A sentence for each part or role that a finish names and the object has not."""
    parts = {shape.part for shape in shapes if shape.part}
    roles = {part for s in shapes for part in (s.material, split_role(s.material)[0]) if part}
    unknown = [key for key in finish if key and key not in parts and key not in roles]
    known = ", ".join([*sorted(parts), *sorted({split_role(r)[0] for r in roles} - {""})][:24])
    return [f"finish of {name!r}: it has no part or material {key!r}; it has {known or 'none'}." for key in unknown]
