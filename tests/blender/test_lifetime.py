# SPDX-License-Identifier: GPL-3.0-or-later
"""What a room lives through: crashes, copies and deletions of scenes, linked files, and what is deleted by hand."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import bpy
import code_as_room
import pytest
from code_as_room.operators import clients, driver, journals, own_room, reference, rooms, view_state
from code_as_room.operators.scene_backend import ResolvedScene
from code_as_room.pipeline.errors import MemoryFormatError, RoomError
from code_as_room.pipeline.memory import FORMAT, Memory, load_memory
from code_as_room.pipeline.models.recorded import RecordedClient
from code_as_room.pipeline.scene.tags import ID, LINE, find_room_collection
from code_as_room.pipeline.scene.texts import MEMORY, PROGRAM
from code_as_room.pipeline.stages import all_stages

STAGES = 3
"""Stages that are run: up to the layout, which is built."""


class Counting(RecordedClient):
    """Recorded answers, with every key that was asked."""

    def __init__(self, folder: Path) -> None:
        super().__init__(folder)
        self.asked: list[str] = []

    def answer(self, prompt: Any, cancel: Any, progress: Any = None) -> Any:
        self.asked.append(prompt.key)
        return super().answer(prompt, cancel, progress)


@pytest.fixture
def client(room: Any, monkeypatch: pytest.MonkeyPatch) -> Counting:
    made = Counting(room.record())
    monkeypatch.setattr(clients, "current_client", lambda *_: made)
    return made


@pytest.fixture
def scene(room: Any, client: Counting, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Any]:
    """A scene with a picture, in an empty file with the add-on enabled and its journals in a folder of their own."""
    monkeypatch.setattr(journals, "folder", lambda: tmp_path / "journal")
    bpy.ops.wm.read_factory_settings(use_empty=True)
    code_as_room.register()
    bpy.ops.code_as_room.load_picture(filepath=str(room.picture))
    bpy.context.scene.code_as_room.iterations = 1
    yield bpy.context.scene
    code_as_room.unregister()


def run(scene: Any, stages: int = STAGES) -> driver.Outcome:
    """Run the first stages to their end."""
    driver.start(scene, all_stages()[:stages])
    return driver.run_blocking()


def built(scene: Any) -> Any:
    outcome = run(scene)
    assert outcome.problem is None, outcome.problem
    return scene


def statuses(scene: Any) -> list[str]:
    return [row.status for row in view_state.refresh(scene).stages[:STAGES]]


def memory(scene: Any) -> Memory:
    return load_memory(ResolvedScene(scene).load_memory())


def proxies(scene: Any) -> dict[str, Any]:
    room = find_room_collection(scene)
    return {o[ID]: o for o in room.all_objects if o.get("code_as_room_kind") == "proxy"} if room else {}


def refused(scene: Any) -> str:
    """The sentence with which a run is refused; the panel must say the same."""
    with pytest.raises(RoomError) as caught:
        driver.start(scene, all_stages()[:STAGES])
    assert not driver.is_running()
    problem = view_state.refresh(scene).problem
    assert problem is not None and problem.message == caught.value.message
    return str(caught.value)


# ---- the journal ----


def test_a_crash_without_saving_costs_no_answer(scene: Any, room: Any, client: Counting) -> None:
    built(scene)
    asked, boxes = len(client.asked), {i: tuple(o.matrix_world.translation) for i, o in proxies(scene).items()}
    journals.forget_all()
    bpy.ops.wm.read_factory_settings(use_empty=True)  # nothing was saved
    bpy.ops.code_as_room.load_picture(filepath=str(room.picture))
    fresh = bpy.context.scene
    fresh.code_as_room.iterations = 1
    assert statuses(fresh)[0] == "answered"
    assert run(fresh).problem is None and len(client.asked) == asked
    assert statuses(fresh) == ["done"] * STAGES
    assert {i: tuple(o.matrix_world.translation) for i, o in proxies(fresh).items()} == boxes


def test_a_stage_that_was_undone_says_so_and_asks_nothing_again(scene: Any, client: Counting) -> None:
    run(scene, 1)
    before = ResolvedScene(scene).load_memory()
    run(scene, 2)
    asked = len(client.asked)
    ResolvedScene(scene).save_memory("")
    find_room_collection(scene)[MEMORY].from_string(before)  # what undo does to the text
    assert statuses(scene)[:2] == ["done", "answered"]
    assert run(scene, 2).problem is None and len(client.asked) == asked
    assert statuses(scene)[:2] == ["done", "done"]


def test_redo_asks_anew_and_its_answers_are_kept_as_well(scene: Any, client: Counting) -> None:
    built(scene)
    asked = len(client.asked)
    driver.start(scene, all_stages()[:1], again=True, fresh=True)
    driver.run_blocking()
    assert client.asked[asked:] == client.asked[:2]


def test_forgotten_answers_are_gone_from_this_computer_and_not_from_the_file(scene: Any, client: Counting) -> None:
    built(scene)
    journal = journals.journal_of(reference.picture_mark(scene))
    assert journal is not None and journal.path.is_file() and journal.answers()
    bpy.ops.code_as_room.forget_answers()
    assert not journal.path.exists() and not journal.answers()
    assert statuses(scene) == ["done"] * STAGES and any(e.type == "Answer" for e in memory(scene).entries)


def test_a_journal_that_cannot_be_written_stops_nothing_and_is_told(
    scene: Any, tmp_path: Path, client: Counting
) -> None:
    (tmp_path / "journal").write_text("a file is in the way")
    built(scene)
    assert "cannot be kept on this computer" in journals.problem_of(scene)


# ---- copies of scenes ----


@pytest.mark.parametrize("kind", ["FULL_COPY", "LINK_COPY"])
def test_a_copied_scene_gets_a_room_of_its_own(scene: Any, kind: str, client: Counting) -> None:
    built(scene)
    names, parents = set(proxies(scene)), {i: o.parent and o.parent[ID] for i, o in proxies(scene).items()}
    bpy.ops.scene.new(type=kind)
    copy = bpy.context.scene
    assert copy != scene
    own_room.look_after_copies()
    first, second = find_room_collection(scene), find_room_collection(copy)
    assert first != second and set(proxies(copy)) == names
    assert {i: o.parent and o.parent[ID] for i, o in proxies(copy).items()} == parents
    assert not set(first.all_objects) & set(second.all_objects)
    assert not {o.data for o in first.all_objects} & {o.data for o in second.all_objects}
    assert first[MEMORY] != second[MEMORY] and first[PROGRAM] != second[PROGRAM]
    assert statuses(scene) == statuses(copy) == ["done"] * STAGES
    bed = proxies(copy)["bed"]
    place, theirs = tuple(proxies(scene)["bed"].location), first[MEMORY].as_string()
    bed.location.x += 0.25
    driver.start(copy, all_stages()[1:2], again=True)
    assert driver.run_blocking().problem is None
    assert tuple(proxies(scene)["bed"].location) == place and first[MEMORY].as_string() == theirs
    assert statuses(scene) == ["done"] * STAGES
    assert view_state.refresh(copy).hand_edits == 1 and view_state.refresh(scene).hand_edits == 0


def test_scenes_that_share_a_collection_around_the_room_are_told_apart_by_the_artist(
    scene: Any, client: Counting
) -> None:
    built(scene)
    room, around = find_room_collection(scene), bpy.data.collections.new("House")
    scene.collection.children.link(around)
    around.children.link(room)
    scene.collection.children.unlink(room)
    bpy.ops.scene.new(type="LINK_COPY")
    with pytest.raises(RoomError, match="shares its room"):
        driver.start(bpy.context.scene, all_stages()[:STAGES])
    own_room.look_after_copies()  # what runs unasked says nothing and does nothing
    assert find_room_collection(scene) == room and len(proxies(scene)) > 3


def test_a_scene_in_no_window_runs_and_a_deleted_one_leaves_the_other_alone(scene: Any, client: Counting) -> None:
    built(scene)
    bpy.ops.scene.new(type="FULL_COPY")
    copy = bpy.context.scene
    assert bpy.context.window is None or bpy.context.window.scene == copy
    driver.start(scene, all_stages()[1:2], again=True)  # not the scene that is shown
    assert driver.run_blocking().problem is None
    before = find_room_collection(scene)[MEMORY].as_string()
    bpy.data.scenes.remove(copy)
    view_state.refresh_all()
    assert statuses(scene) == ["done"] * STAGES and run(scene).problem is None
    assert find_room_collection(scene)[MEMORY].as_string() == before


# ---- what is deleted, unlinked, renamed or broken by hand ----


def test_renamed_things_are_found_again(scene: Any, client: Counting) -> None:
    built(scene)
    room = find_room_collection(scene)
    room.name, room[MEMORY].name, room[PROGRAM].name = "My House", "notes", "script"
    assert statuses(scene) == ["done"] * STAGES
    asked = len(client.asked)
    assert run(scene).problem is None and len(client.asked) == asked


def test_a_room_whose_collection_was_unlinked_is_linked_again(scene: Any, client: Counting) -> None:
    built(scene)
    room, names = find_room_collection(scene), set(proxies(scene))
    scene.collection.children.unlink(room)
    outcome = run(scene)
    assert outcome.problem is None and any("linked again" in notice for notice in outcome.notices)
    assert find_room_collection(scene) == room and set(proxies(scene)) == names
    assert statuses(scene) == ["done"] * STAGES


@pytest.mark.parametrize("objects", [True, False], ids=["with its objects", "and its objects stayed"])
def test_a_room_whose_collection_was_deleted_is_put_together_again(scene: Any, client: Counting, objects: bool) -> None:
    built(scene)
    proxies(scene)["bed"].location.x += 0.25
    driver.start(scene, all_stages()[1:2], again=True)
    driver.run_blocking()
    boxes = {i: tuple(round(v, 4) for v in o.matrix_world.translation) for i, o in proxies(scene).items()}
    room, asked = find_room_collection(scene), len(client.asked)
    for obj in list(room.all_objects):
        if objects:
            bpy.data.objects.remove(obj)
        else:
            scene.collection.objects.link(obj)  # what Blender does when a collection is deleted
    for collection in [*room.children_recursive, room]:
        bpy.data.collections.remove(collection)
    outcome = run(scene)
    assert outcome.problem is None and any("put together again" in notice for notice in outcome.notices)
    assert statuses(scene) == ["done"] * STAGES and len(client.asked) == asked
    after = {i: tuple(round(v, 4) for v in o.matrix_world.translation) for i, o in proxies(scene).items()}
    assert after == boxes, "moved by hand included"
    assert len([o for o in scene.objects if o.get(ID) == "bed"]) == 1
    assert view_state.refresh(scene).hand_edits == 1


def test_a_deleted_memory_is_told_and_answered_from_the_journal(scene: Any, client: Counting) -> None:
    built(scene)
    asked, names = len(client.asked), set(proxies(scene))
    bpy.data.texts.remove(find_room_collection(scene)[MEMORY])
    assert statuses(scene)[0] == "answered"
    outcome = run(scene)
    assert outcome.problem is None and any("memory of this room was deleted" in n for n in outcome.notices)
    assert len(client.asked) == asked and set(proxies(scene)) == names


def test_a_broken_memory_stays_as_it_is_and_its_place_is_named(scene: Any, client: Counting) -> None:
    built(scene)
    text = find_room_collection(scene)[MEMORY]
    broken = text.as_string().replace('"entries": [', '"entries": ', 1)
    text.from_string(broken)
    said = refused(scene)
    assert "line" in said and "column" in said
    with pytest.raises(RuntimeError, match="column"):
        bpy.ops.code_as_room.run_all()
    assert text.as_string() == broken and len(bpy.data.texts) == 2


def test_a_room_of_a_newer_version_is_left_alone(scene: Any, client: Counting) -> None:
    built(scene)
    text = find_room_collection(scene)[MEMORY]
    newer = text.as_string().replace(FORMAT, FORMAT.rpartition("/")[0] + "/12", 1)
    text.from_string(newer)
    assert "newer version" in refused(scene) and text.as_string() == newer
    for damaged in ("code-as-room/memory/x", "code-as-room/memory/0", "other/2"):
        with pytest.raises(MemoryFormatError, match="format"):
            load_memory(newer.replace(FORMAT.rpartition("/")[0] + "/12", damaged, 1))


def test_copies_of_objects_share_no_id_after_a_run(scene: Any, client: Counting) -> None:
    built(scene)
    bed = proxies(scene)["bed"]
    twin = bed.copy()
    twin.data = bed.data.copy()
    twin.location.x += 0.5
    bed.users_collection[0].objects.link(twin)
    driver.start(scene, all_stages()[1:2], again=True)
    assert driver.run_blocking().problem is None
    ids = [o[ID] for o in find_room_collection(scene).all_objects if o.get("code_as_room_kind") == "proxy"]
    assert len(ids) == len(set(ids)) and bed[ID] == "bed" and twin[ID] != "bed"


# ---- the reference image ----


def test_an_unpacked_picture_is_used_for_as_long_as_its_file_is_the_same(
    scene: Any, tmp_path: Path, client: Counting
) -> None:
    run(scene, 1)
    image = scene.code_as_room.picture
    image.filepath_raw = str(tmp_path / "unpacked.png")
    data = bytes(image.packed_file.data)
    Path(image.filepath_raw).write_bytes(data)
    image.unpack(method="REMOVE")
    assert image.packed_file is None
    assert statuses(scene)[0] == "done" and run(scene, 2).problem is None
    assert bytes(scene.code_as_room.picture.packed_file.data) == data, "it is in the file again"


@pytest.mark.parametrize("change", ["gone", "changed", "removed"])
def test_a_picture_that_is_gone_or_changed_is_told_and_loading_it_again_goes_on(
    scene: Any, room: Any, tmp_path: Path, client: Counting, change: str
) -> None:
    run(scene, 1)
    asked, image = len(client.asked), scene.code_as_room.picture
    if change == "removed":
        bpy.data.images.remove(image)
    else:
        image.filepath_raw = str(tmp_path / "unpacked.png")
        image.unpack(method="REMOVE")
        if change == "changed":
            Path(image.filepath_raw).write_bytes(b"something else")
    with pytest.raises(RoomError, match=r"room\.png.*Load the same picture again"):
        driver.start(scene, all_stages()[:STAGES])
    assert view_state.refresh(scene).blocker
    bpy.ops.code_as_room.load_picture(filepath=str(room.picture))
    assert statuses(scene)[0] == "done" and run(scene).problem is None
    assert client.asked[asked:].count("01_analysis") == 0


# ---- linked and overridden data ----


def saved(scene: Any, tmp_path: Path) -> str:
    path = str(tmp_path / "house.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path, check_existing=False, copy=True)
    return path


def link(path: str, **names: list[str]) -> list[Any]:
    with bpy.data.libraries.load(path, link=True) as (_, wanted):
        for kind, values in names.items():
            setattr(wanted, kind, values)
    return [item for kind in names for item in getattr(wanted, kind)]


def state_of(room: Any) -> list[Any]:
    texts = [room[name].as_string() for name in (MEMORY, PROGRAM)]
    objects = [(o.name, tuple(map(tuple, o.matrix_basis)), sorted(o.keys())) for o in room.all_objects]
    return [sorted(room.keys()), texts, sorted(objects)]


@pytest.mark.parametrize("override", [False, True], ids=["linked", "overridden"])
def test_a_room_of_another_file_is_never_written_to(
    scene: Any, room: Any, tmp_path: Path, client: Counting, override: bool
) -> None:
    built(scene)
    name = find_room_collection(scene).name
    path = saved(scene, tmp_path)
    bpy.ops.wm.read_factory_settings(use_empty=True)
    here = bpy.context.scene
    (linked,) = link(path, collections=[name])
    here.collection.children.link(linked)
    if override:
        linked = linked.override_hierarchy_create(here, bpy.context.view_layer)
    before = state_of(linked)
    with pytest.raises(RuntimeError, match=r"house\.blend"):
        bpy.ops.code_as_room.load_picture(filepath=str(room.picture))
    assert state_of(linked) == before and here.code_as_room.picture is None
    with pytest.raises(RoomError, match=r"house\.blend"):
        rooms.put_aside(here)
    assert state_of(linked) == before


def test_a_linked_scene_is_refused(scene: Any, tmp_path: Path, client: Counting) -> None:
    built(scene)
    path, name = saved(scene, tmp_path), scene.name
    bpy.ops.wm.read_factory_settings(use_empty=True)
    (linked,) = link(path, scenes=[name])
    assert "house.blend" in refused(linked)


def test_a_room_beside_a_linked_one_is_this_files_own(scene: Any, room: Any, tmp_path: Path, client: Counting) -> None:
    built(scene)
    name = find_room_collection(scene).name
    path = saved(scene, tmp_path)
    (linked,) = link(path, collections=[name])
    scene.collection.children.unlink(find_room_collection(scene))
    scene.collection.children.link(linked)
    own = next(c for c in bpy.data.collections if c.library is None and c.name == name)
    scene.collection.children.link(own)
    before = state_of(linked)
    assert find_room_collection(scene) == own and run(scene).problem is None
    assert state_of(linked) == before


@pytest.mark.parametrize("what", ["object", "text"])
def test_a_linked_thing_inside_the_room_is_named(scene: Any, tmp_path: Path, client: Counting, what: str) -> None:
    built(scene)
    path, room = saved(scene, tmp_path), find_room_collection(scene)
    if what == "text":
        (text,) = link(path, texts=[room[MEMORY].name])
        room[MEMORY] = text
    else:
        (sofa,) = link(path, objects=[proxies(scene)["chair"].name])
        room.objects.link(sofa)
        assert LINE in sofa
    said = refused(scene)
    assert "house.blend" in said and ("chair" in said or what == "text")
