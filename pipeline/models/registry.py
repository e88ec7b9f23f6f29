# SPDX-License-Identifier: GPL-3.0-or-later
"""From settings to a client. Keys come from preferences or the environment, and are never printed.

Environment variables (for the command; the add-on's preferences come first in Blender):

- `CODE_AS_ROOM_BASE_URL`: base URL of an OpenAI-style service, such as `http://localhost:1234/v1`. Where it is not
  set, the built-in picture analysis answers.
- `CODE_AS_ROOM_MODEL`: the model's name, as the service spells it.
- `CODE_AS_ROOM_API_KEY`: the key; may be left out for local services.
- `CODE_AS_ROOM_TIMEOUT`: most seconds that one question may take, and that the service may be silent for.
"""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Literal

from ..errors import ModelError
from .base import ModelClient
from .exchange import Limits

ClientKind = Literal["builtin", "openai", "recorded"]


@dataclass(frozen=True)
class ClientSettings:
    """Which client answers.

    Attributes:
        kind: "builtin" needs nothing else; "openai" needs `base_url` and `model`; "recorded" needs `folder`.
        api_key: never shown in `repr`.
        ca_bundle: file with certificates to trust, "" for the usual ones.
        read_timeout: seconds a streaming service may be silent; total_timeout: seconds for one question in all.
    """

    kind: ClientKind = "builtin"
    base_url: str = ""
    model: str = ""
    api_key: str = field(default="", repr=False)
    folder: str = ""
    ca_bundle: str = ""
    connect_timeout: float = 10.0
    read_timeout: float = 120.0
    total_timeout: float = 900.0


def settings_from_environment(environment: Mapping[str, str] | None = None) -> ClientSettings:
    """The settings that the environment variables describe; the built-in analysis when there are none.

    Raises:
        ModelError: a model or key is given without a base URL, or the time-out is not a number of seconds.
    """
    given = os.environ if environment is None else environment
    base_url = given.get("CODE_AS_ROOM_BASE_URL", "").strip()
    model = given.get("CODE_AS_ROOM_MODEL", "").strip()
    key = given.get("CODE_AS_ROOM_API_KEY", "").strip()
    if not base_url:
        if model or key:
            raise ModelError(
                "A model or key is set, but not the service's address.",
                "Set CODE_AS_ROOM_BASE_URL, or clear CODE_AS_ROOM_MODEL and CODE_AS_ROOM_API_KEY.",
            )
        return ClientSettings()
    settings = ClientSettings(kind="openai", base_url=base_url, model=model, api_key=key)
    text = given.get("CODE_AS_ROOM_TIMEOUT", "").strip()
    if not text:
        return settings
    try:
        seconds = float(text)
    except ValueError:
        seconds = 0.0
    if not 1.0 <= seconds <= 86_400.0:
        raise ModelError("CODE_AS_ROOM_TIMEOUT is not a number of seconds between 1 and 86400.", "Set it anew.")
    return replace(settings, read_timeout=seconds, total_timeout=seconds)


def make_client(settings: ClientSettings) -> ModelClient:
    """The client that the settings describe. Nothing is sent until it is asked something.

    Raises:
        ModelError: the settings are not complete or cannot be right.
    """
    if settings.kind == "builtin":
        from .builtin.client import BuiltinClient

        return BuiltinClient()
    if settings.kind == "recorded":
        from .recorded import RecordedClient

        if not settings.folder:
            raise ModelError("No folder with recorded answers is given.", "Choose one.")
        return RecordedClient(settings.folder)
    if settings.kind == "openai":
        from .openai_style import OpenAIStyleClient

        limits = Limits(settings.connect_timeout, settings.read_timeout, settings.total_timeout)
        return OpenAIStyleClient(
            settings.base_url, settings.model, settings.api_key, limits, ca_bundle=settings.ca_bundle
        )
    raise ModelError(f"There is no model client of the kind {settings.kind!r}.", "Choose another in the settings.")
