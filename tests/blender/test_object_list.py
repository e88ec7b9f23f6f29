# SPDX-License-Identifier: GPL-3.0-or-later
"""The list of objects: it says what memory says, keeps what the artist says, and follows the selection both ways."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import bpy
import code_as_room
import pytest
from code_as_room.operators import driver, object_list, room_memory, view_state
from code_as_room.operators.view_state import RoomState
from code_as_room.pipeline.artifacts.corrections import Corrections
from PIL import Image, ImageDraw


@pytest.fixture(scope="module")
def built(tmp_path_factory: pytest.TempPathFactory) -> str:
    """A file with a finished room, by the built-in analysis."""
    folder = tmp_path_factory.mktemp("list")
    image = Image.new("RGB", (480, 400), "white")
    pen = ImageDraw.Draw(image)
    pen.rectangle((30, 30, 450, 370), fill=(120, 120, 125))
    pen.rectangle((45, 45, 435, 355), fill=(205, 170, 130))
    pen.rectangle((170, 50, 310, 220), fill=(90, 120, 180))
    pen.rectangle((180, 55, 300, 90), fill=(240, 240, 240))
    pen.rectangle((370, 120, 430, 280), fill=(235, 235, 230))
    pen.rectangle((60, 250, 120, 340), fill=(60, 130, 90))
    image.save(folder / "flat.png")
    bpy.ops.wm.read_factory_settings(use_empty=True)
    code_as_room.register()
    bpy.ops.code_as_room.load_picture(filepath=str(folder / "flat.png"))
    bpy.context.scene.code_as_room.iterations = 1
    bpy.ops.code_as_room.run_all()
    path = str(folder / "built.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    code_as_room.unregister()
    return path


@pytest.fixture(autouse=True)
def scene(built: str) -> Iterator[Any]:
    """The room, opened anew."""
    code_as_room.register()
    bpy.ops.wm.open_mainfile(filepath=built)
    yield bpy.context.scene
    code_as_room.unregister()


def state() -> RoomState:
    found = view_state.peek(bpy.context.scene)
    assert found is not None
    return found


def item(identifier: str) -> Any:
    """The row of an object."""
    return next(i for i in bpy.context.scene.code_as_room.objects if i.name == identifier)


def placed_ids() -> list[str]:
    return [row.id for row in state().objects if row.name]


def said() -> Corrections:
    return room_memory.memory_of(bpy.context.scene).latest(Corrections) or Corrections()


def selected() -> set[str]:
    return {o.name for o in bpy.context.view_layer.objects if o.select_get()}


def test_there_is_a_row_for_each_object_and_what_is_set_in_it_is_kept_with_the_room(scene: Any, tmp_path: Path) -> None:
    ids = [i.name for i in scene.code_as_room.objects]
    assert len(ids) >= 2 and ids == [row.id for row in state().objects]
    row = item(ids[0])
    row.locked, row.note, row.category = True, "  it faces \n the door ", "sofa"
    assert said().of(ids[0]).model_dump(include={"locked", "note", "category"}) == {
        "locked": True,
        "note": "it faces the door",
        "category": "sofa",
    }
    saved = str(tmp_path / "room.blend")
    bpy.ops.wm.save_as_mainfile(filepath=saved)
    bpy.ops.wm.open_mainfile(filepath=saved)
    row = item(ids[0])
    assert (row.locked, row.note, row.category) == (True, "it faces the door", "sofa")


def test_what_is_left_out_keeps_its_row_and_can_be_taken_in_again(scene: Any) -> None:
    ids = [i.name for i in scene.code_as_room.objects]
    item(ids[0]).include = False
    assert [i.name for i in scene.code_as_room.objects] == ids
    assert state().by_id[ids[0]].state == "left out"
    bpy.ops.code_as_room.include_objects(group="ALL", include=True)
    assert item(ids[0]).include and state().by_id[ids[0]].state != "left out"


def test_a_correction_that_cannot_be_is_told_and_nothing_changes(monkeypatch: pytest.MonkeyPatch, scene: Any) -> None:
    monkeypatch.setattr(driver, "is_running", lambda: True)
    row = item(placed_ids()[0])
    row.locked = True
    assert not row.locked and not said().objects
    outcome = driver.outcome_of(scene)
    assert outcome is not None and outcome.problem is not None and "run is going on" in outcome.problem.message


def test_choosing_a_row_selects_its_object_and_an_active_object_chooses_its_row(scene: Any) -> None:
    first, second = placed_ids()[:2]
    settings = scene.code_as_room
    settings.active_object = settings.objects.find(second)
    assert selected() == {second} and bpy.context.view_layer.objects.active.name == second
    obj = object_list.proxies(scene)[first]
    bpy.context.view_layer.objects.active = obj
    assert object_list.follow(scene)
    assert settings.objects[settings.active_object].name == first
    assert not object_list.follow(scene), "nothing moves when nothing changed"


def test_the_row_of_what_does_not_stand_in_the_room_stays_chosen(scene: Any) -> None:
    first, second = placed_ids()[:2]
    settings = scene.code_as_room
    settings.active_object = settings.objects.find(first)
    item(second).include = False
    bpy.ops.code_as_room.run_all()
    settings.active_object = settings.objects.find(second)
    assert selected() == set()
    view_state.refresh(scene)
    assert settings.objects[settings.active_object].name == second


def test_rows_are_not_written_again_when_nothing_changed(scene: Any) -> None:
    before = [i.as_pointer() for i in scene.code_as_room.objects]
    item(placed_ids()[0]).locked = True
    view_state.refresh_all()
    assert [i.as_pointer() for i in scene.code_as_room.objects] == before


def test_typing_filters_by_what_a_row_says_and_sorting_is_by_name(scene: Any) -> None:
    from code_as_room.panels.objects import CODE_AS_ROOM_UL_objects

    chosen = placed_ids()[0]
    item(chosen).locked = True
    fake: Any = SimpleNamespace(filter_name="locked detailed", bitflag_filter_item=1, use_filter_sort_alpha=True)
    flags, order = CODE_AS_ROOM_UL_objects.filter_items(fake, bpy.context, scene.code_as_room, "objects")
    ids = [i.name for i in scene.code_as_room.objects]
    assert [name for name, flag in zip(ids, flags, strict=True) if flag] == [chosen]
    assert [name for _, name in sorted(zip(order, ids, strict=True))] == sorted(ids, key=str.lower)


def test_verbs_for_several_objects(scene: Any) -> None:
    ids = placed_ids()
    bpy.ops.code_as_room.select_objects(group="ALL")
    assert selected() == set(ids)
    bpy.ops.code_as_room.lock_objects(group="SELECTED", lock=True)
    assert {row.id for row in state().locked} == set(ids)
    bpy.ops.code_as_room.lock_objects(identifier=ids[0], lock=False)
    assert {row.id for row in state().locked} == set(ids[1:])
    bpy.ops.code_as_room.lock_objects(group="LOCKED", lock=False)
    assert not state().locked
    bpy.ops.object.select_all(action="DESELECT")
    with pytest.raises(RuntimeError, match="Select one"):
        bpy.ops.code_as_room.lock_objects(group="SELECTED", lock=True)


def test_a_hand_edit_is_taken_over_told_in_words_and_can_be_unlocked(scene: Any) -> None:
    chosen = placed_ids()[0]
    object_list.proxies(scene)[chosen].location.x += 0.2
    bpy.ops.code_as_room.take_over()
    outcome = driver.outcome_of(scene)
    assert outcome is not None and outcome.text == "1 edit taken over"
    assert state().last_count == 1 and chosen in state().last_edits[0]
    row = state().by_id[chosen]
    assert row.edited and row.locked
    item(chosen).locked = False
    assert state().by_id[chosen].edited and not state().by_id[chosen].locked


def test_only_the_selected_objects_are_done_anew(scene: Any) -> None:
    stage = state().stage("s03_layout")
    assert stage is not None and stage.partial
    bpy.ops.object.select_all(action="DESELECT")
    with pytest.raises(RuntimeError, match="Select objects of the room"):
        bpy.ops.code_as_room.run_stage(stage="s03_layout", selected=True)
    first, *others = placed_ids()
    before = {name: object_list.proxies(scene)[name].matrix_world.copy() for name in others}
    object_list.select(scene, [first])
    bpy.ops.code_as_room.run_stage(stage="s03_layout", selected=True)
    standing = object_list.proxies(scene)
    assert first in standing
    assert all(standing[name].matrix_world == matrix for name, matrix in before.items() if name in standing)
    with pytest.raises(RuntimeError, match="always does all objects"):
        bpy.ops.code_as_room.run_stage(stage="s02_graph", selected=True)
