# SPDX-License-Identifier: GPL-3.0-or-later
"""What the pipeline needs of a scene. `pipeline/scene/backend.py` gives it with Blender; tests may give another."""

from __future__ import annotations

from pathlib import Path
from typing import Protocol

from .artifacts.camera import CameraModel
from .artifacts.layout import LayoutEdit
from .artifacts.scene import SceneDocument


class SceneBackend(Protocol):
    """A scene that can show a room program. Called on Blender's main thread only."""

    def build(self, text: str) -> None:
        """Make the scene show this room program (text after the prelude); only what differs is touched.

        Raises:
            ProgramError: the text is outside the room language; the scene is unchanged.
        """
        ...

    def render(self, camera: CameraModel, long_side: int, labels: bool) -> bytes:
        """PNG of what stands in the scene through this camera, in the aspect of its `image_size`."""
        ...

    def read_back(self) -> list[LayoutEdit]:
        """What the artist changed by hand since the last build, as typed edits with origin "artist"."""
        ...

    def load_memory(self) -> str:
        """The memory's text, "" when there is none."""
        ...

    def save_memory(self, text: str) -> None:
        """Keep the memory's text in one assignment."""
        ...

    def program_text(self) -> str:
        """The room program (text after the prelude) that the scene shows, "" when there is none."""
        ...

    def render_view(self, long_side: int) -> bytes:
        """PNG of the room from a raised corner, near walls hidden."""
        ...

    def scene_document(self, image: str, camera: CameraModel) -> SceneDocument:
        """`scene.json` of what stands in the scene (not of what the program asked for)."""
        ...

    def save_copy(self, path: Path) -> None:
        """Save a copy of the .blend, everything packed, without changing the artist's file."""
        ...
