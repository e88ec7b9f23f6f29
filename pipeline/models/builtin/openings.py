# SPDX-License-Identifier: GPL-3.0-or-later
"""Doors, windows and pictures: gaps in the wall ring seen from straight above, shapes on the wall faces in perspective."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .grid import Bools, Floats
from .grouping import Thing
from .outline import Outline, inward
from .place import Frame

DOOR_WIDTH = 0.85


@dataclass(frozen=True)
class Opening:
    """Something in or on a wall.

    Attributes:
        kind: "door", "window" or "picture".
        wall: index in `Frame.walls()`; along: metres from the wall's start to both ends.
        sill, height: lower edge above the floor and height above that, metres.
        bounds: picture box in working pixels.
    """

    kind: str
    wall: int
    along: tuple[float, float]
    sill: float
    height: float
    bounds: tuple[float, float, float, float]


def _wall_of_edge(edge: int, count: int) -> int:
    """Index in `Frame.walls()` (reversed order) of the outline's edge that begins at corner `edge`."""
    return (count - 2 - edge) % count


def _runs(flags: NDArray[np.bool_], bridge: int) -> list[tuple[int, int]]:
    """Start and end of each run of True, with gaps up to `bridge` closed."""
    hits = np.flatnonzero(flags)
    runs: list[list[int]] = []
    for index in hits.tolist():
        if runs and index - runs[-1][1] <= bridge + 1:
            runs[-1][1] = index
        else:
            runs.append([index, index])
    return [(a, b + 1) for a, b in runs]


def ring_gaps(lab: Floats, ink: Floats, outline: Outline, frame: Frame) -> list[Opening]:
    """Doors and windows of an orthographic view or a plan: where the wall ring is not the wall's colour.

    A gap that is light and greyish, like glass and sills, or has a line drawn along it, is a window; any other is a
    door.

    Args:
        ink: `WorkPicture.ink`.
    """
    found = []
    count = len(outline.outer)
    usual = [t for t in outline.wall if t >= 2]
    if not usual:
        return []
    ring = [inward(lab, outline.outer, e, int(round(outline.wall[e]))) for e in range(count) if outline.wall[e] >= 2]
    colour = np.median(np.concatenate([strip.reshape(-1, 3) for strip in ring]), axis=0)
    for edge in range(count):
        thickness = int(round(outline.wall[edge]))
        if thickness < 2:
            continue
        strip = inward(lab, outline.outer, edge, thickness)
        if min(strip.shape[:2]) < 2:
            continue
        other = np.linalg.norm(strip - colour, axis=2) > 12
        flags = other.mean(0) > 0.55
        corner = int(round(1.5 * max(usual)))
        flags[:corner] = flags[-corner:] = False
        for low, high in _runs(flags, max(2, int(0.12 / frame.scale))):
            width = (high - low) * frame.scale
            if not 0.45 < width < 4.0:
                continue
            patch = strip[:, low:high].reshape(-1, 3)
            light = float(np.median(patch[:, 0]))
            chroma = float(np.median(np.hypot(patch[:, 1], patch[:, 2])))
            outside = (
                outline.surround is not None and float(np.linalg.norm(np.median(patch, axis=0) - outline.surround)) < 4
            )
            drawn = inward(ink[..., None], outline.outer, edge, thickness)[:, low + 1 : high - 1, 0] < 65
            lined = drawn.size > 0 and bool((drawn.mean(1) > 0.8).any())
            window = light > 62 and chroma < 14 and (lined or width > 1.15 or not outside)
            found.append(_gap(outline, frame, edge, (low, high), window))
    return found


def _gap(outline: Outline, frame: Frame, edge: int, run: tuple[int, int], window: bool) -> Opening:
    count = len(outline.outer)
    a, b = outline.outer[edge], outline.outer[(edge + 1) % count]
    inner_a = outline.inner[edge]
    horizontal = abs(b[0] - a[0]) >= abs(b[1] - a[1])
    axis = 0 if horizontal else 1
    base = min(a[axis], b[axis])
    low, high = base + run[0], base + run[1]
    across = sorted((a[1 - axis], inner_a[1 - axis]))
    bounds = (low, across[0], high, across[1]) if horizontal else (across[0], low, across[1], high)
    wall = _wall_of_edge(edge, count)
    start, end = frame.walls()[wall]
    ends = [frame.metres(*((v, inner_a[1]) if horizontal else (inner_a[0], v))) for v in (low, high)]
    along = sorted(float((np.array(p) - start) @ (end - start) / max(np.linalg.norm(end - start), 1e-9)) for p in ends)
    sill, height = (0.9, 1.3) if window else (0.0, 2.05)
    limited = (max(along[0], 0.0), min(along[1], float(np.linalg.norm(end - start))))
    return Opening(
        "window" if window else "door",
        wall,
        limited,
        sill,
        height,
        (float(bounds[0]), float(bounds[1]), float(bounds[2]), float(bounds[3])),
    )


def on_wall(frame: Frame, thing: Thing, inside: Bools, light: float) -> Opening | None:
    """Read a thing of a perspective view as lying on a wall face; None when it does not.

    Args:
        inside: mask of the floor's outline; light: mean lightness of the wall faces.
    """
    points = np.concatenate([thing.hull, np.array([thing.box.centre])])
    rows = np.clip(points[:, 1].astype(int), 0, inside.shape[0] - 1)
    columns = np.clip(points[:, 0].astype(int), 0, inside.shape[1] - 1)
    on_floor = inside[rows, columns]
    if on_floor[-1] or on_floor.mean() > 0.12:
        return None
    vanishing = np.array(frame.vanishing)
    floor = frame.floor - vanishing
    count = len(floor)
    ray = np.array(thing.box.centre) - vanishing
    for edge in range(count):
        a, b = floor[edge], floor[(edge + 1) % count]
        normal = np.array([(b - a)[1], -(b - a)[0]])
        level = float(normal @ a)
        if level <= 0 or float(normal @ ray) <= level:
            continue
        foot = ray * level / float(normal @ ray)
        share = float((foot - a) @ (b - a)) / float((b - a) @ (b - a))
        if not 0.0 <= share <= 1.0:
            continue
        return _read_face(frame, thing, edge, a, b, light)
    return None


def _read_face(
    frame: Frame, thing: Thing, edge: int, a: NDArray[np.float64], b: NDArray[np.float64], light: float
) -> Opening | None:
    normal = np.array([(b - a)[1], -(b - a)[0]])
    level = float(normal @ a)
    rays = thing.hull - np.array(frame.vanishing)
    factor = np.maximum((rays @ normal) / level, 1.0)
    camera = frame.height / (1.0 - frame.shrink)
    heights = camera * (1 - 1 / factor)
    feet = rays / factor[:, None]
    length = float(np.linalg.norm(b - a))
    along = np.clip(((feet - a) @ (b - a)) / length, 0, length) * frame.scale
    total = length * frame.scale
    low, high = float(heights.min()), float(min(heights.max(), frame.height))
    start, end = total - float(along.max()), total - float(along.min())  # walls run the other way round
    width = end - start
    bounds = thing.hull.min(0).tolist() + thing.hull.max(0).tolist()
    box = (bounds[0], bounds[1], bounds[2], bounds[3])
    if width < 0.12 or high - low < 0.12:
        return None
    wall = _wall_of_edge(edge, len(frame.floor))
    if low < 0.35 and high > 1.7 and 0.5 < width < 1.6:
        return Opening("door", wall, (start, end), 0.0, min(2.1, high), box)
    glassy = thing.colour[0] > light - 25 and abs(thing.colour[1]) < 12 and thing.colour[2] < 8
    if low > 0.3 and width > 0.5 and high - low > 0.5 and glassy and thing.box.area > 30:
        return Opening("window", wall, (start, end), low, high - low, box)
    if low > 0.5 and thing.fill > 0.5:
        return Opening("picture", wall, (start, end), low, high - low, box)
    return None
