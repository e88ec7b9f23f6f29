# SPDX-License-Identifier: GPL-3.0-or-later
"""How sure each object's place is, from how good the picture's boxes and metres are."""

from __future__ import annotations

import math
from collections.abc import Iterable

from ..artifacts.analysis import Calibration, DetectedObject
from ..artifacts.trust import Trust
from .fuse import LOOSE

PICTURE_FILL = 0.8
"""Usual part of the picture's longer side that the room's longer side takes."""


def placement_spread(objects: Iterable[DetectedObject], calibration: Calibration) -> dict[str, float]:
    """Standard deviation of each object's fused centre in metres, by id; empty where nothing was learnt of the picture."""
    trust = calibration.trust
    if trust is None:
        return {}
    xs, ys = zip(*calibration.floor, strict=True)
    side = max(max(xs) - min(xs), max(ys) - min(ys))
    return {o.id: _spread(o, trust, side) for o in objects}


def _spread(item: DetectedObject, trust: Trust, side: float) -> float:
    metres = trust.centre_sigma * side * (LOOSE if item.source == "corrected box" else 1.0)
    if item.box is None or trust.evidence == "metres":
        return metres
    covered = sum(trust.edges.get(item.id, (1.0, 1.0, 1.0, 1.0))) / 4
    box = trust.box_sigma * covered / 1000.0 / PICTURE_FILL * side / math.sqrt(2.0)
    return box if trust.evidence == "boxes" else 1.0 / math.hypot(1.0 / metres, 1.0 / box)
