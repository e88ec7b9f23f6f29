# SPDX-License-Identifier: GPL-3.0-or-later
"""How turned things stand, read from the picture's own edges.

A model says that an armchair is turned by about 45 degrees; the edges in its box say by how much. The outline and the
seams of furniture run along its sides, so the directions of all brightness edges around it, each weighed by its strength
and taken in the directions of the floor, pile up at its own yaw (modulo a quarter turn).
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from ..artifacts.analysis import Calibration, DetectedObject, Finding, SceneAnalysis
from ..artifacts.camera import CameraModel
from ..geometry.camera import GeometryError, project
from .covered import lowest_of

Floats = npt.NDArray[np.float64]
Pixels = npt.NDArray[np.uint8]

REACH = 25
"""Degrees by which what the model said may be corrected."""
LEAST_TURN = 10.0
"""Turned by fewer degrees than this against the walls: said to stand straight, and left so."""
WALLS = 5.0
"""Degrees from the walls' directions that floorboards, tiles and shadows of walls take up."""
BLUR = 2.0
CLEAR, ALONE, APART = 1.8, 1.3, 9
"""A peak counts when it is so much higher than the mean, and than everything so many degrees away from it."""
STRONG = 0.3
"""Edges weaker than this part of the strongest ones do not count."""
LEAST_PIXELS, MOST_PIXELS = 24, 240
"""Sides of the part that is looked at; larger ones are thinned out."""
WORTH = 1.5
"""Degrees less than which are not corrected."""


def refined_yaws(analysis: SceneAnalysis, calibration: Calibration, pixels: Pixels) -> SceneAnalysis:
    """The analysis with the yaw of turned things on the floor as the picture's edges have it, where they are clear.

    Args:
        pixels: the picture, (height, width, 3).
    """
    objects, findings = [], list(analysis.findings)
    for item in analysis.objects:
        yaw = seen_yaw(item, calibration.camera, pixels) if _worth_reading(item) else None
        if yaw is None or abs(yaw - item.yaw) < WORTH:
            objects.append(item)
            continue
        message = f"Its edges in the picture say that it is turned by {yaw % 360:.0f} degrees, not {item.yaw:.0f}."
        findings.append(Finding(about=item.id, message=message))
        objects.append(item.model_copy(update={"yaw": yaw % 360.0}))
    return analysis.model_copy(update={"objects": objects, "findings": findings})


def _worth_reading(item: DetectedObject) -> bool:
    turned = abs((item.yaw + 45.0) % 90.0 - 45.0)
    return item.placement == "floor" and item.shape != "round" and item.box is not None and turned >= LEAST_TURN


def seen_yaw(item: DetectedObject, camera: CameraModel, pixels: Pixels) -> float | None:
    """The yaw near the stated one that the edges in the picture point to, degrees; None when they are not clear."""
    if item.box is None:
        return None
    try:
        inverse = np.linalg.inv(_floor_to_pixels(item, camera, pixels))
    except (GeometryError, np.linalg.LinAlgError):
        return None
    directions = _directions(item, pixels, inverse)
    if directions is None:
        return None
    height = np.convolve(np.tile(directions, 3), _bell(), mode="same")[90:180]
    peak = _peak(height, round(item.yaw) % 90)
    return None if peak is None else item.yaw + (peak - item.yaw + 45.0) % 90.0 - 45.0


def _floor_to_pixels(item: DetectedObject, camera: CameraModel, pixels: Pixels) -> Floats:
    """How a step on the level of the thing's middle shows in pixels, right and down: a (2, 2) matrix."""
    x, y = item.centre[:2]
    z = lowest_of(item) + item.size[2] / 2
    seen = project(camera, [(x, y, z), (x + 0.05, y, z), (x, y + 0.05, z)])
    seen = seen * np.array((pixels.shape[1], pixels.shape[0])) / 1000.0
    if not np.isfinite(seen).all():
        raise GeometryError("it lies behind the camera")
    matrix: Floats = (seen[1:] - seen[0]).T / 0.05
    return matrix


def _directions(item: DetectedObject, pixels: Pixels, inverse: Floats) -> Floats | None:
    """Strength of the edges by their direction on the floor, one bin a degree, 0..90."""
    assert item.box is not None
    rows, columns = pixels.shape[:2]
    left, right = (int(v * columns / 1000) for v in (item.box.x_min, item.box.x_max))
    top, bottom = (int(v * rows / 1000) for v in (item.box.y_min, item.box.y_max))
    left, top, right, bottom = max(0, left - 3), max(0, top - 3), min(columns, right + 3), min(rows, bottom + 3)
    if min(right - left, bottom - top) < LEAST_PIXELS:
        return None
    step = max(1, round(max(right - left, bottom - top) / MOST_PIXELS))
    grey = pixels[top:bottom, left:right].astype(np.float64).mean(axis=2)
    grey = _smaller(grey, step)
    down, across = np.gradient(_smooth(_smooth(grey)))
    strength = np.hypot(across, down)
    # Far outside of the thing, in the corners of its box, are floor and neighbours.
    v, u = np.meshgrid(*(np.linspace(-1.0, 1.0, n) for n in grey.shape), indexing="ij")
    strength *= np.hypot(u, v) < 1.15
    # The strong edges only: fabric and grain have directions of their own.
    strength = np.where(strength > STRONG * np.quantile(strength, 0.99), strength, 0.0)
    along = np.stack([-down.ravel(), across.ravel()])
    floor = inverse @ along
    angle = np.degrees(np.arctan2(floor[1], floor[0])) % 90.0
    weight = np.sqrt(strength.ravel())
    straight = np.minimum(angle, 90.0 - angle) < WALLS
    weight = np.where(straight, 0.0, weight)
    result: Floats = np.bincount(np.minimum(angle.astype(int), 89), weights=weight, minlength=90).astype(np.float64)
    return result if result.sum() > 0 else None


def _smaller(grey: Floats, step: int) -> Floats:
    rows, columns = grey.shape[0] // step * step, grey.shape[1] // step * step
    blocks: Floats = grey[:rows, :columns].reshape(rows // step, step, columns // step, step).mean(axis=(1, 3))
    return blocks


def _smooth(grey: Floats) -> Floats:
    padded = np.pad(grey, 1, mode="edge")
    rows = (padded[:-2] + 2 * padded[1:-1] + padded[2:]) / 4
    result: Floats = (rows[:, :-2] + 2 * rows[:, 1:-1] + rows[:, 2:]) / 4
    return result


def _bell() -> Floats:
    offsets = np.arange(-8, 9)
    bell = np.exp(-((offsets / BLUR) ** 2) / 2)
    result: Floats = bell / bell.sum()
    return result


def _peak(height: Floats, said: int) -> float | None:
    """Where the highest peak near the stated direction is, degrees modulo 90; None when it does not stand out."""
    near = [(said + offset) % 90 for offset in range(-REACH, REACH + 1)]
    best = max(near, key=lambda degree: height[degree])
    if best in (near[0], near[-1]):
        return None
    others = [height[k] for k in range(90) if min((k - best) % 90, (best - k) % 90) > APART]
    if height[best] < CLEAR * height.mean() or height[best] < ALONE * max(others):
        return None
    before, here, after = (height[(best + k) % 90] for k in (-1, 0, 1))
    bend = before - 2 * here + after
    shift = 0.0 if bend >= 0 else 0.5 * (before - after) / bend
    # A bin holds the directions from its number to the next one.
    return float((best + 0.5 + max(-0.5, min(0.5, shift))) % 90.0)
