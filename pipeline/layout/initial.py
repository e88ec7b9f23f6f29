# SPDX-License-Identifier: GPL-3.0-or-later
"""The first layout of the major objects: metres and boxes fused, hand edits on top."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from ..artifacts.analysis import Calibration, DetectedObject, Finding, SceneAnalysis
from ..artifacts.common import ImageBox
from ..artifacts.layout import CameraLine, Layout, ProxyLine
from .fuse import USUAL, fuse
from .walls import shell

MIN_SIDE = 0.02
MAX_HEIGHT_SHARE = 1.0
_TALL, _GAP = 1.8, 0.08
"""Metres: what is higher and ends so little under the ceiling is built up to it. The gap would be black from above."""


@dataclass(frozen=True)
class Evidence:
    """What is known of where an object is: the detection, with the box as the critic may have refined it."""

    objects: Mapping[str, DetectedObject]

    def box(self, identifier: str) -> ImageBox | None:
        """The object's box in the picture."""
        item = self.objects.get(identifier)
        return None if item is None else item.box

    def with_object(self, item: DetectedObject) -> Evidence:
        """The same evidence with one object added or replaced."""
        return Evidence({**self.objects, item.id: item})

    def without(self, identifier: str) -> Evidence:
        """The same evidence without one object."""
        return Evidence({i: o for i, o in self.objects.items() if i != identifier})


def is_major(item: DetectedObject) -> bool:
    """Whether stage 3 places it: what stands on the floor and defines the layout."""
    return item.salience == "major" and item.placement == "floor"


def empty_layout(analysis: SceneAnalysis, calibration: Calibration) -> tuple[Layout, list[Finding]]:
    """Shell and reference camera, without proxies."""
    room, walls, doors, windows, openings, findings = shell(analysis, calibration)
    layout = Layout(
        room=room, walls=walls, doors=doors, windows=windows, openings=openings, cameras=[camera_line(calibration)]
    )
    return layout, findings


def camera_line(calibration: Calibration) -> CameraLine:
    """The fitted camera as the layout line "reference"."""
    camera = calibration.camera
    return CameraLine(
        id="reference",
        kind=camera.kind,
        matrix=camera.matrix,
        fov_y=camera.fov_y,
        ortho_height=camera.ortho_height,
        image_size=camera.image_size,
        principal=(camera.principal.x, camera.principal.y),
    )


def proxy_of(
    item: DetectedObject, calibration: Calibration, base_z: float | None = None
) -> tuple[ProxyLine, list[Finding]]:
    """One proxy by fusing an object's metres with its box; it never reaches through the ceiling."""
    base = item.centre[2] - item.size[2] / 2 if base_z is None else base_z
    side = max(_extent(calibration.floor))
    fused, findings = fuse(item, calibration.camera, side, base, calibration.trust or USUAL)
    width, depth, height = (max(MIN_SIDE, v) if i < 2 else max(0.005, v) for i, v in enumerate(fused.size))
    top = calibration.height * MAX_HEIGHT_SHARE
    if base + height > top:
        # What stands on something as high as the ceiling has no room above it: it ends at the ceiling all the same.
        base = base if base < top - 0.005 else max(0.0, top - height)
        height = min(height, top - base)
    elif item.placement == "floor" and height > _TALL and top - (base + height) < _GAP:
        height = top - base
    proxy = ProxyLine(
        id=item.id,
        category=item.category,
        label=item.label,
        centre=(fused.centre[0], fused.centre[1], base + height / 2),
        size=(width, depth, height),
        yaw=fused.yaw,
        placement=item.placement,
        parent=item.parent,
        salience=item.salience,
        shape=item.shape,
    )
    return proxy, findings


def first_layout(analysis: SceneAnalysis, calibration: Calibration, evidence: Evidence) -> tuple[Layout, list[Finding]]:
    """Shell, camera and one proxy for each major object, as fused; not yet solved."""
    layout, findings = empty_layout(analysis, calibration)
    proxies = []
    for item in evidence.objects.values():
        if is_major(item):
            # What stands on the floor stands on the floor: a base above it is the model's rounding.
            proxy, notes = proxy_of(item, calibration, 0.0)
            proxies.append(proxy.model_copy(update={"parent": None}))
            findings += notes
    return layout.model_copy(update={"proxies": proxies}), findings


def _extent(floor: Sequence[tuple[float, float]]) -> tuple[float, float]:
    xs, ys = [p[0] for p in floor], [p[1] for p in floor]
    return max(xs) - min(xs), max(ys) - min(ys)
