# SPDX-License-Identifier: GPL-3.0-or-later
"""The reference image inside the .blend: its normalised bytes are packed into an image datablock, so that a room can
be resumed after save and load, on another computer, with the picture's file gone."""

from __future__ import annotations

import hashlib
import io
from pathlib import Path
from typing import Any

import bpy
import numpy as np
from PIL import Image

from ..pipeline.errors import PictureError, RoomError
from ..pipeline.picture import ReferencePicture, read_picture

_MARK = "code_as_room_reference"
_SUFFIX = {b"\x89P": ".png", b"\xff\xd8": ".jpg"}


def keep_picture(scene: Any, picture: ReferencePicture) -> None:
    """Make this the scene's reference image, packed."""
    settings = scene.code_as_room
    old = settings.picture
    stem = Path(picture.name).stem or "reference"
    image = bpy.data.images.new(f"Reference {stem}", picture.width, picture.height)
    image.filepath_raw = f"//{stem}{_SUFFIX.get(picture.data[:2], '.png')}"
    image.file_format = "JPEG" if picture.data[:2] == b"\xff\xd8" else "PNG"
    image.source = "FILE"
    image.pack(data=picture.data, data_len=len(picture.data))
    image[_MARK] = picture.sha256
    image.use_fake_user = False
    settings.picture, settings.picture_name = image, picture.name
    if old is not None and old.get(_MARK) and old.users == 0 and old.library is None:
        bpy.data.images.remove(old)


def picture_mark(scene: Any) -> str:
    """The hash that the scene's reference image was kept under, "" when there is none; cheap."""
    image = scene.code_as_room.picture
    return "" if image is None else str(image.get(_MARK, ""))


def kept_picture(scene: Any) -> ReferencePicture | None:
    """The scene's reference image, None when there is none.

    An image that was unpacked is read from its file, for as long as that was not changed.

    Raises:
        PictureError: the image is there, but its bytes are gone or were changed.
    """
    settings = scene.code_as_room
    image = settings.picture
    if image is None:
        return None
    known = picture_mark(scene)
    data = bytes(image.packed_file.data) if image.packed_file is not None else _unpacked(image)
    if not data or hashlib.sha256(data).hexdigest() != known:
        name = settings.picture_name or image.name
        what = "was changed" if data else "was unpacked, and its file is not there"
        raise PictureError(f"The reference image {name!r} {what}.", "Load the same picture again to go on.")
    width, height = _size(data)
    return ReferencePicture(settings.picture_name or image.name, width, height, data, known)


def missing(scene: Any) -> RoomError:
    """What to tell the artist when there is no reference image."""
    name = scene.code_as_room.picture_name
    if not name:
        return RoomError("There is no picture yet.", "Load a picture of a room first.")
    return PictureError(f"The picture {name!r} was removed from this file.", "Load the same picture again to go on.")


def pack_again(scene: Any) -> None:
    """Take a reference image that the artist unpacked back into the file, when its bytes are still the same."""
    image = scene.code_as_room.picture
    if image is None or image.library is not None or image.packed_file is not None:
        return
    data = _unpacked(image)
    if data and hashlib.sha256(data).hexdigest() == picture_mark(scene):
        image.pack(data=data, data_len=len(data))


def _unpacked(image: Any) -> bytes:
    """The bytes of an image's file, b"" when they cannot be read."""
    if not image.filepath:
        return b""
    try:
        return Path(bpy.path.abspath(image.filepath, library=image.library)).read_bytes()
    except (OSError, ValueError):
        return b""


def _size(data: bytes) -> tuple[int, int]:
    with Image.open(io.BytesIO(data)) as image:
        return image.width, image.height


def picture_of_image(image: Any) -> ReferencePicture:
    """An image that is open in Blender as a reference image.

    Raises:
        PictureError: it holds no pixels, or is too small.
    """
    name = Path(image.filepath or image.name).name or str(image.name)
    if image.packed_file is not None and not image.is_dirty:
        return read_picture(bytes(image.packed_file.data), name)
    path = Path(bpy.path.abspath(image.filepath, library=image.library)) if image.filepath else None
    if path is not None and image.source == "FILE" and not image.is_dirty and path.is_file():
        return read_picture(path.read_bytes(), name)
    return read_picture(_painted(image), name)


def _painted(image: Any) -> bytes:
    """PNG of an image that exists only in Blender's memory; its float pixels are scene-linear when it is a float image."""
    width, height = image.size
    if not width or not height:
        raise PictureError(f"The image {image.name!r} holds no pixels.", "Choose another image.")
    pixels = np.empty(width * height * image.channels, dtype=np.float32)
    image.pixels.foreach_get(pixels)
    rows = pixels.reshape(height, width, image.channels)[::-1]
    colour = rows[..., :3] if image.channels >= 3 else np.repeat(rows[..., :1], 3, axis=2)
    if image.is_float:
        linear = np.clip(colour, 0.0, 1.0)
        colour = np.where(linear <= 0.0031308, linear * 12.92, 1.055 * linear ** (1 / 2.4) - 0.055)
    buffer = io.BytesIO()
    Image.fromarray((np.clip(colour, 0, 1) * 255 + 0.5).astype(np.uint8)).save(buffer, "PNG")
    return buffer.getvalue()
