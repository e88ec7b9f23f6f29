# SPDX-License-Identifier: GPL-3.0-or-later
"""What an artist does while a run goes on is neither lost nor overwritten, and a stop never leaves half a room."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import bpy
import code_as_room
import pytest
from code_as_room.operators import clients, driver, late, room_memory
from code_as_room.operators.building import Building
from code_as_room.operators.scene_backend import ResolvedScene
from code_as_room.pipeline.artifacts.graph import MinorObjects
from code_as_room.pipeline.artifacts.hand import HandEdits
from code_as_room.pipeline.artifacts.layout import Layout, ProxyLine, RoomLine
from code_as_room.pipeline.artifacts.replies import GraphReply
from code_as_room.pipeline.memory import Memory, dump_memory, load_memory
from code_as_room.pipeline.models.base import Prompt, Reply
from code_as_room.pipeline.program.lines import parse_layout, print_layout
from code_as_room.pipeline.scene import backend as scene_backend
from code_as_room.pipeline.scene.plan import plan_build
from code_as_room.pipeline.stages.base import Stage, View
from code_as_room.pipeline.stages.wishes import Ask, Build, Request, StageRun, Tell
from PIL import Image


def room(*proxies: tuple[str, float, float]) -> str:
    """A room program with boxes at these places."""
    lines = [
        ProxyLine(id=name, category="table", centre=(x, y, 0.4), size=(0.8, 0.6, 0.8), yaw=0.0)
        for name, x, y in proxies
    ]
    floor = [(-2, -1.5), (2, -1.5), (2, 1.5), (-2, 1.5)]
    return print_layout(Layout(room=RoomLine(size=(4, 3, 2.6), floor=floor), proxies=lines))


BEFORE, AFTER = room(("desk", -1.0, 0.0)), room(("desk", 0.0, 0.5), ("bench", 1.0, 0.5))


class Client:
    """Answers with an empty reply; it waits at `slow` until `go_on` is set, whatever is cancelled meanwhile."""

    name, describes = "test", "A client for tests"

    def __init__(self, slow: str = "slow") -> None:
        self.slow = slow
        self.asked: list[str] = []
        self.waiting, self.go_on = threading.Event(), threading.Event()

    def answer(self, prompt: Prompt, cancel: threading.Event, progress: Callable[[str], None] | None = None) -> Reply:
        self.asked.append(prompt.key)
        if prompt.key == self.slow:
            self.waiting.set()
            assert self.go_on.wait(20)
        return Reply('{"attributes": [], "relations": []}', "test", 10, 5, 0.01)


def question(key: str) -> Ask:
    return Ask((Request(key, "02_graph", GraphReply, {"objects": key, "walls": "north"}),))


def stage(body: Callable[[View], StageRun], settings: tuple[str, ...] = ("known_width_m",)) -> Stage:
    made = Stage("s02_graph", "Test stage", (), (MinorObjects,), body)
    object.__setattr__(made, "settings", settings)
    return made


def builds_after_thinking(view: View) -> StageRun:
    yield Tell("thinking", 1, 2)
    yield question("slow")
    yield Build(AFTER)
    yield question("last")
    return [MinorObjects(by_parent={"": ["lamp"]})]


def builds_twice(view: View) -> StageRun:
    yield Build(AFTER)
    yield question("slow")
    yield Build(room(("desk", 0.0, 0.9), ("bench", 1.0, 0.5)))
    yield question("last")
    yield Build(room(("desk", 0.0, -0.9), ("bench", 1.0, 0.5)))
    return [MinorObjects(by_parent={})]


def builds_and_thinks(view: View) -> StageRun:
    yield Build(AFTER)
    yield question("slow")
    return [MinorObjects(by_parent={})]


@pytest.fixture
def scene(tmp_path: Path) -> Iterator[Any]:
    """A scene with a picture and a room with a desk in it."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    code_as_room.register()
    path = tmp_path / "room.png"
    Image.new("RGB", (120, 100), "tan").save(path)
    bpy.ops.code_as_room.load_picture(filepath=str(path))
    ResolvedScene(bpy.context.scene).build(BEFORE)
    yield bpy.context.scene
    late.forget_all()
    code_as_room.unregister()


@pytest.fixture
def client(monkeypatch: pytest.MonkeyPatch) -> Iterator[Client]:
    made = Client()
    monkeypatch.setattr(clients, "current_client", lambda: made)
    monkeypatch.setattr(clients, "room_client", lambda *_: made)
    yield made
    made.go_on.set()


def thing(name: str, where: Any = None) -> Any:
    return next((o for o in (where or bpy.context.scene).objects if o.get("code_as_room_id") == name), None)


def place(name: str) -> tuple[float, float]:
    at = thing(name).matrix_world.translation
    return round(at.x, 3), round(at.y, 3)


def tick_until(done: Callable[[], bool]) -> None:
    """Tick as Blender's timer does, until something holds."""
    deadline = time.monotonic() + 20
    while not done():
        assert time.monotonic() < deadline, "it did not happen"
        driver._tick()
        late.pump()
        time.sleep(0.002)


def run_to_the_slow_question(
    scene: Any, client: Client, body: Callable[[View], StageRun] = builds_after_thinking
) -> None:
    driver.start(scene, [stage(body)], again=True)
    tick_until(client.waiting.is_set)


def finish(client: Client) -> Any:
    client.go_on.set()
    tick_until(lambda: not driver.is_running())


def memory_of(scene: Any) -> Memory:
    return load_memory(ResolvedScene(scene).load_memory())


def kept(scene: Any, kind: str) -> list[Any]:
    return [entry.output for entry in memory_of(scene).entries if entry.type == kind]


def program(scene: Any) -> dict[str, tuple[float, float]]:
    """Where the program has the proxies."""
    return {p.id: p.centre[:2] for p in parse_layout(ResolvedScene(scene).program_text()).proxies}


def test_what_is_moved_while_the_model_thinks_stays_where_the_artist_put_it(scene: Any, client: Client) -> None:
    run_to_the_slow_question(scene, client)
    thing("desk").location.y -= 0.7
    bpy.context.view_layer.update()
    finish(client)
    assert driver.outcome_of(scene).problem is None
    assert place("desk") == (-1.0, -0.7) and place("bench") == (1.0, 0.5)
    assert program(scene) == {"desk": (-1.0, -0.7), "bench": (1.0, 0.5)}
    assert [edit["id"] for edits in kept(scene, "HandEdits") for edit in edits["edits"]] == ["desk"], "told once"
    assert ResolvedScene(scene).read_back() == []


def test_what_is_added_and_deleted_meanwhile_is_kept_too(scene: Any, client: Client) -> None:
    run_to_the_slow_question(scene, client, builds_twice)
    bpy.ops.mesh.primitive_cube_add(size=0.5, location=(-1.5, -1.0, 0.25))
    added = bpy.context.object
    for owner in list(added.users_collection):
        owner.objects.unlink(added)
    thing("desk").users_collection[0].objects.link(added)
    bpy.data.objects.remove(thing("bench"))
    finish(client)
    assert driver.outcome_of(scene).problem is None
    assert set(program(scene)) == {"desk", "cube"} and thing("cube") == added and thing("bench") is None
    assert place("desk") == (0.0, -0.9), "what the artist left alone follows the stage"
    assert sorted(e["op"] for edits in kept(scene, "HandEdits") for e in edits["edits"]) == ["add", "remove"]


def test_a_stop_puts_the_room_back_but_not_the_artists_move(scene: Any, client: Client) -> None:
    run_to_the_slow_question(scene, client, builds_and_thinks)
    assert place("desk") == (0.0, 0.5)
    thing("desk").location.y = -1.0
    bpy.context.view_layer.update()
    driver.stop()
    finish(client)
    assert driver.outcome_of(scene).text.startswith("Stopped")
    assert place("desk") == (0.0, -1.0), "the artist's place counts, not the one that stood before"
    assert thing("bench") is None and set(program(scene)) == {"desk"}
    assert kept(scene, "HandEdits")


def test_a_result_made_from_settings_that_changed_is_not_applied(scene: Any, client: Client) -> None:
    run_to_the_slow_question(scene, client)
    settings = scene.code_as_room
    settings["use_known_width"], settings["known_width"] = True, 5.0
    if not settings.use_known_width:  # from 5.0 on, registered properties are not custom properties
        settings.use_known_width, settings.known_width = True, 5.0
    finish(client)
    problem = driver.outcome_of(scene).problem
    assert problem is not None and "not applied" in problem.message and "kept" in problem.fix
    assert not kept(scene, "MinorObjects") and [a["key"] for a in kept(scene, "Answer")] == ["slow"]
    assert program(scene) == {"desk": (-1.0, 0.0)} and thing("bench") is None


def test_settings_that_the_stage_does_not_use_may_change(scene: Any, client: Client) -> None:
    run_to_the_slow_question(scene, client)
    scene.code_as_room.iterations = 2
    finish(client)
    assert driver.outcome_of(scene).problem is None and kept(scene, "MinorObjects")


def test_an_earlier_memory_that_undo_brought_back_keeps_the_answers_and_nothing_else(
    scene: Any, client: Client
) -> None:
    memory = Memory(picture_hash=scene.code_as_room.picture["code_as_room_reference"])
    text = dump_memory(memory)
    backend = ResolvedScene(scene)
    backend.save_memory(text)
    backend.flush()

    def body(view: View) -> StageRun:
        yield question("first")
        yield Tell("the first answer is in the file", 1, 2)
        yield question("slow")
        return [MinorObjects(by_parent={"": ["lamp"]})]

    run_to_the_slow_question(scene, client, body)
    assert [a["key"] for a in kept(scene, "Answer")] == ["first"]
    backend.save_memory(text)
    backend.flush()  # as undo does
    assert not kept(scene, "Answer")
    finish(client)
    assert driver.outcome_of(scene).problem is None, "nothing that the stage read was changed"
    assert sorted(a["key"] for a in kept(scene, "Answer")) == ["first", "slow"]
    assert kept(scene, "MinorObjects")


def test_a_deleted_scene_ends_the_run_with_a_sentence(scene: Any, client: Client) -> None:
    other = bpy.data.scenes.new("Other")
    run_to_the_slow_question(scene, client)
    bpy.data.scenes.remove(scene)
    finish(client)
    outcome = driver.outcome_of(other)
    assert outcome is not None and "deleted" in outcome.problem.message
    assert thing("bench", other) is None


def test_a_run_builds_in_its_own_scene_whichever_is_looked_at(scene: Any, client: Client) -> None:
    other = bpy.data.scenes.new("Other")
    run_to_the_slow_question(scene, client)
    if bpy.context.window is not None:
        bpy.context.window.scene = other
    finish(client)
    assert thing("bench", scene) is not None and thing("bench", other) is None
    assert driver.outcome_of(scene).problem is None


def test_answers_are_in_a_file_that_is_saved_meanwhile(scene: Any, client: Client, tmp_path: Path) -> None:
    def body(view: View) -> StageRun:
        yield question("first")
        yield question("slow")
        return [MinorObjects(by_parent={})]

    run_to_the_slow_question(scene, client, body)
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "meanwhile.blend"), copy=True)
    with bpy.data.libraries.load(str(tmp_path / "meanwhile.blend")) as (inside, wanted):
        wanted.texts = [name for name in inside.texts if name.startswith("Code-as-Room Memory")]
    saved = load_memory(wanted.texts[0].as_string())
    assert [e.output["key"] for e in saved.entries if e.type == "Answer"] == ["first"]
    finish(client)


def test_a_text_that_the_artist_edits_meanwhile_is_set_aside_and_not_lost(scene: Any, client: Client) -> None:
    run_to_the_slow_question(scene, client)
    text = next(t for t in bpy.data.texts if t.name.startswith("room.py"))
    text.write("# my own remark\n")
    finish(client)
    assert any("# my own remark" in t.as_string() for t in bpy.data.texts)
    assert any("edits" in notice for notice in driver.outcome_of(scene).notices) or "remark" in text.as_string()


def test_stop_is_over_soon_and_the_late_answer_is_kept_not_applied(scene: Any, client: Client) -> None:
    run_to_the_slow_question(scene, client)
    driver.stop()
    tick_until(lambda: not driver.is_running())
    assert not client.go_on.is_set(), "it is over although the service still has not answered"
    assert bpy.ops.code_as_room.run_all.poll(), "the panel can be used again"
    assert not kept(scene, "Answer")
    client.go_on.set()
    tick_until(lambda: not late._jobs)
    assert not kept(scene, "MinorObjects") and thing("bench") is None
    client.asked.clear()
    driver.start(scene, [stage(builds_after_thinking)], again=True)
    tick_until(lambda: not driver.is_running())
    assert driver.outcome_of(scene).problem is None


def test_what_was_done_after_a_stop_outlives_the_late_answer(scene: Any, client: Client) -> None:
    run_to_the_slow_question(scene, client)
    driver.stop()
    tick_until(lambda: not driver.is_running())
    thing("desk").location.x += 0.25
    bpy.context.view_layer.update()
    run = room_memory.run_of(scene)
    run.take_over_edits()
    room_memory.keep(run)
    assert len(kept(scene, "HandEdits")) == 1
    client.go_on.set()
    tick_until(lambda: not late._jobs)
    assert len(kept(scene, "HandEdits")) == 1, "the late answer must not bring back the memory of before"
    assert place("desk") == (-0.75, 0.0) and program(scene)["desk"] == (-0.75, 0.0)


def test_a_build_shows_nothing_before_all_of_it_is_ready(scene: Any) -> None:
    backend = ResolvedScene(scene)
    meshes = len(bpy.data.meshes)
    dropped = Building(backend, plan_build(AFTER))
    while dropped.step():
        assert thing("bench") is None and place("desk") == (-1.0, 0.0)
    assert len(bpy.data.meshes) > meshes
    dropped.drop()
    assert len(bpy.data.meshes) == meshes and program(scene) == {"desk": (-1.0, 0.0)}
    building = Building(backend, plan_build(AFTER))
    while building.step():
        pass
    for mesh in [m for m in bpy.data.meshes if m.users == 0]:
        bpy.data.meshes.remove(mesh)  # as an undo does
    building.commit()
    assert place("desk") == (0.0, 0.5) and len(thing("bench").data.vertices)
    assert set(program(scene)) == {"desk", "bench"} and not [m for m in bpy.data.meshes if m.users == 0]


def test_a_build_that_fails_in_the_middle_leaves_the_former_room(scene: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    realise, calls = scene_backend.realise_plan, []

    def breaks(plan: Any, name: str, where: Any, made: Any) -> None:
        realise(plan, name, where, made)
        calls.append(plan)
        if len(calls) == 1:
            raise MemoryError("in the middle")

    monkeypatch.setattr(scene_backend, "realise_plan", breaks)
    with pytest.raises(MemoryError):
        ResolvedScene(scene).build(AFTER)
    assert place("desk") == (-1.0, 0.0) and thing("bench") is None and program(scene) == {"desk": (-1.0, 0.0)}


def test_hand_edits_reach_the_stages_that_follow(scene: Any, client: Client) -> None:
    run_to_the_slow_question(scene, client)
    thing("desk").location.y -= 0.7
    bpy.context.view_layer.update()
    finish(client)
    seen: list[View] = []

    def body(view: View) -> StageRun:
        seen.append(view)
        yield Tell("looking", 1, 1)
        return [MinorObjects(by_parent={})]

    driver.start(scene, [stage(body)], again=True)
    tick_until(lambda: not driver.is_running())
    assert seen[0].locked == {"desk"}
    assert memory_of(scene).latest(HandEdits) is not None
