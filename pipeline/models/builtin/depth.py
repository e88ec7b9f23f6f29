# SPDX-License-Identifier: GPL-3.0-or-later
"""Tells a perspective view from an orthographic one, and finds the floor inside the wall faces.

Seen from straight above, the floor's outline is the wall tops' outline shrunk towards the vanishing point of the
vertical edges (a homothety), so one number, the shrink, and the point describe it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .grid import Floats, box_mean, polygon_mask
from .outline import Polygon, inset, inward


@dataclass(frozen=True)
class FloorFit:
    """The floor's outline in the working picture.

    Attributes:
        floor: (n, 2) corners at floor level, same order as the wall tops given.
        shrink: floor size over wall-top size, 1 for an orthographic view.
        vanishing: (x, y) that the vertical edges run towards.
        score: 0..1, how well the strips on both sides of the outline differ.
    """

    floor: Polygon
    shrink: float
    vanishing: tuple[float, float]
    score: float


class _Steps:
    """How much of a straight line lies on a colour step, in constant time."""

    def __init__(self, lab: Floats, least: float = 4.0) -> None:
        self.tables = []
        for axis in (0, 1):
            values = lab if axis else lab.transpose(1, 0, 2)
            padded = np.pad(values, ((0, 0), (3, 3), (0, 0)), mode="edge")
            width = values.shape[1]
            after = (padded[:, 3 : width + 3] + padded[:, 4 : width + 4]) / 2
            before = (padded[:, 2 : width + 2] + padded[:, 1 : width + 1]) / 2
            step = np.linalg.norm(after - before, axis=2)
            near = step.copy()  # one pixel of tolerance, as the outline is on a coarse grid of candidates
            near[:, 1:] = np.maximum(near[:, 1:], step[:, :-1])
            near[:, :-1] = np.maximum(near[:, :-1], step[:, 1:])
            strong = np.clip(near / least - 0.5, 0.0, 1.0)
            self.tables.append(np.pad(strong.cumsum(0), ((1, 0), (0, 0))))

    def share(self, a: NDArray[np.float64], b: NDArray[np.float64]) -> NDArray[np.float64]:
        """Shares (0..1) of axis-aligned segments a-b that lie on a step; 0 outside the picture.

        Args:
            a, b: (k, 2) ends; all segments run the same way.
        """
        along_x = abs(b[0, 0] - a[0, 0]) >= abs(b[0, 1] - a[0, 1])
        table = self.tables[0] if along_x else self.tables[1]
        if along_x:
            a, b = a[:, ::-1], b[:, ::-1]
        position = np.rint((a[:, 0] + b[:, 0]) / 2).astype(int)
        low = np.rint(np.minimum(a[:, 1], b[:, 1])).astype(int)
        high = np.rint(np.maximum(a[:, 1], b[:, 1])).astype(int)
        valid = (position >= 2) & (position < table.shape[1] - 2) & (low >= 0) & (high < table.shape[0])
        valid &= high - low >= 4
        column = np.where(valid, position, 0)
        total = table[np.where(valid, high, 0), column] - table[np.where(valid, low, 0), column]
        result: NDArray[np.float64] = np.where(valid, total / np.maximum(high - low, 1), 0.0)
        return result


def _scores(steps: _Steps, polygons: NDArray[np.float64]) -> NDArray[np.float64]:
    """For (k, n, 2) polygons the geometric mean over the edges of the share of each that lies on a colour step."""
    count = polygons.shape[1]
    shares = [steps.share(polygons[:, i], polygons[:, (i + 1) % count]) for i in range(count)]
    result: NDArray[np.float64] = np.exp(np.mean(np.log(np.maximum(shares, 0.01)), axis=0))
    return result


def _agreement(lab: Floats, polygon: Polygon) -> float:
    """Whether the colour changes the same way across every edge, from the floor to a wall face; 0..1.

    It does where the outline is the floor's. Where the lines are those of furniture that happens to lie in a
    rectangle, every edge has its own change.
    """
    vectors, inner = [], []
    for index in range(len(polygon)):
        inside = inward(lab, polygon, index, 4)[1:]
        outside = inward(lab, polygon[::-1], len(polygon) - 2 - index, 4)[1:]
        if min(inside.shape[:2]) < 1 or min(outside.shape[:2]) < 1 or inside.shape[1] != outside.shape[1]:
            return 0.0
        step = inside.mean(0) - outside.mean(0)
        size = np.linalg.norm(step, axis=1, keepdims=True)
        bounded = step * np.minimum(1.0, 12.0 / np.maximum(size, 1e-6))
        vectors.append(bounded.mean(0) / max(float(np.minimum(size, 12.0).mean()), 1.0))
        inner.append(np.median(inside.reshape(-1, 3), axis=0))
    return float(np.linalg.norm(np.mean(vectors, axis=0)))


def _nearness(point: NDArray[np.float64], lab: Floats, top: Polygon) -> float:
    """1 where the vanishing point is at the picture's or the room's centre, falling to 0.1 far from both."""
    spread = 0.05 * float(min(lab.shape[:2]))
    centres = (np.array([lab.shape[1] / 2, lab.shape[0] / 2]), (top.max(0) + top.min(0)) / 2)
    distance = min(float(np.linalg.norm(point - c)) for c in centres)
    return 0.1 + 0.9 * float(np.exp(-0.5 * (distance / spread) ** 2))


def _refined(steps: _Steps, fit: FloorFit) -> FloorFit:
    """Move every edge by up to 3 pixels to where most of it lies on a step."""
    polygon = fit.floor
    count = len(polygon)
    shifts = np.zeros(count)
    for index in range(count):
        a, b = polygon[index], polygon[(index + 1) % count]
        across = np.array([0.0, 1.0]) if abs((b - a)[0]) >= abs((b - a)[1]) else np.array([1.0, 0.0])
        sign = np.sign((b - a)[0]) if across[1] else -np.sign((b - a)[1])
        moves = np.arange(-3, 4)
        offsets = sign * moves[:, None] * across
        shifts[index] = moves[int(np.argmax(steps.share(a + offsets, b + offsets) - 0.01 * np.abs(moves)))]
    return FloorFit(inset(polygon, shifts), fit.shrink, fit.vanishing, fit.score)


def fit_floor(lab: Floats, top: Polygon) -> FloorFit | None:
    """Find the floor inside the wall faces of a perspective view.

    Args:
        lab: (h, w, 3) working picture; top: wall tops' inner outline, clockwise on the screen.

    Returns:
        The best fit, with a score that says how far to trust it, or None where nothing fits at all.
    """
    steps = _Steps(lab)
    span = top.max(0) - top.min(0)
    centre = (top.max(0) + top.min(0)) / 2
    middle = np.array([lab.shape[1] / 2, lab.shape[0] / 2])
    points = [c + np.array([i, j]) * 0.015 * span for c in (centre, middle) for i in range(-4, 5) for j in range(-4, 5)]
    near = np.array([_nearness(point, lab, top) for point in points])
    shrinks = np.repeat(np.arange(0.96, 0.42, -0.01), len(points))
    about = np.tile(np.array(points), (len(shrinks) // len(points), 1))
    polygons = about[:, None] + shrinks[:, None, None] * (top[None] - about[:, None])
    scores = np.tile(near, len(shrinks) // len(points)) * _scores(steps, polygons)
    best: FloorFit | None = None
    for index in np.argsort(-scores, kind="stable")[:40].tolist():
        total = float(scores[index]) * _agreement(lab, polygons[index])
        if best is None or total > best.score:
            point = (float(about[index, 0]), float(about[index, 1]))
            best = FloorFit(polygons[index], float(shrinks[index]), point, total)
    return _refined(steps, best) if best is not None else None


def radial_excess(lab: Floats, top: Polygon, fit: FloorFit) -> float:
    """How many more of the oblique edges run towards the vanishing point than beside it (23 degrees to each side).

    In a perspective view these are the room's corners and the upright edges of furniture, doors and windows; seen
    orthographically nothing runs there but chance, and the result is about 0. Only places between wall tops and floor
    are used where that direction is clearly oblique, so edges along the walls say nothing. Of the four quarters
    around the point the middle two count, since one turned chair may point anywhere.
    """
    smooth = box_mean(lab, 1)
    dy, dx = np.zeros(lab.shape, np.float32), np.zeros(lab.shape, np.float32)
    dy[1:-1] = (smooth[2:] - smooth[:-2]) / 2
    dx[:, 1:-1] = (smooth[:, 2:] - smooth[:, :-2]) / 2
    strongest = np.argmax(dx**2 + dy**2, axis=2)[..., None]
    gx = np.take_along_axis(dx, strongest, 2)[..., 0]
    gy = np.take_along_axis(dy, strongest, 2)[..., 0]
    shape = (lab.shape[0], lab.shape[1])
    edges = np.ones(len(top))
    zone = polygon_mask(shape, inset(top, 3 * edges)) & ~polygon_mask(shape, inset(fit.floor, -3 * edges))
    ys, xs = np.mgrid[0 : shape[0], 0 : shape[1]] + 0.5
    rx, ry = xs - fit.vanishing[0], ys - fit.vanishing[1]
    oblique = np.minimum(np.abs(rx), np.abs(ry)) > 0.3 * np.maximum(np.abs(rx), np.abs(ry))
    size = np.hypot(gx, gy)
    edge = zone & (size > 0.6)
    turned = np.arctan2(gy, gx) - np.arctan2(ry, rx)  # a quarter turn where the edge is radial
    weight = np.minimum(size, 4.0)
    shares = []
    for right in (False, True):
        for below in (False, True):
            part = edge & oblique & ((rx > 0) == right) & ((ry > 0) == below)
            total = float(weight[part].sum())
            if total < 8:
                shares.append(0.0)
                continue
            hits = [
                float(weight[part & (np.abs(np.cos(turned + offset)) < 0.12)].sum()) / total
                for offset in (0.0, -0.4, 0.4)
            ]
            shares.append(hits[0] - 0.5 * (hits[1] + hits[2]))
    return float(np.mean(sorted(shares)[1:3]))
