# SPDX-License-Identifier: GPL-3.0-or-later
"""What pattern a surface has: the direction of its planks or tiles, and the distances after which they repeat."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .pixels import Mask, Pixels, blurred, blurred_inside, box_filtered, brightness, grown

Floats = NDArray[np.float64]
_LINES = 0.22
"""Coherence of gradients above which a surface has one direction; along two at right angles for a grid."""
_GRID = 0.3
_LEAST_PERIOD = 0.025
_MOST_PERIOD = 1.3
_TONES = 0.35
"""Sureness from which the tones alone tell the period."""
_FARTHEST = 2.2
"""Metres within which peaks are looked for."""
_BEYOND = 8  # rows more than that are worked out, for what is smoothed at the end
_SNAP = 2.0
_MOST_POINTS = 150_000
_MOST_DEPTH = 0.3
_CONTRAST = 0.022
"""Variation of the logarithm of brightness below which a surface is plain to the eye."""


@dataclass(frozen=True)
class Direction:
    """Which way a surface's lines run.

    Attributes:
        turn: degrees counter-clockwise from the image's +X to the lines, -90 < turn <= 90; for a grid -45 < turn <= 45.
        lines, grid: how much the gradients agree on one direction, and on two at right angles, 0..1.
    """

    turn: float
    lines: float
    grid: float

    @property
    def has_lines(self) -> bool:
        """Whether there is one direction, such as planks have."""
        return self.lines > _LINES

    @property
    def has_grid(self) -> bool:
        """Whether there are two at right angles and none is the stronger, such as tiles have."""
        return not self.has_lines and self.grid > _GRID


def contrast_of(pixels: Pixels, seen: Mask, scale: float) -> float:
    """The usual deviation of the logarithm of brightness at sizes from a centimetre to a hand's breadth.

    It is the median over places: a shadow's edge is strong, but it is in few.
    """
    light = brightness(pixels)
    core = ~grown(~seen, 0.02 * scale)
    if core.sum() < 64:
        return 0.0
    band = blurred_inside(light, seen, 0.008 * scale) - blurred_inside(light, seen, 0.15 * scale)
    band = np.where(core, band, 0.0).astype(np.float32)
    local = blurred_inside(band * band, core, 0.08 * scale)
    return float(np.sqrt(max(0.0, float(np.median(local[core])))))


def is_plain(contrast: float) -> bool:
    """Whether a surface shows no pattern worth a picture."""
    return contrast < _CONTRAST


def direction_of(pixels: Pixels, seen: Mask) -> Direction:
    """The direction of a surface's lines, from the gradients of its brightness (structure tensor)."""
    light = brightness(pixels)
    fine = blurred_inside(light, seen, 0.8) - blurred_inside(light, seen, 6.0)
    down, right = np.gradient(fine.astype(np.float64))
    core = ~grown(~seen, 3)
    gx, gy = right[core], -down[core]
    weight = gx * gx + gy * gy
    if not len(weight) or weight.sum() <= 0:
        return Direction(0.0, 0.0, 0.0)
    # Single strong edges (a cable, a stain) must not speak for all.
    weight = np.minimum(weight, np.percentile(weight, 95))
    # The direction's angle, twice and four times, without working the angle out.
    twice = (gx + 1j * gy) ** 2 / np.maximum(gx * gx + gy * gy, 1e-300)
    double = (weight * twice).sum() / weight.sum()
    fourfold = (weight * twice * twice).sum() / weight.sum()
    lines, grid = float(abs(double)), float(abs(fourfold))
    if lines > _LINES:
        turn = math.degrees(np.angle(double)) / 2 + 90.0
    else:
        turn = math.degrees(np.angle(fourfold)) / 4
    if lines > _LINES or grid > _GRID:
        # Grain and noise bend the gradients; the lines themselves are sharpest when looked along.
        # Of tiles the tones cancel each other along a line, their edges do not.
        turn = _sharpest(fine if lines > _LINES else np.hypot(right, down).astype(np.float32), core, turn)
    turn = (turn + 90.0) % 180.0 - 90.0 if lines > _LINES else (turn + 45.0) % 90.0 - 45.0
    return Direction(90.0 if turn == -90.0 else float(turn), lines, grid)


def _sharpest(fine: Pixels, core: Mask, turn: float) -> float:
    """The turn near this one along which what is seen, summed up, shows the clearest lines."""
    rows, columns = np.nonzero(core)
    if len(rows) > _MOST_POINTS:
        keep = np.linspace(0, len(rows) - 1, _MOST_POINTS).astype(int)
        rows, columns = rows[keep], columns[keep]
    values = np.clip(fine[rows, columns].astype(np.float64), -_MOST_DEPTH, _MOST_DEPTH)
    values -= values.mean()

    def clearness(angle: float) -> float:
        across = -rows * math.cos(math.radians(angle)) - columns * math.sin(math.radians(angle))
        bins = np.round(across - across.min()).astype(np.int64)
        count = np.bincount(bins)
        sums = np.bincount(bins, weights=values)
        # The variance of the lines' means, less what chance gives.
        there = count > 20
        return float((sums[there] ** 2 / count[there]).sum() - there.sum() * float((values**2).mean()))

    best = turn
    for step, number in ((1.0, 9), (0.25, 5)):
        angles = [best + step * i for i in range(-number, number + 1)]
        best = max(angles, key=clearness)
    return best


def snapped(turn: float, directions: list[float]) -> float:
    """The turn, brought to a wall's direction or a right angle to one where it is near it; degrees."""
    best = turn
    least = _SNAP
    for wall in directions:
        for quarter in (0.0, 90.0, 45.0):
            away = (turn - wall - quarter + 90.0) % 180.0 - 90.0
            if abs(away) < least:
                least, best = abs(away), turn - away
    return best


@dataclass(frozen=True)
class Period:
    """A distance after which a pattern repeats, metres, 0 for none, and how sure that is, 0..1."""

    metres: float
    sure: float


def periods_of(pixels: Pixels, seen: Mask, scale: float) -> tuple[Period, Period]:
    """The periods along the image's x and along its y, from the autocorrelation of what is seen.

    The brightness tells of tiles of different tone, the lines between planks of equal ones tell of themselves.
    """
    light = brightness(pixels)
    high = blurred_inside(light, seen, 0.7) - blurred_inside(light, seen, 0.15 * scale)
    core = ~grown(~seen, 2)
    return _down_columns(high.T, core.T, scale), _down_columns(high, core, scale)


def _down_columns(high: Pixels, core: Mask, scale: float) -> Period:
    """The period down the columns of an image without its large-scale light."""
    tones = _first_period(_autocorrelation(np.where(core, high, 0.0), core, scale), scale)
    if tones.sure > _TONES:
        return tones
    # Planks differ in tone at random, but all joints are lines; grain is not as long as they are.
    values = high.astype(np.float64)
    steps = np.abs(np.gradient(values, axis=0))
    grooves = np.maximum(0.0, (np.roll(values, 2, axis=0) + np.roll(values, -2, axis=0)) / 2 - values)
    profile = 0.5 * (_line_profile(steps, core, scale) + _line_profile(grooves, core, scale))
    return _first_period(profile, scale)


def _line_profile(found: Floats, core: Mask, scale: float) -> Floats:
    """The correlation profile of lines along the rows, from how much each pixel looks like one."""
    inside = np.where(core, found, 0.0)
    if core.any():
        inside = np.minimum(inside, np.percentile(inside[core], 97))
    reach = max(1, round(0.12 * scale))
    share = box_filtered(core.astype(np.float64), reach, 1, False)
    level = box_filtered(inside, reach, 1, False) / np.maximum(share, 1e-6)
    away = level - box_filtered(level, max(2, round(0.15 * scale)), 0, False)
    return _autocorrelation(np.where(core, away, 0.0), core, scale)


def _autocorrelation(values: Floats, mask: Mask, scale: float) -> Floats:
    """Correlation down the columns of what is inside the mask with itself, 1 at no shift, 0 where too little is left.

    Only as far as periods are looked for.
    """
    rows = min(len(values), int(_FARTHEST * scale) + _BEYOND)
    length = _even(len(values) + rows)
    inside = np.where(mask, values - values[mask].mean(), 0.0) if mask.any() else values
    power = np.fft.irfft((np.abs(np.fft.rfft(inside, length, axis=0)) ** 2).sum(axis=1), length)[:rows]
    count = np.fft.irfft((np.abs(np.fft.rfft(mask.astype(float), length, axis=0)) ** 2).sum(axis=1), length)[:rows]
    if power[0] <= 0:
        return np.zeros(rows)
    found: Floats = np.where(
        count > 0.03 * count[0], power / np.maximum(count, 1.0) / (power[0] / max(count[0], 1.0)), 0.0
    )
    return found


def _even(length: int) -> int:
    """The next length that transforms fast: of factors 2, 3 and 5."""
    while True:
        rest = length
        for factor in (2, 3, 5):
            while rest % factor == 0:
                rest //= factor
        if rest == 1:
            return length
        length += 1


def _first_period(profile: Floats, scale: float) -> Period:
    """The shortest distance at whose multiples a correlation profile has its peaks, and half-way between them valleys."""
    reach = min(len(profile) - 2, int(_FARTHEST * scale))
    least, most = max(4.0, _LEAST_PERIOD * scale), min(_MOST_PERIOD * scale, reach / 1.5)
    if most <= least:
        return Period(0.0, 0.0)
    smooth = blurred(profile[None].astype(np.float32), 0.6)[0].astype(float)
    lags = np.geomspace(least, most, max(2, int(math.log(most / least) / 0.004)))
    scores = np.array([_comb(smooth, lag, reach) for lag in lags])
    top = float(scores.max())
    if top <= 0:
        return Period(0.0, 0.0)
    # Twice a period repeats as well, so the shortest that is nearly as good counts.
    peaks = [i for i in range(1, len(lags) - 1) if scores[i] >= max(scores[i - 1], scores[i + 1])]
    good = [i for i in peaks if scores[i] > 0.6 * top] or [int(scores.argmax())]
    return Period(float(lags[good[0]]) / scale, min(1.0, top))


def _comb(profile: Floats, lag: float, reach: int) -> float:
    """Mean height of a profile at the multiples of a lag over that half-way between; at least two multiples count."""
    number = min(10, max(1, int(reach / lag)))
    places = np.arange(1, number + 1) * lag
    index = np.arange(len(profile))
    rise = np.interp(places, index, profile) - np.interp(places - lag / 2, index, profile)
    # What is seen once may be chance.
    return float(rise.mean() * min(1.0, number / 2.0))
