# SPDX-License-Identifier: GPL-3.0-or-later
"""Keeps the images of rooms inside the .blend, and gives them back as PNG files. Main thread only."""

from __future__ import annotations

import hashlib
import io
import logging
from collections.abc import Collection, Mapping
from pathlib import Path
from typing import Any

import bpy
import numpy as np
from PIL import Image

from .pictures import IMAGE, STANDS_IN, find_image, mark

log = logging.getLogger(__name__)
_DIGEST = "code_as_room_sha256"  # on our images: of the bytes that we packed
_PNG = b"\x89PNG"


def keep_images(images: Mapping[str, bytes]) -> None:
    """As `ImageKeeper.keep_images`. Images have a fake user until something shows them, so that saving keeps them."""
    for name, data in images.items():
        _keep(name, data)
    ours: Any = bpy.data.images
    for image in ours:
        if IMAGE in image and image.library is None and image[IMAGE] not in images and image.use_fake_user:
            image.use_fake_user = False


def has_images(names: Collection[str]) -> bool:
    """As `ImageKeeper.has_images`."""
    return all(find_image(name) is not None for name in names)


def kept_images(names: Collection[str]) -> dict[str, bytes]:
    """As `ImageKeeper.kept_images`; images of the artist's that a program shows are among them."""
    found = {name: _png(image) for name in names if (image := find_image(name)) is not None}
    return {name: data for name, data in found.items() if data}


def _keep(name: str, data: bytes) -> None:
    """Pack one image, and let it be shown wherever the former one of that name, or its stand-in, was."""
    digest = hashlib.sha256(data).hexdigest()
    former: list[Any] = [i for i in bpy.data.images if i.get(IMAGE) == name and i.library is None]
    for image in former:
        if image.get(_DIGEST) == digest and STANDS_IN not in image and image.packed_file is not None:
            image.use_fake_user = True
            return
    # A new datablock: what an image showed before may stay in Blender's caches over a change of its bytes, and an undo.
    with Image.open(io.BytesIO(data)) as size:
        image = bpy.data.images.new(name, *size.size)
    mark(image, name)
    image.file_format = "PNG"
    image.source = "FILE"
    image.pack(data=data, data_len=len(data))
    image[_DIGEST] = digest
    image.use_fake_user = True
    for old in former:
        old.user_remap(image)
        bpy.data.images.remove(old)
    if former and image.name != name and name not in bpy.data.images:
        image.name = name


def _png(image: Any) -> bytes:
    """An image as a PNG file; b"" where it has no pixels."""
    data = _bytes(image)
    if data.startswith(_PNG):
        return data
    buffer = io.BytesIO()
    try:
        if data:
            with Image.open(io.BytesIO(data)) as other:
                other.convert("RGBA" if "A" in other.getbands() else "RGB").save(buffer, "PNG")
        else:
            _of_pixels(image).save(buffer, "PNG")
    except Exception as error:  # whatever Pillow raises on what is no image to it
        log.info("%s cannot be written as PNG: %s", image.name, error)
        return b""
    return buffer.getvalue()


def _bytes(image: Any) -> bytes:
    """The bytes of its file, packed or not; b"" where it has none, or was painted on since."""
    if image.is_dirty or image.source != "FILE":
        return b""
    if image.packed_file is not None:
        return bytes(image.packed_file.data)
    try:
        return Path(bpy.path.abspath(image.filepath, library=image.library)).read_bytes()
    except (OSError, ValueError):
        return b""


def _of_pixels(image: Any) -> Image.Image:
    width, height = image.size
    pixels = np.empty(width * height * image.channels, dtype=np.float32)
    image.pixels.foreach_get(pixels)
    rows = pixels.reshape(height, width, image.channels)[::-1]
    colour = rows[..., :3] if image.channels >= 3 else np.repeat(rows[..., :1], 3, axis=2)
    return Image.fromarray((np.clip(colour, 0, 1) * 255 + 0.5).astype(np.uint8))
