# SPDX-License-Identifier: GPL-3.0-or-later
"""A tile that repeats without a seam, sewn together from the clean parts of a surface (image quilting on a torus).

The tile is a grid of blocks. A block whose own place in the surface is clean is taken as it is, so that a clean surface
stays in one piece. The others, and those that close the tile to itself, are looked for all over the surface, and sewn in
along the path where both differ least (Efros and Freeman 2001).
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .pixels import DARKEST, Mask, Pixels, blurred, blurred_inside

Ints = NDArray[np.int64]
_BLOCKS = (0.8, 0.6, 0.45, 0.32, 0.22)
"""Metres of a block's side that are tried, the largest first."""
_LEAST_CANDIDATES = 12
_MOST_CANDIDATES = 400
_LIKENESS_STEP = 3
_GAIN = 0.14
_LONG = 1.7
_STAGGER = 0.382
_SOFT = 0.045


@dataclass(frozen=True)
class Tile:
    """A tile in linear light that repeats, and how it was made.

    Attributes:
        owners: for every pixel which sewn block it is from; 0 for the surface in one piece.
        kept: share of the tile that is the surface in one piece.
    """

    pixels: Pixels
    owners: Ints
    kept: float


@dataclass(frozen=True)
class _Plan:
    """Sizes in pixels: blocks a side, a block's core, the overlap of two windows; lines as in `quilted`."""

    number: tuple[int, int]
    core: tuple[int, int]
    overlap: int
    lines: str = ""

    @property
    def size(self) -> tuple[int, int]:
        """Rows and columns of the tile."""
        return self.number[0] * self.core[0], self.number[1] * self.core[1]

    @property
    def window(self) -> tuple[int, int]:
        """Rows and columns of a block with its overlaps."""
        return self.core[0] + self.overlap, self.core[1] + self.overlap

    def place(self, row: int, column: int) -> tuple[int, int]:
        """The upper left corner of a block's core on the tile.

        Along lines, blocks are staggered like the planks themselves, so that their ends do not form a line.
        """
        top, left = row * self.core[0], column * self.core[1]
        if self.lines == "x":
            left += round(row * _STAGGER * self.core[1])
        elif self.lines == "y":
            top += round(column * _STAGGER * self.core[0])
        return top % self.size[0], left % self.size[1]


def quilted(
    pixels: Pixels,
    good: Mask,
    uneven: Pixels,
    scale: float,
    size: tuple[float, float],
    periods: tuple[float, float] = (0.0, 0.0),
    lines: str = "",
    seed: int = 1,
) -> Tile | None:
    """A tile from the good pixels of a surface; None where there are too few in one place.

    Args:
        uneven: how little each pixel is wanted, 0 and up; scale: pixels for a metre.
        size: wanted (width, depth) of the tile in metres, whole periods where there are any.
        periods: along x and y in metres, 0 for none: blocks are only moved by whole periods.
        lines: "x" or "y" where lines run that way: blocks are longer along them.
    """
    for side in _BLOCKS:
        long = (_LONG if lines == "x" else 1.0, _LONG if lines == "y" else 1.0)
        plan = _plan(lines, (side * scale * long[0], side * scale * long[1]), (size[0] * scale, size[1] * scale))
        if plan is None or min(plan.core) < 6:
            continue
        clean = _clean_windows(good, plan.window)
        step = (periods[0] * scale, periods[1] * scale)
        if clean is not None and len(_candidates(clean, (0, 0), step)) >= _LEAST_CANDIDATES:
            return _Quilt(pixels, uneven, clean, plan, step, seed).sewn()
    return None


def _plan(lines: str, side: tuple[float, float], size: tuple[float, float]) -> _Plan | None:
    """Blocks of about these sides that fill the tile exactly; its size is kept to half a pixel a block."""
    columns, rows = max(2, round(size[0] / side[0])), max(2, round(size[1] / side[1]))
    core = round(size[1] / rows), round(size[0] / columns)
    overlap = max(4, round(0.28 * min(core)))
    return _Plan((rows, columns), core, overlap - overlap % 2, lines) if min(core) > 4 else None


def _clean_windows(good: Mask, window: tuple[int, int]) -> Mask | None:
    """For every upper left corner whether the whole window there is good."""
    rows, columns = good.shape
    high, wide = window
    if rows < high or columns < wide:
        return None
    sums = np.zeros((rows + 1, columns + 1), dtype=np.int64)
    sums[1:, 1:] = np.cumsum(np.cumsum(~good, axis=0), axis=1)
    bad = sums[high:, wide:] - sums[:-high, wide:] - sums[high:, :-wide] + sums[:-high, :-wide]
    found: Mask = bad == 0
    return found if found.any() else None


def _candidates(clean: Mask, home: tuple[int, int], step: tuple[float, float]) -> Ints:
    """Corners (N, 2) of clean windows that lie whole periods away from a place."""
    found = np.argwhere(clean)
    for axis, period in ((0, step[1]), (1, step[0])):
        if period > 2:
            away = (found[:, axis] - home[axis] + period / 2) % period - period / 2
            found = found[np.abs(away) <= 0.75]
    return found


class _Quilt:
    """One tile while it is sewn."""

    def __init__(
        self, pixels: Pixels, uneven: Pixels, clean: Mask, plan: _Plan, step: tuple[float, float], seed: int
    ) -> None:
        self._logs = np.log(np.maximum(pixels, DARKEST)).astype(np.float32)
        self._uneven, self._clean, self._plan, self._step = uneven, clean, plan, step
        self._chance = np.random.default_rng(seed)
        rows, columns = plan.size
        self._made = np.zeros((rows, columns, 3), dtype=np.float32)
        self._known = np.zeros((rows, columns), dtype=bool)
        self._owners = np.zeros((rows, columns), dtype=np.int64)
        self._usual = _window_means(uneven, plan.window)

    def sewn(self) -> Tile:
        """The tile."""
        home = self._anchor()
        rest = []
        for row, column in self._places():
            at = self._own(home, row, column)
            if at is None:
                rest.append((row, column))
            else:
                self._place(row, column, at, 0)
        kept = float(self._known.mean())
        for number, (row, column) in enumerate(rest, 1):
            self._place(row, column, self._best(home, row, column), number)
        return Tile(np.exp(self._made).astype(np.float32), self._owners, kept)

    def _places(self) -> Iterator[tuple[int, int]]:
        for row in range(self._plan.number[0]):
            for column in range(self._plan.number[1]):
                yield row, column

    def _own(self, home: tuple[int, int], row: int, column: int) -> tuple[int, int] | None:
        """Where a block's own window lies in the surface, None when it is not clean."""
        top, left = self._plan.place(row, column)
        if top + self._plan.window[0] > self._plan.size[0] or left + self._plan.window[1] > self._plan.size[1]:
            return None  # It closes the tile to itself, where the surface does not go on.
        at = home[0] + top, home[1] + left
        inside = 0 <= at[0] < self._clean.shape[0] and 0 <= at[1] < self._clean.shape[1]
        return at if inside and self._clean[at] else None

    def _anchor(self) -> tuple[int, int]:
        """The place of the tile's upper left window for which most blocks are clean and evenly lit."""
        rows, columns = self._clean.shape
        worth = np.where(self._clean, 1.0 - np.minimum(0.9, 3 * self._usual), 0.0)
        best, chosen = -1.0, (0, 0)
        stride = max(1, min(self._plan.core) // 6)
        for top in range(0, rows, stride):
            for left in range(0, columns, stride):
                own = worth[top :: self._plan.core[0], left :: self._plan.core[1]]
                value = float(own[: self._plan.number[0] - 1, : self._plan.number[1] - 1].sum())
                if value > best:
                    best, chosen = value, (top, left)
        return chosen

    def _window(self, row: int, column: int) -> tuple[Ints, Ints]:
        """Rows and columns of a block's window on the torus."""
        half = self._plan.overlap // 2
        high, wide = self._plan.window
        rows, columns = self._plan.size
        top, left = self._plan.place(row, column)
        down = (top - half + np.arange(high)) % rows
        across = (left - half + np.arange(wide)) % columns
        return down, across

    def _best(self, home: tuple[int, int], row: int, column: int) -> tuple[int, int]:
        """The window that continues what is there; among nearly equal ones an evenly lit one."""
        down, across = self._window(row, column)
        top, left = self._plan.place(row, column)
        at = home[0] + top, home[1] + left
        found = _candidates(self._clean, at, self._step)
        if len(found) < 3:
            found = np.argwhere(self._clean)
        if len(found) > _MOST_CANDIDATES:
            found = found[np.sort(self._chance.choice(len(found), _MOST_CANDIDATES, replace=False))]
        known = self._known[np.ix_(down, across)]
        there = self._made[np.ix_(down, across)]
        coarse = (slice(None, None, _LIKENESS_STEP), slice(None, None, _LIKENESS_STEP))
        wanted = np.argwhere(known[coarse]) * _LIKENESS_STEP
        if not len(wanted):
            top, left = found[np.argmin(self._usual[found[:, 0], found[:, 1]])]
            return int(top), int(left)
        target = there[wanted[:, 0], wanted[:, 1]]
        values = self._logs[
            found[:, 0][:, None] + wanted[:, 0][None], found[:, 1][:, None] + wanted[:, 1][None]
        ]  # fmt: skip
        # A slightly lighter or darker place is as good: its brightness is matched.
        gap = values - target[None]
        level = np.clip(gap.mean(axis=1, keepdims=True), -_GAIN, _GAIN)
        error = ((gap - level) ** 2).mean(axis=(1, 2)) + 0.5 * (level**2).mean(axis=(1, 2))
        error = error * (1.0 + 2.0 * self._usual[found[:, 0], found[:, 1]])
        near = np.flatnonzero(error <= error.min() * 1.05 + 1e-9)
        top, left = found[int(self._chance.choice(near))]
        return int(top), int(left)

    def _place(self, row: int, column: int, at: tuple[int, int], owner: int) -> None:
        """Sew the surface's window at `at` into a block."""
        down, across = self._window(row, column)
        grid = np.ix_(down, across)
        high, wide = self._plan.window
        new = self._logs[at[0] : at[0] + high, at[1] : at[1] + wide]
        known, there = self._known[grid], self._made[grid]
        if owner and known.any():
            level = np.clip((there - new)[known].mean(axis=0), -_GAIN, _GAIN)
            new = new + level
        cost = np.where(known, ((there - new) ** 2).sum(axis=2), 0.0)
        share = np.where(known, self._shares(known, cost), 1.0) if owner else (~known).astype(np.float64)
        self._made[grid] = (
            _blended(there, new, known, share) if owner and known.any() else np.where(known[..., None], there, new)
        )
        self._owners[grid] = np.where(share > 0.5, owner, self._owners[grid])
        self._known[grid] = True

    def _shares(self, known: Mask, cost: Pixels) -> NDArray[np.float64]:
        """1 where the new block is taken: beyond the cheapest path through each overlap with what is known."""
        overlap = self._plan.overlap
        taken = np.ones(known.shape)
        # What is not known yet may lie in a strip as well: it costs nothing, and the new block has it anyway.
        strips = (
            (cost[:, :overlap], known[:, :overlap], 1),
            (cost[:, ::-1][:, :overlap], known[:, ::-1][:, :overlap], -1),
        )
        for strip, there, side in strips:
            if there.mean() > 0.08:
                path = _cheapest_path(strip)
                new = np.arange(overlap)[None] >= path[:, None]
                view = taken if side > 0 else taken[:, ::-1]
                view[:, :overlap] *= new
        for strip, there, side in (
            (cost[:overlap].T, known[:overlap].T, 1),
            (cost[::-1][:overlap].T, known[::-1][:overlap].T, -1),
        ):
            if there.mean() > 0.08:
                path = _cheapest_path(strip)
                new = np.arange(overlap)[None] >= path[:, None]
                view = taken if side > 0 else taken[::-1]
                view[:overlap] *= new.T
        return taken


def _blended(there: Pixels, new: Pixels, known: Mask, share: NDArray[np.float64]) -> Pixels:
    """Both sewn together in two bands: fine detail right at the path, light and shade over a wider strip."""
    sharp = np.where(known, blurred(share.astype(np.float32), 0.8), 1.0)[..., None]
    wide = max(2.0, _SOFT * min(known.shape))
    soft = np.where(known, blurred(share.astype(np.float32), wide), 1.0)[..., None]
    there_low, new_low = blurred_inside(there, known, wide), blurred(new, wide)
    low = there_low * (1 - soft) + new_low * soft
    high = (there - there_low) * (1 - sharp) + (new - new_low) * sharp
    found: Pixels = np.where(known[..., None], low + high, new).astype(np.float32)
    return found


def _window_means(values: Pixels, window: tuple[int, int]) -> NDArray[np.float64]:
    """The mean over every window, by its upper left corner."""
    high, wide = window
    sums = np.zeros((values.shape[0] + 1, values.shape[1] + 1))
    sums[1:, 1:] = np.cumsum(np.cumsum(values, axis=0, dtype=np.float64), axis=1)
    total = sums[high:, wide:] - sums[:-high, wide:] - sums[high:, :-wide] + sums[:-high, :-wide]
    found: NDArray[np.float64] = total / (high * wide)
    return found


def _cheapest_path(cost: Pixels) -> Ints:
    """For each row of a strip the column where the cheapest connected path from its first to its last row goes."""
    rows, columns = cost.shape
    total = cost.astype(np.float64).copy()
    for row in range(1, rows):
        before = np.pad(total[row - 1], 1, constant_values=math.inf)
        total[row] += np.minimum(np.minimum(before[:-2], before[1:-1]), before[2:])
    path = np.empty(rows, dtype=np.int64)
    path[-1] = int(total[-1].argmin())
    for row in range(rows - 2, -1, -1):
        low = max(0, path[row + 1] - 1)
        path[row] = low + int(total[row, low : path[row + 1] + 2].argmin())
    return path
