# SPDX-License-Identifier: GPL-3.0-or-later
"""Scenes as the driver needs them: found again on every call, and with memory that worker threads may write to.

No reference to Blender data outlives a call (undo and load make them invalid). `ResolvedScene` looks its scene up by
`session_uid`, which survives undo. `save_memory` is the one method that a stage's end calls wherever the stage was
running, so it only keeps the text; `flush` writes it on the main thread.
"""

from __future__ import annotations

import threading
from collections.abc import Collection, Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import bpy

from ..pipeline.artifacts.assets import AssetRef, ChosenAsset
from ..pipeline.artifacts.camera import CameraModel
from ..pipeline.artifacts.layout import LayoutEdit
from ..pipeline.artifacts.scene import SceneDocument
from ..pipeline.errors import SceneError
from ..pipeline.program.prelude.shape import Shape
from ..pipeline.report_rounds import text_key
from ..pipeline.scene.backend import BlenderScene
from ..pipeline.scene.first_draw import prepare_drawing
from ..pipeline.scene.plan import BuildPlan
from ..pipeline.scene.targets import Target
from . import round_pictures


def scene_by_uid(uid: int) -> Any | None:
    """The scene with this `session_uid`, None when it is gone."""
    return next((scene for scene in bpy.data.scenes if scene.session_uid == uid), None)


class ResolvedScene:
    """A `SceneBackend` that outlives undo. Everything but `save_memory` on the main thread only.

    Attributes:
        notices: sentences for the artist on what was clamped, set aside or drawn in another way.
    """

    def __init__(self, scene: Any) -> None:
        self.uid: int = scene.session_uid
        self.notices: list[str] = []
        self._lock = threading.Lock()
        self._unsaved: str | None = None

    @contextmanager
    def _scene(self) -> Iterator[BlenderScene]:
        """The scene as it is now, for one call."""
        scene = scene_by_uid(self.uid)
        if scene is None:
            raise SceneError("The scene of this room was deleted.", "Undo that, or load the picture in another scene.")
        found = BlenderScene(scene)
        try:
            yield found
        finally:
            self.notices += [n for n in found.notices if n not in self.notices]

    def build(self, text: str) -> None:
        """As `SceneBackend.build`."""
        with self._scene() as scene:
            scene.build(text)

    def lacking(self, plan: BuildPlan) -> list[Target]:
        """As `BlenderScene.lacking`."""
        with self._scene() as scene:
            return scene.lacking(plan)

    def commit(self, plan: BuildPlan, made: dict[tuple[str, str], Any]) -> None:
        """As `BlenderScene.commit`."""
        with self._scene() as scene:
            scene.commit(plan, made)

    def prepare_drawing(self, camera: CameraModel) -> bool:
        """As `first_draw.prepare_drawing`."""
        with self._scene() as scene:
            return prepare_drawing(scene.scene, camera)

    def render(self, camera: CameraModel, long_side: int, labels: bool) -> bytes:
        """As `SceneBackend.render`."""
        with self._scene() as scene:
            png = scene.render(camera, long_side, labels)
            if labels:  # a round of the layout loop, which the panel shows
                round_pictures.keep(text_key(scene.program_text()), png)
            return png

    def read_back(self) -> list[LayoutEdit]:
        """As `SceneBackend.read_back`."""
        with self._scene() as scene:
            return scene.read_back()

    def prepare_asset(self, ref: AssetRef, file: Path | None) -> tuple[float, float, float]:
        """As `Wardrobe.prepare_asset`."""
        with self._scene() as scene:
            return scene.prepare_asset(ref, file)

    def dress(self, chosen: Sequence[ChosenAsset], files: Mapping[str, Path]) -> dict[str, str]:
        """As `Wardrobe.dress`."""
        with self._scene() as scene:
            return scene.dress(chosen, files)

    def undress(self, ids: Collection[str]) -> list[str]:
        """As `Wardrobe.undress`."""
        with self._scene() as scene:
            return scene.undress(ids)

    def keep_images(self, images: Mapping[str, bytes]) -> None:
        """As `ImageKeeper.keep_images`."""
        with self._scene() as scene:
            scene.keep_images(images)

    def kept_images(self, names: Collection[str]) -> dict[str, bytes]:
        """As `ImageKeeper.kept_images`."""
        with self._scene() as scene:
            return scene.kept_images(names)

    def has_images(self, names: Collection[str]) -> bool:
        """As `ImageKeeper.has_images`."""
        with self._scene() as scene:
            return scene.has_images(names)

    def text_edits(self) -> list[LayoutEdit] | None:
        """As `HandScene.text_edits`."""
        with self._scene() as scene:
            return scene.text_edits()

    def accept_text(self, on: bool = True, renamed: Mapping[str, str] | None = None) -> None:
        """As `HandScene.accept_text`."""
        with self._scene() as scene:
            scene.accept_text(on, renamed)

    def hold(self, ids: frozenset[str]) -> None:
        """As `HandScene.hold`."""
        with self._scene() as scene:
            scene.hold(ids)

    def forget(self, ids: set[str]) -> None:
        """As `HandScene.forget`."""
        with self._scene() as scene:
            scene.forget(ids)

    def load_memory(self) -> str:
        """As `SceneBackend.load_memory`; what was saved last, even before it was flushed."""
        with self._lock:
            if self._unsaved is not None:
                return self._unsaved
        with self._scene() as scene:
            return scene.load_memory()

    def memory_in_file(self) -> str:
        """The memory's text as it stands in the file, whatever is waiting to be written."""
        with self._scene() as scene:
            return scene.load_memory()

    @property
    def has_unsaved(self) -> bool:
        """Whether a text waits for `flush`; any thread."""
        with self._lock:
            return self._unsaved is not None

    def save_memory(self, text: str) -> None:
        """Keep the memory's text until `flush`; any thread."""
        with self._lock:
            self._unsaved = text

    def discard(self) -> None:
        """Drop the text that waits for `flush`: the job that left it is over, and the file has gone on since."""
        with self._lock:
            self._unsaved = None

    def flush(self) -> None:
        """Write the text that `save_memory` kept."""
        with self._lock:
            text, self._unsaved = self._unsaved, None
        if text is not None:
            with self._scene() as scene:
                scene.save_memory(text)

    def program_text(self) -> str:
        """As `SceneBackend.program_text`."""
        with self._scene() as scene:
            return scene.program_text()

    def portrait(self, shapes: Sequence[Shape], family: str, cameras: Sequence[CameraModel]) -> bytes:
        """As `Studio.portrait`."""
        with self._scene() as scene:
            return scene.portrait(shapes, family, cameras)

    def render_view(self, long_side: int) -> bytes:
        """As `SceneBackend.render_view`."""
        with self._scene() as scene:
            return scene.render_view(long_side)

    def scene_document(self, image: str, camera: CameraModel) -> SceneDocument:
        """As `SceneBackend.scene_document`."""
        with self._scene() as scene:
            return scene.scene_document(image, camera)

    def save_copy(self, path: Path) -> None:
        """As `SceneBackend.save_copy`."""
        with self._scene() as scene:
            scene.save_copy(path)
