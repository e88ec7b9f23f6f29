# SPDX-License-Identifier: GPL-3.0-or-later
"""The add-on and the command put the built-in analysis under weak models only, and the panel says where it answered."""

from __future__ import annotations

import threading
from argparse import Namespace
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import bpy
import code_as_room
import pytest
from code_as_room.operators import clients, command, driver, view_state
from code_as_room.pipeline.ask_floor import FloorClient
from code_as_room.pipeline.models.base import Prompt, Reply
from code_as_room.pipeline.models.registry import ClientSettings
from code_as_room.pipeline.spending import meter_of
from code_as_room.pipeline.stages import all_stages

PICTURE = Path(__file__).parents[2] / "samples" / "bedroom" / "picture.png"
URL = "http://127.0.0.1:9/v1"


class Babbler:
    """A model that never answers what was asked."""

    name, describes = "openai:smollm2-135m", "The model smollm2-135m on this computer"

    def answer(self, prompt: Prompt, cancel: threading.Event, progress: Any = None) -> Reply:
        return Reply("Certainly!", "smollm2-135m")


@pytest.fixture
def room() -> Iterator[Any]:
    bpy.ops.wm.read_factory_settings(use_empty=True)
    code_as_room.register()
    bpy.ops.code_as_room.load_picture(filepath=str(PICTURE))  # type: ignore[attr-defined]
    yield bpy.context.scene
    code_as_room.unregister()


@pytest.mark.parametrize(("model", "has_floor"), [("smollm2-135m", True), ("some-strong-model", False)])
def test_the_add_on_gives_weak_models_a_floor(room: Any, monkeypatch: Any, model: str, has_floor: bool) -> None:
    monkeypatch.setattr(clients, "client_settings", lambda: ClientSettings("openai", URL, model))
    client = clients.room_client("picture", 2.5)
    assert isinstance(client, FloorClient) == has_floor
    meter = meter_of(client)
    assert meter is not None and meter.spent == 2.5


@pytest.mark.parametrize("record", [False, True])
@pytest.mark.parametrize(("model", "has_floor"), [("smollm2-135m", True), ("some-strong-model", False)])
def test_so_does_the_command(tmp_path: Path, model: str, has_floor: bool, record: bool) -> None:
    options = Namespace(replies=None, base_url=URL, key_env="", model=model, record=tmp_path if record else None)
    client: Any = command._client(options)
    assert meter_of(client) is not None, "painted images count on the same meter"
    assert isinstance(client.inner if record else client, FloorClient) == has_floor


def test_the_panel_says_which_answers_are_not_the_models(room: Any, monkeypatch: Any) -> None:
    monkeypatch.setattr(clients, "room_client", lambda picture, spent: FloorClient(Babbler()))
    driver.start(room, all_stages()[:1])
    outcome = driver.run_blocking()
    assert outcome.problem is None and any("The built-in analysis answered" in notice for notice in outcome.notices)
    state = view_state.peek(room)
    assert state is not None and state.stages[0].status != "failed"
    assert any("smollm2-135m" in finding.message for finding in state.findings)
