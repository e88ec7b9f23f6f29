# SPDX-License-Identifier: GPL-3.0-or-later
"""Pixels in linear light: conversions, blurring under a mask, resampling, PNG bytes. Row 0 is at the top everywhere."""

from __future__ import annotations

import io
from itertools import pairwise
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray
from PIL import Image

Pixels: TypeAlias = NDArray[np.float32]
"""Linear sRGB (rows, columns, 3), or one channel (rows, columns)."""
Mask: TypeAlias = NDArray[np.bool_]
DARKEST = 1e-3
_PLENTY = 3.0
"""Pixels of a blur's width that show all there is of it: what is blurred wider is worked out on fewer pixels."""
_AT_ONCE = 32_768
"""Pixels that are sampled in one go, so that what is worked out stays in the processor's cache."""
_FEW = 2
"""Radius up to which the values in a window are added up one by one."""
_TABLE = np.arange(256) / 255.0
_LINEAR = np.where(_TABLE <= 0.04045, _TABLE / 12.92, ((_TABLE + 0.055) / 1.055) ** 2.4).astype(np.float32)
_TO_CONE = np.array(((0.4122, 0.5363, 0.0514), (0.2119, 0.6807, 0.1074), (0.0883, 0.2817, 0.6300)), dtype=np.float32)
_TO_LAB = np.array(((0.2105, 0.7936, -0.0041), (1.9780, -2.4286, 0.4506), (0.0259, 0.7828, -0.8087)), dtype=np.float32)


def to_linear(values: NDArray[np.uint8]) -> Pixels:
    """8-bit sRGB as linear light, 0..1."""
    found: Pixels = _LINEAR[values]
    return found


def to_bytes(linear: Pixels) -> NDArray[np.uint8]:
    """Linear light as 8-bit sRGB; what is outside 0..1 is cut."""
    values = np.clip(linear, 0.0, 1.0)
    encoded = np.where(values <= 0.0031308, values * 12.92, 1.055 * values ** (1 / 2.4) - 0.055)
    found: NDArray[np.uint8] = np.round(encoded * 255.0).astype(np.uint8)
    return found


def to_png(linear: Pixels) -> bytes:
    """Linear light as the bytes of a PNG; the same pixels give the same bytes."""
    buffer = io.BytesIO()
    Image.fromarray(to_bytes(linear)).save(buffer, "PNG", compress_level=4)
    return buffer.getvalue()


def perceived(linear: Pixels) -> Pixels:
    """Oklab of linear light, any leading shape: equal distances look equally different."""
    lab: Pixels = np.cbrt(np.maximum(linear, 0.0) @ _TO_CONE.T) @ _TO_LAB.T
    return lab


def brightness(linear: Pixels) -> Pixels:
    """The natural logarithm of luminance: what light multiplies is added here."""
    light = linear @ np.array((0.2126, 0.7152, 0.0722), dtype=np.float32)
    found: Pixels = np.log(np.maximum(light, DARKEST))
    return found


def blurred(values: Pixels, sigma: float, wrap: bool = False) -> Pixels:
    """Three box filters in a row, which is nearly a Gaussian of this many pixels; edges are repeated, or wrap round."""
    if sigma < 0.3:
        return values
    radius = max(1, round((np.sqrt(4 * sigma * sigma + 1) - 1) / 2))
    result = values.astype(np.float64)
    for axis in (0, 1):
        length = result.shape[axis]
        reach = min(radius, max(1, length - 1))
        for _ in range(3):
            result = box_filtered(result, reach, axis, wrap)
    return result.astype(np.float32)


def box_filtered(values: NDArray[np.float64], radius: int, axis: int, wrap: bool) -> NDArray[np.float64]:
    """The mean over `radius` values to both sides along an axis."""
    length, window = values.shape[axis], 2 * radius + 1
    before = (slice(None),) * axis
    sums: NDArray[np.float64]
    if wrap:
        sums = values.take(np.arange(-radius - 1, length + radius), axis=axis, mode="wrap")
    else:
        sums = np.empty((*values.shape[:axis], length + window, *values.shape[axis + 1 :]))
        sums[(*before, slice(radius + 1))] = values[(*before, slice(1))]
        sums[(*before, slice(radius + 1, radius + 1 + length))] = values
        sums[(*before, slice(radius + 1 + length, None))] = values[(*before, slice(length - 1, length))]
    found: NDArray[np.float64]
    if radius <= _FEW:
        found = sums[(*before, slice(1, 1 + length))] + sums[(*before, slice(2, 2 + length))]
        for start in range(3, window + 1):
            found += sums[(*before, slice(start, start + length))]
    else:
        _add_up(sums, axis)
        found = sums[(*before, slice(window, window + length))] - sums[(*before, slice(length))]
    found /= window
    return found


def _add_up(values: NDArray[np.float64], axis: int) -> None:
    """Running sums along an axis, in place."""
    if axis or values.size < _AT_ONCE:
        np.cumsum(values, axis=axis, out=values)
        return
    for above, row in pairwise(values):  # row by row, as they lie in memory
        row += above


def blurred_inside(values: Pixels, mask: Mask, sigma: float, wrap: bool = False) -> Pixels:
    """The blur of what lies inside a mask, for every pixel; far from the mask its overall mean."""
    step = int(sigma / _PLENTY)
    if step > 1 and not wrap and min(mask.shape) > 4 * step:
        return _blurred_coarsely(values, mask, sigma, step)
    weight = mask.astype(np.float32)
    inside = values[mask]
    mean = inside.mean(axis=0) if len(inside) else np.zeros(values.shape[2:], dtype=np.float32)
    shaped = weight if values.ndim == 2 else weight[:, :, None]
    total = blurred(shaped * (values - mean), sigma, wrap)
    share = blurred(weight, sigma, wrap)
    share = share if values.ndim == 2 else share[:, :, None]
    found: Pixels = (total / np.maximum(share, 1e-4) * np.minimum(1.0, share / 1e-3) + mean).astype(np.float32)
    return found


def _blurred_coarsely(values: Pixels, mask: Mask, sigma: float, step: int) -> Pixels:
    """The same, worked out on a smaller image: nobody can tell the difference after a wide blur."""
    rows, columns = mask.shape
    small = (max(2, columns // step), max(2, rows // step))
    share = resized(mask.astype(np.float32), small)
    shaped = (mask if values.ndim == 2 else mask[:, :, None]).astype(np.float32)
    inside = values[mask]
    mean = inside.mean(axis=0) if len(inside) else np.zeros(values.shape[2:], dtype=np.float32)
    total = blurred(resized(((values - mean) * shaped).astype(np.float32), small), sigma / step)
    spread = blurred(share, sigma / step)
    spread = spread if values.ndim == 2 else spread[:, :, None]
    found = (total / np.maximum(spread, 1e-4) * np.minimum(1.0, spread / 1e-3) + mean).astype(np.float32)
    return resized(found, (columns, rows))


def grown(mask: Mask, radius: float) -> Mask:
    """The mask with all pixels within about this many pixels of it."""
    if radius < 0.5:
        return mask
    reach = max(1, round(radius))
    result = mask.astype(np.float64)
    for axis in (0, 1):
        result = (box_filtered(result, min(reach, max(1, result.shape[axis] - 1)), axis, False) > 1e-6).astype(
            np.float64
        )
    return result > 0.5


def sampled(values: Pixels, x: NDArray[np.float64], y: NDArray[np.float64]) -> Pixels:
    """Values between pixels by cubic (Catmull-Rom) interpolation; `x`, `y` in pixels, the first pixel's centre at 0.5.

    Outside the picture its edge is repeated; overshoot beyond the neighbouring pixels is cut.
    """
    flat = values.reshape(values.shape[0] * values.shape[1], -1)
    xs, ys = x.ravel(), y.ravel()
    result = np.empty((len(xs), flat.shape[1]), dtype=np.float32)
    for start in range(0, len(xs), _AT_ONCE):
        part = slice(start, start + _AT_ONCE)
        _sampled(flat, values.shape[:2], xs[part], ys[part], result[part])
    np.clip(result, float(values.min()), float(values.max()), out=result)
    return result.reshape((*x.shape, flat.shape[1])) if values.ndim == 3 else result.reshape(x.shape)


def _sampled(
    flat: Pixels, shape: tuple[int, ...], x: NDArray[np.float64], y: NDArray[np.float64], result: Pixels
) -> None:
    """Write what lies at some places of an image, given as a list of its pixels (N, channels)."""
    rows, columns = shape
    fx, fy = x - 0.5, y - 0.5
    left, top = np.floor(fx).astype(np.int64), np.floor(fy).astype(np.int64)
    across, down = _cubic((fx - left).astype(np.float32)), _cubic((fy - top).astype(np.float32))
    xs = [np.clip(left + i - 1, 0, columns - 1) for i in range(4)]
    result[:] = 0.0
    for j in range(4):
        start = np.clip(top + j - 1, 0, rows - 1) * columns
        line = sum(across[i][:, None] * flat.take(start + xs[i], axis=0) for i in range(4))
        result += down[j][:, None] * line


def _cubic(t: NDArray[np.float32]) -> tuple[NDArray[np.float32], ...]:
    """Weights of the four neighbours at fraction t."""
    t2, t3 = t * t, t * t * t
    return (
        (-t3 + 2 * t2 - t) / 2,
        (3 * t3 - 5 * t2 + 2) / 2,
        (-3 * t3 + 4 * t2 + t) / 2,
        (t3 - t2) / 2,
    )


def resized(values: Pixels, size: tuple[int, int]) -> Pixels:
    """An image of (columns, rows) pixels; averaged where it gets smaller."""
    bands = values[..., None] if values.ndim == 2 else values
    made = [
        np.asarray(Image.fromarray(np.ascontiguousarray(bands[..., c])).resize(size, Image.Resampling.BOX
                   if size[0] < values.shape[1] else Image.Resampling.BICUBIC))
        for c in range(bands.shape[2])
    ]  # fmt: skip
    found: Pixels = made[0].copy() if values.ndim == 2 else np.stack(made, axis=2)
    return found
