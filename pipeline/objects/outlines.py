# SPDX-License-Identifier: GPL-3.0-or-later
"""Outlines of objects in a picture, and which colours inside of one are an object's own."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
_SAME = 0.3
"""Share of two boxes in common from which they are one thing's."""
_SHADES = 10
"""Colours that an object and its surroundings are looked at in, together."""
_RARER = 2.0
"""How much more of an object than of its surroundings a colour of its own is."""


def area(outline: Floats) -> float:
    """Of a polygon (N, 2)."""
    x, y = outline[:, 0], outline[:, 1]
    return abs(float(np.dot(x, np.roll(y, -1)) - np.dot(y, np.roll(x, -1)))) / 2


def grown(outline: Floats, factor: float) -> Floats:
    """An outline about its middle, larger or smaller."""
    middle = (outline.min(axis=0) + outline.max(axis=0)) / 2
    found: Floats = middle + (outline - middle) * factor
    return found


def wider(outline: Floats, pixels: float) -> Floats:
    """An outline that reaches some pixels farther to all sides."""
    half = np.maximum((outline.max(axis=0) - outline.min(axis=0)) / 2, 0.5)
    middle = (outline.min(axis=0) + outline.max(axis=0)) / 2
    found: Floats = middle + (outline - middle) * (half + pixels) / half
    return found


def fitted(outline: Floats, box: Floats) -> Floats:
    """An outline brought into the box that it was found in, where that is the same thing within what both may err."""
    low, high = outline.min(axis=0), outline.max(axis=0)
    left, right = box.min(axis=0), box.max(axis=0)
    across = np.maximum(np.minimum(high, right) - np.maximum(low, left), 0.0)
    shared = float(across.prod() / max(float((high - low).prod() + (right - left).prod() - across.prod()), 1e-6))
    if shared < _SAME:
        return outline
    moved: Floats = left + (outline - low) * (right - left) / np.maximum(high - low, 1e-6)
    return moved


def some(pixels: Floats, most: int) -> Floats:
    """At most so many pixels, taken evenly."""
    return pixels if len(pixels) <= most else pixels[np.linspace(0, len(pixels) - 1, most).astype(int)]


def not_around(inside: Floats, around: Floats) -> NDArray[np.bool_]:
    """Which colours inside of an outline are rarer round it, by colours (Oklab) that both have together."""
    both = np.concatenate([some(inside, 1500), around])
    centres = middles(both, _SHADES)
    here = ((inside[:, None] - centres[None]) ** 2).sum(axis=2).argmin(axis=1)
    there = ((around[:, None] - centres[None]) ** 2).sum(axis=2).argmin(axis=1)
    within = np.bincount(here, minlength=len(centres)) / len(inside)
    outside = np.bincount(there, minlength=len(centres)) / len(around)
    own = within > _RARER * outside
    mask: NDArray[np.bool_] = own[here]
    return mask


def middles(points: Floats, count: int) -> Floats:
    """The middles of clusters of colours."""
    order = np.lexsort((points[:, 2], points[:, 1], np.round(points[:, 0], 1)))
    centres = points[order[np.linspace(0, len(points) - 1, 2 * count + 1).astype(int)[1::2]]]
    for _ in range(8):
        nearest = ((points[:, None] - centres[None]) ** 2).sum(axis=2).argmin(axis=1)
        counts = np.bincount(nearest, minlength=count)
        sums = np.stack([np.bincount(nearest, weights=points[:, i], minlength=count) for i in range(3)], axis=1)
        centres = np.where(counts[:, None] > 0, sums / np.maximum(counts, 1)[:, None], centres)
    found: Floats = centres
    return found


def convex_hull(points: Floats) -> Floats:
    """The convex hull of points (N, 2), counter-clockwise."""
    ordered = sorted({(float(x), float(y)) for x, y in points})
    if len(ordered) < 3:
        return np.array(ordered)

    def chain(items: Sequence[tuple[float, float]]) -> list[tuple[float, float]]:
        found: list[tuple[float, float]] = []
        for p in items:
            while len(found) > 1:
                (ax, ay), (bx, by) = found[-2:]
                if (bx - ax) * (p[1] - ay) - (by - ay) * (p[0] - ax) > 0:
                    break
                found.pop()
            found.append(p)
        return found[:-1]

    return np.array(chain(ordered) + chain(ordered[::-1]))
