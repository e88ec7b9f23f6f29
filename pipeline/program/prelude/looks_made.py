# SPDX-License-Identifier: GPL-3.0-or-later
"""Looks of what is made: paint, metal, tile, concrete, plaster, ceramic, plastic, rubber, paper."""

from __future__ import annotations

from typing import Any

from .checks import choice
from .looks import Look, family, own_colour, share, toned
from .looks_grown import both, graded, shades
from .maps import brick_map, bump, colour_code, lengths, linear, loose, noise_map, varied

_FINISHES = ("brushed", "polished", "cast")


def painted_wood(color: Any = "#F2EFEA", gloss: Any = 0.45) -> Look:
    """Wood under satin paint; its grain only shows as faint ridges."""
    code, colour = own_colour("painted_wood", color)
    shine = share("painted_wood", "gloss", gloss)
    fibres = loose(noise_map(0.005, 2, (30, 1, 1), "uv", rough=0.6))
    base = shades(varied(loose(noise_map(0.3, 2)), 0.1), colour, 0.03)
    return family("painted_wood", code, {"gloss": (shine, 0.45)}, base=base, roughness=0.75 - 0.55 * shine, specular=0.45,
                  bump=bump(fibres, 0.00012, 0.5))  # fmt: skip


def metal(color: Any = "#B9BCC0", finish: Any = "brushed") -> Look:
    """Metal, "brushed" along each part, "polished", or "cast" and dull."""
    where = "metal"
    code, colour = own_colour(where, color)
    kind = choice(where, "finish", finish, _FINISHES)
    options = {"finish": (kind, "brushed")}
    # A metal's colour is what it mirrors: below this it would be a black hole in the room.
    seen = toned(colour, max(1.0, 0.05 / max(1e-3, max(colour))))
    if kind == "cast":
        pits = noise_map(0.006, 4, rough=0.6)
        return family(where, code, options, base=shades(varied(pits, 0.06), seen, 0.2), metallic=0.75, roughness=0.55,
                      bump=bump(pits, 0.0004, 0.5))  # fmt: skip
    if kind == "polished":
        smears = loose(noise_map(0.08, 3))
        return family(where, code, options, base=seen, metallic=1.0, roughness=graded(smears, (0.3, 0.08), (0.7, 0.17)))
    lines = loose(noise_map(0.0015, 2, (60, 1, 1), "uv", rough=0.7))
    return family(where, code, options, base=shades(lines, seen, 0.08), metallic=1.0,
                  roughness=graded(lines, (0.25, 0.24), (0.75, 0.4)), bump=bump(lines, 0.00005, 0.5))  # fmt: skip


def tile(
    color: Any = "#DDE0DF",
    size: Any = (0.3, 0.3),
    grout: Any = "#B9B6B0",
    gap: Any = 0.003,
    offset: Any = 0,
    gloss: Any = 0.75,
) -> Look:
    """Tiles or bricks with grout.

    Args: `size` (length, height) and `gap` in metres; each row shifted by `offset` of a length; `gloss` 0 is raw brick.
    """
    where = "tile"
    code, colour = own_colour(where, color)
    sides = lengths(where, "size", size, 0.005, 10)
    line, wide, by = (
        colour_code(where, "grout", grout),
        share(where, "gap", gap, min(sides) / 2),
        share(where, "offset", offset),
    )
    shine = share(where, "gloss", gloss)
    options = {"size": (sides, (0.3, 0.3)), "grout": (line, "#B9B6B0"), "gap": (wide, 0.003), "offset": (by, 0),
               "gloss": (shine, 0.75)}  # fmt: skip
    tone, joint = (brick_map(sides, wide, output, by, 0.15) for output in ("tone", "gap"))
    clouds = noise_map(0.05, 5, rough=0.7)
    glaze = shades(both(tone, clouds, 0.25 + 0.3 * (1 - shine)), colour, 0.07 + 0.4 * (1 - shine))
    return family(where, code, options, base=both(glaze, linear(line), joint), specular=0.5,
                  roughness=graded(joint, (0.3, 0.85 - 0.72 * shine), (0.7, 0.9)), bump=bump(joint, -0.0015, 0.7))  # fmt: skip


def concrete(color: Any = "#A9A6A0", gloss: Any = 0.2) -> Look:
    """Fair-faced concrete with clouds and pores; `gloss` 1 is a polished floor."""
    code, colour = own_colour("concrete", color)
    shine = share("concrete", "gloss", gloss)
    clouds = loose(noise_map(0.7, 6, rough=0.6))
    grit = noise_map(0.008, 3, rough=0.65)
    base = shades(both(clouds, grit, 0.22), colour, 0.32, 0.2)
    return family("concrete", code, {"gloss": (shine, 0.2)}, base=base, roughness=graded(clouds, (0.3, 0.85 - 0.6 * shine),
                  (0.7, 0.7 - 0.55 * shine)), specular=0.4, bump=bump(grit, 0.0005 * (1 - shine), 0.6))  # fmt: skip


def plaster(color: Any = "#F1EEE8", rough: Any = 0.3) -> Look:
    """Painted plaster, as of walls and ceilings; `rough` 0 is smooth, 1 thick render."""
    code, colour = own_colour("plaster", color)
    much = share("plaster", "rough", rough)
    trowel = noise_map(0.02 + 0.05 * much, 5, rough=0.6)
    base = shades(noise_map(1.1, 3), colour, 0.02 + 0.05 * much)
    return family("plaster", code, {"rough": (much, 0.3)}, base=base, roughness=0.92, specular=0.25,
                  bump=bump(trowel, 0.0008 + 0.006 * much * much, 0.5))  # fmt: skip


def ceramic(color: Any = "#F6F5F2", gloss: Any = 0.8) -> Look:
    """Glazed ceramic and porcelain; `gloss` 0 is bisque or terracotta."""
    code, colour = own_colour("ceramic", color)
    shine = share("ceramic", "gloss", gloss)
    clouds = loose(noise_map(0.05, 4, rough=0.6))
    base = shades(varied(clouds, 0.06), colour, 0.03 + 0.22 * (1 - shine))
    return family("ceramic", code, {"gloss": (shine, 0.8)}, base=base, roughness=0.8 - 0.65 * shine, specular=0.5,
                  coat=max(0.0, 0.8 * shine - 0.2), bump=bump(clouds, 0.0006 + 0.0006 * (1 - shine), 0.3))  # fmt: skip


def plastic(color: Any = "#E3E1DC", gloss: Any = 0.5) -> Look:
    """Plastic and lacquer; `gloss` 1 shines."""
    code, colour = own_colour("plastic", color)
    shine = share("plastic", "gloss", gloss)
    pores = noise_map(0.0012, 1)
    return family("plastic", code, {"gloss": (shine, 0.5)}, base=colour, roughness=0.65 - 0.55 * shine, specular=0.5,
                  bump=bump(pores, 0.00005 * (1 - shine), 0.5))  # fmt: skip


def rubber(color: Any = "#2E2E2E") -> Look:
    """Rubber: dull and dark."""
    code, colour = own_colour("rubber", color)
    return family(
        "rubber", code, {}, base=colour, roughness=0.8, specular=0.3, bump=bump(noise_map(0.002, 2), 0.0001, 0.5)
    )


def paper(color: Any = "#F5F1E6") -> Look:
    """Paper, card and book covers."""
    code, colour = own_colour("paper", color)
    fibres = loose(noise_map(0.003, 4, rough=0.7))
    return family("paper", code, {}, base=shades(varied(fibres, 0.08), colour, 0.05), roughness=0.9, specular=0.2,
                  bump=bump(fibres, 0.0001, 0.5))  # fmt: skip
