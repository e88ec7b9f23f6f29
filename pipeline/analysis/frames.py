# SPDX-License-Identifier: GPL-3.0-or-later
"""How the metres of two calibrations of one picture go over into each other."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ..artifacts.analysis import Calibration, SceneAnalysis
from ..artifacts.camera import CameraModel
from ..artifacts.common import Metres2
from ..geometry.camera import GeometryError, project, to_plane
from ..geometry.polygon import area
from .rescale import Similarity, rescaled_analysis, rescaled_camera

CLOSE = 3e-6
"""Relative difference of lengths that is only the rounding of numbers: known sizes are kept to six digits."""


@dataclass(frozen=True)
class Change:
    """From an old calibration to a new one.

    Attributes:
        metres: what becomes of places and sizes. pure: whether that is all, so that walls and camera follow by it too.
    """

    metres: Similarity
    pure: bool

    @property
    def nothing(self) -> bool:
        """Whether both are the same room."""
        return self.pure and not self.metres.moves


def between(old: Calibration, new: Calibration) -> Change:
    """What leads from one calibration to another.

    A floor that is the old one times a factor is a change of scale. Otherwise the picture says where the old floor lies
    in the new metres; the walls keep their directions, so that nothing is turned.
    """
    if old.floor == new.floor:
        metres = Similarity()
    else:
        factor = _common_factor(old.floor, new.floor)
        metres = _through_picture(old, new) if factor is None else Similarity(factor)
    high = abs(new.height - old.height * metres.factor) <= CLOSE * new.height
    return Change(metres, high and _same_camera(rescaled_camera(old.camera, metres), new.camera))


def same_room(old: SceneAnalysis, new: SceneAnalysis, change: Similarity) -> bool:
    """Whether the new analysis is the old one in other metres; only the height of the walls may differ."""
    moved = rescaled_analysis(old, change)
    blank = {"room_size": (0.0, 0.0, 0.0), "findings": []}
    return _alike(moved.model_copy(update=blank).model_dump(), new.model_copy(update=blank).model_dump())


def transferred(old: CameraModel, new: CameraModel, points: Sequence[Metres2]) -> list[Metres2] | None:
    """Where floor points of one calibration lie in another, by the picture; None when one of them is not on the floor."""
    try:
        seen = project(old, [(x, y, 0.0) for x, y in points])
        found = to_plane(new, seen, 0.0)
    except GeometryError:
        return None
    if not np.isfinite(found).all():
        return None
    return [(float(x), float(y)) for x, y in found[:, :2]]


def _through_picture(old: Calibration, new: Calibration) -> Similarity:
    there = transferred(old.camera, new.camera, old.floor)
    if there is None or area(old.floor) <= 0 or area(there) <= 0:
        return Similarity()
    factor = math.sqrt(area(there) / area(old.floor))
    factor = 1.0 if abs(factor - 1.0) < 1e-3 else factor
    mean_old, mean_new = np.mean(np.array(old.floor), axis=0), np.mean(np.array(there), axis=0)
    shift = mean_new - factor * mean_old
    return Similarity(factor, (float(shift[0]), float(shift[1])))


def _common_factor(old: Sequence[Metres2], new: Sequence[Metres2]) -> float | None:
    """The factor that makes one outline the other, None when there is none."""
    if len(old) != len(new):
        return None
    a, b = np.array(old), np.array(new)
    factor = float(np.linalg.norm(np.ptp(b, axis=0)) / max(1e-9, float(np.linalg.norm(np.ptp(a, axis=0)))))
    if np.abs(a * factor - b).max() > CLOSE * np.abs(b).max():
        return None
    return 1.0 if abs(factor - 1.0) <= CLOSE else factor


def _same_camera(a: CameraModel, b: CameraModel) -> bool:
    return _alike(a.model_dump(), b.model_dump())


def _alike(a: object, b: object) -> bool:
    """Whether two trees of plain data are equal but for the rounding of numbers."""
    if isinstance(a, float) and isinstance(b, int | float):
        return abs(a - b) <= CLOSE * max(1.0, abs(a), abs(b))
    if isinstance(a, dict) and isinstance(b, dict):
        return a.keys() == b.keys() and all(_alike(a[key], b[key]) for key in a)
    if isinstance(a, list | tuple) and isinstance(b, list | tuple):
        return len(a) == len(b) and all(_alike(x, y) for x, y in zip(a, b, strict=True))
    return a == b
