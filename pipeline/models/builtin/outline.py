# SPDX-License-Identifier: GPL-3.0-or-later
"""Finds the room's outline: plain surroundings, the ring of wall tops, and what lies inside it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .grid import Bools, Floats, components, filled, from_border

Polygon = NDArray[np.float64]

PLAIN = 7.0
"""Colour difference (CIE76) within which pixels count as one plain colour."""


@dataclass(frozen=True)
class Outline:
    """The room's outline as far as colour alone shows it; pixels of the working picture.

    Attributes:
        outer: outer edge of the walls (or of the picture), (n, 2) x, y, clockwise on the screen.
        inner: the same corners at the walls' inner upper edge.
        wall: (n,) thickness of the wall ring at the edge that begins at each corner, 0 where none was seen.
        found: False when no outline was seen and the whole picture stands in for it.
        surround: mean Lab colour of the surroundings, or None.
    """

    outer: Polygon
    inner: Polygon
    wall: NDArray[np.float64]
    found: bool
    surround: Floats | None


def surroundings(lab: Floats) -> tuple[Bools, Floats] | None:
    """The plain area that is joined with the picture's border, and its colour; None where the border is not plain."""
    rim = np.concatenate(
        [lab[:2].reshape(-1, 3), lab[-2:].reshape(-1, 3), lab[:, :2].reshape(-1, 3), lab[:, -2:].reshape(-1, 3)]
    )
    colour = np.median(rim, axis=0)
    if np.mean(np.linalg.norm(rim - colour, axis=1) < PLAIN) < 0.6:
        return None
    near = np.linalg.norm(lab - colour, axis=2) < PLAIN
    return from_border(near), colour.astype(np.float32)


def _extent(profile: NDArray[np.float64], share: float) -> tuple[int, int]:
    """First and one-past-last index where the profile reaches `share` of its maximum."""
    hits = np.flatnonzero(profile >= share * max(profile.max(initial=0.0), 1e-9))
    return int(hits[0]), int(hits[-1]) + 1


def _bounds(mask: Bools) -> tuple[int, int, int, int]:
    """Bounds x0, y0, x1, y1 of a mask that ignore slivers, such as window sills that stand out of the wall."""
    top, bottom = _extent(mask.sum(1).astype(np.float64), 0.3)
    left, right = _extent(mask.sum(0).astype(np.float64), 0.3)
    return left, top, right, bottom


def _corner_notch(empty: Bools) -> tuple[int, int]:
    """Width and height of the largest empty rectangle in the top left corner of a mask; (0, 0) when too small."""
    height, width = empty.shape
    depth = np.where(empty.all(0), height, np.argmin(empty, axis=0))
    shared = np.minimum.accumulate(depth)
    areas = (np.arange(width) + 1) * shared
    best = int(np.argmax(areas))
    w, h = best + 1, int(shared[best])
    if w < 0.1 * width or h < 0.1 * height or w > 0.85 * width or h > 0.85 * height:
        return 0, 0
    return w, h


def _notched(bounds: tuple[int, int, int, int], empty: Bools) -> Polygon:
    """The rectangle less the empty rectangles at its corners, clockwise on the screen from the top left."""
    x0, y0, x1, y1 = bounds
    crop = empty[y0:y1, x0:x1]
    points: list[tuple[float, float]] = []
    flips = [(1, 1), (1, -1), (-1, -1), (-1, 1)]
    for row, column in flips:
        w, h = _corner_notch(crop[::row, ::column])
        cx, cy = (x0 if column == 1 else x1), (y0 if row == 1 else y1)
        sx, sy = column, row
        if not w:
            points.append((cx, cy))
            continue
        along_x = (cx + sx * w, cy)
        inner = (cx + sx * w, cy + sy * h)
        along_y = (cx, cy + sy * h)
        clockwise = [along_y, inner, along_x] if (row, column) in ((1, 1), (-1, -1)) else [along_x, inner, along_y]
        points += clockwise
    return np.array(points, dtype=np.float64)


def _supported(mask: Bools, polygon: Polygon) -> float:
    """Share of the outline's length that has something of the mask within 2 pixels inside; the worst but one edge."""
    shares = []
    for index in range(len(polygon)):
        strip = inward(mask[..., None].astype(np.float32), polygon, index, 4)
        shares.append(float(strip[..., 0].max(0).mean()) if strip.size else 0.0)
    return sorted(shares)[1] if len(shares) > 1 else 0.0


def inward(values: Floats, polygon: Polygon, index: int, depth: int) -> Floats:
    """Pixels along one edge, as (depth, length, c), depth 0 at the edge and growing into the room."""
    (x0, y0), (x1, y1) = polygon[index], polygon[(index + 1) % len(polygon)]
    height, width = values.shape[:2]
    if abs(y1 - y0) < abs(x1 - x0):  # horizontal; clockwise on the screen: rightwards means the room is below
        low, high = sorted((round(x0), round(x1)))
        rows = round(y0) + np.arange(depth) if x1 > x0 else round(y0) - 1 - np.arange(depth)
        rows = rows[(rows >= 0) & (rows < height)]
        across: Floats = values[rows][:, max(low, 0) : min(high, width)]
        return across
    low, high = sorted((round(y0), round(y1)))
    columns = round(x0) - 1 - np.arange(depth) if y1 > y0 else round(x0) + np.arange(depth)
    columns = columns[(columns >= 0) & (columns < width)]
    strip: Floats = values[max(low, 0) : min(high, height)][:, columns].transpose(1, 0, 2)
    return strip


def _ring_depth(lab: Floats, polygon: Polygon, index: int, limit: int) -> float:
    """Thickness of the even strip along one edge, 0 when there is none that is even enough."""
    strip = inward(lab, polygon, index, limit + 2)
    if strip.shape[0] < limit or strip.shape[1] < 6:
        return 0.0
    colour = np.median(strip[1:3].reshape(-1, 3), axis=0)
    same = np.linalg.norm(strip - colour, axis=2) < PLAIN
    same[0] = True
    depth = np.where(same.all(0), strip.shape[0], np.argmin(same, axis=0)).astype(np.float64)
    real = depth[depth > 1]
    if len(real) < 0.35 * strip.shape[1]:
        return 0.0
    middle = float(np.median(real))
    steady = np.mean(np.abs(real - middle) <= max(1.5, 0.25 * middle))
    return middle if steady > 0.5 and middle <= limit else 0.0


def inset(polygon: Polygon, depth: NDArray[np.float64]) -> Polygon:
    """Move every edge of a rectilinear polygon (clockwise on the screen) inwards by its own depth."""
    count = len(polygon)
    result = polygon.copy()
    for index in range(count):
        nxt = (index + 1) % count
        dx, dy = polygon[nxt] - polygon[index]
        if abs(dx) >= abs(dy):
            shift = np.array([0.0, depth[index] * np.sign(dx)])
        else:
            shift = np.array([-depth[index] * np.sign(dy), 0.0])
        result[index] += shift
        result[nxt] += shift
    return result


def _peel(lab: Floats, polygon: Polygon) -> tuple[Polygon, NDArray[np.float64]]:
    """Take the wall ring off: at most a thin drawn line and one even strip."""
    span = polygon.max(0) - polygon.min(0)
    limit = max(4, int(0.08 * min(span)))
    total = np.zeros(len(polygon))
    inner = polygon
    for _ in range(3):
        depths = np.array([_ring_depth(lab, inner, index, limit) for index in range(len(inner))])
        seen = depths[depths > 0]
        if len(seen) < 0.5 * len(depths):
            break
        usual = float(np.median(seen))
        depths = np.where((depths > 2.2 * usual) | (depths < usual / 2.2), usual, depths)
        inner, total = inset(inner, depths), total + depths
        if usual > 0.015 * min(span) and usual > 3:
            break
    return inner, total


def find_outline(lab: Floats) -> Outline:
    """Find the walls' outer and inner edges.

    Args:
        lab: (h, w, 3) working picture.

    Returns:
        The outline; the whole picture with `found` False where nothing frames the room.
    """
    height, width = lab.shape[:2]
    whole = np.array([(0, 0), (width, 0), (width, height), (0, height)], dtype=np.float64)
    around = surroundings(lab) if min(height, width) >= 16 else None
    if around is None:
        if min(height, width) < 16:
            return Outline(whole, whole, np.zeros(4), False, None)
        inner, wall = _peel(lab, whole)
        return Outline(whole, inner, wall, bool(wall.any()), None)
    outside, colour = around
    if outside.mean() > 0.97:
        return Outline(whole, whole, np.zeros(4), False, colour)
    body = ~outside
    labels = components(body)
    sizes = np.bincount(labels.reshape(-1), body.reshape(-1))
    body = filled(body & (sizes[labels] > 0.003 * height * width))
    outer = _notched(_bounds(body), outside)
    span = outer.max(0) - outer.min(0)
    if _supported(body, outer) < 0.6 or min(span) < 0.25 * min(height, width):
        return Outline(whole, whole, np.zeros(4), False, colour)
    inner, wall = _peel(lab, outer)
    return Outline(outer, inner, wall, True, colour)
