# SPDX-License-Identifier: GPL-3.0-or-later
"""The artist's corrections applied to what stage 1 found. Pure: nothing is asked, the same input gives the same result.

The order is: corners, then scale, then the height of the walls, then the objects. Where nothing is said, what was
found comes back as it is, number for number.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from functools import lru_cache

from ..artifacts.analysis import Calibration, Finding, SceneAnalysis
from ..artifacts.corrections import Corrections, Found, KnownLength
from ..errors import RoomError
from ..geometry.camera import GeometryError
from ..geometry.fit import fit_from_known_floor
from ..geometry.measuring import floor_distance
from .correct_objects import corrected_objects
from .recorner import recornered
from .rescale import Similarity, rescaled_analysis, rescaled_calibration
from .residuals import residual

DIFFERENT = 0.02
"""Two known sizes that differ by more than this part are reported."""
SHORTEST, LONGEST = 0.01, 200.0
"""Metres that a known length may be."""


@dataclass(frozen=True)
class Known:
    """Sizes that the artist measured: width of the floor's bounding rectangle and height of the walls, metres."""

    width: float | None = None
    height: float | None = None


@dataclass(frozen=True)
class Corrected:
    """The analysis and the calibration after the corrections, and what there is to say of them."""

    analysis: SceneAnalysis
    calibration: Calibration
    findings: list[Finding] = field(default_factory=list)


def correct_found(found: Found, corrections: Corrections, known: Known | None = None) -> Corrected:
    """What stage 1 found, with the artist's corrections and known sizes.

    A known length wins over a known width. Both multiply everything; the height of the walls, when it is known, changes
    the walls and the camera that sees them, and leaves the floor and all objects.

    Raises:
        RoomError: no room has these corners, or the known length does not lie on the floor.
    """
    measures = Corrections(floor_polygon=corrections.floor_polygon, known_length=corrections.known_length)
    analysis, calibration, notes = found.analysis, found.calibration, tuple[Finding, ...]()
    if known not in (None, Known()) or measures != Corrections():
        analysis, calibration, notes = _measured(found.model_dump_json(), measures.model_dump_json(), known or Known())
    findings = list(notes)
    if corrections.objects or corrections.added:
        analysis = corrected_objects(analysis, calibration, corrections, findings)
    if analysis.objects != found.analysis.objects or calibration.camera != found.calibration.camera:
        residuals = [r for o in analysis.objects if (r := residual(o, calibration.camera)) is not None]
        calibration = calibration.model_copy(update={"residuals": residuals})
    if findings:
        analysis = analysis.model_copy(update={"findings": [*analysis.findings, *findings]})
    return Corrected(analysis, calibration, findings)


@lru_cache(maxsize=4)
def _measured(
    found_text: str, measures_text: str, known: Known
) -> tuple[SceneAnalysis, Calibration, tuple[Finding, ...]]:
    """Corners, scale and height applied to what was found, given as JSON.

    Fitting a camera takes tenths of a second, and a note or a box that is corrected does not change the fit: the last
    few results are kept. They are never changed.
    """
    found, measures = Found.model_validate_json(found_text), Corrections.model_validate_json(measures_text)
    findings: list[Finding] = []
    analysis, calibration = found.analysis, found.calibration
    polygon, length = measures.floor_polygon, measures.known_length
    if polygon is not None and polygon != analysis.floor_polygon:
        analysis, calibration = recornered(found, polygon)
    analysis, calibration = _scaled(analysis, calibration, length, known, findings)
    if known.height is not None:
        analysis, calibration = _with_height(analysis, calibration, known.height)
        if length is not None:
            # Another height is another camera, through which the length may come out a hair's breadth different.
            analysis, calibration = _exact_length(analysis, calibration, length, known.height)
    return analysis, calibration, tuple(findings)


def measured(calibration: Calibration, length: KnownLength) -> float:
    """Metres between the length's two points on the floor, as the calibration has them.

    Raises:
        GeometryError: a point does not lie on the floor, or both are the same.
    """
    (ax, ay), (bx, by) = ((p.x, p.y) for p in (length.start, length.end))
    found = floor_distance(calibration.camera, (ax, ay), (bx, by))
    if found is None:
        raise GeometryError("A point of the known length does not lie on the floor.", "Click two points on the floor.")
    if found < 1e-3 or math.hypot(ax - bx, ay - by) < 1.0:
        raise GeometryError("The two points of the known length are too close together.", "Click them farther apart.")
    return found


def _scaled(
    analysis: SceneAnalysis,
    calibration: Calibration,
    length: KnownLength | None,
    known: Known,
    findings: list[Finding],
) -> tuple[SceneAnalysis, Calibration]:
    """Both with the scale that is known."""
    factor, source = 1.0, ""
    if known.width is not None:
        factor, source = known.width / analysis.room_size[0], "known width"
    if length is not None:
        if not SHORTEST <= length.metres <= LONGEST:
            raise RoomError(
                f"A known length of {length.metres:g} m is not possible.",
                f"Give metres between {SHORTEST:g} and {LONGEST:g}.",
            )
        by_length = length.metres / measured(calibration, length)
        if source and abs(math.log(factor / by_length)) > DIFFERENT:
            apart = abs(factor / by_length - 1.0)
            message = f"The known width and the known length differ by {apart:.0%}; the known length is used."
            findings.append(Finding(about="room", message=message, severity="warning"))
        factor, source = by_length, "known length"
    if not source:
        return analysis, calibration
    width = analysis.room_size[0] * factor
    if not 0.3 <= width <= 500.0:
        raise RoomError(f"By this length the room would be {width:.3g} m wide.", "Check the metres and the two points.")
    change = Similarity(factor)
    given = {"scale_source": source, "scale_spread": 0.0}
    return rescaled_analysis(analysis, change), rescaled_calibration(calibration, change).model_copy(update=given)


def _with_height(analysis: SceneAnalysis, calibration: Calibration, height: float) -> tuple[SceneAnalysis, Calibration]:
    """Both with walls of another height: the floor stays, the camera is the one that sees such walls there."""
    if abs(height - calibration.height) < 1e-9:
        return analysis, calibration
    update: dict[str, object] = {"height": height}
    tops = analysis.wall_top_polygon
    if tops and calibration.camera.kind == "perspective":
        fit = fit_from_known_floor(
            analysis.image_size, analysis.floor_polygon, calibration.floor, tops, height, "perspective",
            calibration.camera.principal,
        )  # fmt: skip
        update |= {"camera": fit.camera, "error_px": fit.error_px}
    size = (analysis.room_size[0], analysis.room_size[1], height)
    return analysis.model_copy(update={"room_size": size}), calibration.model_copy(update=update)


def _exact_length(
    analysis: SceneAnalysis, calibration: Calibration, length: KnownLength, height: float
) -> tuple[SceneAnalysis, Calibration]:
    """Both with the known length exact again; the walls keep their height."""
    for again in range(4):
        factor = length.metres / measured(calibration, length)
        if factor == 1.0:
            break
        change = Similarity(factor)
        analysis, calibration = rescaled_analysis(analysis, change), rescaled_calibration(calibration, change)
        if again < 3 and abs(factor - 1.0) > 1e-6:
            analysis, calibration = _with_height(analysis, calibration, height)
        else:
            size = (analysis.room_size[0], analysis.room_size[1], height)
            analysis = analysis.model_copy(update={"room_size": size})
            calibration = calibration.model_copy(update={"height": height})
            break
    return analysis, calibration
