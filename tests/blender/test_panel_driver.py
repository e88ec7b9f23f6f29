# SPDX-License-Identifier: GPL-3.0-or-later
"""The window's driver, ticked by hand: what runs where, and that nothing is lost when a run is stopped or fails."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import bpy
import code_as_room
import pytest
from code_as_room.operators import clients, driver, view_state
from code_as_room.operators.scene_backend import ResolvedScene
from code_as_room.pipeline.artifacts.graph import MinorObjects
from code_as_room.pipeline.artifacts.layout import Layout, RoomLine
from code_as_room.pipeline.artifacts.replies import GraphReply
from code_as_room.pipeline.errors import Cancelled, ModelError, RoomError
from code_as_room.pipeline.memory import load_memory
from code_as_room.pipeline.models.base import Prompt, Reply
from code_as_room.pipeline.program.lines import print_layout
from code_as_room.pipeline.stages.base import Stage, View
from code_as_room.pipeline.stages.wishes import Ask, Build, Request, StageRun, Tell
from PIL import Image

ROOM = print_layout(Layout(room=RoomLine(size=(4, 3, 2.6), floor=[(-2, -1.5), (2, -1.5), (2, 1.5), (-2, 1.5)])))


class Client:
    """Answers with an empty reply; keys in `slow` wait until the run is stopped."""

    name, describes = "test", "A client for tests"

    def __init__(self, slow: str = "") -> None:
        self.slow, self.asked, self.threads = slow, [], set()  # type: ignore[var-annotated]
        self.waiting = threading.Event()

    def answer(self, prompt: Prompt, cancel: threading.Event, progress: Callable[[str], None] | None = None) -> Reply:
        self.asked.append(prompt.key)
        self.threads.add(threading.current_thread())
        if prompt.key == self.slow:
            self.waiting.set()
            assert cancel.wait(20)
            raise Cancelled
        return Reply('{"attributes": [], "relations": []}', "test", 10, 5, 0.01)


def question(key: str) -> Ask:
    return Ask((Request(key, "02_graph", GraphReply, {"objects": key, "walls": "north"}),))


def stage(body: Callable[[View], StageRun], name: str = "s02_graph") -> Stage:
    return Stage(name, "Test stage", (), (MinorObjects,), body)


def asks_twice(view: View) -> StageRun:
    yield Tell("first", 1, 2)
    yield question("one")
    yield Tell("second", 2, 2)
    yield question("two")
    return [MinorObjects(by_parent={"": ["lamp"]})]


@pytest.fixture
def scene(tmp_path: Path) -> Iterator[Any]:
    """A scene with a picture, in an empty file with the add-on enabled."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    code_as_room.register()
    path = tmp_path / "room.png"
    Image.new("RGB", (120, 100), "tan").save(path)
    bpy.ops.code_as_room.load_picture(filepath=str(path))
    yield bpy.context.scene
    code_as_room.unregister()


def use(client: Any, monkeypatch: pytest.MonkeyPatch) -> Any:
    monkeypatch.setattr(clients, "current_client", lambda: client)
    return client


def tick_until(done: Callable[[], bool]) -> None:
    """Tick as Blender's timer does, until something holds."""
    deadline = time.monotonic() + 20
    while not done():
        assert time.monotonic() < deadline, "it did not happen"
        if driver._tick() is None and not done():
            time.sleep(0.005)
        time.sleep(0.002)


def answers(scene: Any) -> list[str]:
    memory = load_memory(ResolvedScene(scene).load_memory())
    return [e.output["key"] for e in memory.entries if e.type == "Answer"]


def test_questions_and_the_stages_own_work_run_off_the_main_thread_and_builds_on_it(
    scene: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    client = use(Client(), monkeypatch)
    seen: dict[str, threading.Thread] = {}

    def body(view: View) -> StageRun:
        seen["start"] = threading.current_thread()
        yield question("one")
        seen["after the answer"] = threading.current_thread()
        yield Build(ROOM)
        seen["after the build"] = threading.current_thread()
        return [MinorObjects(by_parent={})]

    commit = ResolvedScene.commit

    def noted(self: ResolvedScene, plan: Any, made: Any) -> None:
        seen["build"] = threading.current_thread()
        commit(self, plan, made)

    monkeypatch.setattr(ResolvedScene, "commit", noted)
    driver.start(scene, [stage(body)])
    tick_until(lambda: not driver.is_running())
    main = threading.main_thread()
    assert seen.pop("build") is main
    assert main not in set(seen.values()) | client.threads and len(seen) == 3
    assert any(o.get("code_as_room_kind") == "floor" for o in scene.objects)
    assert driver.outcome_of(scene).problem is None


def test_ticks_return_at_once_while_the_model_thinks(scene: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    client = use(Client(slow="one"), monkeypatch)
    driver.start(scene, [stage(asks_twice)])
    tick_until(client.waiting.is_set)
    for _ in range(20):
        assert driver._tick() is not None
    assert driver.progress_of(scene).what == "first"
    driver.stop()
    tick_until(lambda: not driver.is_running())


def test_stop_keeps_what_was_answered_and_the_next_run_does_not_ask_it_again(
    scene: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    client = use(Client(slow="two"), monkeypatch)
    driver.start(scene, [stage(asks_twice)])
    tick_until(client.waiting.is_set)
    driver.stop()
    tick_until(lambda: not driver.is_running())
    assert driver.outcome_of(scene).text.startswith("Stopped")
    assert answers(scene) == ["one"]
    again = use(Client(), monkeypatch)
    driver.start(scene, [stage(asks_twice)])
    assert driver.run_blocking().problem is None
    assert again.asked == ["two"]
    redo = use(Client(), monkeypatch)
    driver.start(scene, [stage(asks_twice)], again=True, fresh=True)
    driver.run_blocking()
    assert redo.asked == ["one", "two"]


def test_an_answer_is_in_the_file_while_the_stage_still_runs(scene: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    client = use(Client(slow="two"), monkeypatch)
    driver.start(scene, [stage(asks_twice)])
    tick_until(client.waiting.is_set)
    assert answers(scene) == ["one"], "an auto-save or a crash now must not lose it"
    driver.stop()
    tick_until(lambda: not driver.is_running())


@pytest.mark.parametrize("error", [RoomError("The reply was odd.", "Run it again."), ZeroDivisionError("boom")])
def test_a_failing_stage_ends_the_run_with_a_sentence(
    scene: Any, monkeypatch: pytest.MonkeyPatch, error: Exception
) -> None:
    use(Client(), monkeypatch)

    def body(view: View) -> StageRun:
        yield question("one")
        raise error

    driver.start(scene, [stage(body), stage(asks_twice, "s03_layout")])
    tick_until(lambda: not driver.is_running())
    problem = driver.outcome_of(scene).problem
    assert problem is not None and "boom" not in problem.message
    assert isinstance(error, ZeroDivisionError) or problem.message == "The reply was odd."
    row = next(r for r in view_state.peek(scene).stages if r.id == "s02_graph")
    assert row.status == "failed" and problem.message in row.detail
    assert answers(scene) == ["one"]


def test_loading_another_file_drops_the_run_and_its_late_answer(scene: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    client = use(Client(slow="two"), monkeypatch)
    job = driver.start(scene, [stage(asks_twice)])
    tick_until(client.waiting.is_set)
    bpy.ops.wm.read_factory_settings(use_empty=True)
    assert not driver.is_running()
    deadline = time.monotonic() + 10
    while any(t.name.startswith("code-as-room") for t in threading.enumerate()) and time.monotonic() < deadline:
        time.sleep(0.01)
    assert not job.tick(1.0)
    assert not bpy.data.texts, "nothing of the old run reaches the new file"


def test_a_picture_that_was_exchanged_meanwhile_ends_the_run(scene: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    use(Client(), monkeypatch)

    def body(view: View) -> StageRun:
        yield Tell("about to build", 1, 1)
        yield Build(ROOM)
        return [MinorObjects(by_parent={})]

    driver.start(scene, [stage(body)])
    scene.code_as_room.picture = None
    tick_until(lambda: not driver.is_running())
    assert "changed" in driver.outcome_of(scene).problem.message
    assert not any(o.get("code_as_room_kind") == "floor" for o in scene.objects)


def test_two_runs_at_once_are_refused(scene: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    client = use(Client(slow="one"), monkeypatch)
    driver.start(scene, [stage(asks_twice)])
    tick_until(client.waiting.is_set)
    with pytest.raises(RoomError, match="Another run"):
        driver.start(scene, [stage(asks_twice)])
    assert not bpy.ops.code_as_room.run_stage.poll()
    bpy.ops.code_as_room.stop()
    tick_until(lambda: not driver.is_running())


class Preferences:
    """The add-on's preferences as `client_settings` reads them."""

    provider, base_url, model = "OPENAI", "https://models.example.com/v1", "big-1"
    api_key, key_variable, timeout, replies_folder = "", "", 60, ""


def test_no_request_leaves_the_computer_while_online_access_is_off(monkeypatch: pytest.MonkeyPatch) -> None:
    preferences = Preferences()
    monkeypatch.setattr(clients, "add_on_preferences", lambda: preferences)
    assert not bpy.app.online_access, "this test needs Blender's default"
    with pytest.raises(ModelError, match="online access is off"):
        clients.current_client()
    preferences.base_url = "http://localhost:1234/v1"
    assert clients.current_client().name
    client = Client()
    guarded = clients.GuardedClient(client)
    clients.watch_online_access(guarded)
    with pytest.raises(ModelError, match="online access is off"):
        guarded.answer(Prompt("s", "k", "t", (), "n", {}, "h"), threading.Event())
    assert client.asked == []


def test_the_key_may_come_from_the_environment(monkeypatch: pytest.MonkeyPatch) -> None:
    preferences = Preferences()
    preferences.api_key, preferences.key_variable = "typed", "CODE_AS_ROOM_TEST_KEY"
    monkeypatch.setattr(clients, "add_on_preferences", lambda: preferences)
    monkeypatch.delenv("CODE_AS_ROOM_TEST_KEY", raising=False)
    with pytest.raises(ModelError, match="CODE_AS_ROOM_TEST_KEY") as caught:
        clients.client_settings()
    assert "typed" not in str(caught.value)
    monkeypatch.setenv("CODE_AS_ROOM_TEST_KEY", "from outside")
    assert clients.client_settings().api_key == "from outside"
    assert "from outside" not in repr(clients.client_settings())
