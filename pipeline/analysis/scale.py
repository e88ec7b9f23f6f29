# SPDX-License-Identifier: GPL-3.0-or-later
"""How large the room is: what the model stated and what things of known size say, weighed against each other.

A model is usually right within a few percent, and now and then far off. So its size is expected with a narrow peak and
heavy tails: anchors that differ by little hardly move it, and many that agree on another size win.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ..artifacts.analysis import Calibration, Finding
from .anchors import Anchor

MODEL_SPREAD = 0.03
"""Width of the peak around the stated size (relative); beyond it the expectation falls off as a power (Cauchy)."""
COMMON = 0.04
"""What anchors may be off by all alike: furniture of another country or for another purse."""
HUBER = 1.5
CONTRADICTS = 2.5
"""In its own standard deviations: an anchor that is off by more from all others is named."""
LARGEST = math.log(3.0)
SMALLEST = math.log(1.03)
"""A smaller correction is not made: what is usual says nothing about so little, and the stated metres stay number for number."""


@dataclass(frozen=True)
class Scale:
    """A factor for all metres.

    Attributes:
        factor: 1 when the stated size stays. spread: its relative uncertainty. source: in words, for `scale_source`.
    """

    factor: float
    spread: float
    source: str
    findings: tuple[Finding, ...] = ()


def estimated_scale(anchors: Sequence[Anchor]) -> Scale:
    """The most probable factor for the stated metres, given the anchors."""
    if not anchors:
        return Scale(1.0, 2 * MODEL_SPREAD, "model")
    mean, spread = robust_mean([a.log_factor for a in anchors], [a.spread for a in anchors])
    spread = math.hypot(spread, COMMON)
    grid = np.linspace(-LARGEST, LARGEST, 4001)
    cost = ((grid - mean) / spread) ** 2 / 2 + np.log1p((grid / MODEL_SPREAD) ** 2)
    weight = np.exp(cost.min() - cost)
    best = float(grid[int(cost.argmin())])
    uncertain = math.sqrt(float(np.dot(weight, (grid - best) ** 2) / weight.sum()))
    factor = math.exp(best) if abs(best) > SMALLEST else 1.0
    findings = []
    if factor != 1.0:
        word = "larger" if factor > 1 else "smaller"
        names = ", ".join(a.name for a in anchors[:6])
        message = f"The room was made {abs(factor - 1):.0%} {word} than stated, by the usual size of: {names}."
        findings.append(Finding(about="room", message=message))
    findings += [
        _odd(a, best) for a in anchors if abs(a.log_factor - best) > CONTRADICTS * math.hypot(a.spread, COMMON)
    ]
    count = f"{len(anchors)} anchors" if len(anchors) > 1 else "1 anchor"
    return Scale(factor, uncertain, f"model and {count}", tuple(findings))


def _odd(anchor: Anchor, best: float) -> Finding:
    # Its factor is what would make it usual: above the room's, it measures less than usual.
    word = "smaller" if anchor.log_factor > best else "larger"
    apart = abs(math.exp(best - anchor.log_factor) - 1)
    message = f"It measures {apart:.0%} {word} than usual, unlike the other things of known size in the room."
    return Finding(about=anchor.name, message=message)


def robust_mean(values: Sequence[float], spreads: Sequence[float]) -> tuple[float, float]:
    """Huber's mean of measurements with their own standard deviations, and its standard deviation.

    Where they agree less than their deviations promise, the mean is less certain by as much (Birge ratio).
    """
    x, s = np.array(values, dtype=float), np.array(spreads, dtype=float)
    order = np.argsort(x)
    share = np.cumsum(1 / s[order] ** 2)
    mean = float(x[order][int(np.searchsorted(share, share[-1] / 2))])  # weighted median
    weight = 1 / s**2
    for _ in range(30):
        off = np.abs(x - mean) / s
        weight = np.minimum(1.0, HUBER / np.maximum(off, 1e-9)) / s**2
        mean = float(np.dot(weight, x) / weight.sum())
    spread = 1 / math.sqrt(float(weight.sum()))
    if len(x) > 1:
        spread *= math.sqrt(max(1.0, float(np.dot(weight, (x - mean) ** 2)) / (len(x) - 1)))
    return mean, spread


def scale_sentence(calibration: Calibration) -> str:
    """Where the room's size comes from and how sure it is, for the panel."""
    if calibration.scale_source in ("known width", "known length"):
        return f"Scale from the {calibration.scale_source}"
    spread = max(1, round(100 * calibration.scale_spread))
    return f"Scale from the {calibration.scale_source}, about {spread} % uncertain"
