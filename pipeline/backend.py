# SPDX-License-Identifier: GPL-3.0-or-later
"""What the pipeline needs of a scene. `pipeline/scene/backend.py` gives it with Blender; tests may give another."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from pathlib import Path
from typing import Protocol, runtime_checkable

from .artifacts.assets import AssetRef, ChosenAsset
from .artifacts.camera import CameraModel
from .artifacts.layout import LayoutEdit
from .artifacts.scene import SceneDocument
from .program.prelude.shape import Shape


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


@runtime_checkable
class Studio(Protocol):
    """A scene that can draw objects which are not in it."""

    def portrait(self, shapes: Sequence[Shape], family: str, cameras: Sequence[CameraModel]) -> bytes:
        """PNG of an object through cameras in its own frame, side by side; b"" where nothing can draw."""
        ...


@runtime_checkable
class Wardrobe(Protocol):
    """A scene whose objects can look like assets of asset libraries."""

    def prepare_asset(self, ref: AssetRef, file: Path | None) -> tuple[float, float, float]:
        """Have an asset at hand, unseen; returns its size in metres.

        Args:
            file: where it is on this computer, None where it is not.

        Raises:
            SceneError: it cannot be had; nothing of it is left.
        """
        ...

    def dress(self, chosen: Sequence[ChosenAsset], files: Mapping[str, Path]) -> dict[str, str]:
        """Let objects look like assets, each in its proxy's box and pose; what fails is told by the object's id."""
        ...

    def undress(self, ids: Collection[str]) -> list[str]:
        """Take assets off these objects, so that the next build gives them their own geometry; returns which had one."""
        ...


@runtime_checkable
class ImageKeeper(Protocol):
    """A scene that keeps the images which its program shows."""

    def keep_images(self, images: Mapping[str, bytes]) -> None:
        """Keep images (PNG bytes by name) for the builds to come.

        What is there under a name with other bytes is replaced wherever it is shown; what no wish asked for this time
        stays only for as long as something shows it.
        """
        ...

    def kept_images(self, names: Collection[str]) -> dict[str, bytes]:
        """PNG bytes of those of these images that are there."""
        ...

    def has_images(self, names: Collection[str]) -> bool:
        """Whether all of these images are there; cheap."""
        ...


@runtime_checkable
class HandScene(Protocol):
    """A scene whose program an artist can edit as text, and whose objects can be held."""

    def text_edits(self) -> list[LayoutEdit] | None:
        """What the artist changed in the program's text since it was built, as typed edits; None for an unedited text.

        A text that says the same in other words, or whose functions changed, has an empty list.

        Raises:
            ProgramError: the text is outside the room language; its line counts from the top of the whole text.
        """
        ...

    def accept_text(self, on: bool = True, renamed: Mapping[str, str] | None = None) -> None:
        """The text as it stands is taken over, so that building does not set it aside; False takes that back.

        Args:
            renamed: objects that the text calls otherwise, former id -> id; they keep what they are.
        """
        ...

    def hold(self, ids: frozenset[str]) -> None:
        """No build deletes the objects with these ids: one that has no place for them sets them aside."""
        ...

    def forget(self, ids: set[str]) -> None:
        """The artist removed these, so nothing of them is kept aside."""
        ...
