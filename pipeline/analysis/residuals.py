# SPDX-License-Identifier: GPL-3.0-or-later
"""How well each object's metres and its picture box agree through the fitted camera, and which disagree."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from ..artifacts.analysis import DetectedObject, ObjectResidual
from ..artifacts.camera import CameraModel
from ..geometry.camera import GeometryError
from ..geometry.footprint import image_box_of
from ..geometry.polygon import Floats

FAR = 3.5
"""Robust standard deviations by which an object has to be off, beyond what is usual in its picture."""
LEAST_SHIFT, LEAST_LOSS = 8.0, 0.12
"""Off by less (units of 0-1000 of the centre; intersection over union) is never called a disagreement."""


def residual(item: DetectedObject, camera: CameraModel) -> ObjectResidual | None:
    """How well an object's metres cover its box in the picture; None without a box or behind the camera."""
    if item.box is None:
        return None
    try:
        seen = image_box_of(camera, item.centre, item.size, item.yaw, item.shape)
    except GeometryError:
        return None
    shift = (seen.centre[0] - item.box.centre[0], seen.centre[1] - item.box.centre[1])
    return ObjectResidual(id=item.id, iou=seen.iou(item.box), shift=shift)


def outliers(residuals: Sequence[ObjectResidual]) -> list[str]:
    """Ids of the objects whose two measurements disagree far more than is usual in this picture, the worst first.

    Judged by how far the centre is off from where most are off (so a shift that all share is none of any one), and by
    the intersection over union; each against the median absolute deviation. A picture in which all agree has none.
    """
    if len(residuals) < 2:
        return [r.id for r in residuals if r.iou < 0.2]
    shifts = np.array([r.shift for r in residuals])
    off = np.linalg.norm(shifts - np.median(shifts, axis=0), axis=1)
    loss = np.array([1.0 - r.iou for r in residuals])
    by_shift, by_loss = _deviations(off, LEAST_SHIFT), _deviations(loss, LEAST_LOSS)
    worst = np.maximum(by_shift, by_loss)
    order = sorted(range(len(residuals)), key=lambda k: -worst[k])
    return [residuals[k].id for k in order if worst[k] > FAR]


def _deviations(values: Floats, least: float) -> Floats:
    """How many robust standard deviations each value is above the median; 0 where it is above by less than `least`."""
    above = values - np.median(values)
    unit = max(1.4826 * float(np.median(np.abs(above))), least / FAR)
    result: Floats = np.where(above > least, above / unit, 0.0)
    return result


def agreement(objects: Sequence[DetectedObject], camera: CameraModel) -> float:
    """Sum of the intersections over union of all objects."""
    return math.fsum(r.iou for o in objects if (r := residual(o, camera)) is not None)
