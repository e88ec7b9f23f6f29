# SPDX-License-Identifier: GPL-3.0-or-later
"""Metres and boxes fused: two measurements of one thing become one placement.

The model's metres and its picture box are both measurements of centre, width, depth and height. What is wrong with all
of one of them alike is taken out first (`Trust`, learnt from the picture at hand). The most probable box is then the one
that moves least from the metres and, projected through the fitted camera, least from the picture box, each counted in its
own uncertainty. The height is uncertain too, so that the edges which a tall thing's top decides weigh less than those of
its foot. Gross disagreements are weighted down, not averaged. (Paper, stage 3; DESIGN.md "What was measured".)
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from ..artifacts.analysis import DetectedObject, Finding
from ..artifacts.camera import CameraModel
from ..artifacts.common import ImageBox, Metres3
from ..artifacts.trust import Trust
from ..geometry.camera import GeometryError, project
from ..geometry.footprint import image_box_of
from ..geometry.least_squares import levenberg_marquardt
from ..geometry.shortfall import edges_of, projected_edges, thousandths

Floats = npt.NDArray[np.float64]

USUAL = Trust()
LOOSE = 4.0
"""How much the metres of a thing count less when they were guessed from a box that proved wrong."""
ALONE = 8.0
"""How much the metres count less where placements are to be made from boxes alone."""
DOUBT = 4.0
CONTRADICTION = 10.0
"""Disagreements (in combined uncertainties) that are reported, and beyond which only one of the two is used."""
LEAST_EDGE = 6.0
"""Differences of edges that are never a contradiction, in thousandths of the picture's longer side."""
BETTER_BOXES = 0.5
"""Boxes are believed against contradicting metres when their errors are usually by so much smaller."""
SQUARE_YAW = 3.0
"""Turned by less than this many degrees from the walls' directions counts as not turned."""

METRES, BOX = "metres were", "box was"
"""Which of two that contradict each other is believed."""

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


def fuse(
    item: DetectedObject, camera: CameraModel, room_side: float, base_z: float, trust: Trust = USUAL
) -> tuple[Fused, list[Finding]]:
    """One object's placement from its metres and its box.

    Args:
        item: metres in the frame of the fitted floor.
        room_side: the room's longer side in metres.
        base_z: height of what it stands on.
        trust: how good the picture's boxes and metres are.
    """
    yaw = straighten(item.yaw)
    width, depth, height = item.size
    centre = (item.centre[0], item.centre[1], base_z + height / 2)
    if item.box is None or trust.evidence == "metres":
        return Fused(centre, item.size, yaw, None, 0.0), []
    findings: list[Finding] = []
    if _swapped_fits_better(item, camera, centre, yaw):
        width, depth = depth, width
        findings.append(Finding(about=item.id, message="Width and depth were exchanged; the picture shows it so."))
    try:
        problem = _Problem(item, camera, (width, depth, height), room_side, base_z, yaw, trust)
        solution, apart = problem.solve()
    except GeometryError as error:
        findings.append(Finding(about=item.id, message=f"Its box was not used: {error.message}"))
        return Fused(centre, (width, depth, height), yaw, None, 0.0), findings
    if apart > CONTRADICTION:
        # One of the two speaks of another thing.
        message = f"Its metres and its picture box contradict each other; the {problem.believed} kept."
        findings.append(Finding(about=item.id, message=message, severity="warning"))
        if problem.believed == METRES:
            return Fused(problem.said, problem.said_size, yaw, 0.0, apart), findings
    elif apart > DOUBT:
        message = "Its metres and its picture box disagree strongly; the place is a compromise."
        findings.append(Finding(about=item.id, message=message, severity="warning"))
    size = (float(math.exp(solution[2])), float(math.exp(solution[3])), float(math.exp(solution[4])))
    placed = (float(solution[0]), float(solution[1]), base_z + size[2] / 2)
    iou = image_box_of(camera, placed, size, yaw, item.shape).iou(item.box)
    return Fused(placed, size, yaw, iou, apart), findings


def disagreement(item: DetectedObject, camera: CameraModel, room_side: float, base_z: float, trust: Trust) -> float:
    """How far an object's metres and its box are apart, in their combined uncertainties (about 1 is usual).

    Raises:
        GeometryError: its metres lie outside the camera's view.
    """
    if item.box is None:
        return 0.0
    problem = _Problem(item, camera, item.size, room_side, base_z, straighten(item.yaw), trust)
    return problem.disagreement()


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
    """The least-squares problem of one object; unknowns are x, y, log width, log depth, log height.

    `believed` says, after solving, which measurement holds where the two contradict each other.
    """

    def __init__(
        self,
        item: DetectedObject,
        camera: CameraModel,
        size: Metres3,
        room_side: float,
        base_z: float,
        yaw: float,
        trust: Trust,
    ) -> None:
        assert item.box is not None
        self.camera, self.base_z, self.yaw, self.shape = camera, base_z, yaw, item.shape
        longer = max(camera.image_size)
        unit = np.array((longer / camera.image_size[0], longer / camera.image_size[1]) * 2)
        # What the artist drew is not wrong in the way that the model's boxes are.
        drawn = item.source == "artist"
        self.target = edges_of(item.box) if drawn else _true_box(item.box, camera, trust, unit)
        self.prior = _true_metres(item, size, room_side, yaw, trust)
        loose = LOOSE if item.source == "corrected box" else 1.0
        loose *= ALONE if trust.evidence == "boxes" else 1.0
        centre_sigma, size_sigma = trust.centre_sigma * room_side * loose, trust.size_sigma * loose
        self.prior_sigma = np.array((centre_sigma, centre_sigma, size_sigma, size_sigma, trust.height_sigma))
        self.least_edge = LEAST_EDGE * unit
        self.box_sigma = trust.box_sigma * unit * np.array(trust.edges.get(item.id, (1.0, 1.0, 1.0, 1.0)))
        self.weights = np.ones(9)
        # What sticks out of the picture box may be hidden, or a corner that no armchair fills; what the box shows is there.
        short = projected_edges(camera, self.said, self.said_size, yaw, item.shape).short
        self.outside_sigma = np.hypot(self.box_sigma, short / thousandths(camera))
        self.believed = METRES

    @property
    def said_size(self) -> Metres3:
        """Width, depth and height as the metres alone have them."""
        return float(math.exp(self.prior[2])), float(math.exp(self.prior[3])), float(math.exp(self.prior[4]))

    @property
    def said(self) -> Metres3:
        """The centre as the metres alone have it."""
        return float(self.prior[0]), float(self.prior[1]), self.base_z + self.said_size[2] / 2

    def edges(self, x: Floats) -> Floats:
        """The projection's edges less the box's, 0-1000."""
        size = np.exp(np.clip(x[2:], -7.0, 5.0))
        centre = (float(x[0]), float(x[1]), self.base_z + float(size[2]) / 2)
        box = image_box_of(self.camera, centre, (float(size[0]), float(size[1]), float(size[2])), self.yaw, self.shape)
        return edges_of(box) - self.target

    def residuals(self, x: Floats) -> Floats:
        """Four edges, then five priors, each in its uncertainty."""
        try:
            edges = self.edges(x)
        except GeometryError:
            return np.full(9, np.nan)
        edges /= np.where(edges * _OUTWARD > 0, self.outside_sigma, self.box_sigma)
        result: Floats = np.concatenate([edges, (x - self.prior) / self.prior_sigma]) * self.weights
        return result

    def solve(self) -> tuple[Floats, float]:
        """The most probable unknowns, and how far the two measurements were apart."""
        x = self.prior.copy()
        if not np.isfinite(self.residuals(x)).all():
            raise GeometryError("its metres lie outside the camera's view")
        apart = self.disagreement()
        if apart > CONTRADICTION and self.believed == BOX:
            self.prior_sigma[:4] *= ALONE
        for _ in range(3):
            x = levenberg_marquardt(self.residuals, x, np.full(5, 0.1), iterations=20, tolerance=1e-9).x
            raw = np.abs(self.residuals(x) / self.weights)
            self.weights = 1.0 / np.sqrt(np.maximum(1.0, raw / 2.0))
        return x, apart

    def disagreement(self) -> float:
        """Root mean square of the edges' differences in the uncertainty that both measurements give them together."""
        start = self.edges(self.prior)
        steps = self.prior_sigma / 10.0
        moved = np.stack([self.edges(self.prior + step) for step in np.diag(steps)])
        by_metres = np.sum(np.square((moved - start) * 10.0), axis=0)
        self.believed = BOX if _mean(self.outside_sigma) < BETTER_BOXES * math.sqrt(_mean(by_metres)) else METRES
        sigma = np.sqrt(by_metres + np.square(self.outside_sigma) + np.square(self.least_edge))
        return float(np.sqrt(np.mean(np.square(start / sigma))))


def _mean(values: Floats) -> float:
    return float(np.mean(values))


def _true_box(box: ImageBox, camera: CameraModel, trust: Trust, unit: Floats) -> Floats:
    """The box without what is wrong with all boxes of this picture."""
    edges = edges_of(box)
    if trust.box_shift == trust.box_stretch == (0.0, 0.0) and not trust.box_inset:
        return edges
    middle = np.tile(project(camera, [(0.0, 0.0, 0.0)])[0], 2)
    shift, stretch = np.array(trust.box_shift * 2) * unit, np.array(trust.box_stretch * 2)
    low = edges - shift + _OUTWARD * trust.box_inset * unit
    result: Floats = middle + (low - middle) / (1.0 + stretch)
    return result if (result[2:] > result[:2] + 0.5).all() else edges


def _true_metres(item: DetectedObject, size: Metres3, room_side: float, yaw: float, trust: Trust) -> Floats:
    """Centre and logarithms of the sizes, without what is wrong with all metres of this picture."""
    x, y = (
        (item.centre[i] - trust.metres_shift[i] * room_side) / (1.0 + trust.metres_stretch[i]) for i in (0, 1)
    )  # fmt: skip
    cos2, sin2 = math.cos(math.radians(yaw)) ** 2, math.sin(math.radians(yaw)) ** 2
    across, up = trust.metres_size
    too_large = (across * cos2 + up * sin2, across * sin2 + up * cos2, 0.0)
    return np.array((x, y, *(math.log(v) - k for v, k in zip(size, too_large, strict=True))))
