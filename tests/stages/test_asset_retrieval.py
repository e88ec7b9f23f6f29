"""Stage 7 with asset libraries: small things look like assets that fit, and everything the artist says of it holds."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import bpy
import pytest
from code_as_room.pipeline.artifacts.assets import ChosenAssets
from code_as_room.pipeline.artifacts.corrections import Corrections, ObjectCorrection
from code_as_room.pipeline.artifacts.surfaces import SmallObjects
from code_as_room.pipeline.memory import dump_memory, load_memory
from code_as_room.pipeline.retrieval.index import Library, Shelf
from code_as_room.pipeline.run import Run
from code_as_room.pipeline.run_assets import chosen_of, match_of, take_off, wanted_of, wear
from code_as_room.pipeline.run_corrections import correct
from code_as_room.pipeline.run_modelling import show_as_boxes
from code_as_room.pipeline.scene.assets import asset_of
from code_as_room.pipeline.scene.backend import BlenderScene
from code_as_room.pipeline.scene.boxes import object_box
from code_as_room.pipeline.stages import all_stages
from code_as_room.pipeline.stages.s07_surfaces import STAGE

sys.path.append(str(Path(__file__).parents[1] / "assets"))
from asset_files import thing, write_library

STAGES = all_stages()[: all_stages().index(STAGE) + 1]
BRASS = "Mine|things.blend|object|Table Lamp Brass"


@pytest.fixture(scope="module")
def done(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of a library."""
    folder = tmp_path_factory.mktemp("library")
    write_library(folder / "things.blend")
    return folder


@pytest.fixture
def run(run: Run, done: Path) -> Run:
    """A run in an empty Blender, whose artist has that library."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    run.memory.settings |= {"iterations": "0", "objects": "library"}
    run.backend = BlenderScene(bpy.context.scene)
    run.shelf = shelf(done)
    return run


def shelf(folder: Path) -> Shelf:
    return Shelf((Library("Mine", folder),), (bpy.app.version[0], bpy.app.version[1]))


def lamp() -> Any:
    return bpy.data.objects["lamp"]


def told(run: Run) -> str:
    small = run.memory.latest(SmallObjects)
    assert small is not None
    return " ".join(f"{finding.about}: {finding.message}" for finding in small.findings)


def test_a_small_thing_looks_like_the_asset_that_fits_and_stands_where_it_stood(run: Run, done: Path) -> None:
    run.shelf = None
    run.run_all(STAGES)
    plain, text = object_box(lamp()), run.backend.program_text()
    assert not asset_of(lamp()) and run.memory.latest(ChosenAssets) is None
    run.shelf = shelf(done)
    run.run_stage(STAGE)
    assert asset_of(lamp()) == BRASS and run.backend.program_text() == text
    box = object_box(lamp())
    assert plain is not None and box is not None and box.centre == pytest.approx(plain.centre, abs=1e-4)
    choice = chosen_of(run.memory).of("lamp")
    assert choice is not None and choice.score == pytest.approx(choice.words * choice.fit, abs=2e-3)
    assert "Table Lamp Brass" in told(run) and f"{choice.score:.2f}" in told(run) and "room.py" in told(run)
    assert [o.name for o in bpy.data.objects if o.type == "MESH" and asset_of(o)] == ["lamp"]
    assert run.backend.read_back() == []


def test_it_stays_through_save_another_run_and_a_library_that_is_gone(
    run: Run, tmp_path: Path, picture: Any, answers: Any
) -> None:
    run.run_all(STAGES)
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "room.blend"))
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "room.blend"))
    backend = BlenderScene(bpy.context.scene)
    later = Run(picture, load_memory(backend.load_memory()), answers, backend, shelf=shelf(tmp_path / "gone"))
    for stage in STAGES[2:]:
        later.run_stage(stage)
    assert asset_of(lamp()) == BRASS and chosen_of(later.memory).of("lamp") is not None


def test_switched_off_nothing_is_looked_for(run: Run) -> None:
    run.memory.settings["assets"] = "off"
    run.run_all(STAGES)
    assert not asset_of(lamp()) and run.memory.latest(ChosenAssets) is None


def test_what_the_artist_took_off_is_not_put_on_again_and_can_be_chosen_again(run: Run) -> None:
    run.run_all(STAGES)
    choice = chosen_of(run.memory).of("lamp")
    assert choice is not None
    assert take_off(run, ["lamp"]) == 1 and not asset_of(lamp())
    run.run_stage(STAGE)
    assert not asset_of(lamp())
    [chosen] = wear(run, [(wanted_of(run, ["lamp"])[0], match_of(choice))])
    assert asset_of(lamp()) == BRASS and chosen.by == "artist"
    run.run_stage(STAGE)
    assert asset_of(lamp()) == BRASS and chosen_of(run.memory).of("lamp") == chosen


def test_shown_as_a_box_it_is_a_box_and_shown_modelled_it_is_the_asset_again(run: Run) -> None:
    run.run_all(STAGES)
    asset = len(lamp().data.vertices)
    show_as_boxes(run, ["lamp"], True)
    assert not asset_of(lamp()) and len(lamp().data.vertices) != asset
    run.run_stage(STAGE)
    assert not asset_of(lamp())
    show_as_boxes(run, ["lamp"], False)
    assert asset_of(lamp()) == BRASS
    assert load_memory(dump_memory(run.memory)).latest(ChosenAssets) == run.memory.latest(ChosenAssets)


def test_what_is_called_otherwise_now_is_looked_for_anew(run: Run) -> None:
    run.run_all(STAGES)
    assert asset_of(lamp()) == BRASS
    correct(run, Corrections(objects=[ObjectCorrection(id="lamp", category="vase")]))
    run.run_all(STAGES)
    assert asset_of(lamp()) == "Mine|things.blend|collection|Clay Vases"
    correct(run, Corrections(objects=[ObjectCorrection(id="lamp", category="candle")]))
    run.run_all(STAGES)
    assert not asset_of(lamp()) and chosen_of(run.memory).of("lamp") is None


def test_an_asset_that_cannot_be_had_gives_way_to_the_next_best(run: Run, tmp_path: Path) -> None:
    def make() -> None:
        thing("Brass Table Lamp", (0.25, 0.25, 0.4), ("lamp",)).data.clear_geometry()
        thing("Table Lamp", (0.25, 0.3, 0.4), ("lamp",))

    folder = tmp_path / "other"
    folder.mkdir()
    write_library(folder / "lamps.blend", make)
    run.backend = BlenderScene(bpy.context.scene)
    run.shelf = shelf(folder)
    index = run.shelf.look()
    empty = next(asset for asset in index.assets if asset.ref.name == "Brass Table Lamp")
    object.__setattr__(empty, "size", (0.25, 0.25, 0.4))  # as if it had been emptied after it was read
    run.run_all(STAGES)
    assert asset_of(lamp()) == "Mine|lamps.blend|object|Table Lamp"
    assert "has no mesh" in told(run)
    (folder / "lamps.blend").write_bytes(b"nonsense")
    run.run_stage(STAGE)
    assert asset_of(lamp()) == "Mine|lamps.blend|object|Table Lamp"


def test_locked_things_keep_what_they_look_like(run: Run) -> None:
    run.shelf, library = None, run.shelf
    run.run_all(STAGES)
    correct(run, Corrections(objects=[ObjectCorrection(id="lamp", locked=True)]))
    run.shelf = library
    run.run_stage(STAGE)
    assert not asset_of(lamp())
