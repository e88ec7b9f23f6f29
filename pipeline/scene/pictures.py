# SPDX-License-Identifier: GPL-3.0-or-later
"""The images that a room's looks show: ours, packed into the file and known by a mark, or the artist's by their names.

Ours are called by surface and content, so the image of a name never changes. A name that belongs to an image of the
artist's is left to it: ours then gets Blender's number behind its name, and is found by its mark all the same.

This module is also inlined in `room.py`, which takes images that the file lacks from the folder beside itself.
"""

from __future__ import annotations

import os
from typing import Any

import bpy

from ..program.prelude.image_files import IMAGE_FOLDER, image_file

IMAGE = "code_as_room_image"  # on our images: the name that programs call them by
STANDS_IN = "code_as_room_stands_in"  # on those of one plain colour, for an image that is not there


def find_image(name: str, stands_in: bool = False) -> Any:
    """The image that programs call by this name, None when the file has none.

    Args:
        stands_in: one of a plain colour that stands for a missing one counts too.
    """
    images: Any = bpy.data.images
    own = [i for i in images if i.get(IMAGE) == name and i.library is None]
    found = next((image for image in own if STANDS_IN not in image), None) or images.get(name)
    if found is not None and STANDS_IN not in found:
        return found
    return own[0] if stands_in and own else None


def ensure_image(name: str, colour: tuple[float, float, float]) -> Any:
    """As `find_image`; what is missing is taken from the folder beside the program or the file, else a plain colour.

    Args:
        colour: linear, of the image that stands for a missing one.
    """
    return find_image(name) or _from_file(name) or find_image(name, True) or _plain(name, colour)


def mark(image: Any, name: str) -> None:
    """From now on it is ours, and found by this name."""
    image[IMAGE] = name
    image.filepath_raw = f"//{IMAGE_FOLDER}/{image_file(name)}"


def _from_file(name: str) -> Any:
    # Of a program that is run as a file, its own path; in Blender's Text Editor, that of the .blend and the text's name.
    own = os.path.dirname(str(globals().get("__file__", "")))
    beside = bpy.path.abspath("//") if bpy.data.filepath else ""
    for folder in (own, beside):
        path = os.path.join(folder, IMAGE_FOLDER, image_file(name))
        if folder and os.path.isfile(path):
            image = bpy.data.images.load(path)
            if not image.size[0]:  # bytes that are no image
                bpy.data.images.remove(image)
                continue
            image.pack()
            image.name = name
            mark(image, name)
            return image
    return None


def _plain(name: str, colour: tuple[float, float, float]) -> Any:
    """An image of one colour."""
    image = bpy.data.images.new(name, 8, 8)
    image.generated_color = (*(12.92 * c if c <= 0.0031308 else 1.055 * c ** (1 / 2.4) - 0.055 for c in colour), 1.0)
    image[IMAGE], image[STANDS_IN] = name, True
    return image
