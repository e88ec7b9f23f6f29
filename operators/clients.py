# SPDX-License-Identifier: GPL-3.0-or-later
"""From the add-on's preferences to the client that answers. Keys stay here: they reach no scene, memory, log or report."""

from __future__ import annotations

import os
import threading
from collections.abc import Callable
from typing import Any

import bpy

from .. import __package__ as base_package
from ..pipeline.errors import ModelError
from ..pipeline.models.addresses import is_local_url, normal_base_url
from ..pipeline.models.base import ModelClient, Prompt, Reply
from ..pipeline.models.registry import ClientSettings, make_client, settings_from_environment

OFFLINE = ModelError(
    "Blender's online access is off, so the model service cannot be asked.",
    "Allow it in Preferences, System, Network; or use the built-in analysis or a service on this computer.",
)


def add_on_preferences() -> Any | None:
    """The add-on's preferences; None where it is used as a Python package and not enabled as an add-on."""
    preferences: Any = bpy.context.preferences
    entry = preferences.addons.get(base_package or "")
    return entry.preferences if entry is not None else None


def client_settings() -> ClientSettings:
    """The settings of the client that would answer now.

    Raises:
        ModelError: the key's environment variable is named but not set.
    """
    preferences = add_on_preferences()
    if preferences is None:
        return settings_from_environment()
    if preferences.provider == "BUILTIN":
        return ClientSettings()
    if preferences.provider == "RECORDED":
        return ClientSettings(kind="recorded", folder=bpy.path.abspath(preferences.replies_folder))
    return ClientSettings(
        kind="openai",
        base_url=preferences.base_url,
        model=preferences.model.strip(),
        api_key=_key(preferences),
        read_timeout=float(preferences.timeout),
    )


def _key(preferences: Any) -> str:
    variable = preferences.key_variable.strip()
    if not variable:
        return str(preferences.api_key).strip()
    value = os.environ.get(variable, "").strip()
    if not value:
        raise ModelError(
            f"The environment variable {variable!r} that should hold the API key is not set.",
            "Set it before Blender starts, or type the key in the preferences.",
        )
    return value


def current_client() -> ModelClient:
    """The client that the preferences describe, fit to be asked from worker threads.

    Raises:
        ModelError: the preferences are not complete, or Blender's online access is off and the service is not local.
    """
    settings = client_settings()
    client = make_client(settings)
    if settings.kind != "openai" or is_local_url(normal_base_url(settings.base_url)):
        return client
    guarded = GuardedClient(client)
    guarded.watch()
    if not guarded.online:
        raise OFFLINE
    return guarded


class GuardedClient:
    """A client on the network. Before every question it looks whether Blender's online access is still on.

    Worker threads must not read `bpy.app`, so the main thread looks for them: `watch` is called on every tick.
    """

    def __init__(self, client: ModelClient) -> None:
        self._client = client
        self.name, self.describes = client.name, client.describes
        self.online = False

    def watch(self) -> None:
        """Look whether online access is on. Main thread only."""
        self.online = bool(bpy.app.online_access)

    def answer(self, prompt: Prompt, cancel: threading.Event, progress: Callable[[str], None] | None = None) -> Reply:
        """As `ModelClient.answer`; ModelError when online access was switched off."""
        if not self.online:
            raise ModelError(OFFLINE.message, OFFLINE.fix)
        return self._client.answer(prompt, cancel, progress)


def watch_online_access(client: ModelClient) -> None:
    """Tell a client on the network whether online access is still on. Main thread only."""
    if isinstance(client, GuardedClient):
        client.watch()


class _Nobody:
    """Answers nothing: for reading the state of a room, where no question is ever asked."""

    name = ""
    describes = ""

    def answer(self, prompt: Prompt, cancel: threading.Event, progress: Callable[[str], None] | None = None) -> Reply:
        """Always ModelError."""
        raise ModelError("There is no model to ask.")


NOBODY: ModelClient = _Nobody()
