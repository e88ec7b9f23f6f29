# SPDX-License-Identifier: GPL-3.0-or-later
"""What the second look is asked about: things whose box and metres cannot both be right."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from ..artifacts.analysis import Calibration, DetectedObject, SceneAnalysis
from ..artifacts.common import ImageBox
from ..artifacts.trust import Trust
from ..geometry.camera import GeometryError
from ..geometry.footprint import lift_box
from ..layout.fuse import disagreement
from .covered import lowest_of
from .differences import NEAR_WALL

MOST = 12
DOUBTFUL = 2.0
"""Disagreement (in combined uncertainties) from which a thing is asked about."""
NOTICED = 0.12
"""Metres, or a part of the thing's size, by which both have to differ for a question to be worth an answer."""
STRICTEST = Trust(box_sigma=9.0, centre_sigma=0.015, size_sigma=0.1)
"""Errors that are taken at most: where everything is poor, the worst is asked about all the same."""
OUTSIDE = 0.15
"""Metres by which a thing may reach through a wall before it is asked about."""


@dataclass(frozen=True)
class Doubt:
    """One question: about which object, how grave it is (1 is just worth asking), and the question itself."""

    about: str
    weight: float
    question: str


def doubts(stated: SceneAnalysis, analysis: SceneAnalysis, calibration: Calibration) -> list[Doubt]:
    """At most twelve questions, the gravest first.

    Args:
        stated: the analysis in the metres that the model spoke in, which the questions use.
        analysis: the same in the frame of the fitted floor.
    """
    trust = _strict(calibration.trust or Trust())
    side = max(analysis.room_size[:2])
    scale = math.sqrt(math.prod(stated.room_size[:2]) / math.prod(analysis.room_size[:2]))
    result = []
    for item in analysis.objects:
        if item.box is None or item.placement not in ("floor", "surface"):
            continue
        doubt = _two_measures(item, item.box, calibration, side, trust, scale) or _through_wall(
            item, calibration, scale
        )
        if doubt is not None:
            result.append(doubt)
    return sorted(result, key=lambda d: (-d.weight, d.about))[:MOST]


def _strict(trust: Trust) -> Trust:
    most = {
        name: min(getattr(trust, name), getattr(STRICTEST, name))
        for name in ("box_sigma", "centre_sigma", "size_sigma")
    }
    return trust.model_copy(update=most)


def asked(found: Sequence[Doubt]) -> str:
    """The questions as a list for the prompt, one a line."""
    return "\n".join(f"- {doubt.about}: {doubt.question}" for doubt in found)


def _two_measures(
    item: DetectedObject, box: ImageBox, calibration: Calibration, side: float, trust: Trust, scale: float
) -> Doubt | None:
    base = lowest_of(item)
    try:
        apart = disagreement(item, calibration.camera, side, base, trust)
        lifted = lift_box(calibration.camera, box, base, item.size[2], item.yaw, item.size, shape=item.shape)
    except GeometryError:
        return Doubt(
            item.id, DOUBTFUL, "its box does not lie on the floor; give its tight `box` and its `centre_m` again"
        )
    if apart < DOUBTFUL:
        return None
    said = []
    for name, by_box, by_metres in zip(("wide", "deep"), lifted.size, item.size, strict=False):
        if abs(by_box - by_metres) > NOTICED * max(by_metres, 0.5):
            said.append(f"by its box it is {by_box * scale:.2f} m {name}, by its metres {by_metres * scale:.2f} m")
    moved = [lifted.centre[i] - item.centre[i] for i in (0, 1)]
    if math.hypot(*moved) > NOTICED:
        far = math.hypot(*moved) * scale
        said.append(f"its box lies {far:.2f} m further {_direction(moved)} than its metres")
    if not said:
        return None
    # A large thing in the wrong place spoils more than a cup.
    weight = apart * (1.5 if item.salience == "major" else 1.0)
    return Doubt(item.id, weight, "; ".join(said) + "; give its tight `box`, `centre_m` and `size_m` again")


def _direction(moved: Sequence[float]) -> str:
    """A step on the floor in words of the picture."""
    x, y = moved
    words = []
    if abs(y) > 0.4 * abs(x):
        words.append("up" if y > 0 else "down")
    if abs(x) > 0.4 * abs(y):
        words.append("right" if x > 0 else "left")
    return " ".join(words)


def _through_wall(item: DetectedObject, calibration: Calibration, scale: float) -> Doubt | None:
    """A question about what reaches out of the room by its metres and its box alike."""
    if item.placement != "floor":
        return None
    xs, ys = [p[0] for p in calibration.floor], [p[1] for p in calibration.floor]
    cos, sin = abs(math.cos(math.radians(item.yaw))), abs(math.sin(math.radians(item.yaw)))
    half = ((item.size[0] * cos + item.size[1] * sin) / 2, (item.size[0] * sin + item.size[1] * cos) / 2)
    out = {
        "left": min(xs) - (item.centre[0] - half[0]),
        "right": item.centre[0] + half[0] - max(xs),
        "bottom": min(ys) - (item.centre[1] - half[1]),
        "top": item.centre[1] + half[1] - max(ys),
    }
    wall = max(out, key=lambda name: out[name])
    if out[wall] < OUTSIDE:
        return None
    question = (
        f"by its metres it reaches {out[wall] * scale:.2f} m through the {wall} wall; "
        "give its tight `box`, `centre_m` and `size_m` again"
    )
    return Doubt(item.id, DOUBTFUL * min(2.0, out[wall] / NEAR_WALL + 1.0), question)
