# SPDX-License-Identifier: GPL-3.0-or-later
"""Takes the room's light out of a surface, and what does not belong to it: gradients, soft shadows, foreign colours."""

from __future__ import annotations

import numpy as np

from .pixels import DARKEST, Mask, Pixels, blurred, blurred_inside, brightness, grown, perceived, resized

CELL = 0.4
"""Metres of the cells in which a floor's colour has to be found again to count as the floor's."""
_LEAST_CELLS = 6
_COMMON = 0.14
_MOST_GAIN = 2.5


def flattened(pixels: Pixels, seen: Mask, sigma: float, strength: float = 1.0, wrap: bool = False) -> Pixels:
    """The surface as if lit evenly: in the logarithm, what varies over more than `sigma` pixels is taken out.

    Each channel on its own, so that warm lamplight and cool daylight go too. The mean over what is seen stays.

    Args:
        strength: 0 leaves everything, 1 takes all of the large-scale variation out.
    """
    if not seen.any():
        return pixels
    logs = np.log(np.maximum(pixels, DARKEST))
    light = blurred_inside(logs, seen, sigma, wrap)
    middle = np.median(light[seen], axis=0)
    gain = np.clip(np.exp(strength * (middle - light)), 1 / _MOST_GAIN, _MOST_GAIN)
    result: Pixels = (pixels * gain).astype(np.float32)
    return result


def foreign(pixels: Pixels, seen: Mask, scale: float) -> Mask:
    """Pixels whose colour is found in few places of the surface only: leftovers of objects, cables, patches of sun.

    Args:
        scale: pixels for a metre.
    """
    rows, columns = seen.shape
    step = max(1, round(0.02 * scale))
    small = (max(4, columns // step), max(4, rows // step))
    even = flattened(pixels, seen, 0.5 * scale)
    weight = resized(seen.astype(np.float32), small)
    colours = resized(even * seen[..., None], small) / np.maximum(weight, 1e-3)[..., None]
    usable = weight > 0.5
    cell = max(2, round(CELL * scale / step))
    down, across = np.nonzero(usable)
    places, nth = np.unique((down // cell) * 10_000 + across // cell, return_inverse=True)
    number = len(places)
    if number < _LEAST_CELLS:
        return np.zeros_like(seen)
    lab = perceived(colours[usable])
    bins = np.floor(lab / np.array((0.07, 0.025, 0.025)) + 0.5).astype(np.int64)
    common = np.zeros(len(bins))
    # A colour is common where it, or one beside it, is found in many cells.
    for offset in (-0.25, 0.25):
        shifted = np.floor(lab / np.array((0.07, 0.025, 0.025)) + 0.5 + offset).astype(np.int64)
        for key in (bins, shifted):
            code = (key[:, 0] * 1000 + key[:, 1]) * 1000 + key[:, 2]
            values, own = np.unique(code, return_inverse=True)
            pairs = np.unique(own * number + nth)
            counts = np.bincount(pairs // number, minlength=len(values))
            common = np.maximum(common, counts[own] / number)
    odd = np.zeros(usable.shape, dtype=np.float32)
    odd[usable] = common < _COMMON
    # Single specks are grain; what hangs together is a thing.
    clumps = blurred(odd, 1.2) > 0.45
    large = resized(grown(clumps, 1).astype(np.float32), (columns, rows)) > 0.5
    found: Mask = large & seen
    return found


def unevenness(pixels: Pixels, seen: Mask, scale: float, period: float = 0.0) -> Pixels:
    """How much the brightness round each pixel differs from the surface's usual one: shadows' edges and patches of sun.

    Args:
        period: metres after which the pattern repeats; smaller variation is the pattern's own.
    """
    sigma = max(0.1, 0.7 * period) * scale
    light = blurred_inside(brightness(pixels), seen, sigma)
    middle = float(np.median(light[seen])) if seen.any() else 0.0
    found: Pixels = np.abs(light - middle).astype(np.float32)
    return found


def typical_colour(pixels: Pixels, seen: Mask) -> Pixels:
    """The mean linear colour of what is neither in shadow nor glossy, as `objects.colours` measures it."""
    inside = pixels[seen]
    if not len(inside):
        return np.full(3, 0.5, dtype=np.float32)
    light = inside.mean(axis=1)
    low, high = np.percentile(light, (30, 80))
    kept = inside[(light >= low) & (light <= high)]
    found: Pixels = (kept if len(kept) else inside).mean(axis=0).astype(np.float32)
    return found
