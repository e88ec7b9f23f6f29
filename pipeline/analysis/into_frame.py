# SPDX-License-Identifier: GPL-3.0-or-later
"""The model's metres brought into the frame of the floor that was fitted to the picture."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

import numpy as np

from ..artifacts.analysis import ArchitectureItem, DetectedObject, Finding, SceneAnalysis
from ..artifacts.camera import CameraModel
from ..artifacts.common import Metres2
from ..geometry.fit import CameraFit
from ..geometry.polygon import bounding_rectangle
from ..layout.walls import NAMES
from .residuals import agreement

LEAST_TURN = 2.0
"""Less than this many degrees between the picture and the walls is a matter of pointing at corners."""
FEWEST = 4
ELSEWHERE = 0.12
"""Median distance of objects from where the picture shows them, as a part of the room, from which their metres may have
been measured from elsewhere; the right place must halve it."""
Move = Callable[[Sequence[float]], Metres2]


def with_centred_metres(analysis: SceneAnalysis) -> SceneAnalysis:
    """The analysis with its metres measured from the room's middle, y up in the picture.

    Some models measure from a corner, or downward, whatever they are asked. The picture boxes tell.
    """
    width, depth = analysis.room_size[:2]
    ways: list[tuple[str, Move]] = [
        ("", lambda p: (p[0], p[1])),
        ("downward", lambda p: (p[0], -p[1])),
        ("from the bottom left corner", lambda p: (p[0] - width / 2, p[1] - depth / 2)),
        ("from the top left corner", lambda p: (p[0] - width / 2, depth / 2 - p[1])),
    ]
    seen = [o for o in analysis.objects if o.box is not None]
    if len(seen) < FEWEST:
        return analysis
    xs, ys = [p.x for p in analysis.floor_polygon], [p.y for p in analysis.floor_polygon]
    low, high = np.array((min(xs), max(ys))), np.array((max(xs), min(ys)))
    boxes = (np.array([o.box.centre for o in seen if o.box is not None]) - low) / (high - low) - 0.5
    off = []
    for _, move in ways:
        said = np.array([move(o.centre) for o in seen]) / (width, depth)
        off.append(float(np.median(np.linalg.norm(said - boxes, axis=1))))
    best = int(np.argmin(off))
    if best == 0 or off[0] < ELSEWHERE or off[best] > off[0] / 2:
        return analysis
    message = (
        f"The places of the objects were measured {ways[best][0]}; they were moved to where the picture shows them."
    )
    return _moved(analysis, ways[best][1], Finding(about="room", message=message, severity="warning"))


def _moved(analysis: SceneAnalysis, move: Move, finding: Finding, turn: float = 0.0) -> SceneAnalysis:
    objects = [
        o.model_copy(update={"centre": (*move(o.centre), o.centre[2]), "yaw": (o.yaw + turn) % 360.0})
        for o in analysis.objects
    ]
    architecture = [a.model_copy(update={"start": move(a.start), "end": move(a.end)}) for a in analysis.architecture]
    findings = [*analysis.findings, finding]
    return analysis.model_copy(update={"objects": objects, "architecture": architecture, "findings": findings})


def turned_with_room(analysis: SceneAnalysis, fit: CameraFit) -> SceneAnalysis:
    """The analysis in the fitted floor's directions; the same one where nothing has to be turned.

    A room that is a little askew in the picture is squared by the fit. A model may have measured along the picture or
    along the walls; the picture boxes tell which.
    """
    # The picture's right-hand direction on the floor is the camera's own x axis.
    turn = math.degrees(math.atan2(fit.camera.matrix[4], fit.camera.matrix[0]))
    if abs(turn) < LEAST_TURN:
        return analysis
    cos, sin = math.cos(math.radians(turn)), math.sin(math.radians(turn))

    def spun(point: Sequence[float]) -> Metres2:
        return point[0] * cos - point[1] * sin, point[0] * sin + point[1] * cos

    message = f"The room is turned by {-turn:.0f} degrees in the picture; its objects were turned back with it."
    turned = _moved(analysis, spun, Finding(about="room", message=message), turn)
    scale = stretch(analysis, fit)
    return turned if _agrees(turned, scale, fit.camera) > _agrees(analysis, scale, fit.camera) else analysis


def _agrees(analysis: SceneAnalysis, scale: tuple[float, float], camera: CameraModel) -> float:
    return agreement([_scaled_object(o, scale) for o in analysis.objects], camera)


def extent_of(floor: Sequence[Metres2]) -> tuple[float, float]:
    """Width and depth of the floor's bounding rectangle."""
    low_x, low_y, high_x, high_y = bounding_rectangle(floor)
    return high_x - low_x, high_y - low_y


def stretch(analysis: SceneAnalysis, fit: CameraFit) -> tuple[float, float]:
    """What the stated metres are multiplied by along x and y."""
    width, depth = extent_of(fit.floor)
    return width / analysis.room_size[0], depth / analysis.room_size[1]


def aligned(analysis: SceneAnalysis, fit: CameraFit) -> SceneAnalysis:
    """The analysis with its floor, and every length in the fitted frame."""
    scale, tops = stretch(analysis, fit), analysis.wall_top_polygon
    return analysis.model_copy(
        update={
            "floor": fit.floor,
            "floor_polygon": [analysis.floor_polygon[i] for i in fit.order],
            "wall_top_polygon": [tops[i] for i in fit.order] if tops and len(tops) > max(fit.order) else None,
            "room_size": (*extent_of(fit.floor), fit.height),
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
