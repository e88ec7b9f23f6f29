# SPDX-License-Identifier: GPL-3.0-or-later
"""Which camera took the picture: every kind that the data allow is fitted, and the best explanation is taken.

A candidate is judged by how far floor corners and wall tops are from where it puts them, by how far the objects' boxes
are from where it shows their metres, and by how unusual it is itself. Every unknown that it may bend costs, so that a
simpler camera wins unless another one explains clearly more; and so does contradicting the word for the view.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from ..artifacts.common import ImagePoint
from .camera import GeometryError, Kind
from .corners import similarity
from .fit import CameraFit, finished
from .fit_evidence import Evidence
from .fit_problem import HEIGHT, ROLL, SHIFT, SHIFT_X, SHIFT_Y, TILT_X, TILT_Y, Assumptions, Problem
from .fit_sighting import Sighting
from .fit_solve import (
    ASSUMED_FOCAL,
    aimed,
    right_angled,
    simplified,
    spread,
    squared,
    start_cameras,
    with_measured_noise,
)
from .polygon import Floats

UNKNOWN_COSTS = 2.0
"""What each unknown must explain, in half squared standard deviations (as in Akaike's and Bayes' criteria)."""
WORD_COSTS = 3.0
"""What contradicting the word for the view costs: about one such word in twenty is wrong."""
GIVEN_SPREAD, STATED_SPREAD = 0.002, 0.06
"""Of the walls' height when someone measured it, and when a model judged it (relative)."""
TILT_SPREAD = 15.0
START_TILTS = ((18.0, 8), (38.0, 4))
"""Degrees, and in how many directions: where a tilt is sought without wall tops."""
COMMON_SIGMA = (0.1, 3.0)
"""Least and largest error of a corner that candidates are judged with, in parts of the usual one."""
HOPELESS = 60.0
"""A camera that is behind by more at first sight is given up."""
CLOSE = 3.0
"""A runner-up that is behind by less is called close."""


@dataclass(frozen=True)
class Way:
    """A kind of camera: its name in plain words, and which unknowns it may bend."""

    name: str
    kind: Kind
    tilt: bool = False
    shift: bool = False

    @property
    def unknowns(self) -> int:
        """Beyond place, scale and roll, which every camera has."""
        return 2 * self.tilt + 2 * self.shift + (self.kind == "perspective")


WAYS = (
    Way("without perspective", "orthographic"),
    Way("without perspective, at an angle", "orthographic", tilt=True),
    Way("straight down", "perspective"),
    Way("straight down, off centre", "perspective", shift=True),
    Way("at an angle", "perspective", tilt=True),
)


@dataclass(frozen=True)
class Candidate:
    """A camera that was tried.

    Attributes:
        cost: what it leaves unexplained, and what it costs itself; lower is better, 1 is little.
        fit: camera and floor. objects_px: usual distance of a box's edge from where the metres put it, or None.
    """

    way: Way
    cost: float
    fit: CameraFit
    objects_px: float | None


def fit_best_camera(
    image_size: tuple[int, int],
    floor_polygon: Sequence[ImagePoint],
    room: tuple[float, float, float],
    wall_top_polygon: Sequence[ImagePoint] | None = None,
    evidence: Evidence | None = None,
    stated: Kind | None = None,
    height_given: bool = False,
) -> list[Candidate]:
    """All cameras that were tried, the best first. The floor keeps the stated area; its proportions are the picture's.

    Args:
        room: stated width, depth and wall height, metres.
        evidence: objects, their metres in the stated room.
        stated: the kind of view that someone named.
        height_given: the wall height was measured, so it is not judged by the picture.

    Raises:
        GeometryError: no room has these corners.
    """
    setup = Sighting.of(image_size, floor_polygon, wall_top_polygon, room[2], None, None)
    ways = [
        w for w in WAYS if not w.tilt or setup.tops is not None or (evidence is not None and w.kind == "perspective")
    ]
    first = [_first(setup, way, room, evidence, height_given) for way in ways]
    found = [(problem, _best(setup, way, problem)) for way, problem in zip(ways, first, strict=True)]
    # What is far behind already is not worth the time that an exact solution takes.
    limit = min(problem.cost(x) for problem, x in found) + HOPELESS
    kept = [(way, *s) for way, s in zip(ways, found, strict=True) if s[0].cost(s[1]) <= limit]
    solved = [(way, s) for way, problem, x in kept for s in _solved(setup, way, problem, x)]
    exact = _with_common_spread([s for _, s in solved])
    sigma = _common_sigma(setup, exact)
    tried = [(_cost(way, *s, sigma, stated), way, *s) for (way, _), s in zip(solved, exact, strict=True)]
    tried.sort(key=lambda t: t[0])
    # Of the two shapes that one kind of camera may see the floor in, the better.
    judged = [t for n, t in enumerate(tried) if t[1] not in [other[1] for other in tried[:n]]]
    return _candidates(setup, judged)


def _candidates(setup: Sighting, judged: list[tuple[float, Way, Problem, Floats]]) -> list[Candidate]:
    result: list[Candidate] = []
    for number, (cost, way, problem, x) in enumerate(judged):
        own = replace(setup, findings=list(setup.findings))
        try:
            result.append(_candidate(own, way, cost, *(simplified(own, problem, x) if number == 0 else (problem, x))))
        except GeometryError:
            if not result and number == len(judged) - 1:
                raise
    return result


def _candidate(setup: Sighting, way: Way, cost: float, problem: Problem, x: Floats) -> Candidate:
    errors = problem.evidence_errors(x)
    off = None if errors is None else float(np.median(np.abs(errors)))
    return Candidate(way, cost, finished(setup, problem, x), off)


def _first(
    setup: Sighting, way: Way, room: tuple[float, float, float], evidence: Evidence | None, height_given: bool
) -> Problem:
    bare = setup.tops is None
    assumed = Assumptions(
        height=setup.height,
        height_spread=GIVEN_SPREAD if height_given else STATED_SPREAD,
        focal=ASSUMED_FOCAL * float(setup.size.max()),
        focal_spread=0.35 if bare and evidence is None else 0.7,
        tilt=TILT_SPREAD,
        area=room[0] * room[1],
        aspect=room[0] / room[1] if way.tilt and way.kind == "perspective" else None,
    )
    frozen = set() if way.shift else set(SHIFT)
    frozen |= set() if way.tilt else {TILT_X, TILT_Y}
    frozen |= {HEIGHT} if bare else set()
    link = tuple(range(len(setup.floor)))
    return Problem(
        way.kind == "perspective", setup.floor, setup.tops, setup.size, setup.principal, assumed, None, link, link,
        setup.noise, frozenset(frozen), evidence,
    )  # fmt: skip


def _solved(setup: Sighting, way: Way, problem: Problem, x: Floats) -> list[tuple[Problem, Floats]]:
    """The floor with straight walls, and with whatever corners were seen where that may be meant as well."""
    straight = right_angled(setup, problem, x)
    result = [squared(setup, *with_measured_noise(problem, x))] if straight else []
    if not straight or (way.tilt and setup.tops is None):
        # Nothing says which way such a room is turned: the picture's axes are the room's, and right angles are no cue.
        free = replace(problem, assumed=replace(problem.assumed, square=math.inf), frozen=problem.frozen | {ROLL})
        start = _best(setup, way, free) if not straight else free.solve(_level(x))[0]
        result.append(with_measured_noise(free, start))
    return result


def _level(x: Floats) -> Floats:
    upright = x.copy()
    upright[ROLL] = 0.0
    return upright


def _best(setup: Sighting, way: Way, problem: Problem) -> Floats:
    """Best solution from all starts: a few steps from each, the rest from the two most promising."""
    tried = [problem.solve(problem.start(camera), 8, 2e-2) for camera in _starts(setup, way, problem)]
    tried = sorted(tried, key=lambda s: s[1])[:2]
    return min((problem.solve(x) for x, _ in tried), key=lambda s: s[1])[0]


def _starts(setup: Sighting, way: Way, problem: Problem) -> list[Floats]:
    cameras = start_cameras(setup, problem)
    for camera in cameras:
        camera[[k for k in (ROLL, TILT_X, TILT_Y) if k in problem.frozen]] = 0.0
    if way.tilt and setup.tops is None:
        for angle, directions in START_TILTS:
            for k in range(directions):
                turn = 2 * math.pi * k / directions
                camera = cameras[0].copy()
                camera[[TILT_X, TILT_Y]] = angle * math.cos(turn), angle * math.sin(turn)
                cameras.append(aimed(problem, camera))
    if way.shift and setup.tops is not None:
        # Upright lines meet where the camera's own foot point shows: straight down, that is the optical axis.
        scale, shift, _ = similarity(setup.floor, setup.tops)
        if scale > 1.01:
            off = (shift / (1 - scale) - setup.principal) / float(setup.size.max())
            camera = cameras[0].copy()
            camera[[SHIFT_X, SHIFT_Y]] = np.clip(off, -0.4, 0.4)
            cameras.append(aimed(problem, camera))
    return [cameras[0], *cameras[3:]] if not way.tilt else cameras


def _with_common_spread(solved: list[tuple[Problem, Floats]]) -> list[tuple[Problem, Floats]]:
    """Solved again, the objects' edges as exact as the camera under which they are most so shows them to be."""
    if solved[0][0].evidence is None:
        return solved
    found = []
    for problem, x in solved:
        assert problem.evidence is not None
        errors = problem.evidence_errors(x)
        assert errors is not None
        found.append(problem.evidence.with_spread(errors))
    best = min(found, key=lambda e: e.spread)
    again = [replace(problem, evidence=best) for problem, _ in solved]
    return [(problem, problem.solve(x, 40)[0]) for problem, (_, x) in zip(again, solved, strict=True)]


def _common_sigma(setup: Sighting, solved: list[tuple[Problem, Floats]]) -> float:
    """Pixels by which corners are off, as the camera that fits them best has it; the usual where nothing tells."""
    found = [s for problem, x in solved if not math.isnan(s := spread(problem, x))]
    least, most = (part * setup.noise for part in COMMON_SIGMA)
    return min(most, max(least, min(found))) if found else setup.noise


def _cost(way: Way, problem: Problem, x: Floats, sigma: float, stated: Kind | None) -> float:
    """What a candidate leaves unexplained when all are judged by the same exactness, with what it costs itself."""
    judged = replace(problem, sigma=sigma, assumed=replace(problem.assumed, square=1.0))
    free = replace(problem, sigma=sigma)
    best = min(judged.cost(x), judged.cost(free.solve(x, 20)[0]))
    word = WORD_COSTS if stated is not None and stated != way.kind else 0.0
    return best + UNKNOWN_COSTS * way.unknowns + word
