# SPDX-License-Identifier: GPL-3.0-or-later
"""Pictures of the room as it stands in the scene: through the reference camera, and from a corner for people."""

from __future__ import annotations

import io
import logging
import os
import tempfile
from dataclasses import dataclass
from typing import Any

import bpy
from PIL import Image

from ..artifacts.camera import CameraModel
from ..errors import SceneError
from .compat import ensure_gpu, quiet
from .graphics import can_draw
from .labels import draw_labels, object_labels
from .studio import cycles, studio, visible_objects
from .tags import find_room_collection
from .viewpoint import corner_camera
from .viewport import draw_in_view, open_view

log = logging.getLogger(__name__)
_QUICK = 3
"""Compression of pictures that the window waits for."""


@dataclass(frozen=True)
class Picture:
    """PNG bytes, and what drew them.

    Attributes:
        method: "viewport" (Workbench in an open 3D view), "workbench" (a render, where there is none) or "cycles" (the
            fallback without a graphics driver).
    """

    png: bytes
    method: str


def capture(
    scene: Any, camera: CameraModel, long_side: int = 1024, labels: bool = False, fine: bool = False
) -> Picture:
    """What stands in the room's collection, through a camera, in the aspect of its `image_size`.

    The scene that is given is not changed. `labels` writes each proxy's id at its projected centre; `fine` takes
    longer and looks better.

    Raises:
        SceneError: there is no room in the scene, or nothing could draw it.
    """
    room = _room(scene)
    with studio(visible_objects(room), camera, long_side, fine) as stage:
        drawn, method = _draw(stage, camera, fine)
    if not labels:
        return _picture(drawn, method)
    image = drawn if isinstance(drawn, Image.Image) else Image.open(io.BytesIO(drawn)).convert("RGB")
    draw_labels(image, object_labels(room, camera))
    return _picture(image, method)


def eye_view(scene: Any, long_side: int = 1280) -> Picture:
    """A raised view into the room from the corner that hides least, near walls cut down. Raises SceneError."""
    room = _room(scene)
    objects = visible_objects(room)
    camera = corner_camera(objects)
    with studio(objects, camera, long_side, fine=True) as stage:
        return _picture(*_draw(stage, camera, fine=True))


def draw_stage(stage: Any, camera: CameraModel) -> tuple[Image.Image | bytes, str]:
    """What a studio's stage shows, as an image or as encoded bytes, and what drew it. Raises SceneError."""
    return _draw(stage, camera, fine=False)


def _room(scene: Any) -> Any:
    room = find_room_collection(scene)
    if room is None or not visible_objects(room):
        raise SceneError("There is no room in this scene yet.", "Run the layout stage first.")
    return room


def _draw(stage: Any, camera: CameraModel, fine: bool) -> tuple[Image.Image | bytes, str]:
    """Draw in an open 3D view; without one, render with Workbench; without a graphics driver, with Cycles."""
    view = open_view()
    if view is not None:
        try:
            return draw_in_view(view, stage, camera, fine), "viewport"
        except (RuntimeError, SystemError, ValueError, TypeError) as error:
            log.warning("The 3D view could not draw the room, so it is rendered: %s", error)
    problem = "there is no graphics driver"
    if can_draw():
        try:
            ensure_gpu()
            return _rendered(stage), "workbench"
        except (RuntimeError, OSError, SystemError) as error:
            problem = str(error).strip() or type(error).__name__
    try:
        with cycles(stage):
            return _rendered(stage), "cycles"
    except (RuntimeError, OSError, TypeError, AttributeError) as error:
        raise SceneError(
            f"Blender could not draw the room: Workbench: {problem}; Cycles: {str(error).strip()}.",
            "Install a graphics driver; on a Linux without one, Mesa's EGL (libegl1 and libgl1-mesa-dri).",
        ) from error


def _rendered(stage: Any) -> bytes:
    """Render the stage to a temporary file and read it."""
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "picture.png")
        stage.render.filepath = path
        with quiet():
            bpy.ops.render.render(write_still=True, scene=stage.name)
        with open(path, "rb") as file:
            data = file.read()
    if not data:
        raise RuntimeError("the picture is empty")
    return data


def _picture(drawn: Image.Image | bytes, method: str) -> Picture:
    """What was drawn as PNG. Nobody waits for a render to be made small, but Blender's window for its own drawing."""
    if isinstance(drawn, bytes):
        return Picture(drawn, method)
    buffer = io.BytesIO()
    if method == "viewport":
        drawn.save(buffer, "PNG", compress_level=_QUICK)
    else:
        drawn.save(buffer, "PNG")
    return Picture(buffer.getvalue(), method)
