# SPDX-License-Identifier: GPL-3.0-or-later
"""From things in the picture to named furniture: what lies on what, what is flat, what each may be, and the scale."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .boxes import OrientedBox
from .categories import RUG, Looks, guess, heights, is_green, small_category
from .grouping import Thing
from .place import Footprint, Frame, WallContact, contacts

PATTERN = -2
SEATS = ("chair", "armchair", "stool")
TABLES = ("desk", "dining_table", "round_table", "coffee_table", "table")
BEDS = ("double_bed", "single_bed")


@dataclass
class Item:
    """A thing with its guess.

    Attributes:
        foot: rectangle on the floor (metres); yaw: degrees, 0 faces -y; width, depth, height in its own frame.
        base: height of its underside; parent: index of the item it stands on, or -1.
    """

    thing: Thing
    category: str
    foot: Footprint
    height: float
    confidence: float
    yaw: float = 0.0
    width: float = 0.0
    depth: float = 0.0
    base: float = 0.0
    parent: int = -1
    minor: bool = False
    directed: bool = False


def _grid(box: OrientedBox) -> NDArray[np.float64]:
    """7 x 7 points spread evenly over a box."""
    steps = (np.arange(7) + 0.5) / 7
    a, b, _, d = box.corners()
    points = a + (b - a) * steps[:, None, None] + (d - a) * steps[None, :, None]
    result: NDArray[np.float64] = points.reshape(-1, 2)
    return result


def _shares(things: list[Thing]) -> NDArray[np.float64]:
    """[i, j]: share of thing i that lies in thing j's box."""
    shares: NDArray[np.float64] = np.zeros((len(things), len(things)))
    grids = [_grid(thing.box) for thing in things]
    bounds = [thing.box.bounds() for thing in things]
    for i, (x0, y0, x1, y1) in enumerate(bounds):
        for j, (u0, v0, u1, v1) in enumerate(bounds):
            if i != j and x0 < u1 and u0 < x1 and y0 < v1 and v0 < y1:
                shares[i, j] = things[j].box.contains(grids[i]).mean()
    return shares


def _is_pattern(inner: Thing, rug: Thing, coloured: bool) -> bool:
    """A field or border of the rug itself: of its colour, or a ragged piece around its centre."""
    alike = float(np.linalg.norm((inner.colour - rug.colour) / (1.6, 1.0, 1.0))) if coloured else 10.0
    apart = float(np.linalg.norm(np.array(inner.box.centre) - np.array(rug.box.centre)))
    return (
        alike < 7
        or inner.fill < 0.45
        or (inner.box.area > 0.35 * rug.box.area and apart < 0.1 * min(rug.box.length, rug.box.breadth) and alike < 25)
    )


def nest(things: list[Thing], frame: Frame, coloured: bool = True) -> None:
    """Set `flat` and `inside`: rugs are found, and everything on something else gets to know it.

    Takes what is only a rug's pattern, or a ragged rest of something else, out of the list. The list is ordered by size, the largest first.
    `coloured` is False for line drawings.
    """
    square = frame.scale**2
    shares = _shares(things)
    for j, outer in enumerate(things):
        outer.flat = _is_rug(j, things, shares, frame, square)
    for j in [j for j, outer in enumerate(things) if outer.flat]:
        for i, inner in enumerate(things):
            if i != j and shares[i, j] > 0.8 and _is_pattern(inner, things[j], coloured):
                inner.flat, inner.inside = False, PATTERN
                things[j].size += inner.size
    ragged = [
        i
        for i, thing in enumerate(things)
        if not thing.flat
        and thing.fill < 0.55
        and any(shares[i, j] > 0.5 and other.fill > thing.fill and not other.flat for j, other in enumerate(things))
    ]
    things[:] = [thing for i, thing in enumerate(things) if thing.inside != PATTERN and i not in ragged]
    shares = _shares(things)
    for i, inner in enumerate(things):
        holders = [
            j
            for j, outer in enumerate(things)
            if j != i and not inner.flat and shares[i, j] > 0.8 and outer.box.area > 1.4 * inner.box.area
        ]
        solid = [j for j in holders if not things[j].flat]
        inner.inside = min(solid, key=lambda j: things[j].box.area) if solid else -1


def _is_rug(j: int, things: list[Thing], shares: NDArray[np.float64], frame: Frame, square: float) -> bool:
    """Something large and flat: partly hidden by what stands half on it, or free in the room with furniture on it."""
    outer = things[j]
    area = outer.box.area * square
    if area < 0.6 or min(outer.box.length, outer.box.breadth) * frame.scale < 0.45 or is_green(outer.colour):
        return False
    if frame.leaning_height(outer.box) is not None:
        return False
    hidden = 0.0
    for i, other in enumerate(things):
        over = shares[i, j] * other.box.area / outer.box.area
        if i != j and 0.03 < shares[i, j] < 0.8 and other.fill > outer.fill and over > 0.1:
            hidden += over
    if hidden > 0.12 and outer.fill < 0.88 and outer.fill + hidden > 0.7:
        return True
    short = min(outer.box.length, outer.box.breadth) * frame.scale
    near = contacts(frame, frame.footprint(outer.box, 0.0))
    over = any(0.08 < shares[j, i] < 0.8 and outer.fill > other.fill for i, other in enumerate(things) if i != j)
    if not over and all(c.gap > 0.4 for c in near) and area > 1.9 and short > 1.15:
        return True  # too large for a table, and beds stand at walls
    on_top = [
        i
        for i in range(len(things))
        if i != j
        and shares[i, j] > 0.8
        and things[i].box.area * square > 0.14
        and min(things[i].box.length, things[i].box.breadth) * frame.scale > 0.28
    ]
    if area < 1.2 or not on_top:
        return False
    if any(c.gap < 0.1 for c in near):
        return False
    offsets = [np.array(things[i].box.centre) - np.array(outer.box.centre) for i in on_top]
    long = max(outer.box.length, outer.box.breadth)
    sided = float(np.linalg.norm(np.mean(offsets, axis=0))) > 0.25 * long  # pillows lie at one end of a bed
    biggest = max(things[i].box.area for i in on_top) * square
    return not sided and (len(on_top) > 1 or biggest > 0.3)


def _gap(a: Footprint, b: Footprint) -> float:
    """Metres between two footprints' axis-aligned bounds, 0 when they touch."""
    spans = []
    for foot in (a, b):
        turn = np.radians(foot.angle)
        c, s = abs(np.cos(turn)), abs(np.sin(turn))
        spans.append(((c * foot.length + s * foot.breadth) / 2, (s * foot.length + c * foot.breadth) / 2))
    dx = abs(a.x - b.x) - spans[0][0] - spans[1][0]
    dy = abs(a.y - b.y) - spans[0][1] - spans[1][1]
    return float(np.hypot(max(dx, 0.0), max(dy, 0.0)))


def furnish(things: list[Thing], frame: Frame) -> list[Item]:
    """Guess a category for every thing, those on the floor first. The result's order is the things' order."""
    items: list[Item | None] = [None] * len(things)
    standing = [i for i, t in enumerate(things) if t.inside < 0]
    for _ in range(2):  # the second time neighbours are known
        known = [item for item in items if item is not None and item.parent < 0]
        for i in standing:
            loaded = any(t.inside == i for t in things)
            items[i] = _standing(things[i], frame, [k for k in known if k.thing is not things[i]], loaded)
    for i in sorted((i for i in range(len(things)) if i not in standing), key=lambda i: -things[i].box.area):
        items[i] = _resting(things, i, items, frame)
    result = [item for item in items if item is not None]
    for item in result:
        _turn(item, result, frame)
    return result


def _standing(thing: Thing, frame: Frame, known: list[Item], loaded: bool) -> Item:
    if thing.flat:
        return Item(thing, RUG.category, frame.footprint(thing.box, RUG.height), RUG.height, 0.6)
    measured = frame.leaning_height(thing.box)
    feet = {height: frame.footprint(thing.box, measured or height) for height in heights()}
    flat = feet[min(feet)]
    near = contacts(frame, flat)
    looks = Looks(
        thing.colour,
        thing.roundness,
        near[0].gap if near else 9.0,
        min((_gap(flat, k.foot) for k in known if k.category in BEDS), default=None),
        min((_gap(flat, k.foot) for k in known if k.category in TABLES), default=None),
        loaded,
        any(k.category in SEATS and _gap(flat, k.foot) < 0.35 for k in known),
        _backed(flat, near),
        measured,
    )
    kind, confidence = guess(feet, looks)
    height = measured or kind.height
    foot = frame.footprint(thing.box, height)
    return Item(thing, kind.category, foot, height, round(confidence * min(1.0, thing.fill + 0.2), 2))


def _backed(foot: Footprint, near: list[WallContact]) -> bool:
    """True when only a long side is at a wall, as a sofa stands and a bed does not."""
    along = foot.angle if foot.length >= foot.breadth else foot.angle + 90
    close = [c for c in near if c.gap < 0.25]
    return bool(close) and all(abs((c.yaw - along + 90) % 180 - 90) < 45 for c in close)


def _resting(things: list[Thing], i: int, items: list[Item | None], frame: Frame) -> Item:
    thing = things[i]
    holder = items[thing.inside]
    base = holder.base + holder.height if holder is not None else 0.0
    foot = frame.footprint(thing.box, 0.1, base)
    category, height = (
        ("decor", 0.12)
        if holder is None
        else small_category(holder.category, thing.colour, things[thing.inside].colour, foot, thing.roundness)
    )
    return Item(thing, category, foot, height, 0.3, base=base, parent=thing.inside, minor=True)


def _turn(item: Item, items: list[Item], frame: Frame) -> None:
    """Choose yaw among the four directions of the box, and width and depth with it."""
    foot = item.foot
    long, short = max(foot.length, foot.breadth), min(foot.length, foot.breadth)
    near = contacts(frame, foot)
    wish: float | None = None
    tables = [t for t in items if t.category in TABLES and t is not item]
    beside = min(tables, key=lambda t: _gap(foot, t.foot), default=None)
    if item.category in SEATS and beside is not None and _gap(foot, beside.foot) < 0.6:
        wish = float(np.degrees(np.arctan2(beside.foot.x - foot.x, -(beside.foot.y - foot.y))))
    elif near and not item.minor and item.category not in ("rug", "potted_plant"):
        close = [c for c in near if c.gap < 0.35] or near[:1]
        if item.category in BEDS:
            # A bed's head is at a short side, so its back is to a wall across its length.
            along = foot.angle if foot.length >= foot.breadth else foot.angle + 90
            close.sort(key=lambda c: abs(abs((c.yaw - along + 90) % 180 - 90) - 90) < 45)
            wish = close[0].yaw if abs((close[0].yaw + 90 - along + 90) % 180 - 90) < 45 else along - 90
        elif close[0].gap < 0.35:
            # In a corner the long side is the back.
            along = foot.angle if foot.length >= foot.breadth else foot.angle + 90
            if long > 1.25 * short:
                close.sort(key=lambda c: abs((c.yaw - along + 90) % 180 - 90) > 45)
            wish = close[0].yaw
        else:
            wish = near[0].yaw
    item.directed = wish is not None
    choices = [foot.angle + quarter for quarter in (0, 90, 180, 270)]
    yaw = min(choices, key=lambda y: abs((y - (wish or 0.0) + 180) % 360 - 180))
    item.yaw = float((yaw + 180) % 360 - 180)
    swapped = abs((item.yaw - foot.angle + 90) % 180 - 90) > 45
    item.width, item.depth = (foot.breadth, foot.length) if swapped else (foot.length, foot.breadth)


def measured_scale(things: list[Thing], frame: Frame, door: float | None) -> tuple[float, str]:
    """A factor for the frame's scale from things of known size, and a sentence on what fixed it.

    Args:
        door: widest door's width in metres at the present scale, or None.
    """
    best: tuple[float, float] | None = None
    for thing in things:
        if thing.flat or thing.inside >= 0 or thing.fill < 0.8:
            continue
        foot = frame.footprint(thing.box, 0.5)
        long, short = max(foot.length, foot.breadth), max(min(foot.length, foot.breadth), 0.01)
        near = contacts(frame, foot)
        factor = 2.04 / long
        width = short * factor
        wide, narrow = 1.35 < width < 1.9, 0.82 < width < 1.15
        if near and near[0].gap < 0.25 and (wide or narrow) and 0.75 < factor < 1.3:
            doubt = abs(np.log(factor)) + (0.0 if wide else 0.12)
            if best is None or doubt < best[0]:
                best = (float(doubt), float(factor))
    if best is not None:
        return best[1], "The scale comes from what looks like a bed, taken as 2.04 m long."
    if door is not None and 0.55 < door < 1.3:
        return 0.85 / door, "The scale comes from what looks like a door, taken as 0.85 m wide."
    return 1.0, "Nothing of known size was seen: the room was taken as about 15 square metres. Set one known length."
