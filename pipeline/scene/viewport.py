# SPDX-License-Identifier: GPL-3.0-or-later
"""Drawing the studio through a 3D view that is open in a window: quicker than a render, and no render is started.

Blender draws off screen with the matrices that it is given, so where the artist looks does not matter. It needs some 3D
view all the same, and takes settings from it. Those that would show in the picture are changed for the length of the
draw; the view is not redrawn meanwhile, so the artist sees nothing of it.

The view is drawn as "Rendered" and the studio's engine is Workbench: so the look is that of `studio.py`, whatever
shading the artist has chosen, and a rendered preview of the artist's goes on.
"""

from __future__ import annotations

import contextlib
from collections.abc import Iterator
from typing import Any

import bpy
import gpu
import mathutils
import numpy as np
from PIL import Image

from ..artifacts.camera import CameraModel
from ..geometry.camera import Projector
from ..geometry.projection import projection_matrix, view_matrix

_NEAREST = 0.02  # metres


def open_view() -> tuple[Any, Any] | None:
    """The space and region of a 3D view in any window, None when none will do.

    In local view, and with collections shown for the view alone, Blender would leave out the studio's copies. Views in
    workspaces that are not shown are not used: Blender has not prepared them for drawing.
    """
    if bpy.app.background:
        return None
    managers = bpy.data.window_managers
    for window in managers[0].windows if managers else ():
        for area in window.screen.areas:
            space: Any = area.spaces.active if area.type == "VIEW_3D" else None
            if space is None or space.local_view is not None or space.use_local_collections:
                continue
            region = next((r for r in area.regions if r.type == "WINDOW" and r.data is not None), None)
            if region is not None:
                return space, region
    return None


def draw_in_view(
    view: tuple[Any, Any], stage: Any, camera: CameraModel, fine: bool, managed: bool = True
) -> Image.Image:
    """A studio's scene through a camera, in the studio's resolution, drawn in an open 3D view.

    Args:
        managed: in the screen's colours.

    Raises:
        RuntimeError: the graphics driver could not do it.
    """
    space, region = view
    layer = stage.view_layers[0]
    width, height = stage.render.resolution_x, stage.render.resolution_y
    stage.render.dither_intensity = 0.0  # noise that makes the file ten times larger
    if not fine:
        stage.display.render_aa = "OFF"  # it takes longer than all the rest
    stage.display.viewport_aa = stage.display.render_aa
    layer.update()  # without a scene evaluated with these settings, Blender 5.2 crashes in the draw
    matrices = [mathutils.Matrix(m.tolist()) for m in (view_matrix(camera), _projection(stage, camera))]
    card: Any = gpu  # the stubs know it badly
    offscreen = card.types.GPUOffScreen(width, height)
    try:
        with _neutral(space, region.data):
            offscreen.draw_view3d(stage, layer, space, region, *matrices, do_color_management=managed)
        with offscreen.bind():
            buffer = card.state.active_framebuffer_get().read_color(0, 0, width, height, 4, 0, "UBYTE")
    finally:
        offscreen.free()
    buffer.dimensions = 4 * width * height
    rows = np.frombuffer(buffer, dtype=np.uint8).reshape(height, width, 4)
    return Image.fromarray(np.ascontiguousarray(rows[::-1, :, :3]))  # a graphics card's first row is the lowest


def _projection(stage: Any, camera: CameraModel) -> Any:
    """The projection whose depths hold everything in the studio."""
    lens = Projector.of(camera)
    depths = [np.zeros(1)]
    for obj in stage.collection.objects:
        if obj.type == "MESH":
            matrix = np.array(obj.matrix_world, dtype=float)
            corners = np.array(obj.bound_box, dtype=float) @ matrix[:3, :3].T + matrix[:3, 3]
            depths.append(lens.depth(corners))
    found = np.concatenate(depths[1:] or depths)
    nearest, farthest = float(found.min()), float(found.max())
    margin = 0.05 * (farthest - nearest) + 0.1
    near = max(_NEAREST, nearest - margin) if lens.perspective else nearest - margin
    return projection_matrix(camera, near, max(near, farthest) + margin)


@contextlib.contextmanager
def _neutral(space: Any, data: Any) -> Iterator[None]:
    """Inside the `with` block, nothing of the artist's view shows in what is drawn with it."""
    wanted = [
        (space.shading, "type", "RENDERED"),
        (space.shading, "use_compositor", "DISABLED"),
        (space.overlay, "show_overlays", False),
        (space, "show_object_viewport_mesh", True),
        (space, "use_render_border", False),
        (data, "use_clip_planes", False),
    ]
    changed = []
    try:
        for owner, name, value in wanted:
            before = getattr(owner, name, value)
            if before != value:
                changed.append((owner, name, before))
                setattr(owner, name, value)
        yield
    finally:
        for owner, name, before in reversed(changed):
            setattr(owner, name, before)
