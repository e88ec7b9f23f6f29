# SPDX-License-Identifier: GPL-3.0-or-later
"""A room that grows while its answer is written: what stands when, and what stays when the artist or the service stops it."""

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
from code_as_room.operators.scene_backend import ResolvedScene
from code_as_room.pipeline import prompting
from code_as_room.pipeline.artifacts.graph import MinorObjects
from code_as_room.pipeline.artifacts.hand import HandEdits
from code_as_room.pipeline.artifacts.layout import Layout, ProxyLine, RoomLine
from code_as_room.pipeline.artifacts.replies import PlainReply
from code_as_room.pipeline.errors import Cancelled, ModelError
from code_as_room.pipeline.memory import Memory, load_memory
from code_as_room.pipeline.models.base import Prompt, Reply
from code_as_room.pipeline.program.lines import print_layout
from code_as_room.pipeline.stages.base import Stage, View
from code_as_room.pipeline.stages.wishes import Ask, Build, Request, StageRun
from PIL import Image

WAIT = 20.0


def room(names: list[str]) -> str:
    """A room program with a box a name, in a row."""
    lines = [
        ProxyLine(id=name, category="table", centre=(0.8 * place - 1.5, 0.0, 0.4), size=(0.6, 0.6, 0.8), yaw=0.0)
        for place, name in enumerate(names)
    ]
    floor = [(-2, -1.5), (2, -1.5), (2, 1.5), (-2, 1.5)]
    return print_layout(Layout(room=RoomLine(size=(4, 3, 2.6), floor=floor), proxies=lines))


class Lines:
    """Every whole line of the answer is an object's name."""

    def __init__(self) -> None:
        self.known: list[str] = []

    def hear(self, text: str) -> str | None:
        names = text.split("\n")[:-1]
        if names == self.known:
            return None
        self.known = names
        return room(names) if names else None


def drafts(view: View) -> StageRun:
    [reply] = yield Ask((Request("draft", "draft", PlainReply, {"what": "names"}),))
    names = Lines()
    names.hear(reply.text)
    [again] = yield Ask((Request("again", "draft", PlainReply, {"what": "again"}),), optional=True)
    more = [] if again is None else ["asked_again"]
    yield Build(room([*names.known, *more]))
    return [MinorObjects(by_parent={"": [*names.known, *more]})]


DRAFTS = Stage("s02_graph", "Draft", (), (MinorObjects,), drafts, growth=lambda view: Lines())


class Writer:
    """Writes a piece each time it is let go on, and hears a stop; an exception in place of a piece is raised."""

    name, describes = "test", "A client for tests"

    def __init__(self, *pieces: str | Exception) -> None:
        self.pieces, self.asked = list(pieces), []  # type: ignore[var-annotated]
        self.told, self.go_on = threading.Semaphore(0), threading.Semaphore(0)

    def answer(self, prompt: Prompt, cancel: threading.Event, progress: Callable[[str], None] | None = None) -> Reply:
        self.asked.append(prompt.key)
        if prompt.key != "draft":
            return Reply("yes", "test")
        text = ""
        for piece in self.pieces:
            if isinstance(piece, Exception):
                raise piece
            text += piece
            assert prompt.hear is not None
            prompt.hear(text)
            self.told.release()
            end = time.monotonic() + WAIT
            while not self.go_on.acquire(timeout=0.02):
                if cancel.is_set():
                    raise Cancelled
                assert time.monotonic() < end
        return Reply(text, "test")


@pytest.fixture
def scene(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Any]:
    """A scene with a picture and nothing else."""
    monkeypatch.setattr(prompting, "load_template", lambda name: "Write {{what}}.")
    bpy.ops.wm.read_factory_settings(use_empty=True)
    code_as_room.register()
    path = tmp_path / "room.png"
    Image.new("RGB", (120, 100), "tan").save(path)
    bpy.ops.code_as_room.load_picture(filepath=str(path))
    yield bpy.context.scene
    late.forget_all()
    code_as_room.unregister()


@pytest.fixture
def begin(scene: Any, monkeypatch: pytest.MonkeyPatch) -> Callable[[Writer], Any]:
    """Begins a draft with a writer, and lets it write its first piece."""

    def start(writer: Writer) -> Any:
        monkeypatch.setattr(clients, "room_client", lambda *a, **k: writer)
        return driver.start(scene, [DRAFTS])

    return start


def until(job: Any, what: Callable[[], bool]) -> None:
    """Tick as the window does until something is so."""
    end = time.monotonic() + WAIT
    while not what():
        assert job.tick(driver.BUDGET) and time.monotonic() < end, job.error
        time.sleep(0.005)


def standing() -> set[str]:
    return {name for name in ("bed", "desk", "lamp", "asked_again") if bpy.data.objects.get(name) is not None}


def memory(scene: Any) -> Memory:
    return load_memory(ResolvedScene(scene).memory_in_file())


def kept(scene: Any) -> MinorObjects | None:
    return room_memory.memory_of(scene).latest(MinorObjects)


def test_objects_stand_as_soon_as_their_lines_are_complete(scene, begin):
    writer = Writer("bed\nde", "sk\nla", "mp\n")
    job = begin(writer)
    until(job, lambda: standing() == {"bed"})
    assert job.progress.what == "bed stands: 1 object so far" and kept(scene) is None
    writer.go_on.release()
    until(job, lambda: standing() == {"bed", "desk"})
    assert job.progress.what == "desk stands: 2 objects so far"
    writer.go_on.release(5)
    outcome = driver.run_blocking()
    assert outcome.text.startswith("Done") and standing() == {"bed", "desk", "lamp", "asked_again"}
    assert kept(scene) == MinorObjects(by_parent={"": ["bed", "desk", "lamp", "asked_again"]})


def test_a_stop_keeps_what_stands_as_the_draft(scene, begin):
    writer = Writer("bed\ndesk\nlam", "p\n")
    job = begin(writer)
    until(job, lambda: standing() == {"bed", "desk"})
    driver.stop()
    outcome = driver.run_blocking()
    assert outcome.problem is None and "What stands is kept" in outcome.text
    assert {"bed", "desk"} <= standing() and "asked_again" not in standing() and writer.asked == ["draft"]
    entry = room_memory.memory_of(scene).latest_entry("MinorObjects")
    assert entry is not None and entry.output["by_parent"][""][:2] == ["bed", "desk"]
    assert any("Ended early" in note for note in entry.meta.notes)


def test_a_stop_before_anything_stands_is_an_ordinary_stop(scene, begin):
    job = begin(Writer("be"))
    until(job, lambda: job.progress.calls_open == 1)
    driver.stop()
    outcome = driver.run_blocking()
    assert "What was answered is kept" in outcome.text and kept(scene) is None and not standing()


def test_a_service_that_breaks_off_leaves_what_stands_and_is_told(scene, begin):
    writer = Writer("bed\n", ModelError("The line is dead.", "Call again."))
    job = begin(writer)
    until(job, lambda: standing() == {"bed"})
    writer.go_on.release()
    outcome = driver.run_blocking()
    assert outcome.problem is not None and outcome.problem.message == "The line is dead."
    assert standing() == {"bed"} and kept(scene) == MinorObjects(by_parent={"": ["bed"]})
    assert job.stages_done == 1


def test_another_try_of_the_question_grows_the_room_anew(scene, begin):
    class Again(Writer):
        def answer(self, prompt, cancel, progress=None):
            if prompt.key == "draft" and not self.asked:
                prompt.hear("desk\nlamp\n")
                assert self.go_on.acquire(timeout=WAIT)
            return super().answer(prompt, cancel, progress)

    writer = Again("bed\n")
    job = begin(writer)
    until(job, lambda: standing() == {"desk", "lamp"})
    writer.go_on.release()
    until(job, lambda: standing() == {"bed"})
    writer.go_on.release()
    driver.run_blocking()
    assert standing() == {"bed", "asked_again"}


def test_what_the_artist_moves_meanwhile_stays_moved_and_is_kept(scene, begin):
    writer = Writer("bed\n", "desk\n", "lamp\n")
    job = begin(writer)
    until(job, lambda: standing() == {"bed"})
    bpy.data.objects["bed"].location.y = 0.75
    bpy.context.view_layer.update()
    writer.go_on.release()
    until(job, lambda: standing() == {"bed", "desk"})
    assert bpy.data.objects["bed"].location.y == pytest.approx(0.75)
    writer.go_on.release(5)
    driver.run_blocking()
    assert standing() == {"bed", "desk", "lamp", "asked_again"}
    assert bpy.data.objects["bed"].location.y == pytest.approx(0.75)
    edits = room_memory.memory_of(scene).latest(HandEdits)
    assert edits is not None and [(edit.op, edit.id) for edit in edits.edits] == [("move", "bed")]


def test_what_the_artist_deletes_meanwhile_stays_deleted(scene, begin):
    writer = Writer("bed\ndesk\n", "lamp\n")
    job = begin(writer)
    until(job, lambda: standing() == {"bed", "desk"})
    bpy.data.objects.remove(bpy.data.objects["desk"])
    writer.go_on.release(5)
    driver.run_blocking()
    assert standing() == {"bed", "lamp", "asked_again"}


def test_a_draft_over_a_room_that_fails_at_once_leaves_the_room(scene, begin):
    ResolvedScene(scene).build(room(["bed", "desk"]))
    begin(Writer(ModelError("No.", "")))
    outcome = driver.run_blocking()
    assert outcome.problem is not None and standing() == {"bed", "desk"} and kept(scene) is None


def test_no_mesh_is_left_over(scene, begin):
    writer = Writer("bed\n", "desk\n", "lamp\n")
    begin(writer)
    writer.go_on.release(9)
    driver.run_blocking()
    assert not [mesh.name for mesh in bpy.data.meshes if mesh.users == 0]


def test_another_file_ends_the_growing(scene, begin):
    writer = Writer("bed\n", "desk\n")
    job = begin(writer)
    until(job, lambda: standing() == {"bed"})
    driver.cancel_for_load()
    writer.go_on.release(5)
    assert not job.tick(driver.BUDGET) and not driver.is_running() and standing() == {"bed"}


def test_what_completes_nothing_builds_nothing(scene, begin, monkeypatch):
    built = []
    commit = ResolvedScene.commit

    def noted(self, plan, made):
        built.append(plan.text)
        commit(self, plan, made)

    monkeypatch.setattr(ResolvedScene, "commit", noted)
    writer = Writer("bed\n", "d", "e", "s", "k\n")
    job = begin(writer)
    until(job, lambda: standing() == {"bed"})
    for _ in range(3):
        writer.go_on.release()
        assert writer.told.acquire(timeout=WAIT)
        until(job, lambda: not job._growing._thread)
        until(job, lambda: not job._growing.has_news)
    assert built == [room(["bed"])]
    writer.go_on.release(5)
    driver.run_blocking()
    assert standing() == {"bed", "desk", "asked_again"}
