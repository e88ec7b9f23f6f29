# SPDX-License-Identifier: GPL-3.0-or-later
"""Looking through the room's reference camera, and where the points of the picture are in the viewport then.

The mapping goes by what Blender draws: the view's own matrices and the picture's corners in front of the camera.
So it holds for every zoom and pan of the camera view, for lens shift, and for any render resolution of the scene.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import bpy
import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..pipeline.artifacts.analysis import Calibration
from ..pipeline.errors import RoomError, SceneError
from ..pipeline.scene.backend import COLLECTION
from ..pipeline.scene.reference_camera import (
    ensure_reference_camera,
    find_reference_camera,
    frame_corners,
    picture_size,
    show_picture,
    stand_in_camera,
)
from ..pipeline.scene.tags import find_room_collection
from . import room_memory
from .base import RoomOperator, allow

Points = NDArray[np.float64]
_MARGIN = 14.0
"""Pixels that are kept free around the picture when it is fitted into the view."""
_SMALLEST_FIT = 80.0


@dataclass(frozen=True)
class _Former:
    """How a 3D view stood before it looked through the camera; plain values, kept by the address of its space."""

    perspective: str
    location: tuple[float, ...]
    rotation: tuple[float, ...]
    distance: float
    zoom: float
    offset: tuple[float, ...]
    local_camera: bool
    camera: str
    lock_camera: bool


@dataclass(frozen=True)
class _View:
    """A 3D view for the length of one call."""

    window: Any
    area: Any
    region: Any
    space: Any
    data: Any


_former: dict[int, _Former] = {}


def follow(scene: Any) -> None:
    """Let the scene have its reference camera, where the fit says, with the picture as its background.

    Called when a picture was loaded, when a stage or a correction may have fitted the camera, and before looking
    through it. Without a picture there is no camera, and nothing is done. Main thread, inside the caller's undo step.
    """
    settings = scene.code_as_room
    image = settings.picture
    if image is None or _is_linked(scene):
        return
    size = (int(image.size[0]), int(image.size[1]))
    calibration = _calibration(scene)
    if calibration is not None:
        camera = calibration.camera
    elif min(size) > 0:
        camera = stand_in_camera(size)
    else:
        return  # the image is gone; the panel says so
    obj = ensure_reference_camera(scene, COLLECTION, camera)
    show_picture(obj, image, settings.reference_opacity, settings.reference_in_front)


def _is_linked(scene: Any) -> bool:
    """Whether the room or its camera belongs to another file, which nothing is written to."""
    room, camera = find_room_collection(scene), find_reference_camera(scene)
    owners = [scene, room, camera, camera.data if camera is not None else None]
    return any(o is not None and (o.library is not None or o.override_library is not None) for o in owners)


def show_background(scene: Any) -> None:
    """Give the camera's background image the opacity and depth that the settings say."""
    settings, obj = scene.code_as_room, find_reference_camera(scene)
    if obj is not None and settings.picture is not None and not _is_linked(scene):
        show_picture(obj, settings.picture, settings.reference_opacity, settings.reference_in_front)


def _calibration(scene: Any) -> Calibration | None:
    try:
        return room_memory.memory_of(scene).latest(Calibration)
    except RoomError:
        return None  # the panel tells of a broken memory


def look_through(context: Any) -> None:
    """Show the 3D view of the context (else the largest one) through the reference camera, fitted into the view.

    The scene's render resolution becomes the picture's, so that the camera's frame is the picture's.

    Raises:
        SceneError: there is no picture, or no 3D view.
    """
    scene = context.scene
    if scene.code_as_room.picture is None:
        raise SceneError("There is no picture to look at yet.", "Load a picture of a room first.")
    view = _view(context)
    if view is None:
        raise SceneError("There is no 3D view in this window.", "Open one, then look through the camera there.")
    follow(scene)
    camera = find_reference_camera(scene)
    if camera is None:
        raise SceneError("The picture's pixels are not there any more.", "Load the picture again.")
    _frame_the_picture(scene, camera)
    if not _looks_through(view, scene, camera):
        _remember(view)
    space = view.space
    space.lock_camera = False  # or every turn of the view would turn the camera
    if scene.camera != camera:
        space.use_local_camera = True
        space.camera = camera
    else:
        space.use_local_camera = False
    view.data.view_perspective = "CAMERA"
    context.view_layer.update()
    _fit_into_view(view, scene, camera)
    view.area.tag_redraw()


def look_back(context: Any) -> None:
    """Give the 3D view back the view that it had before it looked through the camera."""
    view = _view(context)
    if view is None:
        return
    former = _former.pop(view.space.as_pointer(), None)
    data, space = view.data, view.space
    if former is None:
        data.view_perspective = "PERSP"
    else:
        data.view_perspective = former.perspective
        data.view_location, data.view_rotation = former.location, former.rotation
        data.view_distance = former.distance
        data.view_camera_zoom, data.view_camera_offset = former.zoom, former.offset
        space.lock_camera = former.lock_camera
        space.use_local_camera = former.local_camera
        if former.local_camera:
            space.camera = context.scene.objects.get(former.camera)
    data.update()
    view.area.tag_redraw()


def is_looking_through(context: Any) -> bool:
    """Whether the 3D view of the context shows the picture through the room's reference camera. Cheap."""
    view = _view(context)
    scene = context.scene
    if view is None or scene is None or scene.code_as_room.picture is None:
        return False
    return view.data.view_perspective == "CAMERA" and _looks_through(view, scene, find_reference_camera(scene))


def picture_to_region(context: Any, points: ArrayLike) -> Points | None:
    """Where points of the picture are in the 3D view.

    Args:
        points: (N, 2), 0-1000 of the picture's width and height, x right, y down; they may lie outside.

    Returns:
        (N, 2) pixels of the view's WINDOW region from its lower left corner, y up (as `event.mouse_region_x`);
        None when the view does not look through the reference camera.
    """
    frame = _frame(context)
    if frame is None:
        return None
    origin, scale = frame
    result: Points = origin + np.asarray(points, dtype=float).reshape(-1, 2) * scale
    return result


def region_to_picture(context: Any, points: ArrayLike) -> Points | None:
    """The inverse of `picture_to_region`: pixels of the WINDOW region (N, 2) to 0-1000 of the picture (N, 2)."""
    frame = _frame(context)
    if frame is None:
        return None
    origin, scale = frame
    result: Points = (np.asarray(points, dtype=float).reshape(-1, 2) - origin) / scale
    return result


def _frame(context: Any) -> tuple[Points, Points] | None:
    """Region pixels of the picture's upper left corner, and pixels for a thousandth of its width and height."""
    view = _view(context)
    scene = context.scene
    if view is None or scene is None or view.data.view_perspective != "CAMERA":
        return None
    camera = find_reference_camera(scene)
    if not _looks_through(view, scene, camera):
        return None
    spots = _corners(view, scene, camera)
    return None if spots is None else (spots[0], (spots[1] - spots[0]) / 1000.0)


def _corners(view: _View, scene: Any, camera: Any) -> Points | None:
    """Region pixels of the picture's upper left and lower right corner, (2, 2)."""
    picture = scene.code_as_room.picture
    size = picture_size(camera) or (None if picture is None else tuple(picture.size))
    if size is None or not min(size) > 0:
        return None
    first, _, last, _ = frame_corners(camera, size[0] / size[1])
    return _projected(np.stack([first, last]), view)


def _fit_into_view(view: _View, scene: Any, camera: Any) -> None:
    """Zoom and pan the camera view so that the whole picture is seen between toolbar and sidebar."""
    data = view.data
    data.view_camera_zoom, data.view_camera_offset = 0.0, (0.0, 0.0)
    data.update()
    before = _corners(view, scene, camera)
    low, high = _free_part(view)
    if before is None or (high - low).min() < _SMALLEST_FIT:
        return
    scale = float(((high - low) / np.abs(before[1] - before[0])).min())
    # Blender's zoom z makes the frame (sqrt(2) + z / 50)^2 / 4 times as large as the view; it is 1/2 at z = 0.
    zoom = 50.0 * (2.0 * math.sqrt(scale / 2.0) - math.sqrt(2.0))
    data.view_camera_zoom = min(600.0, max(-30.0, zoom))
    data.update()
    middle = _middle(view, scene, camera)
    data.view_camera_offset = (0.1, 0.1)
    data.update()
    step = (_middle(view, scene, camera) - middle) / 0.1  # pixels for a whole offset
    data.view_camera_offset = tuple(((low + high) / 2 - middle) / np.where(np.abs(step) < 1e-6, 1.0, step))
    data.update()


def _middle(view: _View, scene: Any, camera: Any) -> Points:
    corners = _corners(view, scene, camera)
    return np.zeros(2) if corners is None else corners.mean(axis=0)


def _free_part(view: _View) -> tuple[Points, Points]:
    """The corners of the part of the view's region that no toolbar, sidebar or header covers, region pixels."""
    region = view.region
    low, high = np.zeros(2), np.array((region.width, region.height), dtype=float)
    for other in view.area.regions:
        left, bottom = other.x - region.x, other.y - region.y
        right = left + other.width
        if other.width < 2 or other.height < 2 or left >= region.width or right <= 0:
            continue
        if other.type == "TOOLS":
            low[0] = max(low[0], right)
        elif other.type == "UI":
            high[0] = min(high[0], left)
        elif other.type in ("HEADER", "TOOL_HEADER") and bottom > region.height / 2:
            high[1] = min(high[1], bottom)
    return low + _MARGIN, high - _MARGIN


def _projected(points: Points, view: _View) -> Points:
    """World points (N, 3) in front of the view, as pixels of its region (N, 2)."""
    matrix = np.array(view.data.perspective_matrix, dtype=float)
    flat = points @ matrix[:, :3].T + matrix[:, 3]
    half = np.array((view.region.width, view.region.height), dtype=float) / 2
    result: Points = half + half * flat[:, :2] / flat[:, 3:]
    return result


def _looks_through(view: _View, scene: Any, camera: Any) -> bool:
    """Whether the view's camera, where it looks through one, is this one."""
    if camera is None or view.data.view_perspective != "CAMERA":
        return False
    shown = view.space.camera if view.space.use_local_camera else scene.camera
    return bool(shown == camera)


def _remember(view: _View) -> None:
    data, space = view.data, view.space
    before = _former.get(space.as_pointer())  # the artist turned the view away and comes back
    _former[space.as_pointer()] = _Former(
        perspective=data.view_perspective,
        location=tuple(data.view_location),
        rotation=tuple(data.view_rotation),
        distance=data.view_distance,
        zoom=data.view_camera_zoom,
        offset=tuple(data.view_camera_offset),
        local_camera=space.use_local_camera if before is None else before.local_camera,
        camera=(space.camera.name if space.camera is not None else "") if before is None else before.camera,
        lock_camera=space.lock_camera if before is None else before.lock_camera,
    )


def forget_views() -> None:
    """Another file is opened: addresses of its views may be those of the old ones."""
    _former.clear()


def _frame_the_picture(scene: Any, camera: Any) -> None:
    size = picture_size(camera)
    render = scene.render
    if size is not None and (render.resolution_x, render.resolution_y) != size:
        render.resolution_x, render.resolution_y = size
    render.pixel_aspect_x = render.pixel_aspect_y = 1.0


def _view(context: Any) -> _View | None:
    """The 3D view of the context; else the largest one of its window, else of any window."""
    area = context.area
    if area is not None and area.type == "VIEW_3D":
        region = context.region
        of_area = region is not None and region.type == "WINDOW" and region.data is not None
        return _as_view(context.window, area, region if of_area else None)
    windows = [context.window] if context.window is not None else []
    windows += [w for w in context.window_manager.windows if w not in windows] if context.window_manager else []
    for window in windows:
        areas = [a for a in window.screen.areas if a.type == "VIEW_3D"]
        if areas and window.scene == context.scene:
            return _as_view(window, max(areas, key=lambda a: a.width * a.height), None)
    return None


def _as_view(window: Any, area: Any, region: Any) -> _View | None:
    space = area.spaces.active
    if region is None:
        windows = [r for r in area.regions if r.type == "WINDOW"]
        region = next((r for r in windows if r.data == space.region_3d), None)
    return None if region is None else _View(window, area, region, space, region.data)


class CODE_AS_ROOM_OT_look_through(RoomOperator):
    """Look at the room through the camera of the picture, or go back to the view from before.
    The scene's render resolution becomes the picture's, so that frame and picture are the same"""

    bl_idname = "code_as_room.look_through"
    bl_label = "Look Through Fitted Camera"
    bl_options = {"REGISTER"}  # no undo step where only the view changes

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """There must be a picture and a 3D view."""
        if bpy.app.background:
            return allow(cls, "There is no window to look at")
        settings: Any = context.scene
        return allow(cls, "" if settings.code_as_room.picture is not None else "Load a picture of a room first")

    def perform(self, context: bpy.types.Context) -> None:
        """Toggle."""
        if is_looking_through(context):
            look_back(context)
        else:
            before = _frame_of(context.scene)
            look_through(context)
            if _frame_of(context.scene) != before:
                bpy.ops.ed.undo_push(message=self.bl_label)


def _frame_of(scene: Any) -> tuple[Any, ...]:
    """What looking through the camera may change in the file."""
    render, camera = scene.render, find_reference_camera(scene)
    return (
        (render.resolution_x, render.resolution_y, render.pixel_aspect_x, render.pixel_aspect_y),
        None if camera is None else (camera.name, tuple(map(tuple, camera.matrix_basis)), picture_size(camera)),
    )


CLASSES = (CODE_AS_ROOM_OT_look_through,)
