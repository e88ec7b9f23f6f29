# SPDX-License-Identifier: GPL-3.0-or-later
"""Other ways for a picture into a room: dropped on the viewport, or pasted from the clipboard."""

from __future__ import annotations

import io
import logging
from pathlib import Path
from typing import Any
from urllib.parse import unquote, urlsplit

import bpy

from ..pipeline.errors import PictureError
from ..pipeline.picture import ReferencePicture, load_picture, read_picture
from . import driver, reference
from .base import RoomOperator, allow, manager
from .picture_ops import take_picture

log = logging.getLogger(__name__)
SUFFIXES = (".png", ".jpg", ".jpeg", ".webp", ".tif", ".tiff", ".bmp")
_LONGEST_PATH = 4096


class CODE_AS_ROOM_FH_picture(bpy.types.FileHandler):
    """Offers to make a picture that is dropped on a 3D view the picture of the room; Blender offers its own uses too."""

    bl_idname = "CODE_AS_ROOM_FH_picture"
    bl_label = "Picture of the Room"
    bl_import_operator = "code_as_room.drop_picture"
    bl_file_extensions = ";".join(SUFFIXES)

    @classmethod
    def poll_drop(cls, context: bpy.types.Context) -> bool:
        """Over a 3D view, and not while a run is going on."""
        space = context.space_data
        return space is not None and space.type == "VIEW_3D" and not driver.is_running()


class CODE_AS_ROOM_OT_drop_picture(RoomOperator):
    """Make this picture of a room seen from above the one that the room is built from"""

    bl_idname = "code_as_room.drop_picture"
    bl_label = "Use as Picture of the Room"  # the entry of the menu that Blender shows for what was dropped
    bl_options = {"REGISTER", "UNDO", "INTERNAL"}

    filepath: bpy.props.StringProperty(  # type: ignore[valid-type]
        name="File", description="The picture that was dropped", subtype="FILE_PATH", options={"SKIP_SAVE"}
    )

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Not while a run is going on."""
        return allow(cls, "A run is going on; wait for it, or stop it" if driver.is_running() else "")

    def perform(self, context: bpy.types.Context) -> None:
        """Read and normalise the file, and pack it into the .blend."""
        take_picture(context.scene, load_picture(bpy.path.abspath(self.filepath)), anew=False)


class CODE_AS_ROOM_OT_paste_picture(RoomOperator):
    """Use the picture on the clipboard, or the picture file whose path was copied, as the picture of the room"""

    bl_idname = "code_as_room.paste_picture"
    bl_label = "Paste Picture"
    bl_options = {"REGISTER", "UNDO"}

    anew: bpy.props.BoolProperty(  # type: ignore[valid-type]
        name="Begin a New Room",
        description="Put a room that was begun with another picture aside; its memory is kept as a text",
        default=False,
    )

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Not while a run is going on."""
        return allow(cls, "A run is going on; wait for it, or stop it" if driver.is_running() else "")

    def perform(self, context: bpy.types.Context) -> None:
        """Find what was copied, read and normalise it, and pack it into the .blend."""
        take_picture(context.scene, pasted_picture(context), self.anew)


def pasted_picture(context: Any) -> ReferencePicture:
    """The picture that the clipboard holds, or the file that it names.

    Raises:
        PictureError: it holds neither, or what it holds cannot be read.
    """
    path = copied_path(manager(context).clipboard)
    if path is not None:
        return load_picture(path)
    found = _from_system() or _from_blender(context)
    if found is None:
        raise PictureError(
            "There is no picture on the clipboard that can be pasted.",
            "Copy a picture, or the path of a picture file, and paste again; or load the file.",
        )
    return found


def copied_path(text: str) -> Path | None:
    """The first file that a copied text names: a path, a quoted path, or a file address; None when it names none."""
    for line in text.strip().splitlines()[:3]:
        name = line.strip().strip("\"'")
        if name.startswith("file://"):
            name = unquote(urlsplit(name).path)
            if name[2:3] == ":":  # file:///C:/pictures/room.png
                name = name[1:]
        if not name or len(name) > _LONGEST_PATH:
            continue
        try:
            path = Path(name).expanduser()
            if path.is_absolute() and path.is_file():
                return path
        except (OSError, ValueError, RuntimeError):
            continue
    return None


def _from_system() -> ReferencePicture | None:
    """The system's clipboard, as Pillow reads it: Windows and macOS; Linux with wl-paste or xclip."""
    from PIL import Image, ImageGrab

    try:
        found = ImageGrab.grabclipboard()
    except (OSError, NotImplementedError, ValueError, ChildProcessError) as problem:
        log.info("The system's clipboard could not be read: %s", problem)
        return None
    if isinstance(found, Image.Image):
        buffer = io.BytesIO()
        found.save(buffer, "PNG")
        return read_picture(buffer.getvalue(), "pasted.png")
    files = [Path(name) for name in found or () if Path(name).suffix.lower() in SUFFIXES]
    return load_picture(files[0]) if files else None


def _from_blender(context: Any) -> ReferencePicture | None:
    """Blender's own pasting of images, which works in an image editor only: one is shown for the length of the call."""
    paste: Any = bpy.ops.image.clipboard_paste
    if bpy.app.background or context.window is None or not paste.poll():
        return None
    areas = sorted(context.window.screen.areas, key=lambda a: (a.type == "VIEW_3D", a.width * a.height))
    area = areas[0]
    kind, known = area.ui_type, {image.session_uid for image in bpy.data.images}
    try:
        area.ui_type = "IMAGE_EDITOR"
        with context.temp_override(area=area, region=area.regions[-1]):
            paste()
    except RuntimeError as problem:
        log.info("Blender could not paste an image: %s", problem)
    finally:
        area.ui_type = kind
    pasted = [i for i in bpy.data.images if i.session_uid not in known and i.type == "IMAGE" and min(i.size) > 0]
    try:
        return reference.picture_of_image(pasted[0]) if pasted else None
    finally:
        for image in pasted:
            bpy.data.images.remove(image)


CLASSES = (CODE_AS_ROOM_OT_drop_picture, CODE_AS_ROOM_OT_paste_picture, CODE_AS_ROOM_FH_picture)
