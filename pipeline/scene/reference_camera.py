# SPDX-License-Identifier: GPL-3.0-or-later
"""The camera object that the reference image was seen through, with the picture as its background image.

Before the program has been built it is a stand-in: tagged as the program's camera line "reference" will be, but without
the digest of a line. So the first build takes it over instead of making another one, and reading the scene back takes
it neither for the artist's nor for a line of the program.
"""

from __future__ import annotations

from typing import Any

import bpy
import numpy as np

from ..artifacts.camera import CameraModel
from ..geometry.camera import camera_straight_down
from .lenses import write_camera
from .tags import FIELD, ID, KIND, LINE, NAME, ensure_collections, find_room_collection

REFERENCE = "reference"  # the id of the camera line
IMAGE_MARK = "code_as_room_reference"  # on images: the hash of the reference image that they hold
_SIZE = FIELD + "image_size"  # on the camera object: pixels of the picture, which its frame has the aspect of
_ASSUMED_WIDTH = 5.0  # metres that a picture of a room spans, before anything is known
_DISPLAY_SIZE = 0.4  # metres; Blender's camera symbol is as large as a room otherwise
_TOLERANCE = 1e-6


def stand_in_camera(image_size: tuple[int, int]) -> CameraModel:
    """An orthographic camera that looks straight down on a picture which spans 5 m, centred on the origin."""
    width, height = image_size
    depth = _ASSUMED_WIDTH * height / width
    return camera_straight_down("orthographic", _ASSUMED_WIDTH, depth, image_size, margin=0.0)


def find_reference_camera(scene: Any) -> Any | None:
    """The camera object of this scene's room, None when there is none. Cheap enough to be called while drawing."""
    room = find_room_collection(scene)
    if room is None:
        return None
    found = [obj for obj in room.all_objects if obj.type == "CAMERA" and obj.get(KIND) == "camera"]
    found.sort(key=lambda o: (o.get(ID) != REFERENCE, LINE not in o, o.get(NAME) != o.name, o.session_uid))
    return found[0] if found else None


def is_stand_in(obj: Any) -> bool:
    """Whether no program has been built with this camera yet, so that it may be moved."""
    return LINE not in obj


def ensure_reference_camera(scene: Any, collection_name: str, camera: CameraModel) -> Any:
    """The room's reference camera; a stand-in is made where there is none, and put where `camera` is.

    The program's own camera stays as it was built: its line says where it is, and the layout that stands fits it.
    It becomes the scene's camera when the scene has none.
    """
    obj = find_reference_camera(scene)
    if obj is None:
        data = bpy.data.cameras.new(REFERENCE)
        data.display_size = _DISPLAY_SIZE
        obj = bpy.data.objects.new(REFERENCE, data)
        obj[ID], obj[KIND], obj[NAME] = REFERENCE, "camera", obj.name
        ensure_collections(scene, collection_name)["cameras"].objects.link(obj)
    if is_stand_in(obj):
        _put(obj, camera)
    if list(obj.get(_SIZE, ())) != list(camera.image_size):
        obj[_SIZE] = list(camera.image_size)
    if scene.camera is None:
        scene.camera = obj
    return obj


def _put(obj: Any, camera: CameraModel) -> None:
    """Give the object the camera's lens and place, without touching it when it has them."""
    line = camera.model_dump()
    line["principal"] = (camera.principal.x, camera.principal.y)
    write_camera(obj.data, line)
    matrix = np.array(camera.matrix, dtype=float).reshape(4, 4)
    if np.abs(np.array(obj.matrix_basis, dtype=float) - matrix).max() > _TOLERANCE:
        obj.matrix_basis = matrix.T.tolist()  # Blender takes columns


def show_picture(obj: Any, image: Any | None, opacity: float, in_front: bool) -> None:
    """Make an image the camera's background; background images of the artist stay.

    Args:
        image: None takes our image away.
        opacity: 0 to 1.
        in_front: over the layout instead of under it.
    """
    backgrounds = obj.data.background_images
    ours = [b for b in backgrounds if b.source == "IMAGE" and b.image is not None and b.image.get(IMAGE_MARK)]
    for extra in ours[1:] if image is not None else ours:
        backgrounds.remove(extra)
    if image is None:
        return
    ours = ours[:1] or [backgrounds.new()]
    background = ours[0]
    if background.image != image:
        background.image = image
    background.alpha = opacity
    background.display_depth = "FRONT" if in_front else "BACK"
    background.show_on_foreground = in_front
    background.frame_method = "FIT"
    obj.data.show_background_images = True


def picture_size(obj: Any) -> tuple[int, int] | None:
    """Pixels of the picture that the camera's frame shows, None where it was never said."""
    size = obj.get(_SIZE)
    return None if size is None else (int(size[0]), int(size[1]))


def frame_corners(obj: Any, aspect: float) -> Any:
    """The picture's corners in the camera's view, in the world, one unit in front of it: (4, 3).

    In the order top left, top right, bottom right, bottom left. They do not depend on the scene's render resolution.

    Args:
        aspect: width of the picture over its height.
    """
    data = obj.data
    height = data.ortho_scale if data.type == "ORTHO" else data.sensor_height / data.lens
    width = height * aspect
    left, right = data.shift_x * height - width / 2, data.shift_x * height + width / 2
    top, bottom = data.shift_y * height + height / 2, data.shift_y * height - height / 2
    local = np.array([(left, top, -1.0), (right, top, -1.0), (right, bottom, -1.0), (left, bottom, -1.0)])
    matrix = np.array(obj.matrix_world, dtype=float)
    turned = matrix[:3, :3] / np.maximum(np.linalg.norm(matrix[:3, :3], axis=0), 1e-12)  # cameras have no scale
    return local @ turned.T + matrix[:3, 3]
