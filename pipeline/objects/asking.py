# SPDX-License-Identifier: GPL-3.0-or-later
"""What stages 5 and 6 show and tell the model of objects: crops, lines, and batches of what is asked together."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TypeVar

import numpy as np

from ..artifacts.analysis import SceneAnalysis
from ..artifacts.camera import CameraModel
from ..artifacts.common import ImageBox
from ..artifacts.layout import ProxyLine
from ..artifacts.objects import ObjectDescription
from ..geometry.camera import project
from ..geometry.footprint import box_corners
from ..picture import ReferencePicture

CROP = 384
"""Longest side of a crop, pixels."""
_MARGIN = 0.12
T = TypeVar("T")


def picture_box(proxy: ProxyLine, camera: CameraModel, analysis: SceneAnalysis) -> ImageBox | None:
    """Where the picture shows an object: where it was detected, else where its box projects to; None outside of it."""
    seen = next(
        (o.box for o in [*analysis.objects, *analysis.left_out] if o.id == proxy.id and o.box is not None), None
    )
    projected = _projected(proxy, camera)
    # An object that was moved by hand is not where it was detected, and the crop must still show it.
    if seen is not None and (projected is None or seen.iou(projected) > 0.02):
        return seen
    return seen or projected


def _projected(proxy: ProxyLine, camera: CameraModel) -> ImageBox | None:
    points = project(camera, box_corners(proxy.centre, proxy.size, proxy.yaw))
    if not np.isfinite(points).all():
        return None
    low, high = np.clip(points.min(axis=0), 0, 1000), np.clip(points.max(axis=0), 0, 1000)
    if (high - low).min() < 1.0:
        return None
    return ImageBox(x_min=float(low[0]), y_min=float(low[1]), x_max=float(high[0]), y_max=float(high[1]))


def crop_of(picture: ReferencePicture, box: ImageBox) -> bytes:
    """An object's part of the picture with some of what is round it."""
    wide = ImageBox(
        x_min=max(0.0, box.x_min - 4), y_min=max(0.0, box.y_min - 4), x_max=min(1000.0, box.x_max + 4),
        y_max=min(1000.0, box.y_max + 4),
    )  # fmt: skip
    return picture.crop(wide, _MARGIN, CROP)


def batches(items: Sequence[T], size: int) -> list[list[T]]:
    """The items in batches of nearly the same length, none longer than `size`."""
    count = -(-len(items) // size) if items else 0
    return [list(items[len(items) * i // count : len(items) * (i + 1) // count]) for i in range(count)]


def object_line(number: int, proxy: ProxyLine, described: ObjectDescription, parent: ProxyLine | None = None) -> str:
    """One object of a list in a prompt."""
    w, d, h = proxy.size
    label = f" ({proxy.label})" if proxy.label and proxy.label.lower() != proxy.category.lower() else ""
    line = f"{number}, {proxy.id}, {proxy.category.replace('_', ' ')}{label}, {w:.2f} x {d:.2f} x {h:.2f}"
    where = {"wall": "on a wall", "ceiling": "hangs from the ceiling"}.get(proxy.placement, "")
    if parent is not None:
        where = f"on {parent.id}"
    colours = " ".join(f"#{c.code} {c.share:.0%}" for c in described.measured)
    return "; ".join(part for part in (line, where, colours) if part)
