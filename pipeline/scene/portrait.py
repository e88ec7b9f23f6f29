# SPDX-License-Identifier: GPL-3.0-or-later
"""Pictures of one object that is not in the room, through cameras in its own frame, side by side.

The window waits for them, so they are made as cheaply as can be: one mesh without textures' coordinates and without
materials, painted once, one studio for both views, and quickly compressed.
"""

from __future__ import annotations

import io
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import bpy
import numpy as np
from PIL import Image

from ..artifacts.camera import CameraModel
from ..program.prelude.palette import role_colour
from ..program.prelude.shape import Shape
from .arrays import mesh_arrays
from .capture import draw_stage
from .lenses import write_camera
from .meshes import write_arrays
from .paint import paint_faces
from .studio import studio

_NAME = "Code-as-Room Portrait"
_QUICK = 3  # compression


def portrait(shapes: Sequence[Shape], family: str, cameras: Sequence[CameraModel]) -> bytes:
    """PNG of an object through each camera. Nothing stays behind. Raises SceneError when nothing can draw."""
    mesh = bpy.data.meshes.new(_NAME)
    obj = bpy.data.objects.new(_NAME, mesh)
    try:
        _write(mesh, shapes, family)
        with studio([], cameras[0], max(cameras[0].image_size)) as stage:
            stage.collection.objects.link(obj)
            pictures = [_view(stage, camera) for camera in cameras]
    finally:
        bpy.data.objects.remove(obj)
        bpy.data.meshes.remove(mesh)
    page = Image.new("RGB", (sum(p.width for p in pictures), max(p.height for p in pictures)), "white")
    at = 0
    for picture in pictures:
        page.paste(picture, (at, 0))
        at += picture.width
    buffer = io.BytesIO()
    page.save(buffer, "PNG", compress_level=_QUICK)
    return buffer.getvalue()


def _write(mesh: Any, shapes: Sequence[Shape], family: str) -> None:
    """The shapes' faces in their roles' colours; the dearest parts of a room's mesh, UVs and materials, are left out."""
    arrays = mesh_arrays(list(shapes), unwrap=False)
    write_arrays(mesh, replace(arrays, roles=(), slots=np.zeros_like(arrays.slots)), family, "")
    palette = np.array([role_colour(role, family)[:3] for role in arrays.roles]).reshape(-1, 3)
    if len(arrays.starts):
        paint_faces(mesh, palette[arrays.slots], np.eye(3))


def _view(stage: Any, camera: CameraModel) -> Image.Image:
    """What the stage shows through another camera."""
    line = camera.model_dump() | {"principal": (camera.principal.x, camera.principal.y)}
    write_camera(stage.camera.data, line)
    stage.camera.matrix_basis = np.array(camera.matrix, dtype=float).reshape(4, 4).T.tolist()
    drawn, _ = draw_stage(stage, camera)
    return drawn if isinstance(drawn, Image.Image) else Image.open(io.BytesIO(drawn)).convert("RGB")
