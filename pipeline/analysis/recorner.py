# SPDX-License-Identifier: GPL-3.0-or-later
"""Other corners of the floor: the camera is fitted anew, and all metres go over into the new floor's frame."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

from ..artifacts.analysis import ArchitectureItem, Calibration, DetectedObject, SceneAnalysis
from ..artifacts.camera import CameraModel
from ..artifacts.common import ImagePoint, Metres2
from ..artifacts.corrections import Found
from ..geometry.fit import CameraFit, fit_camera
from ..geometry.polygon import area, bounding_rectangle
from .frames import transferred
from .into_frame import LEAST_TURN
from .residuals import residual

CLOSE_SCALE = 1e-3
"""Part of the scale that need not be sought any further: every fit takes a tenth of a second."""
Transfer = Callable[[Sequence[Metres2]], list[Metres2] | None]


def recornered(found: Found, polygon: Sequence[ImagePoint]) -> tuple[SceneAnalysis, Calibration]:
    """The analysis and the calibration with these corners (0-1000) for the floor's.

    The scale stays: what was floor before has the area that it had. Each object goes where the picture shows it, or
    keeps its place between the walls, whichever agrees more with its box.

    Raises:
        GeometryError: no room has these corners.
    """
    analysis, calibration = found.analysis, found.calibration
    fit = _fit(analysis, calibration, polygon)
    low_x, low_y, high_x, high_y = bounding_rectangle(fit.floor)
    old_x, old_y = analysis.room_size[0], analysis.room_size[1]
    stretch = ((high_x - low_x) / old_x, (high_y - low_y) / old_y)

    def by_walls(points: Sequence[Metres2]) -> list[Metres2] | None:
        return [(x * stretch[0], y * stretch[1]) for x, y in points]

    def by_picture(points: Sequence[Metres2]) -> list[Metres2] | None:
        return transferred(calibration.camera, fit.camera, points)

    objects, seen = [], 0
    for item in analysis.objects:
        moved, picture_wins = _better(item, fit.camera, by_picture, by_walls)
        seen += 1 if picture_wins else -1
        objects.append(moved)
    way = by_picture if seen >= 0 else by_walls
    tops = analysis.wall_top_polygon
    same = tops is not None and len(tops) == len(polygon) == len(fit.order)
    corrected = analysis.model_copy(
        update={
            "floor": fit.floor,
            "floor_polygon": [polygon[i] for i in fit.order],
            "wall_top_polygon": [tops[i] for i in fit.order] if tops is not None and same else None,
            "room_size": (high_x - low_x, high_y - low_y, calibration.height),
            "objects": objects,
            "architecture": [_architecture(a, way) for a in analysis.architecture],
        }
    )
    fitted = calibration.model_copy(
        update={
            "camera": fit.camera,
            "floor": fit.floor,
            "error_px": fit.error_px,
            "findings": [*calibration.findings, *(f for f in fit.findings if f not in calibration.findings)],
        }
    )
    return corrected, fitted


def _fit(analysis: SceneAnalysis, calibration: Calibration, polygon: Sequence[ImagePoint]) -> CameraFit:
    """The camera for these corners, at the scale that holds already."""
    camera, tops = calibration.camera, analysis.wall_top_polygon
    if tops is not None and len(tops) != len(polygon):
        tops = None
    width = analysis.room_size[0]
    for _ in range(8):
        fit = fit_camera(
            analysis.image_size, polygon, width, tops, calibration.height, camera.kind, camera.principal, camera
        )
        there = transferred(calibration.camera, fit.camera, calibration.floor)
        covered = 0.0 if there is None else area(there)
        if covered <= 0:
            return fit
        step = math.sqrt(area(calibration.floor) / covered)
        width *= step
        # The wall height does not follow, so the camera may differ a little at another width.
        if abs(step - 1.0) < CLOSE_SCALE:
            break
    return fit


def _better(
    item: DetectedObject, camera: CameraModel, by_picture: Transfer, by_walls: Transfer
) -> tuple[DetectedObject, bool]:
    """The object where it agrees with its box, and whether that is by the picture."""
    seen, between = _moved(item, by_picture), _moved(item, by_walls)
    a, b = residual(seen, camera), residual(between, camera)
    picture = a is None or b is None or a.iou >= b.iou
    return (seen, True) if picture else (between, False)


def _moved(item: DetectedObject, way: Transfer) -> DetectedObject:
    """One object on its way into the new frame; its height and the height of its base stay."""
    x, y, z = item.centre
    angle = math.radians(item.yaw)
    own_x, own_y = (math.cos(angle), math.sin(angle)), (-math.sin(angle), math.cos(angle))
    half_x, half_y = item.size[0] / 2, item.size[1] / 2
    points = [(x, y)]
    points += [(x + s * half_x * own_x[0], y + s * half_x * own_x[1]) for s in (-1, 1)]
    points += [(x + s * half_y * own_y[0], y + s * half_y * own_y[1]) for s in (-1, 1)]
    there = way(points)
    if there is None:
        return item
    centre, left, right, back, front = there
    width, depth = math.dist(left, right), math.dist(back, front)
    turn = math.degrees(math.atan2(right[1] - left[1], right[0] - left[0])) - item.yaw
    turn = (turn + 180.0) % 360.0 - 180.0
    yaw = item.yaw if abs(turn) < LEAST_TURN else (item.yaw + turn) % 360.0
    size = (max(0.001, width), max(0.001, depth), item.size[2])
    return item.model_copy(update={"centre": (centre[0], centre[1], z), "size": size, "yaw": yaw})


def _architecture(item: ArchitectureItem, way: Transfer) -> ArchitectureItem:
    there = way([item.start, item.end])
    return item if there is None else item.model_copy(update={"start": there[0], "end": there[1]})
