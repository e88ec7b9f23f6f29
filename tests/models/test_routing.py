# SPDX-License-Identifier: GPL-3.0-or-later
"""A model for each group of stages, and answers that stay kept under the name of who gave them."""

import threading
from dataclasses import replace

import pytest
from code_as_room.pipeline.errors import ModelError
from code_as_room.pipeline.models.base import Prompt, Reply, name_of
from code_as_room.pipeline.models.prices import PriceList
from code_as_room.pipeline.models.recorded import Recorder
from code_as_room.pipeline.models.registry import ClientSettings, make_client, settings_from_environment
from code_as_room.pipeline.models.routing import RoutingClient, group_of
from code_as_room.pipeline.spending import metered, price_lookup


class Client:
    def __init__(self, name):
        self.name = self.describes = name

    def answer(self, prompt, cancel, progress=None):
        return Reply("{}", self.name)


@pytest.mark.parametrize(
    "stage, group",
    [
        ("s01_analysis", "seeing"),
        ("s02_graph", "layout"),
        ("s04_auxiliary", "layout"),
        ("s05_x", "modelling"),
        ("s07", "modelling"),
        ("s08_light", "surfaces"),
        ("s10_final", "surfaces"),
        ("s11_x", ""),
        ("connection", ""),
        ("", ""),
    ],
)
def test_stages_have_their_groups(stage, group):
    assert group_of(stage) == group


def test_each_stage_is_answered_and_named_by_its_own_model():
    client = RoutingClient(Client("main"), {"seeing": Client("eyes")})
    for stage, expected in (("s01_analysis", "eyes"), ("s03_layout", "main"), ("connection", "main")):
        prompt = Prompt(stage, "k", "t", (), "n", {}, "h")
        assert client.answer(prompt, threading.Event()).model == name_of(client, stage) == expected
    assert "eyes" in client.describes and client.name == "main"


def test_the_name_passes_through_everything_that_wraps_a_client(tmp_path):
    settings = ClientSettings(
        kind="openai", base_url="http://localhost:1/v1", model="big", models={"layout": "small", "seeing": " big "}
    )
    client = Recorder(metered(make_client(settings), settings), tmp_path)
    assert name_of(client, "s03_layout") == "openai:small"
    assert name_of(client, "s01_analysis") == name_of(client, "s09_x") == "openai:big"


def test_one_model_for_all_needs_no_routing():
    settings = ClientSettings(kind="ollama", base_url="http://localhost:1", model="m", models={"seeing": "m"})
    assert make_client(settings).name == "ollama:m"


def test_the_environment_names_a_provider_and_models_by_stage():
    settings = settings_from_environment(
        {
            "CODE_AS_ROOM_PROVIDER": "Anthropic",
            "CODE_AS_ROOM_MODEL": "claude-x",
            "CODE_AS_ROOM_MODEL_SEEING": "claude-y",
            "CODE_AS_ROOM_PROXY": "http://u:secretword@proxy:1",
            "CODE_AS_ROOM_SPENDING_CAP": "2.5",
            "ANTHROPIC_API_KEY": "sk-ant-usual",
            "OPENAI_API_KEY": "sk-other",
        }
    )
    assert (settings.kind, settings.base_url) == ("anthropic", "https://api.anthropic.com/v1")
    assert settings.api_key == "sk-ant-usual" and settings.spending_cap == 2.5
    assert settings.models == {"seeing": "claude-y"}
    assert "secretword" not in repr(settings) and "usual" not in repr(settings)


def test_a_usual_key_is_never_taken_for_another_address():
    for url in ("https://proxy.example/v1", "http://api.anthropic.com/v1", "https://api.anthropic.com.evil.example/v1"):
        given = {
            "CODE_AS_ROOM_PROVIDER": "anthropic",
            "CODE_AS_ROOM_BASE_URL": url,
            "ANTHROPIC_API_KEY": "sk-ant-usual",
        }
        assert settings_from_environment(given).api_key == ""


@pytest.mark.parametrize(
    "environment",
    [
        {"CODE_AS_ROOM_PROVIDER": "telepathy"},
        {"CODE_AS_ROOM_PROVIDER": "ollama", "CODE_AS_ROOM_SPENDING_CAP": "much"},
        {"CODE_AS_ROOM_PROVIDER": "ollama", "CODE_AS_ROOM_SPENDING_CAP": "-1"},
    ],
)
def test_a_provider_or_cap_that_cannot_be_is_refused(environment):
    with pytest.raises(ModelError) as caught:
        settings_from_environment(environment)
    assert caught.value.fix


@pytest.mark.parametrize(
    "name, kind, address",
    [
        ("openai", "openai", "https://api.openai.com/v1"),
        ("openrouter", "openai", "https://openrouter.ai/api/v1"),
        ("lmstudio", "openai", "http://localhost:1234/v1"),
        ("llama.cpp", "openai", "http://localhost:8080/v1"),
        ("vllm", "openai", "http://localhost:8000/v1"),
        ("anthropic", "anthropic", "https://api.anthropic.com/v1"),
        ("gemini", "gemini", "https://generativelanguage.googleapis.com/v1beta"),
        ("ollama", "ollama", "http://localhost:11434"),
    ],
)
def test_every_provider_has_an_address_of_its_own_and_takes_another(name, kind, address):
    given = {"CODE_AS_ROOM_PROVIDER": name, "CODE_AS_ROOM_MODEL": "m"}
    settings = settings_from_environment(given)
    assert settings.kind == kind and make_client(settings).name == f"{kind}:m"
    assert settings.base_url == address == make_client(settings).base_url
    elsewhere = settings_from_environment({**given, "CODE_AS_ROOM_BASE_URL": "http://other.example:9/v1"})
    assert make_client(elsewhere).host == "other.example"


def test_a_model_without_eyes_answers_what_has_no_pictures_and_is_priced_for_it():
    settings = ClientSettings(kind="openai", base_url="http://localhost:1/v1", model="eyes", models={"text": "blind"})
    client = make_client(settings)
    words = Prompt("s06_geometry", "k", "t", (), "n", {}, "h")
    asked = []
    client.main.answer = lambda prompt, *rest: asked.append("eyes") or Reply("{}", "eyes")
    client._groups["text"].answer = lambda prompt, *rest: asked.append("blind") or Reply("{}", "blind")
    client.answer(words, threading.Event())
    client.answer(replace(words, images=(b"\x89PNG",)), threading.Event())
    assert asked == ["blind", "eyes"]
    look = price_lookup(PriceList(), settings)
    assert (look(words.stage, 0)[0], look(words.stage, 1)[0]) == ("blind", "eyes")
