# SPDX-License-Identifier: GPL-3.0-or-later
"""Looks of what grew or was dug: wood, planks, wicker, stone, marble, foliage, soil."""

from __future__ import annotations

from typing import Any

from .checks import choice, flag
from .looks import BRIGHTEST, Look, family, length, own_colour, share, toned
from .maps import (
    Map,
    brick_map,
    bump,
    colour_code,
    lengths,
    linear,
    loose,
    new_map,
    noise_map,
    varied,
    voronoi_map,
    wave_map,
)

_ALONG = ("length", "x", "y", "z")


def graded(map: Map, *stops: tuple[float, Any]) -> Map:
    """A ramp of linear colours or numbers."""
    return new_map("ramp", map=map, stops=tuple(stops))


def shades(map: Map, colour: tuple[float, float, float], spread: float, grey: float = 0.0) -> Map:
    """A colour that gets darker and lighter with the map by this share, less where it is bright; on average it is the colour."""
    spread = min(spread, max(BRIGHTEST / max(*colour, 1e-6) - 1.0, 0.03))
    return graded(map, (0.2, toned(colour, 1 - spread, grey)), (0.8, toned(colour, 1 + spread)))


def both(a: Any, b: Any, by: Any = 0.5, mode: str = "mix") -> Map:
    """A mix of linear colours or maps."""
    return new_map("mix", a=a, b=b, by=by, mode=mode)


def grain_of(along: str, times: float) -> dict[str, Any]:
    """Settings of a pattern that is `times` longer along the grain: U of the UVs, or an axis of the object."""
    if along == "length":
        return {"space": "uv", "stretch": (times, 1, 1)}
    return {"space": "object", "stretch": tuple(times if along == axis else 1 for axis in "xyz")}


def wood(color: Any = "#8A5F3C", along: Any = "length", figure: Any = 0.5, gloss: Any = 0.35) -> Look:
    """Oiled wood, its grain along each part's length or an axis.

    Args: `figure` how much is seen of the grain, `gloss` 1 is lacquered.
    """
    where = "wood"
    code, colour = own_colour(where, color)
    way, much, shine = (
        choice(where, "along", along, _ALONG),
        share(where, "figure", figure),
        share(where, "gloss", gloss),
    )
    options = {"along": (way, "length"), "figure": (much, 0.5), "gloss": (shine, 0.35)}
    return family(where, code, options, **timber(colour, way, much, shine))


def timber(
    colour: tuple[float, float, float], way: str, much: float, shine: float, tone: Map | None = None
) -> dict[str, Any]:
    """What goes into the shader for wood; `tone` makes single boards darker and lighter."""
    rings = loose(noise_map(0.05, 2, distortion=0.6, rough=0.55, **grain_of(way, 9)))
    fibres = loose(noise_map(0.0035, 2, rough=0.7, **grain_of(way, 40)))
    grain = both(rings, fibres, 0.38)
    if tone is not None:
        grain = both(grain, tone, 0.42)
    # Light woods have a faint grain: their light bands have nowhere to go.
    spread = min(0.13 + 0.46 * much, 0.06 + 1.5 * max(BRIGHTEST / max(*colour, 1e-6) - 1.0, 0.0))
    base = graded(
        varied(grain, 0.1),
        (0.28, toned(colour, 1 - spread, 0.0)),
        (0.5, colour),
        (0.76, toned(colour, 1 + 0.75 * spread)),
    )
    rough = 0.62 - 0.4 * shine
    return {"base": base, "roughness": graded(fibres, (0.2, rough + 0.08), (0.8, rough - 0.06)), "specular": 0.4,
            "coat": max(0.0, shine - 0.6), "bump": bump(fibres, 0.0003 * (1 - 0.7 * shine), 0.6)}  # fmt: skip


def planks(
    color: Any = "#A9794F", size: Any = (1.4, 0.14), turned: Any = False, figure: Any = 0.4, gloss: Any = 0.4
) -> Look:
    """Floor boards of one wood, laid in rows.

    Args: `size` (length, width) of a board in metres, along the room's longer side or `turned` across it.
    """
    where = "planks"
    code, colour = own_colour(where, color)
    board = lengths(where, "size", size, 0.01, 20)
    across, much, shine = flag(where, "turned", turned), share(where, "figure", figure), share(where, "gloss", gloss)
    options = {"size": (board, (1.4, 0.14)), "turned": (across, False), "figure": (much, 0.4), "gloss": (shine, 0.4)}
    tone = brick_map(board, 0.0015, "tone", 0.37, turned=across)
    gap = brick_map(board, 0.0015, "gap", 0.37, turned=across)
    inputs = timber(colour, "length", much, shine, tone)
    inputs["base"] = both(shifted(inputs["base"], tone, across), toned(colour, 0.25), gap)
    inputs["bump"] = bump(gap, -0.0012, 0.7)
    return family(where, code, options, **inputs)


def shifted(map: Map, tone: Map, turned: bool) -> Map:
    """The maps in it laid anew for each board, so that the grain ends where a board ends."""
    values: list[tuple[str, Any]] = []
    for name, value in map.values:
        values.append((name, shifted(value, tone, turned) if isinstance(value, Map) else value))
    if map.kind == "noise":
        wide = map["stretch"]
        values = [
            (n, (wide[1], wide[0], wide[2]) if n == "stretch" and turned else v) for n, v in values if n != "loose"
        ]
        values.append(("each", tone))
    return Map(map.kind, tuple(values), map.key, map.weight)


def wicker(color: Any = "#C29A5F", size: Any = 0.03) -> Look:
    """Woven rattan; `size` how far a strand is seen before it goes under the next, in metres."""
    code, colour = own_colour("wicker", color)
    wide = length("wicker", "size", size)
    weave = brick_map((wide, wide * 0.3), wide * 0.09, "gap", 0.5, 1)
    tone = brick_map((wide, wide * 0.3), wide * 0.09, "tone", 0.5, 1)
    base = both(shades(varied(tone, 0.1), colour, 0.3), toned(colour, 0.22), weave)
    return family("wicker", code, {"size": (wide, 0.03)}, base=base, roughness=0.6, bump=bump(weave, -0.003, 0.8))


def marble(color: Any = "#E9E7E3", veins: Any = "#7C7A78", size: Any = 0.5, gloss: Any = 0.85) -> Look:
    """Polished marble; `veins` their colour, `size` about how far they are apart in metres."""
    where = "marble"
    code, colour = own_colour(where, color)
    line = colour_code(where, "veins", veins)
    wide, shine = length(where, "size", size), share(where, "gloss", gloss)
    options = {"veins": (line, "#7C7A78"), "size": (wide, 0.5), "gloss": (shine, 0.85)}
    flow = loose(noise_map(wide, 5, distortion=1.2, rough=0.6))
    thread = graded(flow, (0.44, 0.0), (0.495, 0.75), (0.505, 0.75), (0.53, 0.0))
    cloud = shades(loose(noise_map(wide * 0.7, 4)), colour, 0.07, 0.3)
    return family(
        where, code, options, base=both(cloud, linear(line), thread), roughness=0.5 - 0.45 * shine, specular=0.5
    )


def stone(color: Any = "#A7A39C", size: Any = 0.12, gloss: Any = 0.2) -> Look:
    """Cut natural stone with flecks; `size` of its clouds in metres, `gloss` 1 is polished."""
    code, colour = own_colour("stone", color)
    wide, shine = length("stone", "size", size), share("stone", "gloss", gloss)
    flecks = loose(voronoi_map(0.004, "tone"))
    clouds = loose(noise_map(wide, 6, rough=0.65))
    base = shades(varied(both(clouds, flecks, 0.3), 0.06), colour, 0.3, 0.2)
    return family("stone", code, {"size": (wide, 0.12), "gloss": (shine, 0.2)}, base=base, roughness=0.75 - 0.6 * shine,
                  bump=bump(clouds, 0.003 * (1 - shine), 0.5))  # fmt: skip


def foliage(color: Any = "#5E8B4A") -> Look:
    """Leaves, a little different each."""
    code, colour = own_colour("foliage", color)
    clouds = noise_map(0.06, 2)
    young = (min(0.9, colour[0] * 1.5 + 0.02), min(0.9, colour[1] * 1.25), colour[2] * 0.8)
    base = graded(varied(clouds, 0.1), (0.3, toned(colour, 0.6)), (0.5, colour), (0.72, young))
    veins = wave_map(0.006, "y", 0.5, 1)
    return family(
        "foliage", code, {}, base=base, roughness=0.45, specular=0.45, subsurface=0.12, bump=bump(veins, 0.0003, 0.5)
    )


def soil(color: Any = "#4A3A2C") -> Look:
    """Potting soil."""
    code, colour = own_colour("soil", color)
    crumbs = noise_map(0.012, 5, rough=0.7)
    return family(
        "soil", code, {}, base=shades(crumbs, colour, 0.6), roughness=0.95, specular=0.2, bump=bump(crumbs, 0.008, 0.8)
    )
