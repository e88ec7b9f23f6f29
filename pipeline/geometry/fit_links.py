# SPDX-License-Identifier: GPL-3.0-or-later
"""Which corners of a floor share a coordinate, because a wall between them runs along one of the room's axes."""

from __future__ import annotations

import math

import numpy as np

from .polygon import Floats


def square_links(
    corners: Floats, pixels: Floats, degrees: float, slack_px: float
) -> tuple[tuple[int, ...], tuple[int, ...], float]:
    """Which corners share an x and which a y because a wall between them runs along an axis.

    Args:
        corners: (N, 2) metres; pixels: the same in the picture, for the length of walls as seen.
        degrees: largest angle to the axis; for short walls an offset of `slack_px` counts too, up to 6 degrees.

    Returns:
        link_x, link_y as `Problem` wants them, and the part of the outline's length that runs along an axis.
    """
    count = len(corners)
    link_x, link_y = list(range(count)), list(range(count))
    total = along = 0.0
    for i in range(count):
        j = (i + 1) % count
        step = corners[j] - corners[i]
        length = float(np.hypot(*step))
        seen = float(np.hypot(*(pixels[j] - pixels[i])))
        limit = max(degrees, min(6.0, math.degrees(slack_px / max(1e-6, seen))))
        total += length
        for axis, link in ((0, link_x), (1, link_y)):
            if abs(step[axis]) <= math.sin(math.radians(limit)) * length:
                along += length
                low, high = sorted((link[i], link[j]))
                link[:] = [low if v == high else v for v in link]
    return _compact(link_x), _compact(link_y), along / total if total > 0 else 0.0


def mean_by(values: Floats, link: tuple[int, ...]) -> Floats:
    """The mean of the values that share a number in `link`, in the order of those numbers."""
    index = np.array(link)
    mean: Floats = np.bincount(index, weights=values) / np.bincount(index)
    return mean


def _compact(link: list[int]) -> tuple[int, ...]:
    numbers = {value: k for k, value in enumerate(sorted(set(link)))}
    return tuple(numbers[value] for value in link)
