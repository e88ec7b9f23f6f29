# SPDX-License-Identifier: GPL-3.0-or-later
"""Fit the camera, and the floor in metres, to the room's corners as the picture shows them.

What the picture cannot tell is assumed, softly, and said in a finding. Seen straight down, focal length, camera
height and wall height cannot be told apart: the given or assumed wall height settles it. Without wall tops the view
is taken for orthographic unless the caller knows better; then an ordinary lens is assumed, and right angles are the
only cue for tilt. See docs/geometry.md.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import Literal

import numpy as np

from ..artifacts.analysis import Finding
from ..artifacts.camera import CameraModel
from ..artifacts.common import ImagePoint, Metres2
from .camera import GeometryError, Kind, Projector, camera_from_projector
from .fit_problem import TILT_X, TILT_Y, Problem
from .fit_sighting import ASSUMED_HEIGHT, CORNER_NOISE, Sighting, note, warning
from .fit_solve import kinds_to_try, solve_kind, turned_similarity
from .polygon import Floats, bounding_rectangle, signed_area

HeightSource = Literal["given", "measured", "assumed"]


@dataclass(frozen=True)
class CameraFit:
    """A fitted camera and the floor that belongs to it.

    Attributes:
        floor: metric corners, counter-clockwise, origin at the bounding rectangle's centre.
        order: for each corner of `floor`, its index in the polygon that was given.
        height: wall height in metres; height_source: "measured" only where the picture's tilt told it.
        error_px: root mean square reprojection error of floor corners and wall tops, pixels.
        squared: whether walls within about a degree of the axes were put exactly on them.
    """

    camera: CameraModel
    floor: list[Metres2]
    order: list[int]
    height: float
    height_source: HeightSource
    error_px: float
    squared: bool
    findings: list[Finding] = field(default_factory=list)


def fit_camera(
    image_size: tuple[int, int],
    floor_polygon: Sequence[ImagePoint],
    floor_size: float | Sequence[float] | Sequence[Sequence[float]],
    wall_top_polygon: Sequence[ImagePoint] | None = None,
    height: float | None = None,
    kind: Kind | None = None,
    principal: ImagePoint | None = None,
    expected: CameraModel | None = None,
) -> CameraFit:
    """Fit with whatever is known of the floor.

    Args:
        floor_size: the width of the floor's bounding rectangle, or its (width, depth), or all corners in metres in
            the order of `floor_polygon`. Corners that contradict the picture are used for their size only.

        expected: a camera that was found before: lens and tilt are assumed to be about the same.

    Other arguments, result and errors as in `fit_from_known_length`.
    """
    if isinstance(floor_size, int | float):
        return fit_from_known_length(
            image_size, floor_polygon, floor_size, None, wall_top_polygon, height, kind, principal, expected
        )
    values = np.asarray(floor_size, dtype=float)
    if values.ndim == 1 and len(values) in (1, 2, 3):
        depth = float(values[1]) if len(values) > 1 else None
        return fit_from_known_length(
            image_size, floor_polygon, float(values[0]), depth, wall_top_polygon, height, kind, principal, expected
        )
    if values.ndim != 2 or values.shape[1] != 2:
        raise GeometryError("The floor's size must be a width, a width and a depth, or its corners in metres.")
    problem: str
    try:
        fit = fit_from_known_floor(image_size, floor_polygon, values, wall_top_polygon, height, kind, principal)
        if fit.error_px <= 4 * CORNER_NOISE * max(image_size):
            return fit
        problem = f"The floor in metres does not fit the picture (corners are off by {fit.error_px:.0f} pixels)"
    except GeometryError as error:
        problem = error.message.rstrip(".")
    low_x, low_y, high_x, high_y = bounding_rectangle(values)
    fit = fit_from_known_length(
        image_size, floor_polygon, high_x - low_x, high_y - low_y, wall_top_polygon, height, kind, principal
    )
    fit.findings.append(warning("floor", f"{problem}; its shape was taken from the picture and its size was kept."))
    return fit


def fit_from_known_floor(
    image_size: tuple[int, int],
    floor_polygon: Sequence[ImagePoint],
    floor: Sequence[Sequence[float]] | Floats,
    wall_top_polygon: Sequence[ImagePoint] | None = None,
    height: float | None = None,
    kind: Kind | None = None,
    principal: ImagePoint | None = None,
) -> CameraFit:
    """Fit the camera to a floor whose corners are known in metres, in the same order as `floor_polygon`.

    Raises:
        GeometryError: as `fit_from_known_length`, or the two outlines have different numbers of corners.
    """
    setup = Sighting.of(image_size, floor_polygon, wall_top_polygon, height, kind, principal)
    metric = np.asarray(floor, dtype=float).reshape(-1, 2)
    if len(metric) != len(floor_polygon):
        raise GeometryError("The floor in metres and its outline in the picture have different numbers of corners.")
    if not np.isfinite(metric).all():
        raise GeometryError("A corner of the floor in metres is not a number.")
    metric = _same_order(setup, metric[setup.corners.order])
    low_x, low_y, high_x, high_y = bounding_rectangle(metric)
    metric = metric - ((low_x + high_x) / 2, (low_y + high_y) / 2)
    return _fit(setup, metric, None, None)


def fit_from_known_length(
    image_size: tuple[int, int],
    floor_polygon: Sequence[ImagePoint],
    width: float,
    depth: float | None = None,
    wall_top_polygon: Sequence[ImagePoint] | None = None,
    height: float | None = None,
    kind: Kind | None = None,
    principal: ImagePoint | None = None,
    expected: CameraModel | None = None,
) -> CameraFit:
    """Fit the camera and the floor's shape from one known length (or two).

    Args:
        image_size: width and height in pixels.
        floor_polygon: the floor's corners in the picture, 0-1000, one after another.
        width, depth: extent of the floor's bounding rectangle in metres, x and y.
        wall_top_polygon: the inner upper edges of the same wall corners, in the same order, where they are visible.
        height: wall height in metres when known; otherwise about 2.7 m is assumed.
        kind: the kind of camera when known; None decides by how much larger the wall tops are than the floor.
        principal: where the optical axis meets the picture, 0-1000; None is the centre.
        expected: a camera that was found before, see `fit_camera`.

    Raises:
        GeometryError: corners that no room can have (fewer than three, on a line, not finite), or no positive size.
    """
    for value in (width, depth):
        if value is not None and not (math.isfinite(value) and 0.1 <= value <= 1000):
            raise GeometryError(
                "The known length must lie between 0.1 and 1000 metres.", "Give the room's width in metres."
            )
    setup = Sighting.of(image_size, floor_polygon, wall_top_polygon, height, kind, principal, expected)
    return _fit(setup, None, float(width), None if depth is None else float(depth))


def _same_order(setup: Sighting, metric: Floats) -> Floats:
    """The metric corners as given, or turned round or reversed when only that lies as the picture does."""
    orders = [np.roll(way, -k, axis=0) for way in (metric, metric[::-1]) for k in range(len(metric))]
    misfits = [turned_similarity(setup, order)[2] for order in orders]
    best = int(np.argmin(misfits))
    extent = float(np.linalg.norm(np.ptp(setup.floor, axis=0)))
    if misfits[0] > 0.1 * extent and misfits[best] < 0.5 * misfits[0]:
        setup.findings.append(warning("floor", "The floor in metres was listed in another order than in the picture."))
        return orders[best]
    return metric


def _fit(setup: Sighting, known: Floats | None, width: float | None, depth: float | None) -> CameraFit:
    solved = [solve_kind(setup, kind, known, width, depth) for kind in kinds_to_try(setup)]
    problem, x = min(solved, key=lambda s: s[0].error_px(s[1]))
    if len(solved) == 2:
        # Too close to call by scale: the simpler camera unless the pinhole explains the corners clearly better.
        flat, deep = solved
        clear = deep[0].error_px(deep[1]) < 0.7 * flat[0].error_px(flat[1])
        problem, x = deep if clear else flat
    return finished(setup, problem, x)


def finished(setup: Sighting, problem: Problem, x: Floats) -> CameraFit:
    """Move the origin to the bounding rectangle's centre, make the known length exact, and report."""
    lens, corners, height = problem.lens(x), problem.corners(x), problem.height(x)
    linked = len(set(problem.link_x)) < len(corners) or len(set(problem.link_y)) < len(corners)
    if problem.known is None and setup.tops is None and not linked:
        corners = lens.on_plane(setup.floor, 0.0)[:, :2]  # nothing else measures the corners: take them as seen
    low_x, low_y, high_x, high_y = bounding_rectangle(corners)
    centre = np.array(((low_x + high_x) / 2, (low_y + high_y) / 2, 0.0))
    factor = 1.0
    if problem.known is None:
        assumed = problem.assumed
        ratios = [
            want / have
            for want, have in ((assumed.width, high_x - low_x), (assumed.depth, high_y - low_y))
            if want is not None
        ]
        if assumed.area is not None:
            ratios = [math.sqrt(assumed.area / ((high_x - low_x) * (high_y - low_y)))]
        factor = math.exp(float(np.mean(np.log(ratios))))
        if max(ratios) / min(ratios) > 1.08:
            setup.findings.append(
                warning("floor", "The known width and depth do not agree with the floor's shape in the picture.")
            )
    else:
        centre[:] = 0.0
    lens = replace(
        lens,
        position=(lens.position - centre) * factor,
        scale=lens.scale if lens.perspective else lens.scale / factor,
    )
    corners = (corners - centre[:2]) * factor
    height *= factor
    _check(setup, problem, x, corners, lens)
    floor = [(float(px), float(py)) for px, py in corners]
    error = _error_px(setup, lens, corners, height)
    source = _height_source(setup, problem, x)
    return CameraFit(
        camera_from_projector(lens), floor, setup.corners.order, height, source, error, linked, setup.findings
    )


def _error_px(setup: Sighting, lens: Projector, corners: Floats, height: float) -> float:
    level = np.concatenate([corners, np.zeros((len(corners), 1))], axis=1)
    errors = [lens.pixels(level) - setup.floor]
    if setup.tops is not None:
        level[:, 2] = height
        errors.append((lens.pixels(level) - setup.tops)[np.isfinite(setup.tops[:, 0])])
    return float(np.sqrt(np.mean(np.sum(np.concatenate(errors) ** 2, axis=1))))


def _height_source(setup: Sighting, problem: Problem, x: Floats) -> HeightSource:
    if setup.height_given:
        return "given"
    tilt = float(np.hypot(x[TILT_X], x[TILT_Y]))
    if setup.tops is not None and problem.perspective and tilt > 5 and problem.sigma < setup.noise / 3:
        return "measured"
    setup.findings.append(
        note("height", f"The height of the walls is not known; about {ASSUMED_HEIGHT} m was assumed.")
    )
    return "assumed"


def _check(setup: Sighting, problem: Problem, x: Floats, corners: Floats, lens: Projector) -> None:
    """Refuse a camera that cannot be, doubt one that is unlikely."""
    numbers = (*corners.ravel(), *lens.position, lens.scale)
    if not np.isfinite((*numbers, problem.error_px(x))).all() or signed_area(corners) <= 0:
        raise GeometryError("No camera fits these corners.", "Check the floor's corners and the wall tops.")
    tilt = float(np.hypot(x[TILT_X], x[TILT_Y]))
    if tilt > 25:
        setup.findings.append(
            warning("camera", f"The camera looks {tilt:.0f} degrees off straight down; footprints are less exact.")
        )
    if problem.error_px(x) > 4 * setup.noise:
        setup.findings.append(
            warning("camera", f"The corners fit this camera only to {problem.error_px(x):.0f} pixels; check them.")
        )
