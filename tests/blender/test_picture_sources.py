# SPDX-License-Identifier: GPL-3.0-or-later
"""A picture that is dropped, pasted, or whose path was copied; what is none costs nothing."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import bpy
import code_as_room
import pytest
from code_as_room.operators import picture_sources
from code_as_room.operators.picture_sources import CODE_AS_ROOM_FH_picture, copied_path
from code_as_room.pipeline.picture import load_picture
from PIL import Image, ImageGrab


@pytest.fixture(autouse=True)
def enabled() -> Iterator[None]:
    """The add-on enabled in an empty file."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    code_as_room.register()
    yield
    code_as_room.unregister()


@pytest.fixture
def picture(tmp_path: Path) -> Path:
    """A picture whose path needs quoting."""
    path = tmp_path / "my room.png"
    Image.new("RGB", (300, 200), "teal").save(path)
    return path


def test_copied_paths_are_understood_in_every_usual_form(picture: Path) -> None:
    for text in (str(picture), f' "{picture}" \n', picture.as_uri(), f"copy\n{picture.as_uri()}"):
        assert copied_path(text) == picture, text
    for text in ("", "hello", "my room.png", str(picture.parent), str(picture) + ".bak", "\0", "x" * 9000):
        assert copied_path(text) is None, text


def test_a_picture_file_that_was_copied_is_loaded(picture: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(picture_sources, "manager", lambda context: SimpleNamespace(clipboard=str(picture)))
    bpy.ops.code_as_room.paste_picture()
    assert bpy.context.scene.code_as_room.picture_name == "my room.png"
    assert tuple(bpy.context.scene.code_as_room.picture.size) == (300, 200)


def test_a_copied_picture_is_loaded(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(ImageGrab, "grabclipboard", lambda: Image.new("RGBA", (320, 240), (10, 200, 30, 255)))
    bpy.ops.code_as_room.paste_picture()
    settings = bpy.context.scene.code_as_room
    assert (settings.picture_name, tuple(settings.picture.size)) == ("pasted.png", (320, 240))


def test_copied_files_are_looked_through_for_a_picture(picture: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(ImageGrab, "grabclipboard", lambda: ["/notes.txt", str(picture)])
    bpy.ops.code_as_room.paste_picture()
    assert bpy.context.scene.code_as_room.picture_name == "my room.png"


@pytest.mark.parametrize("fault", [NotImplementedError("xclip is required"), OSError("broken"), None])
def test_an_empty_clipboard_is_told_and_the_picture_stays(
    picture: Path, monkeypatch: pytest.MonkeyPatch, fault: Exception | None
) -> None:
    def grab() -> Any:
        if fault is not None:
            raise fault
        return None

    bpy.ops.code_as_room.load_picture(filepath=str(picture))
    before = bpy.context.scene.code_as_room.picture
    monkeypatch.setattr(ImageGrab, "grabclipboard", grab)
    with pytest.raises(RuntimeError, match="no picture on the clipboard"):
        bpy.ops.code_as_room.paste_picture()
    assert bpy.context.scene.code_as_room.picture == before
    assert len(bpy.data.images) == 1


def test_a_copied_file_that_is_no_picture_is_refused_by_name(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    notes = tmp_path / "notes.txt"
    notes.write_text("not a picture")
    monkeypatch.setattr(picture_sources, "manager", lambda context: SimpleNamespace(clipboard=str(notes)))
    with pytest.raises(RuntimeError, match=r"notes\.txt"):
        bpy.ops.code_as_room.paste_picture()
    assert bpy.context.scene.code_as_room.picture is None


def test_a_dropped_file_is_loaded_without_asking_which(picture: Path) -> None:
    """Blender calls the operator of the handler with the file's path, as a click would."""
    group, verb = CODE_AS_ROOM_FH_picture.bl_import_operator.split(".")
    getattr(getattr(bpy.ops, group), verb)("INVOKE_DEFAULT", filepath=str(picture))
    assert bpy.context.scene.code_as_room.picture_name == "my room.png"


def test_files_of_every_kind_that_is_offered_can_be_read(tmp_path: Path) -> None:
    for suffix in CODE_AS_ROOM_FH_picture.bl_file_extensions.split(";"):
        path = tmp_path / f"room{suffix}"
        Image.new("RGB", (200, 200), "navy").save(path)
        assert (load_picture(path).width, load_picture(path).height) == (200, 200)


def test_pictures_are_taken_over_3d_views_only() -> None:
    def over(kind: str) -> bool:
        context: Any = SimpleNamespace(space_data=SimpleNamespace(type=kind))
        return CODE_AS_ROOM_FH_picture.poll_drop(context)

    assert over("VIEW_3D") and not over("IMAGE_EDITOR")
    nowhere: Any = SimpleNamespace(space_data=None)
    assert not CODE_AS_ROOM_FH_picture.poll_drop(nowhere)
