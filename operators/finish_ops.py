# SPDX-License-Identifier: GPL-3.0-or-later
"""What the artist says of corrections: which kinds are mended, and what is kept as it was."""

from __future__ import annotations

from typing import Any

import bpy

from . import driver, view_state


class CODE_AS_ROOM_OT_spare(bpy.types.Operator):
    """Keep this as it was, or mend it after all. It counts when the stage Light and views runs again; nothing is asked."""

    bl_idname = "code_as_room.spare"
    bl_label = "Keep As It Was"
    bl_options = {"UNDO", "INTERNAL"}

    key: bpy.props.StringProperty(name="Correction", description="Kind and object", options={"HIDDEN"})  # type: ignore[valid-type]

    @classmethod
    def poll(cls, context: Any) -> bool:
        """Not while the room is worked on."""
        if driver.is_running():
            cls.poll_message_set("Wait until the run has ended, or stop it.")
            return False
        return True

    def execute(self, context: Any) -> set[Any]:
        """Switch it."""
        settings = context.scene.code_as_room
        words = [word for word in settings.spared.split("\n") if word]
        words = [w for w in words if w != self.key] if self.key in words else [*words, self.key]
        settings.spared = "\n".join(words)
        view_state.refresh(context.scene)
        return {"FINISHED"}


CLASSES = (CODE_AS_ROOM_OT_spare,)
