# SPDX-License-Identifier: GPL-3.0-or-later
"""A small Levenberg-Marquardt solver: dense, deterministic, for tens of unknowns."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from .polygon import Floats

Residuals = Callable[[Floats], Floats]
DIFFERENCE = 1e-6  # of the typical size of a change: the step of the difference quotient


class Solution(NamedTuple):
    """Where the solver ended.

    Attributes:
        x: unknowns; cost: half the sum of squared residuals; iterations: accepted and refused steps together.
    """

    x: Floats
    cost: float
    iterations: int


def levenberg_marquardt(
    residuals: Residuals,
    start: Floats,
    steps: Floats,
    iterations: int = 60,
    tolerance: float = 1e-10,
    many: Residuals | None = None,
) -> Solution:
    """Minimise the sum of squared residuals from `start` (Marquardt 1963, with a forward-difference Jacobian).

    Args:
        residuals: unknowns (n,) to residuals (m,); where it is not finite the step is refused.
        steps: (n,) typical size of a change of each unknown; scales the damping and the difference quotient.
        tolerance: stop when the cost falls by less than this part of itself.
        many: the same residuals for many points at once, (b, n) to (b, m), if that is faster than one by one.

    Returns:
        The best point seen; its cost is infinite when even the start could not be evaluated.
    """
    x = np.array(start, dtype=float)
    value = residuals(x)
    cost = _cost(value)
    damping = 1e-3
    count = 0
    while count < iterations and np.isfinite(cost) and cost > 1e-24:
        jacobian = _jacobian(residuals, many, x, value, steps)
        normal, gradient = jacobian.T @ jacobian, jacobian.T @ value
        improved = False
        while count < iterations and damping < 1e12:
            count += 1
            # In units of `steps`; the floor keeps unknowns that no residual sees where they are.
            ridge = damping * np.maximum(np.diag(normal), 1e-9 * np.trace(normal) / len(x) + 1e-12)
            step = np.linalg.lstsq(normal + np.diag(ridge), -gradient, rcond=None)[0]
            trial = x + step * steps
            trial_value = residuals(trial)
            trial_cost = _cost(trial_value)
            if trial_cost < cost:
                gain = (cost - trial_cost) / cost
                x, value, cost = trial, trial_value, trial_cost
                damping = max(damping / 10, 1e-12)
                improved = gain > tolerance
                break
            damping *= 10
        if not improved:
            break
    return Solution(x, cost, count)


def _cost(value: Floats) -> float:
    with np.errstate(over="ignore", invalid="ignore"):
        total = float(value @ value) / 2
    return total if np.isfinite(total) else np.inf


def _jacobian(residuals: Residuals, many: Residuals | None, x: Floats, value: Floats, steps: Floats) -> Floats:
    moved = x + np.diag(DIFFERENCE * steps)
    values = many(moved) if many is not None else np.stack([residuals(row) for row in moved])
    jacobian: Floats = np.nan_to_num((values - value).T / DIFFERENCE, nan=0.0, posinf=0.0, neginf=0.0)
    return jacobian
