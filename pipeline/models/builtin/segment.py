# SPDX-License-Identifier: GPL-3.0-or-later
"""Splits a picture into areas of even colour by merging neighbours, the most alike first."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .grid import Floats, Ints, union

NOISE_AREA = 40.0
"""Pixels from which on an area's mean colour is trusted; smaller areas are merged more readily."""


def _pixel_edges(labels: Ints) -> tuple[Ints, Ints]:
    a = np.concatenate([labels[:, 1:].reshape(-1), labels[1:].reshape(-1)])
    b = np.concatenate([labels[:, :-1].reshape(-1), labels[:-1].reshape(-1)])
    apart = a != b
    return a[apart], b[apart]


def neighbours(labels: Ints) -> tuple[Ints, Ints, Ints]:
    """Pairs of touching areas (a < b) and the length of their common border in pixels."""
    return _unique_edges(*_pixel_edges(labels), int(labels.max()) + 1)


def _unique_edges(a: Ints, b: Ints, count: int, weight: Ints | None = None) -> tuple[Ints, Ints, Ints]:
    low, high = np.minimum(a, b), np.maximum(a, b)
    keys, inverse, counts = np.unique(low * count + high, return_inverse=True, return_counts=True)
    lengths = counts if weight is None else np.bincount(inverse.reshape(-1), weight).astype(np.int64)
    return keys // count, keys % count, lengths.astype(np.int64)


def _best_neighbour(cost: NDArray[np.float64], a: Ints, b: Ints, count: int) -> Ints:
    """For every area the cheapest neighbour (-1: none)."""
    cheapest = np.full(count, np.inf)
    np.minimum.at(cheapest, a, cost)
    np.minimum.at(cheapest, b, cost)
    best = np.full(count, -1)
    for ends, others in ((a, b), (b, a)):
        hit = cost <= cheapest[ends]
        best[ends[hit]] = others[hit]
    return best


def merge_areas(lab: Floats, threshold: float = 3.5, start: Ints | None = None, small: int = 12) -> Ints:
    """Merge mutually most alike neighbours until every two touching areas differ by more than `threshold`.

    Mutual nearest-neighbour agglomeration on mean colours; the difference counts less where the smaller of the two
    areas is below `NOISE_AREA` pixels, so noise and plank joints disappear first. Areas under `small` pixels always
    merge.

    Args:
        lab: (h, w, 3) colours; threshold: colour difference (CIE76) below which areas merge.

    Returns:
        (h, w) labels 0..k-1.
    """
    height, width = lab.shape[:2]
    labels = np.arange(height * width).reshape(height, width) if start is None else start
    flat = lab.reshape(-1, 3).astype(np.float64)
    count = int(labels.max()) + 1
    size = np.bincount(labels.reshape(-1), minlength=count).astype(np.float64)
    mean = np.stack([np.bincount(labels.reshape(-1), flat[:, c], count) for c in range(3)], 1) / size[:, None]
    a, b, length = neighbours(labels)
    total: Ints = labels.reshape(-1)
    for step in range(60):
        if not len(a):
            break
        least = np.minimum(size[a], size[b])
        cost = np.sqrt(((mean[a] - mean[b]) ** 2).sum(1)) * np.minimum(1.0, np.sqrt(least / NOISE_AREA))
        cost = np.where(least < small, cost * 0.2, cost)
        best = _best_neighbour(cost, a, b, count)
        # The allowance grows slowly, so a chain of joins within one step cannot run across a soft gradient.
        allowed = threshold * min(1.0, 0.06 * (step + 1))
        likes = (best[a] == b).astype(np.int8) + (best[b] == a)
        join = (likes >= (1 if step < 20 else 2)) & ((cost < allowed) | ((least < small) & (step >= 8)))
        if not join.any():
            if allowed >= threshold:
                break
            continue
        group = union(count, a[join], b[join])
        count = int(group.max()) + 1
        merged: NDArray[np.float64] = np.bincount(group, size, count).astype(np.float64)
        mean = np.stack([np.bincount(group, mean[:, c] * size, count) for c in range(3)], 1) / merged[:, None]
        size, total = merged, group[total]
        a, b = group[a], group[b]
        apart = a != b
        a, b, length = _unique_edges(a[apart], b[apart], count, length[apart])
    return total.reshape(height, width)


def area_means(labels: Ints, values: Floats) -> tuple[Ints, Floats]:
    """Pixel count and mean value (k, c) of each area."""
    flat = labels.reshape(-1)
    size = np.bincount(flat)
    columns = values.reshape(len(flat), -1)
    mean = np.stack([np.bincount(flat, columns[:, c]) for c in range(columns.shape[1])], 1) / size[:, None]
    return size.astype(np.int64), mean.astype(np.float32)
