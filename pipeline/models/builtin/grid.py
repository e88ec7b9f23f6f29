# SPDX-License-Identifier: GPL-3.0-or-later
"""Operations on pixel grids that numpy lacks: connected components, box filters, morphology, flood from the border."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Ints = NDArray[np.int64]
Bools = NDArray[np.bool_]
Floats = NDArray[np.float32]


def union(count: int, first: Ints, second: Ints) -> Ints:
    """Components of a graph with `count` nodes and edges (first[i], second[i]), as labels 0..k-1, one a node."""
    parent = np.arange(count)
    while True:
        a, b = parent[first], parent[second]
        apart = a != b
        if not apart.any():
            break
        np.minimum.at(parent, np.maximum(a, b)[apart], np.minimum(a, b)[apart])
        while True:
            jumped = parent[parent]
            if np.array_equal(jumped, parent):
                break
            parent = jumped
    result: Ints = np.unique(parent, return_inverse=True)[1].astype(np.int64).reshape(-1)
    return result


def components(values: NDArray[np.generic]) -> Ints:
    """Label the 4-connected areas of equal value of a 2D array; labels are 0..k-1, background included."""
    height, width = values.shape
    begins = np.ones((height, width), dtype=bool)
    begins[:, 1:] = values[:, 1:] != values[:, :-1]
    runs = np.cumsum(begins.reshape(-1)) - 1
    runs = runs.reshape(height, width)
    same = values[1:] == values[:-1]
    labels = union(int(runs[-1, -1]) + 1, runs[1:][same], runs[:-1][same])
    result: Ints = labels[runs]
    return result


def box_sum(values: Floats, radius: int) -> Floats:
    """Sum over a (2r+1) square window that is cut at the border. Works on (h, w) and (h, w, c)."""
    result = np.asarray(values, dtype=np.float64)
    for axis in (0, 1):
        length = result.shape[axis]
        padded = np.concatenate([np.zeros_like(result.take([0], axis)), np.cumsum(result, axis=axis)], axis=axis)
        index = np.arange(length)
        high = np.minimum(index + radius + 1, length)
        low = np.maximum(index - radius, 0)
        result = padded.take(high, axis) - padded.take(low, axis)
    total: Floats = result.astype(np.float32)
    return total


def box_mean(values: Floats, radius: int, mask: Bools | None = None) -> Floats:
    """Mean over a square window, over the pixels of `mask` only where it is given (0 where there are none)."""
    weight = np.ones(values.shape[:2], np.float32) if mask is None else mask.astype(np.float32)
    total = box_sum(values * (weight[..., None] if values.ndim == 3 else weight), radius)
    count = np.maximum(box_sum(weight, radius), 1e-6)
    mean: Floats = (total / (count[..., None] if values.ndim == 3 else count)).astype(np.float32)
    return mean


def dilate(mask: Bools, radius: int) -> Bools:
    """Grow a mask by a square of (2r+1)."""
    return box_sum(mask.astype(np.float32), radius) > 0.5


def erode(mask: Bools, radius: int) -> Bools:
    """Shrink a mask by a square of (2r+1); the picture's border does not eat into it."""
    return ~dilate(~mask, radius)


def opened(mask: Bools, radius: int) -> Bools:
    """Erode, then dilate: removes what is thinner than 2r+1."""
    return dilate(erode(mask, radius), radius)


def closed(mask: Bools, radius: int) -> Bools:
    """Dilate, then erode: closes gaps narrower than 2r+1."""
    return erode(dilate(mask, radius), radius)


def from_border(mask: Bools) -> Bools:
    """The part of a mask that is 4-connected with the picture's border."""
    labels = components(mask)
    rim = np.concatenate([labels[0], labels[-1], labels[:, 0], labels[:, -1]])
    inside = np.concatenate([mask[0], mask[-1], mask[:, 0], mask[:, -1]])
    touched = np.zeros(int(labels.max()) + 1, dtype=bool)
    touched[rim[inside]] = True
    result: Bools = touched[labels] & mask
    return result


def filled(mask: Bools) -> Bools:
    """The mask with its holes filled."""
    return ~from_border(~mask)


def polygon_mask(shape: tuple[int, int], polygon: NDArray[np.float64]) -> Bools:
    """Pixels whose centres lie inside a simple polygon.

    Args:
        polygon: (n, 2) x, y in pixels, where pixel (row, column) covers [column, column+1] x [row, row+1].
    """
    ys, xs = np.mgrid[0 : shape[0], 0 : shape[1]] + 0.5
    inside = np.zeros(shape, dtype=bool)
    for (x0, y0), (x1, y1) in zip(polygon, np.roll(polygon, -1, axis=0), strict=True):
        if y0 == y1:
            continue
        crosses = (ys < y0) != (ys < y1)
        inside ^= crosses & (xs < x0 + (ys - y0) * (x1 - x0) / (y1 - y0))
    return inside
