# SPDX-License-Identifier: GPL-3.0-or-later
"""What the picture at hand tells of how good its boxes and its metres are.

Boxes and metres measure the same things, so the spread of their differences is the sum of both errors. What splits the
sum: errors of centres move both edges of a thing alike, errors of sizes grow with the thing, errors of boxes do neither;
things stand flush at walls, do not reach into walls or into each other, and come in sets of one size. The usual errors
are the mean over all of them, each weighed by how probable it makes what was seen and by what is usual; so a picture with
few objects stays near what is usual. What is wrong with all metres or all boxes alike (a stretch, a shift, sizes too small,
boxes too tight) is a weighted least-squares fit that has to overcome the assumption that nothing is.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product
from typing import TypeAlias

import numpy as np
import numpy.typing as npt

from ..artifacts.analysis import Calibration, SceneAnalysis
from ..artifacts.trust import Sources, Trust
from .covered import covered_edges
from .differences import (
    NEAR_WALL,
    Difference,
    Gap,
    Twins,
    Variance,
    differences,
    neighbour_gaps,
    seen_twice,
    twins,
    wall_gaps,
)

Floats: TypeAlias = npt.NDArray[np.float64]

LEAST_OBJECTS = 3
USUAL = Trust()
SPREAD = {"box": 0.9, "centre": 1.0, "size": 0.9}
"""How far the usual errors of a picture lie from what is usual, as standard deviations of their logarithms."""
CAUTION = 0.5
"""What the evidence for one combination of common errors over another counts: some of it is the same thing seen twice."""
STEPS = 17
REACH = (-1.8, 3.4)
"""Errors that are weighed: so many, from and to so many of these standard deviations off. Weak models may be far off."""
FREEDOM = 8.0
"""Degrees of freedom of Student's t: gross errors are expected now and then."""
SURE = 2.0
"""How much more probable (logarithm) a common error has to make what was seen to be believed."""
FLUSH, FLUSH_SIGMA = 0.5, 0.02
"""How often a thing near a wall stands flush at it, and how exactly (metres)."""
EXEMPT = 0.25
"""How often neighbours may reach into each other: chairs under tables."""
ROUNDS = 3
METRES_PRIOR = (0.06, 0.06, 0.02, 0.02, 0.12, 0.015)
BOX_PRIOR = (5.0, 5.0, 0.012, 0.012, 3.0)
"""Standard deviations of what is wrong with all metres (stretch, shift, sizes, sizes to the right less sizes up) and all
boxes (shift, stretch, inset). Who takes furniture for too large does so in every direction of the picture; where boxes say
otherwise, seen at an angle, it is things that are no cuboids."""
_AXES = np.eye(len(METRES_PRIOR) + len(BOX_PRIOR))
_AXES[4:6, 4:6] = ((1.0, 1.0), (1.0, -1.0))
"""From sizes and their difference to sizes to the right and up."""
_FARTHEST = np.array((0.6, 0.6, 0.5, 0.5, 1.5, 1.5, 150.0, 150.0, 0.4, 0.4, 40.0))
"""What is farther off than this is no common error any more."""
MOST_COMMON = 5
"""So many kinds of common errors at once, at most."""
_COMBINATIONS: npt.NDArray[np.bool_] = np.array([c for c in product((False, True), repeat=11) if sum(c) <= MOST_COMMON])


@dataclass(frozen=True)
class _Evidence:
    """What is known, as arrays for all errors that are weighed."""

    rows: Sequence[Difference]
    gaps: Sequence[Gap]
    twins: Sequence[Twins]

    @property
    def regressors(self) -> Floats:
        return np.array([(*r.metres, *r.box) for r in self.rows])


def learn_trust(analysis: SceneAnalysis, calibration: Calibration, evidence: Sources = "both") -> Trust:
    """How far this picture's boxes and metres can be trusted; what is usual where it has too few objects to tell.

    Args:
        analysis: metres in the frame of the fitted floor.
        evidence: what placements are to be made from; with one source alone there is nothing to compare.
    """
    covered = covered_edges(analysis, calibration)
    if evidence != "both":
        return Trust(evidence=evidence, edges=covered)
    seen = seen_twice(analysis, calibration, covered)
    if len(seen) < LEAST_OBJECTS:
        return Trust(edges=covered, objects=len(seen))
    side = _side(calibration)
    known = _Evidence(
        differences(seen, side),
        [*wall_gaps(seen, calibration.floor, side), *neighbour_gaps(seen, side)],
        twins(seen),
    )
    sigmas = np.array((USUAL.centre_sigma * side, USUAL.size_sigma, USUAL.box_sigma))
    common = np.zeros(len(METRES_PRIOR) + len(BOX_PRIOR))
    for _ in range(ROUNDS):
        common = _common(known, sigmas, common)
        sigmas = _sigmas(known, common, side)
    a = [round(float(v), 6) for v in np.clip(common, -_FARTHEST, _FARTHEST)]
    return Trust(
        objects=len(seen),
        centre_sigma=round(float(sigmas[0] / side), 6),
        size_sigma=round(float(sigmas[1]), 6),
        box_sigma=round(float(sigmas[2]), 4),
        metres_stretch=(a[0], a[1]),
        metres_shift=(a[2], a[3]),
        metres_size=(a[4], a[5]),
        box_shift=(a[6], a[7]),
        box_stretch=(a[8], a[9]),
        box_inset=a[10],
        edges=covered,
    )


def _side(calibration: Calibration) -> float:
    xs, ys = [p[0] for p in calibration.floor], [p[1] for p in calibration.floor]
    return max(max(xs) - min(xs), max(ys) - min(ys))


def _of(terms: Sequence[Variance], sigmas: Floats) -> Floats:
    """Variances (..., terms) for errors (..., 3) of centres, sizes and boxes."""
    weights = np.array(terms).reshape(-1, 5)
    learnt = np.square(sigmas) @ weights[:, :3].T
    result: Floats = learnt + weights[:, 3] * USUAL.height_sigma**2 + weights[:, 4]
    return result


def _common(known: _Evidence, sigmas: Floats, start: Floats) -> Floats:
    """What is wrong with all metres or all boxes alike: only what the picture tells for sure, the rest stays zero.

    Every combination of common errors is weighed by how probable it makes what was seen, over all their sizes.
    """
    prior = np.square((*METRES_PRIOR, *BOX_PRIOR))
    for _ in range(2):
        rows, values, pull = _equations(known, sigmas, start)
        rows = rows @ _AXES
        normal, right = rows.T @ (pull[:, None] * rows), rows.T @ (pull * values)
        taken = _COMBINATIONS[:, :, None] & _COMBINATIONS[:, None, :]
        # What is not taken is held at zero by equations of its own.
        matrices = np.where(taken, normal, 0.0) + np.where(_COMBINATIONS, 1.0 / prior, 1.0)[:, :, None] * np.eye(
            len(prior)
        )
        sides = np.where(_COMBINATIONS, right, 0.0)
        solutions = np.linalg.solve(matrices, sides[:, :, None])[:, :, 0]
        gains = np.sum(solutions * sides, axis=1) / 2
        gains -= (np.linalg.slogdet(matrices)[1] + _COMBINATIONS @ np.log(prior)) / 2
        gains -= SURE * _COMBINATIONS.sum(axis=1)
        chance = np.exp(CAUTION * (gains - gains.max()))
        start = _AXES @ (chance @ solutions / chance.sum())
    return start


def _equations(known: _Evidence, sigmas: Floats, start: Floats) -> tuple[Floats, Floats, Floats]:
    """Equations for the common errors: their coefficients, right-hand sides and weights."""
    values = np.array([r.value for r in known.rows])
    weights = np.array([r.weight for r in known.rows])
    variances = _of([r.variance for r in known.rows], sigmas)
    off = values - known.regressors @ start
    pull = weights * (FREEDOM + 1) / (FREEDOM + off**2 / variances) / variances
    walls = [g for g in known.gaps if g.wall]
    if not walls:
        return known.regressors, values, pull
    no_metres, no_boxes = (0.0,) * len(METRES_PRIOR), (0.0,) * len(BOX_PRIOR)
    rows = np.array([(*g.common_metres, *no_boxes) for g in walls] + [(*no_metres, *g.common_boxes) for g in walls])
    gaps = np.array([g.by_metres for g in walls] + [g.by_boxes for g in walls])
    variances = _of([g.metres for g in walls] + [g.box for g in walls], sigmas) + FLUSH_SIGMA**2
    # Things that one of the two puts to the wall are taken to stand there.
    flush = FLUSH * np.exp(-((gaps - rows @ start) ** 2) / (2 * variances)) / np.sqrt(2 * np.pi * variances)
    share = flush / (flush + (1 - FLUSH) / NEAR_WALL)
    half = len(walls)
    either = np.maximum(share[:half], share[half:])
    wall_pull = np.concatenate([either, either]) / variances
    far = np.abs(gaps - rows @ start) / np.sqrt(variances)
    wall_pull /= 1.0 + far**2 / FREEDOM
    return np.vstack([known.regressors, rows]), np.concatenate([values, gaps]), np.concatenate([pull, wall_pull])


def _sigmas(known: _Evidence, common: Floats, side: float) -> Floats:
    """Mean errors of centres (metres), sizes and boxes over all that are weighed, in the logarithm."""
    usual = np.array((USUAL.centre_sigma * side, USUAL.size_sigma, USUAL.box_sigma))
    spread = np.array((SPREAD["centre"], SPREAD["size"], SPREAD["box"]))
    steps = np.linspace(*REACH, STEPS)
    grid = np.stack(np.meshgrid(steps, steps, steps, indexing="ij"), axis=-1).reshape(-1, 3)
    sigmas = usual * np.exp(grid * spread)
    fit = -np.sum(grid**2, axis=1) / 2
    fit += _differences_fit(known, common, sigmas)
    fit += _gaps_fit(known.gaps, common, sigmas)
    if known.twins:
        values = np.array([t.value for t in known.twins])
        fit += np.sum(_student(values, _of([t.variance for t in known.twins], sigmas)), axis=1)
    chance = np.exp(fit - fit.max())
    result: Floats = usual * np.exp(spread * (chance @ grid) / chance.sum())
    return result


def _student(values: Floats, variances: Floats) -> Floats:
    """Logarithm of the density of Student's t with these variances, up to a constant."""
    return -0.5 * np.log(variances) - (FREEDOM + 1) / 2 * np.log1p(values**2 / ((FREEDOM - 2) * variances))


def _differences_fit(known: _Evidence, common: Floats, sigmas: Floats) -> Floats:
    values = np.array([r.value for r in known.rows]) - known.regressors @ common
    weights = np.array([r.weight for r in known.rows])
    fit: Floats = _student(values, _of([r.variance for r in known.rows], sigmas)) @ weights
    return fit


def _gaps_fit(gaps: Sequence[Gap], common: Floats, sigmas: Floats) -> Floats:
    """How probable the gaps are beside the differences: most at walls are none, and none is negative."""
    if not gaps:
        return np.zeros(len(sigmas))
    metres, box = _of([g.metres for g in gaps], sigmas), _of([g.box for g in gaps], sigmas)
    split = len(METRES_PRIOR)
    by_metres = np.array([g.by_metres for g in gaps]) - np.array([g.common_metres for g in gaps]) @ common[:split]
    by_boxes = np.array([g.by_boxes for g in gaps]) - np.array([g.common_boxes for g in gaps]) @ common[split:]
    both = metres * box / (metres + box)
    mean = both * (by_metres / metres + by_boxes / box)
    wide = both + FLUSH_SIGMA**2
    open_gap = _normal_below(mean / np.sqrt(wide))
    flush = np.exp(-(mean**2) / (2 * wide)) / np.sqrt(2 * np.pi * wide)
    wall = np.array([g.wall for g in gaps])
    chance = np.where(wall, FLUSH * flush + (1 - FLUSH) * open_gap / NEAR_WALL, EXEMPT + (1 - EXEMPT) * open_gap)
    fit: Floats = np.sum(np.log(chance + 1e-6), axis=1)
    return fit


def _normal_below(x: Floats) -> Floats:
    """The normal distribution's share below x (Abramowitz and Stegun 26.2.17, error below 1e-7)."""
    t = 1.0 / (1.0 + 0.2316419 * np.abs(x))
    series = t * (0.319381530 + t * (-0.356563782 + t * (1.781477937 + t * (-1.821255978 + t * 1.330274429))))
    tail = series * np.exp(-(x**2) / 2) / math.sqrt(2 * math.pi)
    return np.where(x >= 0, 1.0 - tail, tail)
