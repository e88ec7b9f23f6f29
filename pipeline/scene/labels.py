# SPDX-License-Identifier: GPL-3.0-or-later
"""Ids written on a captured picture, each at the projected centre of its object, none on top of another."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from PIL import Image, ImageDraw, ImageFont

from ..artifacts.camera import CameraModel
from ..geometry.camera import project
from .measure import measure, mesh_points
from .studio import proxies_of
from .tags import FIELD, ID, world_matrix

_INK, _HALO = (20, 20, 24), (255, 255, 255)


@dataclass(frozen=True)
class Label:
    """A text at a place of the picture (0..1 of its width and height); majors are written first."""

    text: str
    x: float
    y: float
    major: bool


def object_labels(room: Any, camera: CameraModel) -> list[Label]:
    """One label for each proxy that is in the picture, at the projected centre of its top."""
    labels = []
    for obj in proxies_of(room):
        if obj.type != "MESH" or not obj.data.vertices or obj.hide_render:
            continue
        box = measure(mesh_points(obj.data), world_matrix(obj))
        top = (box.centre[0], box.centre[1], box.centre[2] + box.size[2] / 2)
        x, y = (float(v) / 1000.0 for v in np.asarray(project(camera, [top]))[0])
        if 0 <= x <= 1 and 0 <= y <= 1:
            labels.append(Label(str(obj[ID]), x, y, obj.get(FIELD + "salience") == "major"))
    return sorted(labels, key=lambda label: (not label.major, label.text))


def draw_labels(image: Image.Image, labels: list[Label]) -> None:
    """Write the labels on the picture, in place. A label that would cover another one moves up or down."""
    draw = ImageDraw.Draw(image)
    size = max(10, round(max(image.size) / 72))
    taken: list[tuple[float, float, float, float]] = []
    for label in labels:
        font = ImageFont.load_default(size if label.major else max(9, round(0.85 * size)))
        left, top, right, bottom = draw.textbbox((0, 0), label.text, font=font)
        width, height = right - left, bottom - top
        x = min(max(label.x * image.width - width / 2, 2), max(2, image.width - width - 2))
        y = _free_row(x, label.y * image.height - height / 2, width, height, taken, image.height)
        taken.append((x, y, x + width, y + height))
        stroke = max(1, size // 6)
        draw.text((x - left, y - top), label.text, _INK, font, stroke_width=stroke, stroke_fill=_HALO)


def _free_row(
    x: float, y: float, width: float, height: float, taken: list[tuple[float, float, float, float]], limit: int
) -> float:
    """The nearest y, in steps of a line, at which the label covers none that is there; the wish when there is none."""
    step = height + 6
    for offset in (0, 1, -1, 2, -2, 3, -3, 4, -4):
        at = y + offset * step
        if not 0 <= at <= limit - height:
            continue
        if all(x > r + 3 or x + width < a - 3 or at > d + 4 or at + height < b - 4 for a, b, r, d in taken):
            return at
    return min(max(y, 0), max(0, limit - height))
