# SPDX-License-Identifier: GPL-3.0-or-later
"""Which names a room program may use of the prelude. Add a constructor here and nowhere else.

A room must not bind any of the names in `RESERVED` at its top level: in plain Python that would change the meaning of
the prelude, which shares the module. Names that begin with an underscore are the prelude's own (see `assemble.py`).
"""

from __future__ import annotations

import builtins
import math
from collections.abc import Callable
from typing import Any

from . import (
    carve,
    cloth,
    growing,
    joinery,
    looks,
    looks_clear,
    looks_cloth,
    looks_grown,
    looks_made,
    maps,
    numbers,
    operations,
    outlines,
    profiles,
    reshape,
    sheets,
    soft,
    solids,
    tints,
    weaving,
)

CONSTANTS: dict[str, float] = {"pi": math.pi, "tau": math.tau}
"""Names with a fixed value."""

MATH: tuple[str, ...] = (
    "sin", "cos", "tan", "asin", "acos", "atan", "atan2", "sqrt", "exp", "log",
    "floor", "ceil", "radians", "degrees", "hypot",
)  # fmt: skip
"""Functions of Python's math module that are in the language under their own names."""

CONSTRUCTORS: dict[str, Callable[..., Any]] = {
    "lerp": numbers.lerp,
    "clamp": numbers.clamp,
    "smoothstep": numbers.smoothstep,
    "rand": numbers.rand,
    "noise": numbers.noise,
    "append": numbers.append,
    "keys": numbers.keys,
    "values": numbers.values,
    "items": numbers.items,
    "rectangle": outlines.rectangle,
    "ellipse": outlines.ellipse,
    "spline": outlines.spline,
    "box": solids.box,
    "rounded_box": solids.rounded_box,
    "cylinder": solids.cylinder,
    "cone": solids.cone,
    "sphere": solids.sphere,
    "capsule": solids.capsule,
    "torus": solids.torus,
    "prism": solids.prism,
    "wedge": solids.wedge,
    "panelled": joinery.panelled,
    "lathe": profiles.lathe,
    "extrude": profiles.extrude,
    "tube": profiles.tube,
    "sweep": profiles.sweep,
    "loft": profiles.loft,
    "grid": sheets.grid,
    "mesh": sheets.mesh,
    "cushion": soft.cushion,
    "pillow": soft.pillow,
    "tufted": soft.tufted,
    "pouf": soft.pouf,
    "drape": cloth.drape,
    "curtain": cloth.curtain,
    "rug": weaving.rug,
    "leaves": growing.leaves,
    "move": operations.move,
    "turn": operations.turn,
    "scale": operations.scale,
    "mirror": operations.mirror,
    "array": operations.array,
    "carve": carve.carve,
    "bevel": reshape.bevel,
    "subdivide": reshape.subdivide,
    "solidify": reshape.solidify,
    "displace": reshape.displace,
    "taper": reshape.taper,
    "bend": reshape.bend,
    "join": operations.join,
    "part": operations.part,
    "material": operations.material,
    "tint": tints.tint,
    "smooth": operations.smooth,
    "bounds": operations.bounds,
    "size_of": operations.size_of,
}
"""Pure functions of the prelude by name: numbers to numbers, numbers to shapes, shapes to shapes."""

LOOKS: dict[str, Callable[..., Any]] = {
    "wood": looks_grown.wood,
    "planks": looks_grown.planks,
    "painted_wood": looks_made.painted_wood,
    "wicker": looks_grown.wicker,
    "fabric": looks_cloth.fabric,
    "linen": looks_cloth.linen,
    "velvet": looks_cloth.velvet,
    "knit": looks_cloth.knit,
    "carpet": looks_cloth.carpet,
    "leather": looks_cloth.leather,
    "metal": looks_made.metal,
    "glass": looks_clear.glass,
    "mirror_glass": looks_clear.mirror_glass,
    "marble": looks_grown.marble,
    "stone": looks_grown.stone,
    "tile": looks_made.tile,
    "concrete": looks_made.concrete,
    "plaster": looks_made.plaster,
    "ceramic": looks_made.ceramic,
    "plastic": looks_made.plastic,
    "rubber": looks_made.rubber,
    "paper": looks_made.paper,
    "foliage": looks_grown.foliage,
    "soil": looks_grown.soil,
    "water": looks_clear.water,
    "screen": looks_clear.screen,
    "shade": looks_clear.shade,
    "glow": looks_clear.glow,
    "principled": looks.principled,
    "noise_map": maps.noise_map,
    "wave_map": maps.wave_map,
    "voronoi_map": maps.voronoi_map,
    "brick_map": maps.brick_map,
    "picture": maps.picture,
    "ramp": maps.ramp,
    "mix": maps.mix,
    "bump": maps.bump,
}
"""What a room says of materials: families of looks, looks of one's own, and the maps that these are made of."""

LINE_NAMES: tuple[str, ...] = (
    "room", "wall", "door", "window", "opening", "proxy", "light", "world", "view", "camera", "furnish", "finish", "build"
)  # fmt: skip
"""Methods of `Recorder` that are in the language under their own names."""

RESERVED: frozenset[str] = frozenset({*CONSTANTS, *MATH, *CONSTRUCTORS, *LOOKS, *LINE_NAMES, *dir(builtins)})
