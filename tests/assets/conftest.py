"""Asset libraries that the tests make themselves: real .blend files with marked objects and collections."""

from __future__ import annotations

import shutil
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import bpy
import pytest

sys.path.append(str(Path(__file__).parent))  # for what writes the files: tests are imported by their paths

from asset_files import write_library


@pytest.fixture(autouse=True)
def empty_blender() -> Iterator[None]:
    """Every test starts from an empty file."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    yield


@pytest.fixture(scope="session")
def written(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A file of assets, written once."""
    return write_library(tmp_path_factory.mktemp("written") / "things.blend")


@pytest.fixture
def library(written: Path, tmp_path: Path) -> Path:
    """The folder of a library with one file of lamps and vases."""
    folder = tmp_path / "Müller's library"
    folder.mkdir()
    shutil.copy(written, folder)
    return folder


@pytest.fixture
def picture_of_colour(tmp_path: Path) -> Callable[[str], Any]:
    """Makes an image file of one colour."""

    def make(name: str) -> Path:
        image = bpy.data.images.new(name, 8, 8)
        image.filepath_raw, image.file_format = str(tmp_path / f"{name}.png"), "PNG"
        image.save()
        return tmp_path / f"{name}.png"

    return make
