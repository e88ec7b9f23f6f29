# SPDX-License-Identifier: GPL-3.0-or-later
"""Small bright pictures of shapes as the add-on builds them, each fitted into its frame. For sheets in documentation."""

from __future__ import annotations

import tempfile
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import bpy
import numpy as np
from code_as_room.pipeline.program.prelude.shape import Shape
from code_as_room.pipeline.scene.arrays import mesh_arrays
from code_as_room.pipeline.scene.compat import quiet
from code_as_room.pipeline.scene.meshes import write_arrays
from mathutils import Vector
from PIL import Image

BACKGROUND = 0.88
_EXPOSURE = 1.0
_MARGIN = 1.06
Direction = tuple[float, float, float]


class Photographs:
    """An empty scene with a camera and even light, in which one set of shapes after the other is drawn.

    Args:
        size: of every picture, pixels.
    """

    def __init__(self, size: tuple[int, int]) -> None:
        bpy.ops.wm.read_factory_settings(use_empty=True)
        scene: Any = bpy.context.scene
        self.scene, self.size = scene, size
        scene.render.engine = "BLENDER_WORKBENCH"
        scene.render.resolution_x, scene.render.resolution_y = size
        scene.world = bpy.data.worlds.new("grey")
        scene.world.color = (BACKGROUND**2.2 / 2**_EXPOSURE,) * 3
        scene.view_settings.view_transform = "Standard"
        scene.view_settings.exposure = _EXPOSURE
        scene.display.render_aa = "8"
        shading = scene.display.shading
        shading.light, shading.studio_light, shading.color_type = "STUDIO", "Default", "MATERIAL"
        shading.show_specular_highlight = False
        shading.show_cavity, shading.cavity_type = True, "SCREEN"
        shading.show_shadows, shading.shadow_intensity = True, 0.25
        scene.display.light_direction = (-0.45, -0.35, 0.8)
        self.camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
        self.camera.data.type = "ORTHO"
        scene.collection.objects.link(self.camera)
        scene.camera = self.camera

    def take(self, shapes: list[Shape], family: str, views: Iterable[Direction]) -> list[Image.Image]:
        """One picture from each direction (from the shapes towards the camera)."""
        mesh = bpy.data.meshes.new("shapes")
        write_arrays(mesh, mesh_arrays(shapes), family, "")
        obj = bpy.data.objects.new("shapes", mesh)
        self.scene.collection.objects.link(obj)
        points = np.concatenate([shape.vertices for shape in shapes])
        try:
            with tempfile.TemporaryDirectory() as folder:
                return [self._picture(points, Vector(view).normalized(), Path(folder) / "view.png") for view in views]
        finally:
            bpy.data.objects.remove(obj)
            bpy.data.meshes.remove(mesh)

    def _picture(self, points: Any, direction: Vector, path: Path) -> Image.Image:
        turn = (-direction).to_track_quat("-Z", "Y").to_matrix()
        seen = points @ np.array(turn)  # in the camera's axes
        low, high = seen.min(axis=0), seen.max(axis=0)
        width, height = high[0] - low[0], high[1] - low[1]
        aspect = self.size[0] / self.size[1]
        data = self.camera.data
        data.ortho_scale = _MARGIN * max(width, height * aspect, 1e-3)
        deep = float(high[2] - low[2]) + 1.0
        middle = np.array([(low[0] + high[0]) / 2, (low[1] + high[1]) / 2, high[2] + deep])
        self.camera.matrix_world = turn.to_4x4()
        self.camera.location = Vector(np.array(turn) @ middle)
        data.clip_start, data.clip_end = 0.01, 4 * deep
        self.scene.render.filepath = str(path)
        with quiet():
            bpy.ops.render.render(write_still=True)
        with Image.open(path) as image:
            return image.convert("RGB")
