# SPDX-License-Identifier: GPL-3.0-or-later
"""Metres and boxes fused: two measurements of one thing become one placement.

The model's metres and its picture box are both measurements of centre, width, depth and height. The most probable box is
the one that moves least from the metres and, projected through the fitted camera, least from the picture box, each
counted in its own uncertainty. The height is uncertain too, so that the edges which a tall thing's top decides weigh less
than those of its foot. Gross disagreements are weighted down, not averaged. (Paper, stage 3; DESIGN.md "What was measured".)
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from ..artifacts.analysis import DetectedObject, Finding
from ..artifacts.camera import CameraModel
from ..artifacts.common import ImageBox, Metres3
from ..geometry.camera import GeometryError
from ..geometry.footprint import image_box_of
from ..geometry.least_squares import levenberg_marquardt

Floats = npt.NDArray[np.float64]

BOX_SIGMA = 6.0
"""Usual error of a picture box's edge, in 0-1000 of the picture's longer side."""
CENTRE_SIGMA = 0.008
"""Usual error of a centre in metres, as a part of the room's longer side."""
SIZE_SIGMA = 0.08
HEIGHT_SIGMA = 0.2
"""Usual relative errors of width and depth, and of height."""
LOOSE = 4.0
"""How much the metres of a thing count less when they were guessed from a box that proved wrong."""
HIDDEN = 0.5
"""How much an edge that reaches beyond the picture box counts, beside one that stays inside it."""
TURNED = 0.8
"""How much less it counts still for a thing turned by 45 degrees."""
DOUBT = 4.0
CONTRADICTION = 10.0
"""Disagreements (in combined uncertainties) that are reported, and beyond which the box is not used."""
SQUARE_YAW = 8.0
"""Turned by less than this many degrees from the walls' directions counts as not turned."""

_OUTWARD = np.array((-1.0, -1.0, 1.0, 1.0))


@dataclass(frozen=True)
class Fused:
    """A placement after fusing.

    Attributes:
        iou: of the picture box with the projection of the result; None without a box.
        disagreement: how far metres and box were apart, in their combined uncertainties (about 1 is usual).
    """

    centre: Metres3
    size: Metres3
    yaw: float
    iou: float | None
    disagreement: float


def straighten(yaw: float) -> float:
    """Yaw in 0..360, moved to the nearest quarter turn when it is nearly there."""
    quarter = round(yaw / 90.0) * 90.0
    return (quarter if abs(yaw - quarter) < SQUARE_YAW else yaw) % 360.0


def fuse(item: DetectedObject, camera: CameraModel, room_side: float, base_z: float) -> tuple[Fused, list[Finding]]:
    """One object's placement from its metres and its box.

    Args:
        item: metres in the frame of the fitted floor.
        room_side: the room's longer side in metres.
        base_z: height of what it stands on.
    """
    yaw = straighten(item.yaw)
    width, depth, height = item.size
    centre = (item.centre[0], item.centre[1], base_z + height / 2)
    if item.box is None:
        return Fused(centre, item.size, yaw, None, 0.0), []
    findings: list[Finding] = []
    if _swapped_fits_better(item, camera, centre, yaw):
        width, depth = depth, width
        findings.append(Finding(about=item.id, message="Width and depth were exchanged; the picture shows it so."))
    problem = _Problem(item, camera, (width, depth, height), room_side, base_z, yaw)
    try:
        solution, disagreement = problem.solve()
    except GeometryError as error:
        findings.append(Finding(about=item.id, message=f"Its box was not used: {error.message}"))
        return Fused(centre, (width, depth, height), yaw, None, 0.0), findings
    size = (float(math.exp(solution[2])), float(math.exp(solution[3])), float(math.exp(solution[4])))
    placed = (float(solution[0]), float(solution[1]), base_z + size[2] / 2)
    iou = image_box_of(camera, placed, size, yaw, item.shape).iou(item.box)
    if disagreement > CONTRADICTION:
        # One of the two speaks of another thing. The direct answer is the floor below which nothing may fall.
        message = "Its metres and its picture box contradict each other; the metres were kept."
        findings.append(Finding(about=item.id, message=message, severity="warning"))
        return Fused(centre, (width, depth, height), yaw, 0.0, disagreement), findings
    if disagreement > DOUBT:
        message = "Its metres and its picture box disagree strongly; the place is a compromise."
        findings.append(Finding(about=item.id, message=message, severity="warning"))
    return Fused(placed, size, yaw, iou, disagreement), findings


def _swapped_fits_better(item: DetectedObject, camera: CameraModel, centre: Metres3, yaw: float) -> bool:
    """Whether exchanging width and depth brings the projection's proportions much nearer to the box's."""
    width, depth, height = item.size
    if item.box is None or max(width, depth) < 1.25 * min(width, depth):
        return False
    try:
        straight = _centred_iou(image_box_of(camera, centre, (width, depth, height), yaw, item.shape), item.box)
        swapped = _centred_iou(image_box_of(camera, centre, (depth, width, height), yaw, item.shape), item.box)
    except GeometryError:
        return False
    return swapped > straight + 0.15


def _centred_iou(a: ImageBox, b: ImageBox) -> float:
    """IoU of two boxes laid centre on centre: compares sizes only."""
    shared = min(a.x_max - a.x_min, b.x_max - b.x_min) * min(a.y_max - a.y_min, b.y_max - b.y_min)
    return shared / (a.area + b.area - shared)


class _Problem:
    """The least-squares problem of one object; unknowns are x, y, log width, log depth, log height."""

    def __init__(
        self, item: DetectedObject, camera: CameraModel, size: Metres3, room_side: float, base_z: float, yaw: float
    ) -> None:
        assert item.box is not None
        self.camera, self.base_z, self.yaw, self.shape = camera, base_z, yaw, item.shape
        self.target = np.array((item.box.x_min, item.box.y_min, item.box.x_max, item.box.y_max))
        longer = max(camera.image_size)
        unit = np.array((longer / camera.image_size[0], longer / camera.image_size[1]) * 2)
        loose = LOOSE if item.source == "corrected box" else 1.0
        centre_sigma = CENTRE_SIGMA * room_side * loose
        self.prior = np.array((item.centre[0], item.centre[1], *(math.log(v) for v in size)))
        self.prior_sigma = np.array((centre_sigma, centre_sigma, SIZE_SIGMA * loose, SIZE_SIGMA * loose, HEIGHT_SIGMA))
        self.box_sigma = BOX_SIGMA * unit
        self.weights = np.ones(9)
        # Armchairs and plants do not fill the corners that a turned rectangle would show in the picture.
        self.hidden = HIDDEN * (1.0 - TURNED * abs(math.sin(2 * math.radians(yaw))))

    def residuals(self, x: Floats) -> Floats:
        """Four edges, then five priors, each in its uncertainty."""
        try:
            size = np.exp(np.clip(x[2:], -7.0, 5.0))
            centre = (float(x[0]), float(x[1]), self.base_z + float(size[2]) / 2)
            box = image_box_of(
                self.camera, centre, (float(size[0]), float(size[1]), float(size[2])), self.yaw, self.shape
            )
        except GeometryError:
            return np.full(9, np.nan)
        edges = (np.array((box.x_min, box.y_min, box.x_max, box.y_max)) - self.target) / self.box_sigma
        # What sticks out of the picture box may be hidden behind a wall or under a blanket; what the box shows is there.
        edges = np.where(edges * _OUTWARD > 0, edges * self.hidden, edges)
        result: Floats = np.concatenate([edges, (x - self.prior) / self.prior_sigma]) * self.weights
        return result

    def solve(self) -> tuple[Floats, float]:
        """The most probable unknowns, and how far the two measurements were apart."""
        x = self.prior.copy()
        start = self.residuals(x)
        if not np.isfinite(start).all():
            raise GeometryError("its metres lie outside the camera's view")
        disagreement = float(np.sqrt(np.mean(np.square(start[:4]))) * BOX_SIGMA / math.hypot(BOX_SIGMA, 10.0))
        for _ in range(3):
            x = levenberg_marquardt(self.residuals, x, np.full(5, 0.1), iterations=20, tolerance=1e-9).x
            raw = np.abs(self.residuals(x) / self.weights)
            self.weights = 1.0 / np.sqrt(np.maximum(1.0, raw / 2.0))
        return x, disagreement
