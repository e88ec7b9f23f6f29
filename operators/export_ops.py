# SPDX-License-Identifier: GPL-3.0-or-later
"""The room for other programs: one file of glTF or USD."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

import bpy

from ..pipeline.errors import OutputError
from ..pipeline.scene import exports
from ..pipeline.scene.tags import find_room_collection
from . import driver
from .base import RoomOperator, allow, busy_blocker, manager


class _Export(RoomOperator):
    """What both formats share. The file selector warns before it writes over a file."""

    bl_options = {"REGISTER"}
    ending = ""
    export: Any = None
    lacks: Any = None

    filepath: bpy.props.StringProperty(  # type: ignore[valid-type]
        name="File", description="Where to write the room", subtype="FILE_PATH", options={"SKIP_SAVE"}
    )
    check_existing: bpy.props.BoolProperty(  # type: ignore[valid-type]
        name="Check Existing", description="Warn before a file is written over", default=True, options={"HIDDEN"}
    )

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """There must be a room, no run, and Object mode: what is edited now is not in the meshes yet."""
        missing = "" if find_room_collection(context.scene) is not None else "Run the stages up to the layout first"
        return allow(cls, cls.lacks() or busy_blocker(context) or missing)

    def check(self, context: bpy.types.Context) -> bool:
        """The ending is put right while the artist types."""
        wanted = self._wanted(self.filepath) if self.filepath else ""
        changed = bool(wanted != self.filepath)
        self.filepath = wanted
        return changed

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[Any]:
        """Let the artist choose the file: beside the .blend and called like it, until they say otherwise."""
        if not self.filepath:
            scene: Any = context.scene
            name = Path(bpy.data.filepath or scene.code_as_room.picture_name or "room").stem
            self.filepath = self._wanted(str(Path(bpy.data.filepath).parent / name) if bpy.data.filepath else name)
        manager(context).fileselect_add(self)
        return {"RUNNING_MODAL"}

    def perform(self, context: bpy.types.Context) -> None:
        """Write the file; nothing in the scene changes."""
        if not self.filepath:
            raise OutputError("No file was chosen.", "Choose one.")
        path = type(self).export(context.scene, Path(bpy.path.abspath(self._wanted(self.filepath))))
        megabytes = path.stat().st_size / 1e6
        said = f"{path.name} written, {megabytes:.1f} MB"
        driver.note_outcome(context.scene, said)
        self.report({"INFO"}, f"{said}: {path}")

    def _wanted(self, path: str) -> str:
        root, ending = os.path.splitext(path)
        return path if ending.lower() == self.ending else (root if ending.lower() in _ENDINGS else path) + self.ending


class CODE_AS_ROOM_OT_export_glb(_Export):
    """Write the room as one .glb file (glTF) for game engines, web viewers and other programs"""

    bl_idname = "code_as_room.export_glb"
    bl_label = "Export glTF"
    ending = ".glb"
    export = staticmethod(exports.export_glb)
    lacks = staticmethod(exports.lacks_glb)

    filter_glob: bpy.props.StringProperty(  # type: ignore[valid-type]
        name="Files", description="Which files are listed", default="*.glb", options={"HIDDEN"}
    )


class CODE_AS_ROOM_OT_export_usdz(_Export):
    """Write the room as one .usdz file (USD) for Houdini, Maya, Unreal, Omniverse and Apple devices"""

    bl_idname = "code_as_room.export_usdz"
    bl_label = "Export USD"
    ending = ".usdz"
    export = staticmethod(exports.export_usdz)
    lacks = staticmethod(exports.lacks_usd)

    filter_glob: bpy.props.StringProperty(  # type: ignore[valid-type]
        name="Files", description="Which files are listed", default="*.usdz", options={"HIDDEN"}
    )


_ENDINGS = (".glb", ".gltf", ".usd", ".usda", ".usdc", ".usdz", ".blend", ".png", ".jpg", ".jpeg", ".webp")
CLASSES = (CODE_AS_ROOM_OT_export_glb, CODE_AS_ROOM_OT_export_usdz)
