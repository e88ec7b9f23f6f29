# SPDX-License-Identifier: GPL-3.0-or-later
"""What stands in the way of light and looks: boxes for furniture, and veils, which are curtains, for light alone."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..artifacts.layout import ProxyLine
from ..geometry.polygon import Floats
from ..program.prelude.palette import category_family, role_colour
from .tone import luminance

Ints = NDArray[np.int64]
Bools = NDArray[np.bool_]
FLAT = 0.05
"""Metres; what is lower lies on the floor and hides nothing."""
FAR = 1e9
"""Metres: how far it is to what a ray does not meet."""
SKIN = 1e-4
"""Metres from which on a ray meets something."""
_SLAB = 0.06  # metres: what a table's top is high
_SMALL = 0.02  # cubic metres
_THIN = frozenset(["lamp", "light", "chandelier", "pendant", "sconce", "plant", "rug", "carpet", "mat"])
_VEILS = (("sheer sheers voile voiles veil net", 0.5), ("blind blinds", 0.3), ("curtain curtains drape drapes", 0.06))
"""How much light goes through, by words; the first that fit."""
_LOW = {
    "bed": re.compile(r"\b(bed|daybed)\b"),
    "seating": re.compile(r"\b(sofa|couch|loveseat|settee|armchair|recliner)\b"),
}
_LOW_PART, _LOWEST, _BACK = 0.55, 0.4, 0.14
"""Of a bed or sofa that is higher than `_LOWEST`: what lies or sits is this part of its height; its back is so many metres."""


@dataclass(frozen=True)
class Boxes:
    """Oriented boxes: centres (N, 3), half sizes (N, 3), cosine and sine of their yaw, reflectance (N,), owners.

    Veils have how much light goes through in the place of reflectance.
    """

    centres: Floats
    halves: Floats
    cosines: Floats
    sines: Floats
    albedo: Floats
    owners: tuple[str, ...]


Row = tuple[str, tuple[float, float, float], tuple[float, float, float], float, float]
"""Of one box: owner, centre, half sizes, yaw in degrees, reflectance."""


def furniture_boxes(proxies: Iterable[ProxyLine], given: Mapping[str, float]) -> Boxes:
    """Boxes of what is large enough to matter, beds and sofas as what one lies or sits on and a back, tables as their tops.

    Args:
        given: luminance that things give back, by their id; else their family's.
    """
    rows: list[Row] = []
    for p in proxies:
        if _is_thin(p) or let_through(p) is not None or not _counts(p):
            continue
        family = category_family(p.category)
        light = given.get(p.id, float(luminance(np.array(role_colour("", family)[:3]))))
        rows += [(p.id, centre, half, p.yaw, light) for centre, half in _solid(p, family)]
    return boxes_of(rows)


def veils_of(proxies: Iterable[ProxyLine]) -> Boxes:
    """Boxes of curtains and blinds, with how much light goes through each."""
    told = [(p, let_through(p)) for p in proxies]
    return boxes_of([
        (p.id, p.centre, (p.size[0] / 2, p.size[1] / 2, p.size[2] / 2), p.yaw, share)
        for p, share in told if share is not None
    ])  # fmt: skip


def boxes_of(rows: Iterable[Row]) -> Boxes:
    """Rows as arrays."""
    rows = list(rows)
    return Boxes(
        centres=np.array([r[1] for r in rows], dtype=float).reshape(-1, 3),
        halves=np.array([r[2] for r in rows], dtype=float).reshape(-1, 3),
        cosines=np.cos(np.radians([r[3] for r in rows])),
        sines=np.sin(np.radians([r[3] for r in rows])),
        albedo=np.array([r[4] for r in rows], dtype=float),
        owners=tuple(r[0] for r in rows),
    )


def let_through(proxy: ProxyLine) -> float | None:
    """How much light goes through a curtain or a blind; None for other things."""
    words = set(re.findall(r"[a-z]+", f"{proxy.category} {proxy.label}".lower()))
    if not words & set(" ".join(known for known, _ in _VEILS).split()) or {"rod", "rail", "pole", "track"} & words:
        return None
    return next(share for known, share in _VEILS if words & set(known.split()))


def entered(boxes: Boxes, box: Ints, origins: Floats, ways: Floats, within: Floats) -> tuple[Floats, Ints, Floats]:
    """Where rays, each given with one box, enter that box: distance (`FAR` for none), across which axis, from which side."""
    x, y, z = (origins - boxes.centres[box]).T
    c, s = boxes.cosines[box], boxes.sines[box]
    local = (c * x + s * y, c * y - s * x, z)
    way = (c * ways[:, 0] + s * ways[:, 1], c * ways[:, 1] - s * ways[:, 0], ways[:, 2])
    nears, sides, leave = [], [], np.full(len(box), np.inf)
    for at, toward, half in zip(local, way, boxes.halves[box].T, strict=True):
        toward = np.where(np.abs(toward) < 1e-12, 1e-12, toward)
        one, other = (-half - at) / toward, (half - at) / toward
        nears.append(np.minimum(one, other))
        np.minimum(leave, np.maximum(one, other), out=leave)
        sides.append(-np.sign(toward))
    near = np.stack(nears)
    axis = near.argmax(axis=0)
    enter = np.maximum(np.maximum(near[0], near[1]), near[2])
    met = (enter < leave) & (enter > SKIN) & (enter < within)
    return np.where(met, enter, FAR), axis, np.choose(axis, sides)


def near(boxes: Boxes, origins: Floats, ways: Floats) -> Bools:
    """Which rays pass the ball round each box, (rays, boxes)."""
    reach = np.einsum("ij,ij->i", boxes.halves, boxes.halves)
    across = np.einsum("ij,ij->i", origins, origins)[:, None] + (boxes.centres**2).sum(axis=1)
    across -= 2 * origins @ boxes.centres.T
    along = np.einsum("ij,ij->i", origins, ways)[:, None] - ways @ boxes.centres.T
    along *= along
    along /= np.maximum(np.einsum("ij,ij->i", ways, ways), 1e-30)[:, None]
    found: Bools = across - along <= 1.0001 * reach + 1e-6
    return found


def _solid(p: ProxyLine, family: str) -> list[tuple[tuple[float, float, float], tuple[float, float, float]]]:
    """Centres and half sizes of what fills an object."""
    x, y, z = p.centre
    w, d, h = p.size
    if family == "table" and p.placement == "floor" and h > 0.3 and "nightstand" not in p.category.lower():
        return [((x, y, z + h / 2 - _SLAB / 2), (w / 2, d / 2, _SLAB / 2))]
    low = family in _LOW and h > _LOWEST and d > 3 * _BACK and _LOW[family].search(p.category.lower())
    if not low:
        return [((x, y, z), (w / 2, d / 2, h / 2))]
    part, off = _LOW_PART * h, d / 2 - _BACK / 2
    turn = math.radians(p.yaw)
    back = (x - off * math.sin(turn), y + off * math.cos(turn), z)
    return [((x, y, z - h / 2 + part / 2), (w / 2, d / 2, part / 2)), (back, (w / 2, _BACK / 2, h / 2))]


def _is_thin(proxy: ProxyLine) -> bool:
    """Whether light passes it by: rugs, lamps, leaves."""
    words = f"{proxy.category} {proxy.label}".lower().split()
    return proxy.size[2] < FLAT or not _THIN.isdisjoint(words) or proxy.placement == "ceiling"


def _counts(proxy: ProxyLine) -> bool:
    """Whether it is large enough to matter for light and looks."""
    w, d, h = proxy.size
    return proxy.salience == "major" or w * d * h > _SMALL
