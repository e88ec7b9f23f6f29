# SPDX-License-Identifier: GPL-3.0-or-later
"""The camera and the scale: the analysis in the frame of the floor that was fitted to the picture. (Paper, stage 1.)"""

from __future__ import annotations

import math
from collections.abc import Sequence

from ..artifacts.analysis import ArchitectureItem, Calibration, DetectedObject, Finding, ObjectResidual, SceneAnalysis
from ..artifacts.camera import CameraModel
from ..artifacts.common import Metres2
from ..geometry.camera import GeometryError, Kind
from ..geometry.fit import CameraFit, fit_camera
from ..geometry.footprint import image_box_of
from ..layout.walls import NAMES

ASPECT_LIMIT = 0.08
LEAST_TURN = 2.0
"""Less than this many degrees between the picture and the walls is a matter of pointing at corners."""


def calibrate(
    analysis: SceneAnalysis, known_width: float | None = None, wall_height: float | None = None
) -> tuple[SceneAnalysis, Calibration]:
    """Fit the camera and bring all metres of the analysis into the fitted floor's frame.

    The picture decides the room's shape, the model (or the artist's known width) its size: when the model's width and
    depth contradict the picture's proportions, its floor area is kept.

    Args:
        known_width: width of the floor's bounding rectangle in metres, when the artist measured it.
        wall_height: height of the walls in metres, when the artist knows it.

    Raises:
        GeometryError: no room can have the floor outline that was found.
    """
    findings: list[Finding] = []
    said_width, said_depth, said_height = analysis.room_size
    height = wall_height or said_height
    width = known_width or said_width
    fit = _fit(analysis, width, height)
    extent = _extent(fit.floor)
    aspect = extent[0] / extent[1]
    if known_width is None:
        width = math.sqrt(said_width * said_depth * aspect)
        fit = _fit(analysis, width, height)
        extent = _extent(fit.floor)
    elif wall_height is None:
        # The model judged the walls by the same yardstick as everything else.
        height *= math.sqrt(extent[0] * extent[1] / (said_width * said_depth))
        fit = _fit(analysis, width, height)
        extent = _extent(fit.floor)
    if abs(math.log(aspect * said_depth / said_width)) > ASPECT_LIMIT:
        message = (
            f"The stated size {said_width:.2f} x {said_depth:.2f} m does not fit the picture's proportions; "
            f"{extent[0]:.2f} x {extent[1]:.2f} m is used."
        )
        findings.append(Finding(about="room", message=message, severity="warning"))
    scale = (extent[0] / said_width, extent[1] / said_depth)
    aligned = _aligned(_turned(analysis, fit.camera, scale), fit, scale, height)
    calibration = Calibration(
        camera=fit.camera,
        floor=fit.floor,
        height=height,
        error_px=fit.error_px,
        scale_source="known width" if known_width else "model",
        scale_spread=0.0 if known_width else abs(math.log(aspect * said_depth / said_width)) / 2 + 0.03,
        residuals=[r for o in aligned.objects if (r := residual(o, fit.camera)) is not None],
        findings=[*findings, *fit.findings],
    )
    return aligned, calibration


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


def _fit(analysis: SceneAnalysis, width: float, height: float) -> CameraFit:
    flat = analysis.view in ("orthographic", "plan")
    kind: Kind | None = "orthographic" if flat else None if analysis.wall_top_polygon else "perspective"
    tops = None if flat else analysis.wall_top_polygon
    return fit_camera(analysis.image_size, analysis.floor_polygon, width, tops, height, kind)


def _turned(analysis: SceneAnalysis, camera: CameraModel, scale: tuple[float, float]) -> SceneAnalysis:
    """The analysis in the fitted floor's directions.

    A room that is a little askew in the picture is squared by the fit. A model may have measured along the picture or
    along the walls; the picture boxes tell which.
    """
    # The picture's right-hand direction on the floor is the camera's own x axis.
    turn = math.degrees(math.atan2(camera.matrix[4], camera.matrix[0]))
    if abs(turn) < LEAST_TURN:
        return analysis
    cos, sin = math.cos(math.radians(turn)), math.sin(math.radians(turn))

    def spun(point: Sequence[float]) -> Metres2:
        return point[0] * cos - point[1] * sin, point[0] * sin + point[1] * cos

    def agreement(objects: Sequence[DetectedObject]) -> float:
        return sum(r.iou for o in objects if (r := residual(_scaled_object(o, scale), camera)) is not None)

    objects = [
        o.model_copy(update={"centre": (*spun(o.centre), o.centre[2]), "yaw": (o.yaw + turn) % 360.0})
        for o in analysis.objects
    ]
    if agreement(objects) <= agreement(analysis.objects):
        return analysis
    architecture = [a.model_copy(update={"start": spun(a.start), "end": spun(a.end)}) for a in analysis.architecture]
    message = f"The room is turned by {-turn:.0f} degrees in the picture; its objects were turned back with it."
    findings = [*analysis.findings, Finding(about="room", message=message)]
    return analysis.model_copy(update={"objects": objects, "architecture": architecture, "findings": findings})


def _extent(floor: list[Metres2]) -> tuple[float, float]:
    xs, ys = [p[0] for p in floor], [p[1] for p in floor]
    return max(xs) - min(xs), max(ys) - min(ys)


def _aligned(analysis: SceneAnalysis, fit: CameraFit, scale: tuple[float, float], height: float) -> SceneAnalysis:
    """The analysis with its floor, and every length in the fitted frame."""
    extent = _extent(fit.floor)
    tops = analysis.wall_top_polygon
    return analysis.model_copy(
        update={
            "floor": fit.floor,
            "floor_polygon": [analysis.floor_polygon[i] for i in fit.order],
            "wall_top_polygon": [tops[i] for i in fit.order] if tops else None,
            "room_size": (extent[0], extent[1], height),
            "objects": [_scaled_object(o, scale) for o in analysis.objects],
            "architecture": [_scaled_architecture(a, scale) for a in analysis.architecture],
        }
    )


def _scaled_object(item: DetectedObject, scale: tuple[float, float]) -> DetectedObject:
    cos2, sin2 = math.cos(math.radians(item.yaw)) ** 2, math.sin(math.radians(item.yaw)) ** 2
    own = (scale[0] * cos2 + scale[1] * sin2, scale[0] * sin2 + scale[1] * cos2)
    mean = math.sqrt(scale[0] * scale[1])
    # Heights follow the scale too: the model judged everything by the same yardstick.
    width, depth, tall = item.size[0] * own[0], item.size[1] * own[1], item.size[2] * mean
    base = (item.centre[2] - item.size[2] / 2) * mean
    centre = (item.centre[0] * scale[0], item.centre[1] * scale[1], base + tall / 2)
    # From here on the outer walls have ids of their own.
    parent = NAMES.get(item.parent or "", item.parent)
    return item.model_copy(update={"centre": centre, "size": (width, depth, tall), "parent": parent})


def _scaled_architecture(item: ArchitectureItem, scale: tuple[float, float]) -> ArchitectureItem:
    start = (item.start[0] * scale[0], item.start[1] * scale[1])
    end = (item.end[0] * scale[0], item.end[1] * scale[1])
    return item.model_copy(update={"start": start, "end": end})
