# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender as the pipeline's scene (`pipeline/backend.py`)."""

from __future__ import annotations

import functools
from collections.abc import Collection, Mapping, Sequence
from pathlib import Path
from typing import Any

import bpy

from ..artifacts.assets import AssetRef, ChosenAsset
from ..artifacts.camera import CameraModel
from ..artifacts.layout import LayoutEdit
from ..artifacts.scene import SceneDocument
from ..errors import SceneError
from ..program.assemble import room_part
from ..program.parse_safe import uncollected
from ..program.prelude.shape import Shape
from .adopt import adopt
from .assets import dress, follow, prepare, undress
from .capture import capture, eye_view
from .document import scene_document
from .holding import forget_aside
from .keeping_images import has_images, keep_images, kept_images
from .plan import BuildPlan, line_ids, plan_build
from .portrait import portrait
from .readback import read_back
from .realise import lacking, realise_plan
from .save import save_copy
from .tags import HELD, ID, ensure_collections, find_room_collection
from .targets import Target
from .texts import MEMORY, PROGRAM, is_hand_edited, read_text, write_text
from .typed import accept_text, text_edits

COLLECTION = "Code-as-Room"
_room_part = functools.lru_cache(maxsize=4)(room_part)
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
        with uncollected():
            self.commit(plan_build(text, meshes=False), {})

    def lacking(self, plan: BuildPlan) -> list[Target]:
        """What `realise.new_mesh` may make before `commit`, so that it has less to do; nothing is changed."""
        return lacking(plan.room, self._room())

    def commit(self, plan: BuildPlan, made: dict[tuple[str, str], Any]) -> None:
        """Make the scene show a plan: objects and program text together.

        Args:
            made: meshes that were made beforehand, by their target's key; what is used is taken out.
        """
        room = self._ensure_room()
        _leave_edit_mode(room)
        follow(room, plan.room)
        try:
            realise_plan(plan.room, COLLECTION, self.scene, made)
        except Exception:
            # Objects and text agree whatever happens: what stood before stands again.
            former = self.program_text()
            if former and former != plan.text:
                before = plan_build(former, meshes=False).room
                follow(room, before)
                realise_plan(before, COLLECTION, self.scene, {})
            raise
        self._tell(*plan.room.notes)
        self._tell(write_text(room, PROGRAM, plan.full_text))

    def render(self, camera: CameraModel, long_side: int, labels: bool) -> bytes:
        """As `SceneBackend.render`."""
        picture = capture(self.scene, camera, long_side, labels, fine=long_side > _QUICK)
        return self._drawn(picture.png, picture.method)

    def render_view(self, long_side: int) -> bytes:
        """As `SceneBackend.render_view`."""
        picture = eye_view(self.scene, long_side)
        return self._drawn(picture.png, picture.method)

    def portrait(self, shapes: Sequence[Shape], family: str, cameras: Sequence[CameraModel]) -> bytes:
        """As `Studio.portrait`."""
        try:
            return portrait(shapes, family, cameras)
        except SceneError as error:
            self._tell(f"The model could not be shown its objects: {error.message}")
            return b""

    def prepare_asset(self, ref: AssetRef, file: Path | None) -> tuple[float, float, float]:
        """As `Wardrobe.prepare_asset`."""
        size, notes = prepare(ref, file)
        self._tell(*(f"{ref.name}: {note}." for note in notes))
        return size

    def dress(self, chosen: Sequence[ChosenAsset], files: Mapping[str, Path]) -> dict[str, str]:
        """As `Wardrobe.dress`."""
        return dress(self._ensure_room(), chosen, files)

    def undress(self, ids: Collection[str]) -> list[str]:
        """As `Wardrobe.undress`."""
        return undress(self._ensure_room(), ids)

    def keep_images(self, images: Mapping[str, bytes]) -> None:
        """As `ImageKeeper.keep_images`."""
        keep_images(images)

    def kept_images(self, names: Collection[str]) -> dict[str, bytes]:
        """As `ImageKeeper.kept_images`."""
        return kept_images(names)

    def has_images(self, names: Collection[str]) -> bool:
        """As `ImageKeeper.has_images`."""
        return has_images(names)

    def read_back(self) -> list[LayoutEdit]:
        """As `SceneBackend.read_back`. What was copied, added or renamed gets its id on the object."""
        text, room = self.program_text(), self._room()
        if room is None or not text:
            return []
        reading = read_back(room, set(line_ids(text)))
        adopt(reading)
        self._tell(*(f"{finding.about}: {finding.message}" for finding in reading.findings))
        return reading.edits

    def text_edits(self) -> list[LayoutEdit] | None:
        """As `HandScene.text_edits`."""
        room = self._room()
        if room is None or not is_hand_edited(room, PROGRAM):
            return None
        return text_edits(room)

    def accept_text(self, on: bool = True, renamed: Mapping[str, str] | None = None) -> None:
        """As `HandScene.accept_text`."""
        room = self._room()
        if room is not None:
            accept_text(room, on, renamed or {})

    def hold(self, ids: frozenset[str]) -> None:
        """As `HandScene.hold`."""
        room = self._room()
        for obj in room.all_objects if room is not None else ():
            if obj.get(ID) in ids and HELD not in obj:
                obj[HELD] = True

    def forget(self, ids: set[str]) -> None:
        """As `HandScene.forget`."""
        room = self._room()
        if room is not None and ids:
            forget_aside(room, ids)

    def load_memory(self) -> str:
        """As `SceneBackend.load_memory`; a text that the artist broke comes as it is."""
        return read_text(self._room(), MEMORY)

    def save_memory(self, text: str) -> None:
        """As `SceneBackend.save_memory`. A text that the artist broke meanwhile is set aside, not lost."""
        self._tell(write_text(self._ensure_room(), MEMORY, text))

    def program_text(self) -> str:
        """As `SceneBackend.program_text`, with what the artist edited in it."""
        text = read_text(self._room(), PROGRAM)
        return _room_part(text) if text else ""

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
        if method == "cycles":
            self._tell(f"The picture was drawn with {method}, since Workbench found no graphics driver.")
        return png

    def _tell(self, *sentences: str) -> None:
        self.notices += [s for s in sentences if s and s not in self.notices]


def _leave_edit_mode(room: Any) -> None:
    """Meshes cannot be written while they are being edited."""
    poll: Any = bpy.ops.object.mode_set.poll
    if any(obj.mode == "EDIT" for obj in room.all_objects) and poll():
        bpy.ops.object.mode_set(mode="OBJECT")
