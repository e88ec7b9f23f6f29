# SPDX-License-Identifier: GPL-3.0-or-later
"""Looks of cloth and hide: fabric, linen, velvet, knit, carpet, leather."""

from __future__ import annotations

from typing import Any

from .looks import Look, family, length, own_colour, share, toned
from .looks_grown import both, graded, shades
from .maps import Map, bump, loose, noise_map, varied, voronoi_map


def threads(size: float, stretch: float) -> Map:
    """Yarn that runs along U and V, thicker and thinner: the two directions of a weave."""
    return both(
        loose(noise_map(size, 2, (stretch, 1, 1), "uv", rough=0.6)),
        loose(noise_map(size * 1.15, 2, (1, stretch, 1), "uv", rough=0.6)),
    )


def weave(size: float) -> Map:
    """A plain weave: small cushions side by side, `size` metres each."""
    return voronoi_map(size, "distance", 0.15, (1, 1, 1), "uv")


def sheer_inputs(sheer: float) -> dict[str, Any]:
    """What lets light through thin cloth: holes between its threads."""
    return {"alpha": 1 - 0.9 * sheer**0.5, "through": sheer} if sheer else {}


def fabric(color: Any = "#B9B4AA", size: Any = 0.003, mottle: Any = 0.4, sheer: Any = 0) -> Look:
    """Woven upholstery or cotton.

    Args: `size` of its weave in metres; `mottle` how uneven its yarn is; `sheer` 1 is a veil.
    """
    code, colour = own_colour("fabric", color)
    wide, much, thin = (
        length("fabric", "size", size),
        share("fabric", "mottle", mottle),
        share("fabric", "sheer", sheer),
    )
    options = {"size": (wide, 0.003), "mottle": (much, 0.4), "sheer": (thin, 0)}
    yarn = threads(wide * 1.2, 6)
    base = shades(varied(yarn, 0.1), colour, 0.1 + 0.4 * much)
    return family("fabric", code, options, base=base, roughness=0.9, specular=0.5, sheen=0.2,
                  bump=bump(weave(wide), -wide * 0.12, 0.6), **sheer_inputs(thin))  # fmt: skip


def linen(color: Any = "#EFEAE0", sheer: Any = 0) -> Look:
    """Bed linen and curtains: fine, soft, with faint slubs. `sheer` 1 is a veil."""
    code, colour = own_colour("linen", color)
    thin = share("linen", "sheer", sheer)
    slubs = threads(0.004, 14)
    creases = loose(noise_map(0.14, 2, distortion=0.8))
    return family("linen", code, {"sheer": (thin, 0)}, base=shades(varied(slubs, 0.06), colour, 0.12), roughness=0.92,
                  specular=0.45, sheen=0.15, bump=bump(both(creases, slubs, 0.04), 0.012, 0.5), **sheer_inputs(thin))  # fmt: skip


def velvet(color: Any = "#5C6F7B") -> Look:
    """Velvet: dark where it is seen along its pile's direction, light at its edges."""
    code, colour = own_colour("velvet", color)
    brushed = loose(noise_map(0.12, 2, distortion=1.2))
    base = graded(
        varied(brushed, 0.1), (0.3, toned(colour, 0.8)), (0.5, toned(colour, 0.97)), (0.72, toned(colour, 1.17))
    )
    return family("velvet", code, {}, base=base, roughness=0.8, specular=0.4, sheen=0.7,
                  bump=bump(noise_map(0.004, 2), 0.0006, 0.5))  # fmt: skip


def knit(color: Any = "#D8CFC0", size: Any = 0.012) -> Look:
    """Chunky knit; `size` of a stitch in metres."""
    code, colour = own_colour("knit", color)
    wide = length("knit", "size", size)
    stitches = voronoi_map(wide, "distance", 0.12, (1.0, 0.62, 1), "uv")
    base = graded(stitches, (0.1, toned(colour, 1.18)), (0.75, toned(colour, 0.5)))
    return family("knit", code, {"size": (wide, 0.012)}, base=base, roughness=0.95, specular=0.45, sheen=0.25,
                  bump=bump(stitches, -0.35 * wide, 0.8))  # fmt: skip


def carpet(color: Any = "#CFC6B8", pile: Any = 0.006, mottle: Any = 0.4) -> Look:
    """Carpet and rugs; `pile` how long the tufts are in metres, `mottle` how much their colour changes."""
    code, colour = own_colour("carpet", color)
    deep, much = length("carpet", "pile", pile), share("carpet", "mottle", mottle)
    tufts = voronoi_map(0.004 + 0.4 * deep, "distance", 1, (1, 1, 1), "uv")
    yarn = threads(0.012, 9)
    clouds = both(yarn, loose(noise_map(0.25, 3, space="uv")), 0.3)
    base = both(shades(varied(clouds, 0.06), toned(colour, 1.1), 0.12 + 0.6 * much), toned(colour, 0.45),
                graded(tufts, (0.3, 0.0), (1.0, 0.55)))  # fmt: skip
    options = {"pile": (deep, 0.006), "mottle": (much, 0.4)}
    return family(
        "carpet", code, options, base=base, roughness=1.0, specular=0.5, sheen=0.25, bump=bump(tufts, -deep * 0.5, 0.7)
    )


def leather(color: Any = "#8A5A3C", size: Any = 0.004, worn: Any = 0.3) -> Look:
    """Leather; `size` of its grain in metres, `worn` how uneven its colour is."""
    code, colour = own_colour("leather", color)
    wide, much = length("leather", "size", size), share("leather", "worn", worn)
    cells = loose(voronoi_map(wide, "edge", 1))
    clouds = loose(noise_map(0.09, 3, distortion=0.5))
    grain = graded(cells, (0.0, 0.0), (0.16, 1.0))
    base = both(
        shades(varied(clouds, 0.08), colour, 0.15 + 0.5 * much),
        toned(colour, 0.55),
        graded(cells, (0.0, 0.6), (0.1, 0.0)),
    )
    options = {"size": (wide, 0.004), "worn": (much, 0.3)}
    return family("leather", code, options, base=base, roughness=graded(clouds, (0.3, 0.52), (0.7, 0.38)), specular=0.45,
                  bump=bump(grain, wide * 0.09, 0.7))  # fmt: skip
