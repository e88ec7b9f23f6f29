# SPDX-License-Identifier: GPL-3.0-or-later
"""The preferences are drawn for every provider and every state, and say what an artist needs to know."""

from __future__ import annotations

import threading
from collections.abc import Iterator
from types import SimpleNamespace
from typing import Any

import bpy
import code_as_room
import pytest
from code_as_room.operators import clients, connection, model_prices
from code_as_room.panels import preferences as panel
from code_as_room.panels.preferences_draw import draw_preferences
from code_as_room.pipeline.errors import ModelError
from code_as_room.pipeline.models.connection import ConnectionReport, Step
from code_as_room.pipeline.models.listing import ModelInfo
from code_as_room.pipeline.models.presets import PRESETS, preset

OPERATORS = ("test_connection", "fetch_models", "stop_connection", "choose_model", "set_price")


class Layout:
    """Notes what is drawn."""

    def __init__(self, drawn: list[str] | None = None) -> None:
        self.drawn: list[str] = [] if drawn is None else drawn

    def _sub(self, *args: Any, **options: Any) -> Layout:
        return Layout(self.drawn)

    row = column = _sub

    def label(self, text: str = "", icon: str = "NONE") -> None:
        self.drawn.append(text)

    def separator(self, **options: Any) -> None:
        pass

    def prop(self, data: Any, name: str, **options: Any) -> None:
        assert hasattr(data, name), name
        self.drawn.append(name)

    def operator(self, name: str, **options: Any) -> Any:
        self.drawn.append(name)
        return SimpleNamespace()


class Preferences(SimpleNamespace):
    """The add-on's preferences as they are drawn, with the real defaults."""

    def __init__(self, provider: str, **more: Any) -> None:
        kind = panel.CodeAsRoomPreferences.bl_rna.properties
        values = {p.identifier: p.default for p in kind if hasattr(p, "default") and p.identifier != "rna_type"}
        super().__init__(**{**values, "provider": provider, "base_url": preset(provider).base_url, **more})


@pytest.fixture(autouse=True)
def add_on() -> Iterator[None]:
    """The add-on is registered, and nothing is left in its state."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    code_as_room.register()
    yield
    code_as_room.unregister()


def drawn(preferences: Preferences) -> str:
    layout: Any = Layout()
    region = SimpleNamespace(width=700)
    context = SimpleNamespace(scene=bpy.context.scene, region=region, preferences=bpy.context.preferences)
    draw_preferences(preferences, layout, context)
    return " | ".join(layout.drawn)


@pytest.mark.parametrize("provider", [p.id for p in PRESETS])
def test_every_provider_is_drawn_with_what_it_needs(provider: str, monkeypatch: pytest.MonkeyPatch) -> None:
    chosen = preset(provider)
    if chosen.key_variable:
        monkeypatch.delenv(chosen.key_variable, raising=False)
    text = drawn(Preferences(provider, show_models=True, show_network=True))
    asks = chosen.kind not in ("builtin", "recorded", "manual")
    assert ("by_hand_folder" in text) is (chosen.kind == "manual")
    assert ("base_url" in text) is asks and ("code_as_room.test_connection" in text) is asks
    assert ("api_key" in text) is (chosen.key != "none")
    assert ("replies_folder" in text) is (chosen.kind == "recorded")
    if chosen.key == "needed":
        assert "There is no key yet" in text and "wm.url_open" in text
    if asks:
        assert (
            all(f"model_{group}" in text for group in (*clients.GROUPS, "text"))
            and "proxy" in text
            and "ca_bundle" in text
        )
        on_the_internet = chosen.base_url.startswith("https")
        assert ("Each question sends the picture" in text) is on_the_internet
        assert ("online access is off" in text) is on_the_internet


def test_where_the_key_comes_from_is_said_and_the_key_itself_is_not(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("OPENAI_API_KEY", "sk-CANARY-0123")
    assert "environment variable OPENAI_API_KEY" in drawn(Preferences("OPENAI"))
    assert "environment variable" not in drawn(Preferences("OPENAI", base_url="https://elsewhere.example/v1"))
    typed = drawn(Preferences("OPENAI", api_key="sk-CANARY-4567"))
    assert "userpref.blend" in typed and "environment variable OPENAI" not in typed
    assert "CANARY" not in typed + drawn(Preferences("OPENAI"))


def test_results_and_problems_are_shown(monkeypatch: pytest.MonkeyPatch) -> None:
    steps = (Step("Connection", "good"), Step("Key", "bad", "no"), Step("Pictures"))
    report = ConnectionReport("bad", "key", "The key is wrong.", "Check it.", steps=steps)
    monkeypatch.setattr(connection, "_report", report)
    monkeypatch.setattr(connection, "_problem", ModelError("The list cannot be had.", "Type it."))
    monkeypatch.setattr(model_prices, "_lines", ("The price of m is not known.",))
    monkeypatch.setattr(model_prices, "_missing", ("m",))
    text = drawn(Preferences("LMSTUDIO", spending_cap=1.0))
    assert "The key is wrong. Check it." in text and "Connection | Key" in text and "Pictures" not in text
    assert "The list cannot be had." in text and "code_as_room.set_price" in text and "nothing is sent" in text
    task = connection.Activity("Testing the connection", lambda task: None, lambda found: None, threading.Event())
    monkeypatch.setattr(connection, "_activity", task)
    assert "code_as_room.stop_connection" in drawn(Preferences("LMSTUDIO"))


def test_the_models_that_were_found_can_be_searched(monkeypatch: pytest.MonkeyPatch) -> None:
    preferences = Preferences("LMSTUDIO")
    found = (ModelInfo("qwen-vl-8b"), ModelInfo("gemma"))
    monkeypatch.setattr(connection, "_models", {("openai", preferences.base_url): found})
    assert "2 models found" in drawn(preferences) and "code_as_room.choose_model" in drawn(preferences)
    assert [name for name, _ in panel._suggest_models(preferences, None, "vl qwen")] == ["qwen-vl-8b"]
    assert list(panel._suggest_models(Preferences("VLLM"), None, "")) == []


def test_every_operator_and_setting_has_a_tooltip_and_no_number_of_a_provider_is_used_twice() -> None:
    for name in OPERATORS:
        kind = getattr(bpy.ops.code_as_room, name).get_rna_type()
        assert kind.description.strip() and not kind.description.rstrip().endswith("."), name
    for kind in (panel.CodeAsRoomPreferences, panel.CodeAsRoomService):
        ours = [p for p in kind.bl_rna.properties if p.identifier not in ("rna_type", "name", "bl_idname")]
        assert all(p.description for p in ours), [p.identifier for p in ours if not p.description]
    for secret in ("api_key",):
        assert panel.CodeAsRoomService.bl_rna.properties[secret].subtype == "PASSWORD"
    assert len({p.number for p in PRESETS}) == len({p.id for p in PRESETS}) == len(PRESETS)
