# SPDX-License-Identifier: GPL-3.0-or-later
"""What the command puts into its .blend beside the room, so that an artist who opens it goes on where it ended."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from typing import Any

import bpy

from ..pipeline.picture import ReferencePicture
from . import properties, reference


@contextmanager
def scene_settings() -> Iterator[None]:
    """The scenes' settings exist inside the `with` block, also in a process where the add-on is not enabled."""
    scene_type: Any = bpy.types.Scene
    if hasattr(scene_type, "code_as_room"):
        yield
        return
    pointer: Any = bpy.props.PointerProperty
    for cls in properties.CLASSES:
        bpy.utils.register_class(cls)
    scene_type.code_as_room = pointer(type=properties.CodeAsRoomSettings, name="Code-as-Room")
    try:
        yield
    finally:
        del scene_type.code_as_room
        for cls in reversed(properties.CLASSES):
            bpy.utils.unregister_class(cls)


def keep_start(scene: Any, picture: ReferencePicture, settings: Mapping[str, str]) -> None:
    """The picture goes into the file, and the run's settings become those of the panel.

    Args:
        settings: as memory has them.
    """
    reference.keep_picture(scene, picture)
    properties.show_settings(scene.code_as_room, settings)
