# SPDX-License-Identifier: GPL-3.0-or-later
"""Loading the reference image."""

from __future__ import annotations

from typing import Any

import bpy

from ..pipeline.errors import RoomError
from ..pipeline.memory import Memory, load_memory
from ..pipeline.picture import ReferencePicture, load_picture
from ..pipeline.scene.reference_camera import IMAGE_MARK
from . import driver, fitted_view, own_room, reference, rooms, view_state
from .base import RoomOperator, allow, manager


def take_picture(scene: Any, picture: ReferencePicture, anew: bool) -> None:
    """Make a picture the scene's reference image.

    Args:
        anew: a room that was begun with another picture is put aside.

    Raises:
        RoomError: the scene holds a room of another picture and `anew` is not set.
    """
    own_room.prepare(scene)
    if _other_room(scene, picture):
        if not anew:
            raise RoomError(
                "This scene holds a room that was begun with another picture.",
                "Use New Room first, or load the picture in another scene.",
            )
        rooms.put_aside(scene)
    reference.keep_picture(scene, picture)
    fitted_view.follow(scene)
    for image in [i for i in bpy.data.images if i.get(IMAGE_MARK) and i.users == 0 and i.library is None]:
        bpy.data.images.remove(image)  # only the camera's background had still used it
    view_state.refresh(scene)
    driver.note_outcome(scene, picture.notes[0] if picture.notes else "")


def _other_room(scene: Any, picture: ReferencePicture) -> bool:
    memory = _memory(scene)
    return bool(memory.entries) and memory.picture_hash != picture.sha256


def _memory(scene: Any) -> Memory:
    from .scene_backend import ResolvedScene

    return load_memory(ResolvedScene(scene).load_memory())


class CODE_AS_ROOM_OT_load_picture(RoomOperator):
    """Load a picture of a room seen from above"""

    bl_idname = "code_as_room.load_picture"
    bl_label = "Load Picture"
    bl_options = {"REGISTER", "UNDO"}

    filepath: bpy.props.StringProperty(name="File", description="The picture", subtype="FILE_PATH")  # type: ignore[valid-type]
    filter_image: bpy.props.BoolProperty(default=True, options={"HIDDEN"})  # type: ignore[valid-type]
    filter_folder: bpy.props.BoolProperty(default=True, options={"HIDDEN"})  # type: ignore[valid-type]
    anew: bpy.props.BoolProperty(  # type: ignore[valid-type]
        name="Begin a New Room",
        description="Put a room that was begun with another picture aside; its memory is kept as a text",
        default=False,
    )

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Not while a run is going on."""
        return allow(cls, "A run is going on; wait for it, or stop it" if driver.is_running() else "")

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[Any]:
        """Let the artist choose the file, among pictures."""
        manager(context).fileselect_add(self)
        return {"RUNNING_MODAL"}

    def perform(self, context: bpy.types.Context) -> None:
        """Read and normalise the file, and pack it into the .blend."""
        path = bpy.path.abspath(self.filepath)
        take_picture(context.scene, load_picture(path), self.anew)


def _open_images(self: Any, context: Any) -> list[tuple[str, str, str]]:
    """Images that are open in Blender; the list is kept, since Blender does not keep the strings of dynamic enums."""
    global _items
    names = [image.name for image in bpy.data.images if image.type not in ("RENDER_RESULT", "COMPOSITING")]
    _items = [(name, name, "") for name in names] or [("", "No image is open", "")]
    return _items


_items: list[tuple[str, str, str]] = []


class CODE_AS_ROOM_OT_use_image(RoomOperator):
    """Use an image that is already open in Blender as the picture of the room"""

    bl_idname = "code_as_room.use_image"
    bl_label = "Use Open Image"
    bl_options = {"REGISTER", "UNDO"}
    bl_property = "image"

    image: bpy.props.EnumProperty(name="Image", description="The image to use", items=_open_images)  # type: ignore[valid-type]
    anew: bpy.props.BoolProperty(  # type: ignore[valid-type]
        name="Begin a New Room",
        description="Put a room that was begun with another picture aside; its memory is kept as a text",
        default=False,
    )

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """There must be an image, and no run."""
        if driver.is_running():
            return allow(cls, "A run is going on; wait for it, or stop it")
        return allow(cls, "" if bpy.data.images else "No image is open in Blender")

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[Any]:
        """Let the artist search among the open images."""
        manager(context).invoke_search_popup(self)
        return {"RUNNING_MODAL"}

    def perform(self, context: bpy.types.Context) -> None:
        """Read the image's pixels, and pack a normalised copy."""
        image = bpy.data.images.get(self.image)
        if image is None:
            raise RoomError("There is no image to use.", "Load a picture instead.")
        take_picture(context.scene, reference.picture_of_image(image), self.anew)


class CODE_AS_ROOM_OT_new_room(RoomOperator):
    """Begin a new room in this scene: the built room is removed, and what was answered is kept as a text"""

    bl_idname = "code_as_room.new_room"
    bl_label = "New Room"
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """There must be a room, and no run."""
        if driver.is_running():
            return allow(cls, "A run is going on; wait for it, or stop it")
        state = view_state.peek(context.scene)
        return allow(cls, "" if state is None or state.has_memory else "There is no room in this scene yet")

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[Any]:
        """Ask first."""
        result: set[Any] = manager(context).invoke_confirm(self, event)
        return result

    def perform(self, context: bpy.types.Context) -> None:
        """Put the room aside."""
        name = rooms.put_aside(context.scene)
        fitted_view.follow(context.scene)  # the picture stays
        view_state.refresh(context.scene)
        driver.note_outcome(context.scene, f"The earlier room's memory is kept in the text {name!r}" if name else "")


CLASSES = (CODE_AS_ROOM_OT_load_picture, CODE_AS_ROOM_OT_use_image, CODE_AS_ROOM_OT_new_room)
