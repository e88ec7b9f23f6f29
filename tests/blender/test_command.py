"""The command from end to end: what it leaves behind, what survives a failure, and that its program builds its scene."""

from __future__ import annotations

import http.server
import json
import os
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from code_as_room.operators import command
from code_as_room.pipeline.artifacts.layout import LayoutProgram
from code_as_room.pipeline.memory import load_memory
from PIL import Image

CALL = "import sys; from code_as_room.operators.command import main; sys.exit(main())"
REBUILD = """
import json, os, runpy, sys, bpy

def boxes():
    bpy.context.view_layer.update()
    found = {}
    for obj in bpy.data.objects:
        if obj.type == "MESH" and not obj.library:
            found[obj.name] = [list(obj.matrix_world @ v.co) for v in obj.data.vertices]
    return found

bpy.ops.wm.read_factory_settings(use_empty=True)
runpy.run_path("room.py", run_name="__main__")
built = boxes()
bpy.ops.wm.open_mainfile(filepath=os.path.abspath("room.blend"))
json.dump({"room.py": built, "room.blend": boxes(), "package": "code_as_room" in sys.modules}, open("boxes.json", "w"))
"""


def types(memory: Any) -> list[str]:
    return [entry.type for entry in memory.entries]


def asked(result: Any) -> list[str]:
    """The questions whose answers memory holds, in their order."""
    return [entry.output["key"] for entry in result.memory.entries if entry.type == "Answer"]


def test_room_py_and_room_blend_hold_the_boxes_of_scene_json(room) -> None:
    room.analysis["architecture"].append(
        {**room.analysis["architecture"][0], "id": "partition_1", "kind": "partition", "wall": None,
         "start": {"x_m": 1.0, "y_m": 0.5}, "end": {"x_m": 2.3, "y_m": 0.5}}
    )  # fmt: skip
    result = room.make("--iterations", "1").finished()
    done = subprocess.run([sys.executable, "-c", REBUILD], cwd=room.out, capture_output=True, text=True, timeout=120)
    assert done.returncode == 0, done.stderr
    built = json.loads((room.out / "boxes.json").read_text())
    assert not built["package"], "room.py needs no package of ours"
    assert built["room.py"].keys() == built["room.blend"].keys()
    assert len(result.scene["objects"]) == 7
    for place in ("room.py", "room.blend"):
        for item in result.scene["objects"]:
            corners = np.array(built[place][item["id"]]) - item["centre"]
            yaw = np.radians(item["yaw"])
            across, up = np.array([np.cos(yaw), np.sin(yaw), 0]), np.array([-np.sin(yaw), np.cos(yaw), 0])
            own = np.stack([corners @ across, corners @ up, corners[:, 2]], axis=1)
            half = np.array(item["size"]) / 2
            np.testing.assert_allclose(own.min(axis=0), -half, atol=1e-3, err_msg=f"{place} {item['id']}")
            np.testing.assert_allclose(own.max(axis=0), half, atol=1e-3, err_msg=f"{place} {item['id']}")
        floor = np.array(built[place]["floor"])[:, :2]
        for corner in result.scene["room"]["floor"]:
            assert np.abs(floor - corner).max(axis=1).min() < 1e-3


def test_everything_is_told_at_the_end(room) -> None:
    result = room.make().finished()
    assert "Objects: 7 detected: 7 detailed." in result.out and "Made by: Recorded answers" in result.out
    assert all(name in result.out for name in result.files)
    for name in ("top.png", "view.png"):
        with Image.open(room.out / name) as image:
            assert image.convert("L").getextrema()[1] > image.convert("L").getextrema()[0], "something is drawn"


def test_an_earlier_room_in_the_folder_is_replaced_whole(room) -> None:
    objects = room.analysis["objects"]
    room.analysis["objects"] = [room.object("bed")]
    first = room.make().finished()
    before = {name: (room.out / name).read_bytes() for name in first.files}
    room.analysis["objects"] = objects
    (room.out / "notes.txt").write_text("mine")
    second = room.make()
    assert second.code == 0 and second.files == {*before, "notes.txt"}
    assert all((room.out / name).read_bytes() != data for name, data in before.items())
    assert len(second.scene["objects"]) == 7 and types(second.memory).count("SceneAnalysis") == 1


def test_a_failing_run_leaves_an_earlier_room_and_its_memory(room) -> None:
    first = room.make().finished()
    before = {name: (room.out / name).read_bytes() for name in first.files}
    whole = room.answers["analysis"]
    room.answers["analysis"] = "no"
    assert "no readable JSON" in room.make().failed(files=first.files)
    assert {name: (room.out / name).read_bytes() for name in first.files} == before
    room.answers.update(analysis=whole, graph="no")
    result = room.make()
    result.failed(files={*first.files, "memory.earlier.json"})
    assert "earlier memory.json is kept" in result.out
    assert (room.out / "memory.earlier.json").read_bytes() == before["memory.json"]
    room.answers["graph"] = {"attributes": [], "relations": []}
    assert asked(room.make("--resume")) == ["01_analysis", "01_second_look", "02_graph"]


def test_resuming_after_a_failure_asks_only_what_is_open(room) -> None:
    room.answers["critique"] = None
    said = room.make("--iterations", "1").failed(files={"memory.json"})
    assert "No answer is recorded for 's03_layout/03_critique/0'" in said
    # Were they asked again, there would be nothing to answer them with.
    room.answers.update(analysis=None, second_look=None, graph=None, critique={"score": 90, "edits": []})
    result = room.make("--iterations", "1", "--resume").finished()
    assert asked(result) == ["01_analysis", "01_second_look", "02_graph", "03_critique/0"]
    assert len(result.scene["objects"]) == 7


def test_resuming_a_finished_room_makes_its_results_again(room) -> None:
    first = room.make().finished()
    text, scene, entries = (room.out / "room.py").read_text(), first.scene, len(first.memory.entries)
    for name in first.files - {"memory.json"}:
        (room.out / name).unlink()
    room.answers = {}
    again = room.make("--resume").finished()
    assert (room.out / "room.py").read_text() == text and again.scene == scene
    assert len(again.memory.entries) == entries


def test_resuming_with_another_width_asks_nothing_that_was_answered(room) -> None:
    room.make().finished()
    room.answers = {**room.answers, "graph": None}
    result = room.make("--resume", "--wall-height", "3").finished()
    assert result.scene["room"]["size"][2] == pytest.approx(3.0)


def test_resuming_where_nothing_is_begins_anew(room) -> None:
    result = room.make("--resume").finished()
    assert "Nothing to resume" in result.out


def test_resuming_with_another_picture_is_refused(room) -> None:
    room.make().finished()
    kept = (room.out / "memory.json").read_bytes()
    Image.new("RGB", (240, 204), "black").save(room.picture)
    result = room.make("--resume")
    assert result.code == 1 and "begun with another picture (room.png)" in result.err
    assert (room.out / "memory.json").read_bytes() == kept


DAMAGED = {
    "cut": lambda text: text[: len(text) // 2],
    "not a number": lambda text: text.replace('"seconds": 0', '"seconds": NaN', 1).replace("{", '{"x": NaN,', 1),
    "another version": lambda text: text.replace("memory/1", "memory/99", 1),
    "an entry of another shape": lambda text: text.replace('"image_size"', '"picture_size"', 1),
    "a list": lambda text: "[]",
    "not a text": lambda text: "\udcff\udcfe",
    "deep": lambda text: "[" * 100_000,
}


@pytest.mark.parametrize("damage", DAMAGED.values(), ids=DAMAGED.keys())
def test_a_damaged_memory_is_said_and_left_as_it_is(room, damage: Any) -> None:
    room.answers["graph"] = None
    room.make().failed(files={"memory.json"})
    path = room.out / "memory.json"
    path.write_text(damage(path.read_text(encoding="utf-8")), encoding="utf-8", errors="surrogateescape")
    before = path.read_bytes()
    said = room.make("--resume").failed(files={"memory.json"})
    assert "without --resume" in said and path.read_bytes() == before


def test_stopping_in_the_middle_keeps_what_was_answered(room, monkeypatch) -> None:
    real = command._print_progress

    def stop(what: str, step: int, steps: int) -> None:
        if what.startswith("Layout"):
            raise KeyboardInterrupt
        real(what, step, steps)

    monkeypatch.setattr(command, "_print_progress", stop)
    stopped = room.make()
    assert stopped.code == 130 and stopped.files == {"memory.json"} and "--resume" in stopped.err
    assert types(stopped.memory).count("SceneGraph") == 1 and stopped.memory.latest(LayoutProgram) is None
    monkeypatch.setattr(command, "_print_progress", real)
    room.answers = {}
    assert len(room.make("--resume").finished().scene["objects"]) == 7


def test_every_finished_stage_is_on_disk_before_the_next_begins(room, monkeypatch) -> None:
    seen: dict[str, list[str]] = {}

    def look(what: str, step: int, steps: int) -> None:
        path = room.out / "memory.json"
        seen[what] = types(load_memory(path.read_text(encoding="utf-8"))) if path.exists() else []

    monkeypatch.setattr(command, "_print_progress", look)
    room.make().finished()
    assert seen["Asking what is in the picture"] == []
    assert "SceneAnalysis" in seen["Asking what belongs to what"]
    assert "SceneGraph" in seen["Layout, round 1"]
    assert "LayoutProgram" in seen["Building the room"]


def test_a_mistake_of_ours_is_no_traceback_and_costs_no_answer(room, monkeypatch) -> None:
    def wrong(*arguments: Any) -> None:
        raise KeyError("oh\nno")

    monkeypatch.setattr("code_as_room.operators.outputs.make_report", wrong)
    result = room.make()
    assert result.code == 1 and result.files == {"memory.json"}
    assert result.err.count("\n") == 1 and "unexpected problem (KeyError: 'oh\\nno')" in result.err
    assert result.memory.latest(LayoutProgram) is not None
    monkeypatch.setenv("CODE_AS_ROOM_DEBUG", "1")
    assert "Traceback" in room.make().err


def test_recording_and_playing_back_give_the_same_room(room) -> None:
    record = room.home / "again"
    first = room.make("--iterations", "1", "--record", str(record)).finished()
    second = room.call(
        [str(room.picture), "--out", str(room.out), "--replies", str(record), "--iterations", "1"]
    ).finished()
    assert second.scene == first.scene
    notes = [note for entry in second.memory.entries for note in entry.meta.notes]
    assert not any("changed since" in note for note in notes)
    (room.home / "file").write_text("mine")
    third = room.make("--record", str(room.home / "file"))
    assert third.code == 1 and "--record" in third.err


class Silent(http.server.BaseHTTPRequestHandler):
    """A service that takes a question and never answers."""

    asked = threading.Event()
    over = threading.Event()

    def do_POST(self) -> None:
        self.asked.set()
        self.over.wait(60)

    def log_message(self, *arguments: Any) -> None:
        return


@pytest.fixture
def silent_service() -> Iterator[str]:
    Silent.asked.clear()
    Silent.over.clear()
    server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), Silent)
    server.daemon_threads = True
    thread = threading.Thread(target=server.serve_forever, daemon=True)
    thread.start()
    yield f"http://127.0.0.1:{server.server_port}/v1"
    Silent.over.set()
    server.shutdown()
    server.server_close()


@pytest.mark.skipif(os.name != "posix", reason="sends a signal")
def test_control_c_while_a_service_is_silent_ends_the_program(room, silent_service: str, tmp_path: Path) -> None:
    arguments = [str(room.picture), "--out", str(room.out), "--base-url", silent_service, "--model", "m"]
    program = subprocess.Popen(
        [sys.executable, "-c", CALL, *arguments],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        # A test run in the background ignores Ctrl-C, and its children would inherit that.
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),
    )
    try:
        assert Silent.asked.wait(60)
        time.sleep(0.2)
        program.send_signal(signal.SIGINT)
        _, said = program.communicate(timeout=30)
    finally:
        program.kill()
    assert program.returncode == 130 and "stopped" in said and "Traceback" not in said
    assert list(room.out.iterdir()) == []


def test_the_artist_goes_on_in_the_file_that_the_command_wrote(room) -> None:
    import bpy
    import code_as_room
    from code_as_room.operators import view_state

    room.make("--iterations", "2", "--width", "4.7", "--notes", "a small bed").finished()
    assert not hasattr(bpy.types.Scene, "code_as_room"), "the command leaves nothing registered behind"
    code_as_room.register()
    try:
        bpy.ops.wm.open_mainfile(filepath=str(room.out / "room.blend"))
        scene = bpy.context.scene
        state = view_state.refresh(scene)
        assert state.problem is None and state.has_layout and state.picture_name == "room.png"
        assert {row.status for row in state.stages} == {"done"}, [(r.id, r.status) for r in state.stages]
        settings = scene.code_as_room
        assert settings.use_known_width and abs(settings.known_width - 4.7) < 1e-5
        assert (settings.iterations, settings.notes, settings.use_wall_height) == (2, "a small bed", False)
    finally:
        code_as_room.unregister()
        bpy.ops.wm.read_factory_settings(use_empty=True)
