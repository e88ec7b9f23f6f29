# SPDX-License-Identifier: GPL-3.0-or-later
"""The camera and the scale: the analysis in the frame of the floor that was fitted to the picture. (Paper, stage 1.)"""

from __future__ import annotations

import math

from ..artifacts.analysis import Calibration, Finding, SceneAnalysis, TriedCamera
from ..artifacts.camera import CameraModel
from ..artifacts.common import ImagePoint
from ..errors import PictureError
from ..geometry.camera import Kind, camera_straight_down, project
from ..geometry.fit import CameraFit
from ..geometry.fit_candidates import CLOSE, Candidate, fit_best_camera
from ..geometry.fit_evidence import Evidence, Seen
from .anchors import find_anchors
from .into_frame import aligned, extent_of, turned_with_room, with_centred_metres
from .rescale import Similarity, rescaled_analysis, rescaled_calibration
from .residuals import residual
from .scale import MODEL_SPREAD, Scale, estimated_scale

ASPECT_LIMIT = 0.08
LOWEST_VIEW = 42.0
"""Degrees below the horizon: a camera that looks less steeply sees the fronts of things, not where they stand."""
DOUBTFUL = 8.0
"""A picture is not refused while a camera from above explains it less well by no more than this."""
LONGEST_ROOM = 12.0
"""A floor that comes out more times as long as wide is no room, but one seen from the side."""
FROM_ABOVE = "Choose a picture that shows one whole room from above: a photo, a render or a plan."


def calibrate(
    analysis: SceneAnalysis, known_width: float | None = None, wall_height: float | None = None
) -> tuple[SceneAnalysis, Calibration]:
    """Fit the camera and bring all metres of the analysis into the fitted floor's frame.

    The picture decides the room's shape. Its size is the model's, corrected by things of known size where many of them
    agree on another one, or follows from the artist's known width.

    Args:
        known_width: width of the floor's bounding rectangle in metres, when the artist measured it.
        wall_height: height of the walls in metres, when the artist knows it.

    Raises:
        PictureError: the picture was not taken from above.
        GeometryError: no room can have the floor outline that was found.
    """
    found, fitted = _fitted(analysis, None)
    scale = _scale(found, fitted, known_width)
    if wall_height is not None:
        found, fitted = _fitted(analysis, wall_height / scale.factor)
        scale = _scale(found, fitted, known_width)
    change = Similarity(scale.factor)
    found, fitted = rescaled_analysis(found, change), rescaled_calibration(fitted, change)
    if wall_height is not None:
        found = found.model_copy(update={"room_size": (*found.room_size[:2], wall_height)})
        fitted = fitted.model_copy(update={"height": wall_height})
    residuals = [r for o in found.objects if (r := residual(o, fitted.camera)) is not None]
    spread = scale.spread if known_width is None else 0.0
    if known_width is None and fitted.scale_spread:
        spread = math.hypot(spread, fitted.scale_spread)
    update = {
        "scale_source": scale.source,
        "scale_spread": spread,
        "residuals": residuals,
        "findings": [*fitted.findings, *scale.findings],
    }
    return found, fitted.model_copy(update=update)


def uncalibrated(analysis: SceneAnalysis) -> tuple[SceneAnalysis, Calibration]:
    """The room as it was stated, a rectangle seen straight down without perspective: what there is without calibration."""
    width, depth, height = analysis.room_size
    floor = [(-width / 2, -depth / 2), (width / 2, -depth / 2), (width / 2, depth / 2), (-width / 2, depth / 2)]
    camera = camera_over(analysis, width, depth)
    corners = project(camera, [(*p, 0.0) for p in floor])
    plain = CameraFit(camera, floor, [0, 1, 2, 3], height, "given", 0.0, True)
    polygon = [ImagePoint(x=float(x), y=float(y)) for x, y in corners]
    stated = analysis.model_copy(update={"floor_polygon": polygon, "wall_top_polygon": None})
    found = aligned(stated, plain)
    calibration = Calibration(
        camera=camera,
        floor=floor,
        height=height,
        error_px=0.0,
        scale_source="model",
        scale_spread=2 * MODEL_SPREAD,
        residuals=[r for o in found.objects if (r := residual(o, camera)) is not None],
    )
    return found, calibration


def camera_over(analysis: SceneAnalysis, width: float, depth: float) -> CameraModel:
    """A straight-down camera without perspective that puts a rectangle of this size over the floor in the picture."""
    camera = camera_straight_down("orthographic", width, depth, analysis.image_size, margin=0.0)
    xs, ys = [p.x for p in analysis.floor_polygon], [p.y for p in analysis.floor_polygon]
    wide, high = ((max(v) - min(v)) / 1000 * s for v, s in zip((xs, ys), analysis.image_size, strict=True))
    scale = math.sqrt(max(1.0, wide) * max(1.0, high) / (width * depth))  # pixels for a metre
    middle = [(min(v) + max(v)) / 2000 - 0.5 for v in (xs, ys)]
    matrix = list(camera.matrix)
    matrix[3], matrix[7] = -middle[0] * analysis.image_size[0] / scale, middle[1] * analysis.image_size[1] / scale
    return camera.model_copy(update={"matrix": tuple(matrix), "ortho_height": analysis.image_size[1] / scale})


def _fitted(analysis: SceneAnalysis, wall_height: float | None) -> tuple[SceneAnalysis, Calibration]:
    """Camera and floor at the stated scale; the spread is what the floor's proportions leave open."""
    analysis = with_centred_metres(analysis)
    tried = _candidates(analysis, wall_height)
    turned = turned_with_room(analysis, tried[0].fit)
    if turned is not analysis:
        analysis, tried = turned, _candidates(turned, wall_height)
    tried = _not_from_the_side(tried)
    fit = tried[0].fit
    findings = [*_shape_findings(analysis, fit), *_camera_findings(analysis, tried), *fit.findings]
    contradiction = _contradiction(analysis, fit)
    calibration = Calibration(
        camera=fit.camera,
        floor=fit.floor,
        height=fit.height,
        error_px=fit.error_px,
        scale_source="model",
        scale_spread=contradiction / 2 if contradiction > ASPECT_LIMIT else 0.0,
        tried=[
            TriedCamera(name=c.way.name, cost=c.cost, error_px=c.fit.error_px, objects_px=c.objects_px) for c in tried
        ],
        findings=findings,
    )
    return aligned(analysis, fit), calibration


def _candidates(analysis: SceneAnalysis, wall_height: float | None) -> list[Candidate]:
    stated: Kind = "perspective" if analysis.view == "perspective" else "orthographic"
    width, depth, height = analysis.room_size
    seen = [Seen(o.centre, o.size, o.yaw, o.box, o.shape) for o in analysis.objects if o.box is not None]
    return fit_best_camera(
        analysis.image_size,
        analysis.floor_polygon,
        (width, depth, wall_height or height),
        analysis.wall_top_polygon,
        Evidence.of(seen, (width, depth), analysis.image_size),
        stated,
        wall_height is not None,
    )


def _scale(found: SceneAnalysis, fitted: Calibration, known_width: float | None) -> Scale:
    if known_width is not None:
        return Scale(known_width / found.room_size[0], 0.0, "known width")
    return estimated_scale(find_anchors(found, fitted.camera))


def down_angle(camera: CameraModel) -> float:
    """Degrees below the horizon that a camera looks; 90 is straight down."""
    return math.degrees(math.asin(max(-1.0, min(1.0, camera.matrix[10]))))


def _not_from_the_side(tried: list[Candidate]) -> list[Candidate]:
    """The candidates, the best first, for a picture from above; a view from the side has to be beyond doubt."""
    steep = [c for c in tried if down_angle(c.fit.camera) >= LOWEST_VIEW]
    if steep and steep[0].cost - tried[0].cost < DOUBTFUL:
        tried = [steep[0], *(c for c in tried if c is not steep[0])]
    fit = tried[0].fit
    down = down_angle(fit.camera)
    if down < LOWEST_VIEW:
        raise PictureError(
            f"This picture cannot be used: it looks only about {max(0.0, down):.0f} degrees down into the room.",
            FROM_ABOVE,
        )
    width, depth = extent_of(fit.floor)
    if max(width, depth) > LONGEST_ROOM * min(width, depth):
        raise PictureError("This picture cannot be used: its floor is not seen from above.", FROM_ABOVE)
    return tried


def _contradiction(analysis: SceneAnalysis, fit: CameraFit) -> float:
    """How far the stated proportions are from those of the picture (logarithm)."""
    width, depth = extent_of(fit.floor)
    return abs(math.log(width / depth * analysis.room_size[1] / analysis.room_size[0]))


def _shape_findings(analysis: SceneAnalysis, fit: CameraFit) -> list[Finding]:
    if _contradiction(analysis, fit) <= ASPECT_LIMIT:
        return []
    (said_width, said_depth, _), (width, depth) = analysis.room_size, extent_of(fit.floor)
    message = (
        f"The stated size {said_width:.2f} x {said_depth:.2f} m does not fit the picture's proportions; "
        f"{width:.2f} x {depth:.2f} m is used."
    )
    return [Finding(about="room", message=message, severity="warning")]


def _camera_findings(analysis: SceneAnalysis, tried: list[Candidate]) -> list[Finding]:
    best, others = tried[0], tried[1:]
    message = f"The picture was taken {best.way.name}"
    if others and others[0].cost - best.cost < CLOSE:
        message += f"; that it was taken {others[0].way.name} explains it nearly as well"
    elif others:
        message += f"; the next best, {others[0].way.name}, explains corners and objects less well"
    findings = [Finding(about="camera", message=message + ".")]
    flat = best.way.kind == "orthographic"
    if flat == (analysis.view == "perspective"):
        said = "with perspective" if flat else "without perspective"
        message = f"The picture was said to be taken {said}; its corners and objects show that it was not."
        findings.append(Finding(about="camera", message=message))
    return findings
