# SPDX-License-Identifier: GPL-3.0-or-later
"""Assets for objects that the artist chooses: found, shown with their scores, used, turned and taken off, with undo."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import bpy
import code_as_room
import pytest
from code_as_room.operators import asset_search, asset_shelf, driver, view_state
from code_as_room.operators.view_state import RoomState
from code_as_room.panels.assets import draw_asset
from code_as_room.pipeline.scene.assets import asset_of
from PIL import Image, ImageDraw

sys.path.append(str(Path(__file__).parents[1] / "assets"))
from asset_files import thing, write_library


@dataclass
class Made:
    """A finished room, one of its objects, and a library that has something for it."""

    path: str
    name: str
    category: str
    folder: Path


class Lines:
    """A layout that only notes what it says."""

    def __init__(self, said: list[str] | None = None) -> None:
        self.said: list[str] = [] if said is None else said

    def row(self, **_: Any) -> Lines:
        return Lines(self.said)

    column = box = row

    def label(self, text: str = "", icon: str = "NONE") -> None:
        self.said.append(text)

    def operator(self, name: str, text: str = "", icon: str = "NONE") -> Any:
        self.said.append(text)
        return type("Operator", (), {})()


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> Made:
    folder = tmp_path_factory.mktemp("assets")
    image = Image.new("RGB", (480, 400), "white")
    pen = ImageDraw.Draw(image)
    pen.rectangle((30, 30, 450, 370), fill=(120, 120, 125))
    pen.rectangle((45, 45, 435, 355), fill=(205, 170, 130))
    pen.rectangle((170, 50, 310, 220), fill=(90, 120, 180))
    pen.rectangle((180, 55, 300, 90), fill=(240, 240, 240))
    pen.rectangle((60, 250, 120, 340), fill=(60, 130, 90))
    image.save(folder / "flat.png")
    bpy.ops.wm.read_factory_settings(use_empty=True)
    code_as_room.register()
    bpy.ops.code_as_room.load_picture(filepath=str(folder / "flat.png"))
    bpy.context.scene.code_as_room.iterations = 1
    bpy.ops.code_as_room.run_all()
    row = next(row for row in state().objects if row.name and row.size)
    bpy.ops.wm.save_as_mainfile(filepath=str(folder / "built.blend"))
    code_as_room.unregister()
    assert row.size is not None
    x, y, z = row.size

    def make() -> None:
        thing(f"Fine {row.category}", (x, y, z), (row.category,))
        thing(f"Odd {row.category}", (x, 1.4 * y, z), (row.category,))
        thing(f"Narrow {row.category}", (x / 3, y, z), (row.category,))

    (folder / "library").mkdir()
    write_library(folder / "library" / "own.blend", make)
    (folder / "library" / "torn.blend").write_bytes(b"BLENDER-v405REND")
    return Made(str(folder / "built.blend"), row.name, row.category, folder / "library")


@pytest.fixture(autouse=True)
def scene(made: Made) -> Iterator[Any]:
    """The room, opened anew, by an artist with that library."""
    code_as_room.register()
    bpy.ops.wm.open_mainfile(filepath=made.path)
    libraries = bpy.context.preferences.filepaths.asset_libraries
    for library in list(libraries):
        libraries.remove(library)
    libraries.new(name="Own", directory=str(made.folder))
    yield bpy.context.scene
    for library in list(libraries):
        libraries.remove(library)
    code_as_room.unregister()


def state() -> RoomState:
    found = view_state.refresh(bpy.context.scene)
    return found


def worn(made: Made) -> str:
    return asset_of(bpy.data.objects[made.name]).rpartition("|")[2]


def said_by_panel(made: Made) -> str:
    lines = Lines()
    draw_asset(lines, bpy.context, state(), made.name)
    return " ".join(lines.said)


def outcome() -> str:
    found = driver.outcome_of(bpy.context.scene)
    assert found is not None
    return f"{found.text} {found.problem.sentence if found.problem else ''}"


def test_the_best_is_taken_and_the_others_are_shown_with_their_scores(made: Made) -> None:
    assert "Find Asset" in said_by_panel(made)
    bpy.ops.code_as_room.find_assets(identifier=made.name)
    assert worn(made) == f"Fine {made.category}"
    [choice] = state().assets
    said = said_by_panel(made)
    assert f"{choice.score:.2f}" in said and f"words {choice.words:.2f} x size {choice.fit:.2f}" in said.replace(
        "  ", " "
    )
    found = asset_search.found_for(bpy.context.scene, made.name)
    assert found is not None and [m.asset.ref.name.split()[0] for m in found] == ["Fine", "Odd", "Narrow"]
    assert f"{found[1].score:.2f}  Odd" in said and "torn.blend" in said
    assert choice.asset.name in outcome()


def test_another_can_be_used_turned_and_taken_off_and_the_file_keeps_it(made: Made, tmp_path: Path) -> None:
    bpy.ops.code_as_room.find_assets(identifier=made.name)
    plain = len(bpy.data.objects[made.name].data.vertices)
    bpy.ops.code_as_room.use_asset(identifier=made.name, asset=f"Own|own.blend|object|Odd {made.category}")
    assert worn(made) == f"Odd {made.category}"
    bpy.ops.code_as_room.turn_asset(identifier=made.name)
    assert state().assets[0].turn == 1
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "again.blend"))
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "again.blend"))
    bpy.context.preferences.filepaths.asset_libraries[0].path = str(tmp_path / "unplugged")
    assert worn(made) == f"Odd {made.category}" and state().assets[0].by == "artist"
    bpy.ops.code_as_room.turn_asset(identifier=made.name)  # needs no library
    assert state().assets[0].turn == 2
    bpy.ops.code_as_room.drop_assets(identifier=made.name)
    assert worn(made) == "" and state().assets == () and len(bpy.data.objects[made.name].data.vertices) != plain
    assert "library piece" in bpy.ops.code_as_room.drop_assets.get_rna_type().description


def test_what_is_below_the_threshold_stays_as_it_is_and_can_be_used_all_the_same(made: Made, tmp_path: Path) -> None:
    x, y, z = next(row.size for row in state().objects if row.name == made.name) or (1, 1, 1)
    path, name = made.path, f"Far {made.category}"
    write_library(tmp_path / "far.blend", lambda: thing(name, (x / 2.5, y, z)) and None)
    bpy.ops.wm.open_mainfile(filepath=path)
    bpy.context.preferences.filepaths.asset_libraries.new(name="Own", directory=str(tmp_path))
    bpy.ops.code_as_room.find_assets(identifier=made.name)
    assert worn(made) == "" and "well enough" in outcome() and name in outcome()
    bpy.ops.code_as_room.use_asset(identifier=made.name, asset=f"Own|far.blend|object|{name}")
    assert worn(made) == name


@pytest.mark.parametrize("case", ["none", "gone", "empty"])
def test_libraries_with_nothing_in_them_are_a_sentence(made: Made, tmp_path: Path, case: str) -> None:
    libraries = bpy.context.preferences.filepaths.asset_libraries
    if case == "none":
        libraries.remove(libraries[0])
        with pytest.raises(RuntimeError, match="No asset library is set up.*Preferences"):
            bpy.ops.code_as_room.find_assets(identifier=made.name)
    else:
        libraries[0].path = str(tmp_path if case == "empty" else tmp_path / "gone")
        bpy.ops.code_as_room.find_assets(identifier=made.name)
        assert "no marked objects" in outcome() and worn(made) == ""
        assert case == "empty" or "is not there" in " ".join(asset_search.problems())


def test_the_folder_that_blender_names_for_everybody_is_passed_over_while_it_is_not_there(tmp_path: Path) -> None:
    libraries = bpy.context.preferences.filepaths.asset_libraries
    libraries[0].name, libraries[0].path = "User Library", str(tmp_path / "Assets")
    assert asset_shelf.shelf() is None


def test_detail_again_and_show_as_boxes_are_possible_with_an_asset(made: Made) -> None:
    bpy.ops.code_as_room.find_assets(identifier=made.name)
    row = next(row for row in state().objects if row.name == made.name)
    from code_as_room.operators import object_list

    object_list.select(bpy.context.scene, [row.id])
    bpy.ops.code_as_room.show_boxes(boxes=True)
    assert worn(made) == ""
    bpy.ops.code_as_room.show_boxes(boxes=False)
    assert worn(made) == f"Fine {made.category}"
    bpy.ops.code_as_room.detail_again()
    assert worn(made) == "" and state().assets == ()
