# SPDX-License-Identifier: GPL-3.0-or-later
"""First guesses of what a thing is, from its size, shape, colour, place and neighbours."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .grid import Floats
from .place import Footprint


@dataclass(frozen=True)
class Kind:
    """A category with the size it usually has, metres.

    Attributes:
        long, short: sides of the footprint; spread: relative width of the prior.
        height: usual height; wall: how it likes to stand: 1 at a wall, -1 free, 0 either way.
        round: True when it is usually round from above, None when it may be either.
        bonus: how common it is.
    """

    category: str
    long: float
    short: float
    height: float
    spread: float = 0.18
    wall: int = 0
    round: bool | None = False
    bonus: float = 0.0


KINDS = (
    Kind("double_bed", 2.05, 1.65, 0.55, 0.14, 1, False, 0.6),
    Kind("single_bed", 2.02, 0.95, 0.5, 0.12, 1, False, 0.4),
    Kind("wardrobe", 1.5, 0.6, 2.1, 0.3, 1, False, 0.2),
    Kind("wardrobe", 2.3, 0.62, 2.1, 0.2, 1),
    Kind("sofa", 2.0, 0.9, 0.8, 0.17, 0, False, 0.3),
    Kind("dresser", 1.1, 0.47, 0.85, 0.22, 1, False, 0.2),
    Kind("desk", 1.35, 0.68, 0.75, 0.2, 0, False, 0.2),
    Kind("bookshelf", 1.1, 0.32, 1.8, 0.35, 1, False, 0.1),
    Kind("nightstand", 0.48, 0.42, 0.5, 0.18, 1),
    Kind("dining_table", 1.7, 0.9, 0.75, 0.18, -1, None),
    Kind("coffee_table", 1.0, 0.58, 0.42, 0.2, -1, None),
    Kind("round_table", 0.95, 0.95, 0.72, 0.25, -1, True, 0.3),
    Kind("armchair", 0.85, 0.8, 0.85, 0.14, 0, None, 0.2),
    Kind("chair", 0.5, 0.47, 0.88, 0.18, -1, None, 0.1),
    Kind("stool", 0.36, 0.35, 0.45, 0.2, -1, True),
    Kind("side_table", 0.5, 0.48, 0.5, 0.2, 0, None),
    Kind("bench", 1.25, 0.42, 0.45, 0.18, -1),
    Kind("cabinet", 0.75, 0.5, 0.9, 0.3, 1, False, -0.2),
    Kind("sideboard", 1.7, 0.45, 0.8, 0.2, 1, False, -0.1),
    Kind("storage_box", 0.45, 0.35, 0.4, 0.3, 0, False, -0.5),
    Kind("shelf", 0.8, 0.2, 1.2, 0.3, 1, False, -0.4),
    Kind("floor_lamp", 0.4, 0.4, 1.5, 0.25, 0, True, 0.0),
    Kind("pouf", 0.55, 0.55, 0.42, 0.2, -1, True, 0.0),
    Kind("table", 1.2, 1.1, 0.75, 0.35, -1, False, -0.4),
)
PLANT = Kind("potted_plant", 0.5, 0.5, 1.0, 0.5)
RUG = Kind("rug", 2.0, 1.4, 0.015)
FALLBACK = Kind("cabinet", 1.0, 0.6, 0.8)


@dataclass(frozen=True)
class Looks:
    """What the guess goes by, besides size.

    Attributes:
        colour: mean Lab; roundness: hull over rectangle; wall_gap: metres to the nearest wall.
        near_bed: metres to the nearest bed's side, or None; near_table: to a desk or table.
        loaded: something lies on it; seat: a chair stands at it; height: as measured, or None; backed: only a long side is at a wall.
    """

    colour: Floats
    roundness: float
    wall_gap: float
    near_bed: float | None = None
    near_table: float | None = None
    loaded: bool = False
    seat: bool = False
    backed: bool = False
    height: float | None = None


def is_green(colour: Floats) -> bool:
    """Leaf colours."""
    return bool(colour[1] < -9 and colour[2] > 6)


def _score(kind: Kind, foot: Footprint, looks: Looks) -> float:
    """Logarithm of how well a kind fits; 0 is a perfect and common fit."""
    long, short = max(foot.length, foot.breadth), max(min(foot.length, foot.breadth), 0.01)
    value = -0.5 * (np.log(long / kind.long) / kind.spread) ** 2 - 0.5 * (np.log(short / kind.short) / kind.spread) ** 2
    value += kind.bonus
    at_wall = looks.wall_gap < 0.22
    if kind.wall == 1 and not at_wall:
        value -= 2.2
    if kind.wall == -1 and at_wall:
        value -= 1.0
    is_round = looks.roundness < 0.86 and long / short < 1.35
    if kind.round is not None and kind.round != is_round:
        value -= 1.5
    if kind.category == "nightstand":
        value += 2.5 if looks.near_bed is not None and looks.near_bed < 0.35 else -1.0
    if kind.category in ("chair", "stool"):
        value += 1.2 if looks.near_table is not None and looks.near_table < 0.45 else -0.6
    if looks.height is not None:
        value -= 0.5 * (np.log(kind.height / looks.height) / 0.35) ** 2
    if kind.height > 1.2 and looks.loaded:
        value -= 1.5
    if kind.category in ("desk", "dining_table", "table") and looks.seat:
        value += 1.6
    if kind.category.endswith("bed") and looks.backed:
        value -= 1.2
    if kind.category == "bench" and looks.near_bed is not None and looks.near_bed < 0.3:
        value += 2.0
    return float(value)


def guess(foot_of: dict[float, Footprint], looks: Looks) -> tuple[Kind, float]:
    """The likeliest kind and a confidence 0.1..0.8.

    Args:
        foot_of: the footprint for each height in `heights()`, since in perspective the size depends on it.
    """
    if is_green(looks.colour):
        return PLANT, 0.7
    scored = sorted(((_score(kind, foot_of[kind.height], looks), i) for i, kind in enumerate(KINDS)), reverse=True)
    best, index = scored[0]
    if best < -6.0:
        return FALLBACK, 0.15
    rival = next((value for value, i in scored[1:] if KINDS[i].category != KINDS[index].category), best - 3)
    certainty = 1 / (1 + np.exp(rival - best)) * np.exp(min(0.0, best) / 4)
    return KINDS[index], float(np.clip(certainty, 0.1, 0.8))


def heights() -> tuple[float, ...]:
    """All heights that a guess may assume, metres."""
    return tuple(sorted({kind.height for kind in KINDS}))


def small_category(
    parent: str, colour: Floats, parent_colour: Floats, foot: Footprint, roundness: float
) -> tuple[str, float]:
    """Category and height in metres of something on top of a piece of furniture."""
    long, short = max(foot.length, foot.breadth), min(foot.length, foot.breadth)
    if is_green(colour):
        return "potted_plant", 0.3
    if parent.endswith("bed"):
        if long < 0.95 and short > 0.2:
            return "pillow", 0.14
        return "blanket", 0.04
    if parent in ("sofa", "armchair", "bench"):
        return ("cushion", 0.15) if short > 0.2 else ("blanket", 0.03)
    if parent in ("nightstand", "side_table", "dresser") and roundness < 0.9 and long / max(short, 0.01) < 1.4:
        return "table_lamp", 0.4
    if parent == "desk" and long > 0.3 and colour[0] < 45:
        return ("monitor", 0.4) if short < 0.25 else ("laptop", 0.04)
    if long > 0.25 and long / max(short, 0.01) > 1.15 and parent in ("desk", "coffee_table", "dresser", "bookshelf"):
        return "book", 0.05
    return "decor", 0.12


def room_type(categories: set[str]) -> str:
    """Name of the room by what stands in it."""
    if categories & {"double_bed", "single_bed"}:
        return "bedroom"
    if "sofa" in categories:
        return "living room"
    if "dining_table" in categories:
        return "dining room"
    if "desk" in categories:
        return "home office"
    return "room"
