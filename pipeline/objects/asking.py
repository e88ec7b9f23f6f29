# SPDX-License-Identifier: GPL-3.0-or-later
"""What stages 5 and 6 show and tell the model of objects: crops, lines, and batches of what is asked together."""

from __future__ import annotations

import math
from collections.abc import Collection, Sequence
from typing import TypeVar

import numpy as np

from ..artifacts.analysis import SceneAnalysis
from ..artifacts.camera import CameraModel
from ..artifacts.common import ImageBox
from ..artifacts.layout import Layout, ProxyLine
from ..artifacts.objects import ObjectDescription
from ..geometry.camera import project
from ..geometry.footprint import box_corners
from ..picture import ReferencePicture
from .crops import marked_crop

_SIDES = ("right", "upper right", "top", "upper left", "left", "lower left", "bottom", "lower right")
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
    """An object's part of the picture with some of what is round it, its corners marked; small ones are enlarged."""
    return marked_crop(picture, box)


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


def facing_words(proxy: ProxyLine, camera: CameraModel) -> str:
    """Where an object's front (-Y) and its +X point in the picture, "" where the picture does not tell.

    Directions are those of the picture's plane; degrees are given where they are none of its eight main ones.
    """
    turned = math.radians(proxy.yaw)
    x, y, z = proxy.centre[0], proxy.centre[1], proxy.centre[2] - proxy.size[2] / 2
    step = 0.1
    front, right = (math.sin(turned), -math.cos(turned)), (math.cos(turned), math.sin(turned))
    spots = project(camera, [(x, y, z), *((x + step * a, y + step * b, z) for a, b in (front, right))])
    if not np.isfinite(spots).all():
        return ""
    ways = (spots[1:] - spots[0]) * np.array(camera.image_size)
    if np.linalg.norm(ways, axis=1).min() < 1e-6:
        return ""
    forward, sideways = (_way(float(a), float(b)) for a, b in ways)
    return f"its front (-Y) looks to the picture's {forward}, its +X to the {sideways}"


def _way(right: float, down: float) -> str:
    angle = math.degrees(math.atan2(-down, right)) % 360
    nearest = round(angle / 45) % 8
    off = (angle - 45 * nearest + 180) % 360 - 180
    if abs(off) < 6:
        return _SIDES[nearest]
    return f"{_SIDES[nearest]} ({abs(off):.0f} degrees {'counter-' if off > 0 else ''}clockwise of it)"


def apart_from(
    proxy: ProxyLine, layout: Layout, analysis: SceneAnalysis, gone: Collection[str] = ()
) -> list[tuple[str, str]]:
    """What stands or lies on an object, or is inside of its box, and is modelled on its own: (id, category) pairs.

    Args:
        gone: ids that the artist removed.
    """
    found: dict[str, str] = {}
    for other in layout.proxies:
        if other.id != proxy.id and (other.parent == proxy.id or _within(other, proxy)):
            found[other.id] = other.category
    for item in analysis.objects:
        known = layout.proxy(item.id)
        if known is None and item.parent == proxy.id and item.id not in gone and item.placement == "surface":
            found.setdefault(item.id, item.category)
    return [(i, category.replace("_", " ")) for i, category in found.items()]


def _within(other: ProxyLine, proxy: ProxyLine) -> bool:
    """Whether the middle of a smaller thing is inside of an object's box."""
    if math.prod(other.size) > 0.5 * math.prod(proxy.size) or other.placement != "surface":
        return False
    turned = math.radians(-proxy.yaw)
    dx, dy = other.centre[0] - proxy.centre[0], other.centre[1] - proxy.centre[1]
    x, y = dx * math.cos(turned) - dy * math.sin(turned), dx * math.sin(turned) + dy * math.cos(turned)
    dz = other.centre[2] - proxy.centre[2]
    return all(abs(a) < b / 2 for a, b in zip((x, y, dz), proxy.size, strict=True))
