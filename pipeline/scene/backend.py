# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender as the pipeline's scene (`pipeline/backend.py`)."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import bpy

from ..artifacts.camera import CameraModel
from ..artifacts.layout import LayoutEdit
from ..artifacts.scene import SceneDocument
from ..errors import SceneError
from ..program.assemble import assemble, room_part
from ..program.evaluate import evaluate
from ..program.lines import parse_layout
from .adopt import adopt
from .capture import capture, eye_view
from .document import scene_document
from .readback import read_back
from .realise import realise_record
from .save import save_copy
from .tags import ensure_collections, find_room_collection
from .texts import MEMORY, PROGRAM, read_text, write_text

COLLECTION = "Code-as-Room"
_QUICK = 1024  # pixels; larger pictures are for people and are drawn finer


class BlenderScene:
    """One Blender scene with a room in it. Main thread only; keep none across undo or load.

    Attributes:
        notices: sentences for the artist about what was clamped, set aside or drawn in another way.
    """

    def __init__(self, scene: Any | None = None) -> None:
        self.scene: Any = scene or bpy.context.scene
        self.notices: list[str] = []

    def build(self, text: str) -> None:
        """As `SceneBackend.build`."""
        record = evaluate(text)
        room = self._ensure_room()
        _leave_edit_mode(room)
        self._tell(*realise_record(record, COLLECTION, self.scene))
        self._tell(write_text(room, PROGRAM, assemble(text)))

    def render(self, camera: CameraModel, long_side: int, labels: bool) -> bytes:
        """As `SceneBackend.render`."""
        picture = capture(self.scene, camera, long_side, labels, fine=long_side > _QUICK)
        return self._drawn(picture.png, picture.method)

    def render_view(self, long_side: int) -> bytes:
        """As `SceneBackend.render_view`."""
        picture = eye_view(self.scene, long_side)
        return self._drawn(picture.png, picture.method)

    def read_back(self) -> list[LayoutEdit]:
        """As `SceneBackend.read_back`. What was copied, added or renamed gets its id on the object."""
        text, room = self.program_text(), self._room()
        if room is None or not text:
            return []
        layout = parse_layout(text)
        lines = (layout.walls, layout.doors, layout.windows, layout.openings, layout.proxies, layout.lights)
        taken = {line.id for group in (*lines, layout.cameras) for line in group}
        reading = read_back(room, taken)
        adopt(reading)
        return reading.edits

    def load_memory(self) -> str:
        """As `SceneBackend.load_memory`; a text that the artist broke comes as it is."""
        return read_text(self._room(), MEMORY)

    def save_memory(self, text: str) -> None:
        """As `SceneBackend.save_memory`. A text that the artist broke meanwhile is set aside, not lost."""
        self._tell(write_text(self._ensure_room(), MEMORY, text))

    def program_text(self) -> str:
        """As `SceneBackend.program_text`, with what the artist edited in it."""
        text = read_text(self._room(), PROGRAM)
        return room_part(text) if text else ""

    def scene_document(self, image: str, camera: CameraModel) -> SceneDocument:
        """As `SceneBackend.scene_document`."""
        room = self._room()
        if room is None:
            raise SceneError("There is no room in this scene yet.", "Run the layout stage first.")
        return scene_document(room, image, camera)

    def save_copy(self, path: Path) -> None:
        """As `SceneBackend.save_copy`."""
        save_copy(path)

    def _room(self) -> Any | None:
        return find_room_collection(self.scene)

    def _ensure_room(self) -> Any:
        return ensure_collections(self.scene, COLLECTION)["room"]

    def _drawn(self, png: bytes, method: str) -> bytes:
        if method != "workbench":
            self._tell(f"The picture was drawn with {method}, since Workbench found no graphics driver.")
        return png

    def _tell(self, *sentences: str) -> None:
        self.notices += [s for s in sentences if s and s not in self.notices]


def _leave_edit_mode(room: Any) -> None:
    """Meshes cannot be written while they are being edited."""
    poll: Any = bpy.ops.object.mode_set.poll
    if any(obj.mode == "EDIT" for obj in room.all_objects) and poll():
        bpy.ops.object.mode_set(mode="OBJECT")
