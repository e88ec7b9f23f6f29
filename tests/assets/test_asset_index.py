"""What libraries hold is read off real .blend files, and no bad file stops the others."""

from __future__ import annotations

import os
import shutil
import threading
from pathlib import Path
from typing import Any

import bpy
import pytest
from asset_files import CATALOGUE, all_things, mark, thing, write_library
from code_as_room.pipeline.errors import Cancelled
from code_as_room.pipeline.retrieval import index as index_module
from code_as_room.pipeline.retrieval.index import Index, Library, Shelf

NOW = (bpy.app.version[0], bpy.app.version[1])


def look(folder: Path, cache: Path | None = None) -> Index:
    return Shelf((Library("Mine", folder),), NOW, cache).look()


@pytest.mark.parametrize("compress", [False, True])
def test_names_tags_descriptions_and_sizes_are_those_that_the_artist_gave(tmp_path: Path, compress: bool) -> None:
    write_library(tmp_path / "things.blend", compress=compress)
    assets = {asset.ref.name: asset for asset in look(tmp_path).assets}
    assert set(assets) == {
        "Table Lamp Brass", "Étagère 書架", "Huge Vase", "Clay Vases", "Reading Nook Empty", "Empty Stool",
    }  # fmt: skip
    lamp = assets["Table Lamp Brass"]
    assert lamp.tags == ("lamp", "light") and lamp.description == "A brass lamp, schön"
    assert lamp.size == pytest.approx((0.2, 0.2, 0.4), abs=1e-5)
    assert assets["Clay Vases"].ref.kind == "collection" and assets["Clay Vases"].tags == ("vase", "pot")


def test_a_catalogue_gives_its_path(tmp_path: Path) -> None:
    def make() -> None:
        thing("x_17", (0.5, 0.5, 0.9)).asset_data.catalog_id = CATALOGUE

    write_library(tmp_path / "sub.blend", make)
    (tmp_path / "blender_assets.cats.txt").write_text(f"VERSION 1\n\n{CATALOGUE}:Home/Chairs:Home-Chairs\n")
    assert [asset.catalog for asset in look(tmp_path).assets] == ["Home/Chairs"]


def spoil(folder: Path) -> None:
    good = folder / "things.blend"
    data = good.read_bytes()
    (folder / "cut.blend").write_bytes(data[: len(data) // 3])
    (folder / "empty.blend").write_bytes(b"")
    (folder / "text.blend").write_text("this is no file of Blender")
    newer = bytearray(data)
    at = data.index(b"v", 7, 17) + 1
    newer[at : at + 3] = b"999" if data[7:9] != b"17" else b"099"
    (folder / "newer.blend").write_bytes(bytes(newer))
    noise = bytearray(data)
    for place in range(200, len(noise), 997):
        noise[place] ^= 0xFF
    (folder / "noise.blend").write_bytes(bytes(noise))
    os.symlink(folder / "nowhere", folder / "dangling.blend")


def test_bad_files_are_told_one_by_one_and_stop_nothing(library: Path) -> None:
    spoil(library)
    index = look(library)
    assert "Table Lamp Brass" in {asset.ref.name for asset in index.assets}
    told = " ".join(index.problems)
    for name in ("cut.blend", "empty.blend", "text.blend", "newer.blend", "dangling.blend"):
        assert name in told
    assert "newer than this one" in told and "cut off" in told and "Traceback" not in told


def test_a_library_without_its_folder_is_told(tmp_path: Path, library: Path) -> None:
    shelf = Shelf((Library("Gone", tmp_path / "gone"), Library("Mine", library)), NOW)
    index = shelf.look()
    assert index.assets and any('"Gone"' in problem for problem in index.problems)


def test_a_file_is_read_again_only_when_it_changed(
    library: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    cache = tmp_path / "user" / "assets.json"
    first = look(library, cache)
    read: list[Path] = []
    real = index_module.read_assets
    monkeypatch.setattr(index_module, "read_assets", lambda path, newest: read.append(path) or real(path, newest))
    assert look(library, cache).assets == first.assets and not read
    write_library(library / "things.blend", lambda: mark(thing("New Stool", (0.4, 0.4, 0.5)), ("stool",)))
    assert [asset.ref.name for asset in look(library, cache).assets] == ["New Stool"] and len(read) == 1
    (library / "things.blend").unlink()
    assert look(library, cache).assets == ()


@pytest.mark.parametrize("content", ["", "{", '{"format": "code-as-room/assets/1", "files": 3}', "[[[[", "null"])
def test_a_broken_cache_only_costs_time(library: Path, tmp_path: Path, content: str) -> None:
    cache = tmp_path / "assets.json"
    cache.write_text(content)
    assert len(look(library, cache).assets) == 6
    text = cache.read_text()
    cache.write_text(text.replace('"kind": "object"', '"kind": "nonsense"'))
    assert look(library, cache).files == 1


def test_thousands_of_assets_are_read_and_compared_and_a_search_can_be_stopped(tmp_path: Path) -> None:
    def make() -> None:
        for number in range(3000):
            empty: Any = bpy.data.objects.new(f"Chair {number}", None)
            mark(empty, ("chair",))

    write_library(tmp_path / "many.blend", make)
    for number in range(3):
        shutil.copy(tmp_path / "many.blend", tmp_path / f"copy {number}.blend")
    shelf = Shelf((Library("Mine", tmp_path),), NOW)
    cancel = threading.Event()
    with pytest.raises(Cancelled):
        shelf.look(cancel, lambda done, of: cancel.set())
    assert len(shelf.look().assets) == 12000


def test_all_things_is_what_the_names_above_say() -> None:
    all_things()
    assert sum(1 for o in bpy.data.objects if o.asset_data) == 4
