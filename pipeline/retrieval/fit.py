# SPDX-License-Identifier: GPL-3.0-or-later
"""How an asset of some size gets into a proxy's box: by one factor where that fills it, a little stretched where not."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

STRETCH = 1.5
"""How much more one axis may be stretched than another."""
_THIN_STRETCH = 4.0
_THIN = 0.15
_BETTER = 1.15
"""An asset is only turned where that fits better by this factor: its front is taken to be -Y, as in Blender."""
_UNKNOWN = 0.8


@dataclass(frozen=True)
class Fit:
    """How an asset fits a box.

    Attributes:
        score: 0 to 1. turn: quarter turns counter-clockwise about z.
        factors: along the box's axes, after turning. scale: how much larger the box is on the whole.
    """

    score: float
    turn: int = 0
    factors: tuple[float, float, float] = (1.0, 1.0, 1.0)
    scale: float = 1.0


def best_fit(size: Sequence[float] | None, box: Sequence[float], turn: int | None = None) -> Fit:
    """How an asset fits.

    Args:
        size: width, depth, height of the asset in metres, None where that is not known yet. box: of the proxy.
        turn: quarter turns that the artist wants; None turns by one where that fits clearly better.
    """
    if size is None or max(size) <= 0:
        return Fit(_UNKNOWN if size is None else 0.0, turn or 0)
    if turn is not None:
        return _fit(size, box, turn % 4)
    plain, turned = _fit(size, box, 0), _fit(size, box, 1)
    return turned if turned.score > _BETTER * plain.score else plain


def placing(low: Any, high: Any, box: Sequence[float], turn: int, placement: str = "floor") -> Any:
    """The 4 x 4 matrix from an asset's own metres into its proxy's frame, wherever the asset's origin is.

    The proxy's frame has its origin at the centre of the box's base and faces -Y. The asset stays inside the box: it
    stands on the base, hangs from the top on a ceiling, has its back (+Y) on a wall.

    Args:
        low, high: lowest and highest corner of the asset. turn: as in `Fit`.
    """
    low, high = np.asarray(low, dtype=float), np.asarray(high, dtype=float)
    fit = _fit(high - low, box, turn % 4)
    matrix = np.eye(4)
    matrix[:2, :2] = _TURNS[turn % 4]
    matrix[:3, :3] = np.diag(fit.factors) @ matrix[:3, :3]
    corners = np.array([low, high]) @ matrix[:3, :3].T
    bottom, top = corners.min(axis=0), corners.max(axis=0)
    size = np.asarray(box, dtype=float)
    move = -(bottom + top) / 2
    move[2] = -bottom[2]
    if placement == "ceiling":
        move[2] = size[2] - top[2]
    elif placement == "wall":
        move[1] = size[1] / 2 - top[1]
        move[2] = size[2] / 2 - (bottom[2] + top[2]) / 2
    matrix[:3, 3] = move
    return matrix


_TURNS = ([[1, 0], [0, 1]], [[0, -1], [1, 0]], [[-1, 0], [0, -1]], [[0, 1], [-1, 0]])


def _fit(size: Any, box: Sequence[float], turn: int) -> Fit:
    sides = [float(v) for v in (size if turn % 2 == 0 else (size[1], size[0], size[2]))]
    room = [max(float(v), 1e-4) for v in box]
    flat = [side < 1e-4 * max(sides) for side in sides]
    # The thickness of a rug or a picture says little.
    thin = [a < _THIN * max(sides) and b < _THIN * max(room) for a, b in zip(sides, room, strict=True)]
    ratios = [1.0 if f else b / a for a, b, f in zip(sides, room, flat, strict=True)]
    counted = [r for r, f, t in zip(ratios, flat, thin, strict=True) if not f and not t]
    if not counted:
        return Fit(0.0, turn)
    logs = [math.log(r) for r in counted]
    scale = math.exp(sum(logs) / len(logs))
    least = min(counted)
    factors = [
        least if f else min(r, (_THIN_STRETCH if t else STRETCH) * least)
        for r, f, t in zip(ratios, flat, thin, strict=True)
    ]
    apart = math.exp(-0.9 * max(0.0, max(logs) - min(logs) - 0.15))
    far = max(0.75, math.exp(-0.2 * max(0.0, abs(math.log(scale)) - 0.35)))
    return Fit(apart * far, turn, (factors[0], factors[1], factors[2]), scale)
