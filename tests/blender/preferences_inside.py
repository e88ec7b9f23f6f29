# SPDX-License-Identifier: GPL-3.0-or-later
"""What `test_preferences_extension.py` runs in a process of its own: the add-on, enabled as an extension in a clean
profile, with a key in its preferences and a service on loopback that echoes whatever it is sent.

    python preferences_inside.py FOLDER PICTURE REPLIES

Writes FOLDER/found.json; everything that was printed or logged goes to standard output and error.
"""

from __future__ import annotations

import importlib
import json
import logging
import os
import sys
import threading
import time
import traceback
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from typing import Any

import bpy

KEY = "sk-CANARY-4f8a1c77e2"
OTHER_KEY = "ant-CANARY-99b2"
MODULE = "bl_ext.user_default.code_as_room"
STAGES = {
    "AnalysisReply": "s01_analysis/01_analysis",
    "SecondLookReply": "s01_analysis/01_second_look",
    "GraphReply": "s02_graph/02_graph",
}
folder, picture, replies = (Path(argument) for argument in sys.argv[1:4])
found: dict[str, Any] = {}
mode = ["good"]
asked: list[dict[str, Any]] = []
met: list[str] = []


class Service(BaseHTTPRequestHandler):
    """Fails or succeeds as `mode` says, and echoes the key each time."""

    def log_message(self, *args: Any) -> None:
        """Quiet."""

    def send(self, status: int, payload: Any) -> None:
        """Answer, with the key in a header too."""
        met.append(self.command)
        data = json.dumps(payload).encode()
        self.send_response(status, f"said {KEY}")
        self.send_header("Content-Type", "application/json")
        self.send_header("X-Echo", self.headers.get("Authorization", ""))
        self.send_header("Content-Length", str(len(data)))
        self.end_headers()
        self.wfile.write(data)

    def do_GET(self) -> None:
        """The list of models."""
        self.send(200, {"data": [{"id": "served"}, {"id": f"served-{KEY}"}]})

    def do_POST(self) -> None:
        """A question."""
        body = json.loads(self.rfile.read(int(self.headers["Content-Length"])))
        asked.append({"authorization": self.headers.get("Authorization", ""), "model": body["model"]})
        said = self.headers.get("Authorization", "")
        if mode[0] == "money":
            return self.send(402, {"error": {"message": f"Account of {said} has no credit", "code": said}})
        if mode[0] == "key":
            return self.send(
                401, {"error": {"message": f"Wrong key {said}, {KEY[:12]}***", "type": said}, "echo": said}
            )
        if mode[0] == "junk":
            return self.send(200, {"detail": said, "choices": said})
        if mode[0] == "slow":
            time.sleep(3)
        self.send(200, self.chat(body, said))
        return None

    def chat(self, body: dict[str, Any], said: str) -> dict[str, Any]:
        """A good answer, with the key in every place that a service can write to."""
        name = body.get("response_format", {}).get("json_schema", {}).get("name", "")
        recorded = json.loads((replies / "replies.json").read_text(encoding="utf-8"))["replies"]
        if name in STAGES:
            answer = recorded[STAGES[name]]["reply"]
            for thing in answer.get("objects", []):
                thing["label"] = f"{thing['label']} {said}"
            if "room_type" in answer:
                answer["room_type"] = f"bedroom {KEY}"
        else:
            known = {"Answer": {"answer": 5}, "Colour": {"colour": "red"}, "CritiqueReply": {"score": 90, "edits": []}}
            answer = known.get(name, {"placements": []})
        message = {"role": "assistant", "content": json.dumps(answer)}
        return {
            "model": f"served {KEY}",
            "choices": [{"index": 0, "message": message, "finish_reason": "stop"}],
            "usage": {"prompt_tokens": 100, "completion_tokens": 200},
        }


def part(name: str) -> Any:
    """A module of the installed add-on."""
    return importlib.import_module(f"{MODULE}.{name}")


def attempt(name: str, call: Any) -> None:
    """Note what a call says; its traceback is printed as a user's console would show it."""
    try:
        found[name] = repr(call())
    except Exception as error:
        traceback.print_exc()
        found[name] = f"{type(error).__name__}: {error}"


def without_a_run(preferences: Any, base: str) -> None:
    """Everything that happens by itself, or that is no request: a service is chosen, and nobody asks it anything."""
    ops, scene = bpy.ops.code_as_room, bpy.context.scene
    preferences.provider = "CUSTOM"
    preferences.base_url, preferences.model, preferences.api_key = base, "served", KEY
    preferences.model_seeing, preferences.model_seeing = "eyes", ""
    ops.load_picture(filepath=str(picture))
    part("operators.clients").run_estimate(["s01_analysis"], 5)
    attempt("looked at", lambda: [row.status for row in part("operators.view_state").peek(scene).stages])
    bpy.ops.wm.save_as_mainfile(filepath=str(folder / "quiet.blend"))
    bpy.ops.wm.open_mainfile(filepath=str(folder / "quiet.blend"))
    importlib.import_module("addon_utils").disable(MODULE, default_set=True)
    importlib.import_module("addon_utils").enable(MODULE, default_set=True)
    found["requests without a run"] = list(met)


def connection(preferences: Any, base: str) -> None:
    """Testing the connection and fetching models."""
    ops = bpy.ops.code_as_room
    preferences.provider = "CUSTOM"
    preferences.base_url, preferences.model, preferences.api_key = base, "served", KEY
    attempt("test good", ops.test_connection)
    found["report"] = repr(part("operators.connection").report())
    for mode[0] in ("key", "money", "junk"):
        attempt(f"test {mode[0]}", ops.test_connection)
    mode[0] = "good"
    attempt("fetch", ops.fetch_models)
    found["models"] = [info.id for info in part("operators.connection").models_of(preferences)]
    before = len(asked)
    preferences.base_url = "https://models.example.com/v1"
    found["poll while offline"] = ops.test_connection.poll()
    attempt("test while offline", ops.test_connection)
    found["asked while offline"] = len(asked) - before
    preferences.base_url = base


def stopping(preferences: Any) -> None:
    """A test that is stopped, and one whose settings change meanwhile."""
    state = part("operators.connection")
    mode[0] = "slow"
    state.start_test()
    began = time.monotonic()
    threading.Timer(0.3, state.stop).start()
    state.run_blocking()
    found["seconds to stop"] = time.monotonic() - began
    found["report after stop"] = repr(state.report())
    state.start_test()
    preferences.model = "another"
    state.run_blocking()
    found["report after change"] = repr(state.report())
    preferences.model = "served"
    mode[0] = "good"


def switching(preferences: Any) -> None:
    """Each provider has its own address, models and key."""
    preferences.model_seeing = "eyes"
    preferences.provider = "ANTHROPIC"
    found["anthropic"] = [preferences.base_url, preferences.model, preferences.model_seeing, preferences.api_key]
    preferences.api_key, preferences.model = OTHER_KEY, "claude"
    preferences.provider = "OLLAMA"
    found["ollama"] = [preferences.base_url, preferences.model, preferences.api_key]
    preferences.provider = "ANTHROPIC"
    found["anthropic again"] = [preferences.base_url, preferences.model, preferences.api_key]
    preferences.provider = "CUSTOM"
    found["custom again"] = [preferences.model, preferences.model_seeing, preferences.api_key]
    preferences.model_seeing = ""


def room(preferences: Any) -> None:
    """A whole room, after runs that fail; everything is written that the add-on writes."""
    ops, scene = bpy.ops.code_as_room, bpy.context.scene
    part("operators.outputs").LONG_SIDE = 96
    ops.load_picture(filepath=str(picture))
    scene.code_as_room.iterations = 1
    scene.code_as_room.way = "STAGES"
    for mode[0] in ("key", "money", "junk"):
        attempt(f"run {mode[0]}", lambda: ops.run_stage(stage="s01_analysis"))
    mode[0] = "good"
    clients, prices = part("operators.clients"), part("pipeline.models.prices")
    clients.keep_price(preferences.base_url, "served", prices.Price(1e3, 1e3))
    preferences.spending_cap = 0.5
    before = len(asked)
    attempt("run over the cap", lambda: ops.run_stage(stage="s01_analysis"))
    found["asked over the cap"] = len(asked) - before
    preferences.spending_cap = 5_000.0
    estimate = clients.run_estimate(["s01_analysis"], 5)
    found["estimate"] = estimate.sentence() if estimate else ""
    attempt("run", ops.run_all)
    memory = clients.bpy.data.texts
    found["texts"] = [text.name for text in memory]
    found["statuses"] = [row.status for row in part("operators.view_state").peek(scene).stages]
    found["spent"] = list(part("operators.room_memory").memory_of(scene).cost())
    attempt("write", lambda: ops.write_outputs(directory=str(folder / "results")))
    bpy.ops.wm.save_as_mainfile(filepath=str(folder / "saved.blend"), compress=False)
    for text in bpy.data.texts:
        (folder / f"text-{text.name.replace('/', '_')}.txt").write_text(text.as_string(), encoding="utf-8")


def main() -> None:
    """Everything."""
    logging.basicConfig(level=logging.DEBUG, stream=sys.stderr)
    server = ThreadingHTTPServer(("127.0.0.1", 0), Service)
    threading.Thread(target=server.serve_forever, daemon=True).start()
    bpy.ops.wm.read_factory_settings(use_empty=True)
    addon_utils = importlib.import_module("addon_utils")  # there once bpy is
    addon_utils.enable(MODULE, default_set=True)
    preferences = bpy.context.preferences.addons[MODULE].preferences
    found["default"] = preferences.provider
    without_a_run(preferences, f"http://127.0.0.1:{server.server_address[1]}/v1")
    bpy.ops.wm.read_factory_settings(use_empty=True)
    addon_utils.enable(MODULE, default_set=True)
    preferences = bpy.context.preferences.addons[MODULE].preferences
    connection(preferences, f"http://127.0.0.1:{server.server_address[1]}/v1")
    stopping(preferences)
    switching(preferences)
    found["authorizations"] = sorted({question["authorization"] for question in asked})
    room(preferences)
    found["representations"] = repr(part("operators.clients").client_settings()) + repr(
        part("operators.clients").current_client()
    )
    addon_utils.disable(MODULE, default_set=True)
    found["timer left"] = bpy.app.timers.is_registered(part("operators.connection")._tick)
    (folder / "found.json").write_text(json.dumps(found, indent=1), encoding="utf-8")


try:
    main()
except BaseException:
    traceback.print_exc()
sys.stdout.flush()
sys.stderr.flush()
# bpy 4.5 may hang while Python takes it down.
os._exit(0)
