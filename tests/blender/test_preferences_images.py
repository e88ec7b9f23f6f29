# SPDX-License-Identifier: GPL-3.0-or-later
"""The image model's preferences: drawn for every provider, keys kept apart, consent asked for, problems told in the panel."""

from __future__ import annotations

from collections.abc import Iterator
from types import SimpleNamespace
from typing import Any

import bpy
import code_as_room
import pytest
from code_as_room.operators import clients, consent, painters
from code_as_room.panels import preferences_images as panel
from code_as_room.panels.preferences_service import switch
from code_as_room.pipeline.errors import ModelError
from code_as_room.pipeline.models.image_base import ImageRequest
from code_as_room.pipeline.models.image_registry import IMAGE_PRESETS, image_preset

KEY = "sk-CANARY-4f8a1c77e2"


class Layout:
    """Notes what is drawn."""

    def __init__(self, drawn: list[str] | None = None) -> None:
        self.drawn: list[str] = [] if drawn is None else drawn

    def row(self, *args: Any, **options: Any) -> Layout:
        return Layout(self.drawn)

    column = row

    def label(self, text: str = "", icon: str = "NONE") -> None:
        self.drawn.append(text)

    def separator(self) -> None:
        pass

    def prop(self, data: Any, name: str, **options: Any) -> None:
        assert hasattr(data, name), name
        self.drawn.append(name)

    def operator(self, name: str, **options: Any) -> Any:
        self.drawn.append(name)
        return SimpleNamespace()


class Services(list[Any]):
    """The collection of what was typed for other providers."""

    def get(self, name: str) -> Any:
        return next((service for service in self if service.name == name), None)

    def add(self) -> Any:
        self.append(SimpleNamespace(name=""))
        return self[-1]


class Preferences(SimpleNamespace):
    """The add-on's preferences as an artist has filled them in."""

    def __init__(self, provider: str, **more: Any) -> None:
        empty = {f"image_{name}": "" for name in ("model", "api_key", "key_variable")}
        usual = {
            "provider": "BUILTIN",
            "image_price": 0.0,
            "spending_cap": 0.0,
            "proxy": "",
            "ca_bundle": "",
            "image_services": Services(),
        }
        address = {"image_base_url": image_preset(provider).base_url, "image_last_provider": provider}
        super().__init__(**{"image_provider": provider, **empty, **usual, **address, **more})


@pytest.fixture(autouse=True)
def add_on(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    for name in ("OPENAI_API_KEY", "GEMINI_API_KEY"):
        monkeypatch.delenv(name, raising=False)
    bpy.ops.wm.read_factory_settings(use_empty=True)
    code_as_room.register()
    yield
    code_as_room.unregister()


def use(preferences: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(clients, "add_on_preferences", lambda: preferences)


def drawn(preferences: Any) -> str:
    layout: Any = Layout()
    region = SimpleNamespace(width=700)
    context = SimpleNamespace(scene=bpy.context.scene, region=region, preferences=bpy.context.preferences)
    panel.draw_image_preferences(preferences, layout, context)
    return " | ".join(layout.drawn)


@pytest.mark.parametrize("provider", [p.id for p in IMAGE_PRESETS])
def test_every_provider_is_drawn_with_what_it_needs(provider: str) -> None:
    text = drawn(Preferences(provider, image_api_key=KEY, spending_cap=1.0))
    asks = provider != "NONE"
    assert all((name in text) is asks for name in ("image_base_url", "image_model", "image_api_key", "unencrypted"))
    assert KEY not in text
    remote = provider in ("OPENAI", "GEMINI")
    assert (
        ("image_price" in text) is remote
        and ("| spending_cap |" in text) is remote
        and ("nothing is painted" in text) is remote
    )


def test_a_key_that_was_typed_for_one_service_never_stands_in_anothers_field() -> None:
    preferences = Preferences("OPENAI", image_api_key=KEY, image_model="a", image_price=0.04)
    switch(preferences, panel.FIELDS, "OPENAI", "CUSTOM", image_preset("CUSTOM").base_url)
    assert (preferences.image_api_key, preferences.image_model, preferences.image_price) == ("", "", 0.0)
    assert preferences.image_base_url == image_preset("CUSTOM").base_url
    switch(preferences, panel.FIELDS, "CUSTOM", "OPENAI", image_preset("OPENAI").base_url)
    assert (preferences.image_api_key, preferences.image_model, preferences.image_price) == (KEY, "a", 0.04)


def test_settings_that_are_not_complete_keep_no_stage_from_running_and_say_what_is_missing(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    use(Preferences("OPENAI", image_api_key=KEY), monkeypatch)
    painter = painters.room_painter("picture", 0.0)
    assert painter is not None and "model" in painters.image_problem()
    with pytest.raises(ModelError, match="model"):
        painter.paint(ImageRequest("oak"), None)  # type: ignore[arg-type]


def test_without_online_access_nothing_is_sent_to_the_internet(monkeypatch: pytest.MonkeyPatch) -> None:
    use(Preferences("OPENAI", image_api_key=KEY, image_model="x"), monkeypatch)
    monkeypatch.setattr(painters.GuardedPainter, "watch", lambda self: setattr(self, "online", False))
    painter = painters.room_painter("picture", 0.0)
    assert painter is not None
    with pytest.raises(ModelError, match="online access is off"):
        painter.paint(ImageRequest("oak"), None)  # type: ignore[arg-type]


def test_the_artist_is_asked_before_an_image_model_on_the_internet_is(monkeypatch: pytest.MonkeyPatch) -> None:
    use(Preferences("OPENAI", image_api_key=KEY, image_model="x"), monkeypatch)
    assert painters.image_host() == "api.openai.com"
    host = consent.IMAGES + painters.image_host()
    context = SimpleNamespace(scene=bpy.context.scene)
    said = " ".join(line for line, _ in consent.what_is_sent(context, host))
    assert "api.openai.com" in said and "Nothing of the picture itself is sent" in said
    use(Preferences("CUSTOM", image_model="x"), monkeypatch)
    assert painters.image_host() == ""
