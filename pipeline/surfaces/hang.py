# SPDX-License-Identifier: GPL-3.0-or-later
"""Clothes in a wardrobe hang from its rail, down to what is below: seen from above, nobody can tell how long they are."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence

import numpy as np

from ..artifacts.layout import ProxyLine
from ..geometry.polygon import Floats
from ..program.prelude.shape import Shape
from .choose import Carriers
from .find import Surface
from .frame import base_of, to_local, to_room
from .rays import faces_of, hits
from .seat import occupied

_CLOTHES = re.compile(
    r"\b(clothes|clothing|garments?|coats?|dress(es)?|shirts?|jackets?|suits?|blouses?)\b", re.IGNORECASE
)
_FOLDED = re.compile(r"\b(fold(ed)?|stack|pile|shoes?|hooks?)\b", re.IGNORECASE)
_RAIL = re.compile(r"\b(rails?|rods?|pole|bar)\b", re.IGNORECASE)
_THICK = 0.08
"""Metres that a rail may be high."""
_BESIDE, _OFF = 0.1, 0.35
"""Metres that the middle of a row may be past its rail's end, and before or behind it."""
_HOOK, _HIGHEST = 0.015, 0.03
"""Metres by which a hanger's hook stands above its rail at first, and by which it is let down or lifted onto it at most."""
_ASIDE = 0.12
"""Metres that a row is moved to be over its rail, at most."""
_HEM = 0.002
"""Metres that the longest hem gives way on what is below."""
_WITHIN, _LEAST_CELLS = 0.9, 3
"""Share of a row's outline that counts, and cells of a surface in it from which the row is over that."""
_SUNK, _DEEPEST = 0.004, 0.022
"""Metres by which hooks may be in their rail, and by which they can be after their clothes grew; what is deeper is a hanger's neck."""
_MOST = 400
"""Points of clothes over a rail that are looked at."""
_LEAST = 0.35
"""Metres that clothes are long at least."""


def is_hung(words: str) -> bool:
    """Whether a thing is clothes that hang, by what it is called."""
    said = words.replace("_", " ")
    return bool(_CLOTHES.search(said)) and not _FOLDED.search(said)


def under_rail(proxy: ProxyLine, carrier: ProxyLine, carriers: Carriers) -> ProxyLine | None:
    """A row of clothes hung from the rail over it, down to what is below; None for all else, and where that is no place.

    It keeps its place as seen from above. What stands below it (shoes) is not reached into.

    Args:
        carrier: what it is in; carriers: with all that stands there by now.
    """
    if not is_hung(f"{proxy.category} {proxy.label}"):
        return None
    x, y = to_local(carrier, proxy.centre[:2])
    rails = [
        (base_of(carrier) + float(shape.vertices[:, 2].max()) + _HOOK, shape)
        for shape in _rails(carriers.shapes.get(carrier.id, ()))
        if _is_under(shape.vertices.min(axis=0), shape.vertices.max(axis=0), x, y)
    ]
    if not rails:
        return None
    top, rail = min(rails, key=lambda r: abs(r[0] - base_of(proxy) - proxy.size[2]))
    levels = [base_of(carrier) + s.level for s in carriers.surfaces(carrier.id) if _is_over(s, proxy, carrier)]
    below = [level for level in levels if level < top - _LEAST]
    if not below:
        return None
    base = (
        max([max(below), *(t for t in _tops_below(proxy, carrier, carriers) if max(below) < t < top - _LEAST)]) - _HEM
    )
    hung = proxy.model_copy(
        update={
            "centre": (*proxy.centre[:2], (base + top) / 2),
            "size": (*proxy.size[:2], top - base),
            "parent": carrier.id,
            "placement": "surface",
        }
    )
    own = carriers.shapes.get(proxy.id, ())
    hung = _on_rail(hung, own, carrier, rail)
    height = top - _over_rail(hung, own, carrier, rail) - base
    return hung.model_copy(update={"centre": (*hung.centre[:2], base + height / 2), "size": (*hung.size[:2], height)})


def on_its_rail(proxy: ProxyLine, carrier: ProxyLine, shapes: Mapping[str, Sequence[Shape]]) -> ProxyLine:
    """Clothes that hang already, with their hooks on their rail in the shapes that they have in their size now.

    Their program was made in another size when they were hung, and hooks are not longer on longer clothes.
    """
    x, y = to_local(carrier, proxy.centre[:2])
    rails = [
        shape
        for shape in _rails(shapes.get(carrier.id, ()))
        if _is_under(shape.vertices.min(axis=0), shape.vertices.max(axis=0), x, y)
    ]
    top = base_of(proxy) + proxy.size[2] - base_of(carrier)
    rail = min(rails, key=lambda r: abs(float(r.vertices[:, 2].max()) - top), default=None)
    if rail is None:
        return proxy
    over = _over_rail(proxy, shapes.get(proxy.id, ()), carrier, rail)
    if not -_DEEPEST < over < -_SUNK:  # hooks above the rail are no harm where hems stand on what is below
        return proxy
    height = proxy.size[2] - over
    centre = (*proxy.centre[:2], base_of(proxy) + height / 2)
    return proxy.model_copy(update={"centre": centre, "size": (*proxy.size[:2], height)})


def _is_under(low: Floats, high: Floats, x: float, y: float) -> bool:
    """Whether the middle of a row of clothes is where a rail is, seen from above."""
    return bool(low[0] - _BESIDE <= x <= high[0] + _BESIDE and low[1] - _OFF <= y <= high[1] + _OFF)


def _on_rail(proxy: ProxyLine, shapes: Sequence[Shape], carrier: ProxyLine, rail: Shape) -> ProxyLine:
    """Clothes moved across their rail until their hooks are over it, as far as what they are in is deep."""
    points = np.concatenate([s.vertices for s in shapes]) if shapes else np.zeros((0, 3))
    if not len(points):
        return proxy
    low, high = rail.vertices.min(axis=0), rail.vertices.max(axis=0)
    axis = 0 if high[1] - low[1] > high[0] - low[0] else 1
    turn = math.radians(proxy.yaw - carrier.yaw)
    hooks = points[points[:, 2] > points[:, 2].max() - 0.005]
    place = list(to_local(carrier, proxy.centre[:2]))
    local = (
        hooks[:, 0] * math.cos(turn) - hooks[:, 1] * math.sin(turn),
        hooks[:, 0] * math.sin(turn) + hooks[:, 1] * math.cos(turn),
    )
    off = float((low[axis] + high[axis] - local[axis].min() - local[axis].max()) / 2) - place[axis]
    wide = abs(proxy.size[axis] * math.cos(turn)) + abs(proxy.size[1 - axis] * math.sin(turn))
    most = max(0.0, (carrier.size[axis] - wide) / 2)
    moved = min(max(place[axis] + off, min(-most, place[axis])), max(most, place[axis]))
    if abs(moved - place[axis]) > _ASIDE:
        return proxy
    place[axis] = moved
    return proxy.model_copy(update={"centre": (*to_room(carrier, place), proxy.centre[2])})


def _over_rail(proxy: ProxyLine, shapes: Sequence[Shape], carrier: ProxyLine, rail: Shape) -> float:
    """Metres by which what hangs over a rail is above it where it is nearest to it; 0 where that is no hook's height.

    Args:
        shapes: of the clothes in their own frame, as high as they were made.
    """
    points = np.concatenate([s.vertices for s in shapes]) if shapes else np.zeros((0, 3))
    if not len(points) or np.ptp(points[:, 2]) < _LEAST / 2:
        return 0.0
    low, high = rail.vertices.min(axis=0), rail.vertices.max(axis=0)
    turn = math.radians(proxy.yaw - carrier.yaw)
    x, y = to_local(carrier, proxy.centre[:2])
    heights = base_of(proxy) - base_of(carrier) + points[:, 2] * proxy.size[2] / points[:, 2].max()
    across = x + points[:, 0] * math.cos(turn) - points[:, 1] * math.sin(turn)
    along = y + points[:, 0] * math.sin(turn) + points[:, 1] * math.cos(turn)
    there = (across > low[0]) & (across < high[0]) & (along > low[1]) & (along < high[1])
    there &= np.abs(heights - (low[2] + high[2]) / 2) < _THICK
    gaps, bar = [], faces_of([rail])
    for index in np.flatnonzero(there & (heights > low[2] - 0.005))[:_MOST]:
        met = hits(bar, np.array((across[index], along[index], high[2] + 0.1)), np.array((0.0, 0.0, -1.0)))
        gaps += [heights[index] - (high[2] + 0.1 - float(met[0]))] if len(met) else []
    gap = float(min(gaps, default=0.0))
    return gap if abs(gap) <= _HIGHEST else 0.0


def _is_over(surface: Surface, proxy: ProxyLine, carrier: ProxyLine) -> bool:
    """Whether there is some of a surface below a row of clothes: a board, or a box in one corner of it."""
    x, y = to_local(carrier, proxy.centre[:2])
    width, depth = (_WITHIN * v for v in proxy.size[:2])
    below = occupied(surface.grid, x, y, width, depth, proxy.yaw - carrier.yaw) & np.isfinite(surface.heights)
    return bool(below.sum() >= _LEAST_CELLS)


def _tops_below(proxy: ProxyLine, carrier: ProxyLine, carriers: Carriers) -> list[float]:
    """Upper ends of what stands in the same carrier, where the outlines meet."""
    x, y = to_local(carrier, proxy.centre[:2])
    reach = min(proxy.size[:2]) / 2
    found = []
    for other in carriers.proxies.values():
        if other.parent == carrier.id and other.id != proxy.id and not is_hung(f"{other.category} {other.label}"):
            u, v = to_local(carrier, other.centre[:2])
            if math.hypot(u - x, v - y) < reach + max(other.size[:2]) / 2:
                found.append(base_of(other) + other.size[2])
    return found


def _rails(shapes: Sequence[Shape]) -> list[Shape]:
    """The bars that lie level."""
    named = [s for s in shapes if len(s.vertices) and _RAIL.search(s.part.replace("_", " "))]
    extents = [np.ptp(s.vertices, axis=0) for s in named]
    return [s for s, extent in zip(named, extents, strict=True) if extent[2] <= _THICK and extent.max() > 0.2]
