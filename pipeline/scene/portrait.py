# SPDX-License-Identifier: GPL-3.0-or-later
"""Pictures of one object that is not in the room: from its front at eye level, and from above, side by side."""

from __future__ import annotations

import io
from collections.abc import Sequence
from typing import Any

import bpy
import numpy as np
from PIL import Image

from ..artifacts.camera import CameraModel
from ..program.prelude.shape import Shape
from .arrays import mesh_arrays
from .capture import draw_stage
from .meshes import write_arrays
from .studio import studio

_VIEWS = ((-0.5, -1.0, 0.42), (0.0, -0.28, 1.0))
_FIELD = 0.42  # radians


def portrait(shapes: Sequence[Shape], family: str, long_side: int) -> bytes:
    """PNG of an object from its front and from above. Nothing stays behind. Raises SceneError when nothing can draw."""
    mesh = bpy.data.meshes.new("Code-as-Room Portrait")
    before = set(bpy.data.materials)
    obj = bpy.data.objects.new("Code-as-Room Portrait", mesh)
    try:
        write_arrays(mesh, mesh_arrays(list(shapes)), family, "")
        points = np.concatenate([shape.vertices for shape in shapes])
        pictures = [_view(obj, points, view, long_side // 2) for view in _VIEWS]
    finally:
        made = [m for m in bpy.data.materials if m not in before]
        bpy.data.objects.remove(obj)
        bpy.data.meshes.remove(mesh)
        bpy.data.batch_remove(made)
    page = Image.new("RGB", (sum(p.width for p in pictures), max(p.height for p in pictures)), "white")
    at = 0
    for picture in pictures:
        page.paste(picture, (at, 0))
        at += picture.width
    buffer = io.BytesIO()
    page.save(buffer, "PNG")
    return buffer.getvalue()


def _view(obj: Any, points: Any, direction: tuple[float, float, float], side: int) -> Image.Image:
    camera = looking_at(points, direction, side)
    with studio([obj], camera, side) as stage:
        drawn, _ = draw_stage(stage, camera)
    return drawn if isinstance(drawn, Image.Image) else Image.open(io.BytesIO(drawn)).convert("RGB")


def looking_at(points: Any, direction: tuple[float, float, float], side: int) -> CameraModel:
    """A camera that sees all points (N, 3) from a direction, in a square picture."""
    back = np.array(direction) / np.linalg.norm(direction)
    right = np.cross((0.0, 0.0, 1.0), back)
    right /= np.linalg.norm(right)
    axes = np.stack([right, np.cross(back, right), back], axis=1)
    middle = (points.min(axis=0) + points.max(axis=0)) / 2
    local = (points - middle) @ axes
    tangent = np.tan(_FIELD / 2)
    distance = float((np.abs(local[:, :2]).max(axis=1) / tangent + local[:, 2]).max()) * 1.06
    matrix = np.eye(4)
    matrix[:3, :3], matrix[:3, 3] = axes, middle + back * distance
    return CameraModel(
        kind="perspective", matrix=tuple(float(v) for v in matrix.ravel()), fov_y=_FIELD, image_size=(side, side)
    )
