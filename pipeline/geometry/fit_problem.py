# SPDX-License-Identifier: GPL-3.0-or-later
"""The camera fit as a least-squares problem: unknowns, what the picture shows, and what is assumed.

The unknowns are chosen to be nearly independent: pixels for a metre at the floor point that the camera aims at, the
distance to that point, tilt, roll, that point, the wall height, how far the optical axis is off the given principal
point (a part of the picture's longer side), and the corners' metric coordinates.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from .camera import NEAR, Projector, tilt_rotation
from .fit_evidence import Evidence
from .fit_links import mean_by
from .least_squares import levenberg_marquardt
from .polygon import Floats

SCALE, DISTANCE, TILT_X, TILT_Y, ROLL, AIM_X, AIM_Y, HEIGHT, SHIFT_X, SHIFT_Y = range(10)
CAMERA_UNKNOWNS = 10
SHIFT = frozenset((SHIFT_X, SHIFT_Y))
STEPS = np.array((0.05, 0.05, 3.0, 3.0, 2.0, 0.2, 0.2, 0.05, 0.02, 0.02))
ORTHO_DISTANCE = 10.0
ROBUST_FROM = 4.0  # corners off by more than this many standard deviations pull less


@dataclass(frozen=True)
class Assumptions:
    """Standard deviations of what is assumed; each pulls, none is a rule.

    Attributes:
        height, focal: expected wall height in metres and focal length in pixels, with the spread of their logarithms.
        tilt, roll: degrees; the tilt is around `towards` (tilt_x, tilt_y).
        shift: of the optical axis from the principal point, a part of the picture's longer side.
        square: degrees by which a wall may leave the two main directions before it counts as slanted.
        width, depth: known extent of the floor's bounding rectangle in metres, or None, with the log's spread.
        area: of that rectangle, instead of both. aspect: width / depth as someone stated it, with the log's spread.
    """

    height: float
    height_spread: float
    focal: float
    focal_spread: float
    tilt: float
    roll: float = 10.0
    square: float = 1.0
    width: float | None = None
    depth: float | None = None
    size_spread: float = 0.002
    area: float | None = None
    aspect: float | None = None
    aspect_spread: float = 0.08
    towards: tuple[float, float] = (0.0, 0.0)
    shift: float = 0.12


@dataclass(frozen=True)
class Problem:
    """One fit.

    Attributes:
        floor, tops: (N, 2) pixels, y down; tops with nan rows where unknown, or None.
        known: (N, 2) metric corners when they are given; then only the camera and the height are unknown.
        link_x, link_y: for each corner, which x and which y coordinate it uses; walls along an axis share one.
        sigma: pixels by which corners are expected to be off.
        frozen: camera unknowns that keep their start value.
        evidence: objects that tell of the camera too, or None.
    """

    perspective: bool
    floor: Floats
    tops: Floats | None
    size: Floats
    principal: Floats
    assumed: Assumptions
    known: Floats | None
    link_x: tuple[int, ...]
    link_y: tuple[int, ...]
    sigma: float
    frozen: frozenset[int] = SHIFT
    evidence: Evidence | None = None

    def lens(self, x: Floats) -> Projector:
        """The camera that the unknowns describe."""
        rotation = tilt_rotation(float(x[TILT_X]), float(x[TILT_Y]), float(x[ROLL]))
        scale, distance = math.exp(min(20.0, x[SCALE])), math.exp(min(12.0, x[DISTANCE]))
        position = np.array((x[AIM_X], x[AIM_Y], 0.0)) + distance * rotation[:, 2]
        focal = scale * distance if self.perspective else scale
        principal = self.principal + x[[SHIFT_X, SHIFT_Y]] * float(self.size.max())
        return Projector(self.perspective, rotation, position, focal, principal, self.size)

    def corners(self, x: Floats) -> Floats:
        """Metric corners (N, 2)."""
        corners: Floats = self._corners(x[None])[0]
        return corners

    def _corners(self, many: Floats) -> Floats:
        if self.known is not None:
            return np.broadcast_to(self.known, (len(many), *self.known.shape))
        count = max(self.link_x) + 1
        shared = many[:, CAMERA_UNKNOWNS:]
        return np.stack([shared[:, list(self.link_x)], shared[:, count:][:, list(self.link_y)]], axis=2)

    def height(self, x: Floats) -> float:
        """Wall height in metres."""
        return math.exp(min(5.0, float(x[HEIGHT])))

    def pixel_errors(self, x: Floats) -> Floats:
        """Reprojection errors in pixels, (M, 2), floor first, wall tops that are known after."""
        errors: Floats = self._pixel_errors(x[None], _View.of(self, x[None]))[0]
        return errors

    def evidence_errors(self, x: Floats) -> Floats | None:
        """How far the objects' boxes are from where their metres put them, pixels (K, 4)."""
        return None if self.evidence is None else self._evidence_errors(x[None], _View.of(self, x[None]))[0]

    def _pixel_errors(self, many: Floats, view: _View) -> Floats:
        """As `pixel_errors` for many vectors of unknowns at once, (B, M, 2)."""
        corners = self._corners(many)
        errors = [view.pixels(corners, np.zeros((1, 1))) - self.floor]
        if self.tops is not None:
            level = np.exp(np.minimum(5.0, many[:, HEIGHT]))[:, None]
            valid = np.isfinite(self.tops[:, 0])
            errors.append(view.pixels(corners[:, valid], level) - self.tops[valid])
        return np.concatenate(errors, axis=1)

    def _evidence_errors(self, many: Floats, view: _View) -> Floats:
        assert self.evidence is not None
        return self.evidence.errors(view.pixels(*self.evidence.points_in(self._corners(many))))

    def error_px(self, x: Floats) -> float:
        """Root mean square distance between corners as given and as seen by the camera, pixels."""
        return float(np.sqrt(np.mean(np.sum(self.pixel_errors(x) ** 2, axis=1))))

    def residuals(self, many: Floats) -> Floats:
        """All residuals in units of their standard deviations, for vectors of unknowns (B, n): (B, m)."""
        view = _View.of(self, many)
        relative = self._pixel_errors(many, view).reshape(len(many), -1) / self.sigma / ROBUST_FROM
        # Pseudo-Huber: quadratic for small errors, linear for large ones.
        seen = np.sign(relative) * ROBUST_FROM * np.sqrt(2 * (np.sqrt(1 + relative**2) - 1))
        parts = [seen, self._camera_priors(many), self._floor_priors(many)]
        if self.evidence is not None:
            parts.append(self.evidence.residuals(self._evidence_errors(many, view)))
        return np.concatenate(parts, axis=1)

    def cost(self, x: Floats) -> float:
        """Half the sum of squared residuals."""
        values = self.residuals(x[None])[0]
        total = float(values @ values) / 2
        return total if math.isfinite(total) else math.inf

    def _camera_priors(self, many: Floats) -> Floats:
        assumed = self.assumed
        priors = [
            (many[:, HEIGHT] - math.log(assumed.height)) / assumed.height_spread,
            (many[:, TILT_X] - assumed.towards[0]) / assumed.tilt,
            (many[:, TILT_Y] - assumed.towards[1]) / assumed.tilt,
            many[:, ROLL] / assumed.roll,
            many[:, SHIFT_X] / assumed.shift,
            many[:, SHIFT_Y] / assumed.shift,
        ]
        if self.perspective:
            focal = many[:, SCALE] + many[:, DISTANCE]
            priors.append((focal - math.log(assumed.focal)) / assumed.focal_spread)
        return np.stack(priors, axis=1)

    def _floor_priors(self, many: Floats) -> Floats:
        if self.known is not None:
            return np.zeros((len(many), 0))
        corners, assumed = self._corners(many), self.assumed
        step = np.concatenate([corners[:, 1:], corners[:, :1]], axis=1) - corners
        # sin(2 angle) / 2: the angle to the nearer axis, smooth up to 45 degrees.
        leaning = step[:, :, 0] * step[:, :, 1] / np.maximum(1e-12, (step**2).sum(axis=2))
        leaning = np.degrees(leaning) / assumed.square
        slant = np.sign(leaning) * np.sqrt(np.log1p(leaning**2))  # Cauchy: a slanted wall costs a bounded amount
        middle = corners.sum(axis=1) / corners.shape[1]  # the floor may lie anywhere: keep it where the start put it
        extent = np.log(np.maximum(1e-6, corners.max(axis=1) - corners.min(axis=1)))
        sizes = [
            (extent[:, axis : axis + 1] - math.log(want)) / assumed.size_spread
            for axis, want in enumerate((assumed.width, assumed.depth))
            if want is not None
        ]
        if assumed.area is not None:
            sizes.append((extent.sum(axis=1, keepdims=True) - math.log(assumed.area)) / assumed.size_spread)
        if assumed.aspect is not None:
            said = (extent[:, :1] - extent[:, 1:] - math.log(assumed.aspect)) / assumed.aspect_spread
            sizes.append(np.sign(said) * np.sqrt(np.log1p(said**2)))
        return np.concatenate([slant, middle, *sizes], axis=1)

    def active(self, x: Floats) -> Floats:
        """Which unknowns are solved for, as a mask."""
        mask = np.ones(len(x), dtype=bool)
        mask[list(self.frozen)] = False
        if not self.perspective:
            mask[DISTANCE] = False
        return mask.astype(float)

    def freedom(self, x: Floats) -> int:
        """Measured coordinates less unknowns that they have to decide; above 0 the misfit tells the noise."""
        unknowns = int(self.active(x).sum()) - (0 if self.known is not None else 3)
        if self.tops is None:
            unknowns -= int(HEIGHT not in self.frozen)
        return 2 * len(self.pixel_errors(x)) - unknowns

    def solve(self, start: Floats, iterations: int = 80, tolerance: float = 1e-6) -> tuple[Floats, float]:
        """Best unknowns and their cost, from a start vector."""
        mask = self.active(start) > 0
        steps = np.concatenate([STEPS, np.full(len(start) - CAMERA_UNKNOWNS, 0.05)])

        def many(values: Floats) -> Floats:
            full = np.repeat(start[None], len(values), axis=0)
            full[:, mask] = values
            return self.residuals(full)

        def one(values: Floats) -> Floats:
            row: Floats = many(values[None])[0]
            return row

        solution = levenberg_marquardt(one, start[mask], steps[mask], iterations, tolerance, many)
        result = start.copy()
        result[mask] = solution.x
        return result, solution.cost

    def start(self, camera: Floats) -> Floats:
        """Full start vector: corners are seen through the start camera onto the floor."""
        if self.known is not None:
            return camera.copy()
        ground = self.lens(camera).on_plane(self.floor, 0.0)[:, :2]
        ground = np.nan_to_num(ground)
        return np.concatenate([camera, mean_by(ground[:, 0], self.link_x), mean_by(ground[:, 1], self.link_y)])

    def relinked(self, x: Floats, link_x: tuple[int, ...], link_y: tuple[int, ...]) -> tuple[Problem, Floats]:
        """The same problem with other shared coordinates, and the unknowns carried over."""
        corners = self.corners(x)
        moved = np.concatenate([x[:CAMERA_UNKNOWNS], mean_by(corners[:, 0], link_x), mean_by(corners[:, 1], link_y)])
        return replace(self, link_x=link_x, link_y=link_y), moved


@dataclass(frozen=True)
class _View:
    """The cameras of many vectors of unknowns in bulk: the same as `Problem.lens`, one after the other."""

    perspective: bool
    rotation: Floats
    position: Floats
    focal: Floats
    principal: Floats

    @staticmethod
    def of(problem: Problem, many: Floats) -> _View:
        rotation = _rotations(many)
        distance = np.exp(np.minimum(12.0, many[:, DISTANCE]))
        focal = np.exp(np.minimum(20.0, many[:, SCALE])) * (distance if problem.perspective else 1.0)
        position = distance[:, None] * rotation[:, :, 2]
        position[:, :2] += many[:, [AIM_X, AIM_Y]]
        principal = problem.principal + many[:, [SHIFT_X, SHIFT_Y]] * float(problem.size.max())
        return _View(problem.perspective, rotation, position, focal, principal)

    def pixels(self, across: Floats, up: Floats) -> Floats:
        """Pixels (B, N, 2) of points (B, N, 2) on the floor plane and (B, N) or (B, 1) above it; nan behind."""
        flat = across - self.position[:, None, :2]
        level = (up - self.position[:, 2:])[:, :, None]
        local = flat @ self.rotation[:, :2, :] + level * self.rotation[:, 2:3, :]
        seen = local[:, :, :2] * (1.0, -1.0) * self.focal[:, None, None]
        if self.perspective:
            with np.errstate(divide="ignore", invalid="ignore"):
                depth = -local[:, :, 2:]
                seen = np.where(depth > NEAR, seen / depth, np.nan)
        result: Floats = self.principal[:, None] + seen
        return result


def _rotations(many: Floats) -> Floats:
    """`tilt_rotation` of many vectors of unknowns, (B, 3, 3)."""
    x, y = np.radians(many[:, TILT_X]), -np.radians(many[:, TILT_Y])
    angle = np.hypot(x, y)
    safe = np.where(angle > 1e-9, angle, 1.0)
    sin, cos = np.sinc(angle / np.pi), np.cos(angle)  # sin(angle) / angle
    versed = np.where(angle > 1e-9, (1 - cos) / safe**2, 0.5)
    rolled = np.radians(many[:, ROLL])
    right, up = np.cos(rolled), np.sin(rolled)
    columns = (
        (cos + versed * x * x, versed * x * y, -y * sin),
        (versed * x * y, cos + versed * y * y, x * sin),
        (y * sin, -x * sin, cos),
    )
    first, second, third = (np.stack(column, axis=1) for column in columns)
    turned = (right[:, None] * first + up[:, None] * second, right[:, None] * second - up[:, None] * first, third)
    return np.stack(turned, axis=2)
