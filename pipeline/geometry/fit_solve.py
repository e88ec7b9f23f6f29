# SPDX-License-Identifier: GPL-3.0-or-later
"""How a camera fit is solved: which kinds are tried, from which starts, and how far assumptions are trusted."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from .camera import Kind, Projector
from .corners import main_direction, similarity
from .fit_links import square_links
from .fit_problem import (
    AIM_X,
    AIM_Y,
    CAMERA_UNKNOWNS,
    DISTANCE,
    HEIGHT,
    ORTHO_DISTANCE,
    ROLL,
    SCALE,
    SHIFT,
    TILT_X,
    TILT_Y,
    Assumptions,
    Problem,
)
from .fit_sighting import Sighting, note, warning
from .polygon import Floats

ASSUMED_HEIGHT_SPREAD = 0.08
GIVEN_HEIGHT_SPREAD = 0.01
ASSUMED_FOCAL = 1.4  # of the picture's longer side: about 39 degrees, an ordinary lens
FLAT, DEEP = 1.01, 1.05  # wall tops larger than the floor by less: orthographic; by more: perspective
SQUARE_DEGREES = 1.5
EXPECTED_TILT_SPREAD, EXPECTED_FOCAL_SPREAD = 3.0, 0.1
"""Degrees, and relative: how far a camera may differ from the one that is expected."""
MAX_ROLL = 15.0  # a room that seems turned further has slanted walls instead
SQUARE_SHARE = 0.6  # part of the outline along the axes from which a room counts as right-angled


def turned_similarity(setup: Sighting, metric: Floats) -> tuple[float, float, float]:
    """Pixels for a metre, camera roll in degrees and misfit in pixels of the best similarity metres -> picture."""
    seen = setup.floor[:, 0] - 1j * setup.floor[:, 1]
    flat = metric[:, 0] + 1j * metric[:, 1]
    seen, flat = seen - seen.mean(), flat - flat.mean()
    factor = complex(np.vdot(flat, seen) / max(1e-12, float(np.vdot(flat, flat).real)))
    roll = -math.degrees(math.atan2(factor.imag, factor.real))
    misfit = float(np.sqrt(np.mean(np.abs(seen - factor * flat) ** 2)))
    # A wrong order can fit a square room turned by 90 degrees; rooms lie upright in their picture.
    return abs(factor), roll, misfit if abs(roll) < 45 else misfit + 10 * float(setup.size.max())


def kinds_to_try(setup: Sighting) -> list[Kind]:
    """The kinds of camera worth trying, simplest first."""
    if setup.tops is None:
        if setup.kind is None:
            setup.findings.append(note("camera", "No wall tops are visible; the view was taken for orthographic."))
        return [setup.kind or "orthographic"]
    scale = similarity(setup.floor, setup.tops)[0]
    if setup.kind == "orthographic" and scale > DEEP:
        setup.findings.append(
            warning("camera", "The wall tops are larger than the floor: the view is a perspective one.")
        )
        return ["perspective"]
    if setup.kind == "perspective" and scale < FLAT:
        setup.findings.append(
            warning("camera", "The wall tops are no larger than the floor: the view was taken for orthographic.")
        )
        return ["orthographic"]
    if setup.kind is not None:
        return [setup.kind]
    if scale < FLAT:
        return ["orthographic"]
    return ["perspective"] if scale > DEEP else ["orthographic", "perspective"]


def solve_kind(
    setup: Sighting, kind: Kind, known: Floats | None, width: float | None, depth: float | None
) -> tuple[Problem, Floats]:
    problem = _first_problem(setup, kind, known, width, depth)
    x = _best_start(setup, problem)
    if known is None and not right_angled(setup, problem, x):
        # Nothing says which way such a room is turned: the picture's axes are the room's, and right angles are no cue.
        x[ROLL] = 0.0
        problem = replace(
            problem, assumed=replace(problem.assumed, square=math.inf), frozen=problem.frozen | {ROLL, *_tilt(setup)}
        )
        x = _best_start(setup, problem)
        return simplified(setup, *with_measured_noise(problem, x))
    problem, x = with_measured_noise(problem, x)
    if known is None:
        problem, x = squared(setup, problem, x)
    return simplified(setup, problem, x)


def _tilt(setup: Sighting) -> set[int]:
    """Tilt is left out where nothing shows it."""
    return {TILT_X, TILT_Y} if setup.tops is None else set()


def _best_start(setup: Sighting, problem: Problem) -> Floats:
    """Best solution from all starts: a few steps from each, the rest from the most promising."""
    starts = [problem.start(camera) for camera in start_cameras(setup, problem)]
    if len(starts) > 1:
        starts = [min((problem.solve(start, 12, 1e-2) for start in starts), key=lambda s: s[1])[0]]
    return problem.solve(starts[0])[0]


def right_angled(setup: Sighting, problem: Problem, x: Floats) -> bool:
    share = square_links(problem.corners(x), setup.floor, 2 * SQUARE_DEGREES, 1.5 * setup.noise)[2]
    return share >= SQUARE_SHARE and abs(float(x[ROLL])) <= MAX_ROLL


def _first_problem(
    setup: Sighting, kind: Kind, known: Floats | None, width: float | None, depth: float | None
) -> Problem:
    perspective, bare = kind == "perspective", setup.tops is None
    assumed = Assumptions(
        height=setup.height,
        height_spread=GIVEN_HEIGHT_SPREAD if setup.height_given else ASSUMED_HEIGHT_SPREAD,
        focal=ASSUMED_FOCAL * float(setup.size.max()),
        focal_spread=0.35 if bare else 0.7,
        tilt=4.0 if bare and known is None else 12.0,
        width=width,
        depth=depth,
        size_spread=0.002 if depth is None else 0.03,
    )
    if setup.expected is not None and perspective == setup.expected.perspective:
        assumed = replace(assumed, towards=_tilt_of(setup.expected), tilt=EXPECTED_TILT_SPREAD)
        if perspective:
            assumed = replace(assumed, focal=setup.expected.scale, focal_spread=EXPECTED_FOCAL_SPREAD)
    frozen: set[int] = set(SHIFT)
    if bare:
        frozen.add(HEIGHT)
        if not perspective:
            frozen |= {TILT_X, TILT_Y}  # foreshortening would not tell which way it is tilted
    link = tuple(range(len(setup.floor)))
    return Problem(
        perspective, setup.floor, setup.tops, setup.size, setup.principal, assumed, known, link, link, setup.noise,
        frozenset(frozen),
    )  # fmt: skip


def _tilt_of(lens: Projector) -> tuple[float, float]:
    """(tilt_x, tilt_y) in degrees, as `tilt_rotation` takes them, of a camera that looks down."""
    x, y, z = -lens.rotation[:, 2]
    angle, across = math.degrees(math.acos(max(-1.0, min(1.0, -z)))), math.hypot(x, y)
    return (0.0, 0.0) if across < 1e-9 else (angle * y / across, angle * x / across)


def start_cameras(setup: Sighting, problem: Problem) -> list[Floats]:
    """Start values of the camera unknowns: straight down, and tilted as far as the wall tops say."""
    camera = np.zeros(CAMERA_UNKNOWNS)
    camera[[TILT_X, TILT_Y]] = problem.assumed.towards
    camera[HEIGHT] = math.log(setup.height)
    if problem.known is not None:
        scale, roll, _ = turned_similarity(setup, problem.known)
        camera[ROLL] = roll if abs(roll) < 45 else 0.0
    else:
        upright = setup.floor * (1.0, -1.0)
        direction, agreement = main_direction(upright)
        camera[ROLL] = -direction if agreement > 0.7 and ROLL not in problem.frozen else 0.0
        scale = _seen_scale(upright, -float(camera[ROLL]), problem.assumed)
    camera[SCALE] = math.log(scale)
    camera[DISTANCE] = math.log(problem.assumed.focal / scale if problem.perspective else ORTHO_DISTANCE)
    if setup.tops is None:
        return [aimed(problem, camera)]
    tops_scale, shift, _ = similarity(setup.floor, setup.tops)
    tilted = camera.copy()
    if problem.perspective:
        nearer = max(0.005, 1 - 1 / tops_scale)
        camera[DISTANCE] = tilted[DISTANCE] = math.log(setup.height / nearer)
        # Upright lines meet where the camera's own foot point shows (the nadir): the fixed point of floor -> tops.
        off = (shift / (1 - tops_scale) - setup.principal) / (scale * math.exp(camera[DISTANCE]))
    else:
        off = -(np.nanmean(setup.tops - setup.floor, axis=0)) / (scale * setup.height)
    limit = math.tan(math.radians(30))
    off = off * min(1.0, limit / max(1e-9, float(np.hypot(*off))))
    angle = np.degrees(np.arctan(off))
    tilted[TILT_X], tilted[TILT_Y] = angle[1], -angle[0]
    half = tilted.copy()
    half[[TILT_X, TILT_Y]] /= 2
    return [aimed(problem, start) for start in (camera, half, tilted)]


def _seen_scale(upright: Floats, degrees: float, assumed: Assumptions) -> float:
    """Pixels for a metre, for a room that appears turned by so many degrees, from its width or its area."""
    angle = math.radians(degrees)
    along = float(np.ptp(upright @ np.array((math.cos(angle), math.sin(angle)))))
    if assumed.area is None:
        return along / (assumed.width or 1.0)
    across = float(np.ptp(upright @ np.array((-math.sin(angle), math.cos(angle)))))
    return math.sqrt(along * across / assumed.area)


def aimed(problem: Problem, camera: Floats) -> Floats:
    """Shift the camera over the floor so that the corners' mean comes to lie where it belongs."""
    ground = problem.lens(camera).on_plane(problem.floor, 0.0)[:, :2]
    wanted = np.zeros(2) if problem.known is None else problem.known.mean(axis=0)
    moved = camera.copy()
    moved[[AIM_X, AIM_Y]] += wanted - np.nan_to_num(np.nanmean(ground, axis=0))
    return moved


def spread(problem: Problem, x: Floats) -> float:
    """Standard deviation of a measured coordinate, from the misfit and the degrees of freedom; nan without any."""
    free = problem.freedom(x)
    return math.sqrt(float((problem.pixel_errors(x) ** 2).sum()) / free) if free > 0 else math.nan


def with_measured_noise(problem: Problem, x: Floats) -> tuple[Problem, Floats]:
    """Solve again with the noise that the misfit shows, so that exact corners are not bent by assumptions."""
    if problem.freedom(x) <= 0:
        return problem, x
    start = problem.sigma
    exact = replace(problem, sigma=0.01 * start)
    found = exact.solve(x, 30, 1e-3)[0]
    if spread(exact, found) < 0.05 * start:
        return exact, exact.solve(found, 80, 1e-9)[0]
    for _ in range(3):
        measured = min(1.5 * start, spread(problem, x))
        if 0.7 * problem.sigma < measured < 1.2 * problem.sigma:
            break
        problem = replace(problem, sigma=measured)
        x = problem.solve(x, 30)[0]
    return problem, x


def squared(setup: Sighting, problem: Problem, x: Floats) -> tuple[Problem, Floats]:
    """Put walls that nearly run along an axis exactly on it, where the corners' noise allows that."""
    link_x, link_y, share = square_links(problem.corners(x), setup.floor, SQUARE_DEGREES, 1.5 * setup.noise)
    if share < SQUARE_SHARE or max(link_x) < 1 or max(link_y) < 1:
        return problem, x
    strict, start = replace(problem, sigma=setup.noise).relinked(x, link_x, link_y)
    strict, found = with_measured_noise(strict, strict.solve(start)[0])
    free, bound = spread(problem, x), spread(strict, found)
    # The noise may look three times as large with the walls made straight: with few corners it is known no better.
    limit = 1.5 * setup.noise if math.isnan(free) else min(2 * setup.noise, max(3 * free, 0.1 * setup.noise))
    if math.isnan(bound):
        bound = strict.error_px(found)
    return (strict, found) if bound <= limit else (problem, x)


def simplified(setup: Sighting, problem: Problem, x: Floats) -> tuple[Problem, Floats]:
    """No roll, and no tilt, where the corners fit as well without."""
    for unknowns, small in (((ROLL,), 1.0), ((TILT_X, TILT_Y), 1.5)):
        values = x[list(unknowns)]
        if not values.any() or float(np.hypot.reduce(values)) > small:
            continue
        start = x.copy()
        start[list(unknowns)] = 0.0
        plain = replace(problem, frozen=problem.frozen | set(unknowns))
        found = plain.solve(start)[0]
        before, after = problem.error_px(x), plain.error_px(found)
        if after <= 1.15 * before + 0.02 * setup.noise:
            problem, x = plain, found
    return problem, x
