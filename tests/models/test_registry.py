# SPDX-License-Identifier: GPL-3.0-or-later
"""From settings and environment to a client."""

import pytest
from code_as_room.pipeline.errors import ModelError
from code_as_room.pipeline.models.addresses import is_local_url
from code_as_room.pipeline.models.openai_style import OpenAIStyleClient
from code_as_room.pipeline.models.registry import ClientSettings, make_client, settings_from_environment


def test_with_nothing_configured_the_built_in_analysis_answers():
    assert settings_from_environment({}).kind == "builtin"
    assert make_client(ClientSettings()).name == "builtin"


def test_the_environment_configures_a_service():
    settings = settings_from_environment(
        {
            "CODE_AS_ROOM_BASE_URL": "http://localhost:1234",
            "CODE_AS_ROOM_MODEL": "local",
            "CODE_AS_ROOM_API_KEY": " sk-secretsecret ",
            "CODE_AS_ROOM_TIMEOUT": "3600",
        }
    )
    client = make_client(settings)
    assert isinstance(client, OpenAIStyleClient)
    assert client.base_url == "http://localhost:1234/v1" and client.name == "openai:local"
    assert settings.total_timeout == settings.read_timeout == 3600
    assert "sk-secret" not in repr(settings)


@pytest.mark.parametrize(
    "environment",
    [
        {"CODE_AS_ROOM_MODEL": "m"},
        {"CODE_AS_ROOM_API_KEY": "sk-x"},
        {"CODE_AS_ROOM_BASE_URL": "http://x", "CODE_AS_ROOM_TIMEOUT": "soon"},
        {"CODE_AS_ROOM_BASE_URL": "http://x", "CODE_AS_ROOM_TIMEOUT": "nan"},
        {"CODE_AS_ROOM_BASE_URL": "http://x", "CODE_AS_ROOM_TIMEOUT": "0"},
    ],
)
def test_half_a_configuration_is_refused_rather_than_ignored(environment):
    with pytest.raises(ModelError):
        settings_from_environment(environment)


@pytest.mark.parametrize(
    "settings",
    [
        ClientSettings(kind="openai", base_url="http://x/v1"),
        ClientSettings(kind="openai", model="m"),
        ClientSettings(kind="recorded"),
        ClientSettings(kind="recorded", folder="/no/such/folder"),
        ClientSettings(kind="telepathy"),  # type: ignore[arg-type]
    ],
)
def test_incomplete_settings_are_refused(settings):
    with pytest.raises(ModelError) as caught:
        make_client(settings)
    assert caught.value.fix


@pytest.mark.parametrize(
    "url, local",
    [
        ("http://localhost:1234/v1", True),
        ("http://127.0.0.1/v1", True),
        ("http://127.8.8.8/v1", True),
        ("http://[::1]:8080/v1", True),
        ("http://192.168.1.5/v1", False),
        ("https://api.example.com/v1", False),
        ("http://localhost.example.com", False),
        ("http://127.0.0.1.example.com", False),
        ("http://[broken", False),
        ("", False),
    ],
)
def test_only_this_computer_is_local(url, local):
    assert is_local_url(url) is local
