# SPDX-License-Identifier: GPL-3.0-or-later
"""From settings to a client. Keys come from preferences or the environment, and are never printed.

Environment variables (for the command; the add-on's preferences come first in Blender):

- `CODE_AS_ROOM_PROVIDER`: builtin, openai, anthropic, gemini, openrouter, lmstudio, ollama, ollama_openai, llamacpp,
  vllm or custom. Where neither it nor the base URL is set, the built-in picture analysis answers.
- `CODE_AS_ROOM_BASE_URL`: the service's address; the provider's own where it is not set. Without a provider it is
  that of an OpenAI-style service, such as `http://localhost:1234/v1`.
- `CODE_AS_ROOM_MODEL`: the model's name, as the service spells it; `CODE_AS_ROOM_MODEL_SEEING`, `_LAYOUT`,
  `_MODELLING` and `_SURFACES`: another one for stage 1, stages 2 to 4, 5 to 7 and 8 to 10.
- `CODE_AS_ROOM_API_KEY`: the key; may be left out for local services. Where it is not set, the variable that the
  provider's users know is looked at (OPENAI_API_KEY and the like), for the provider's own address only.
- `CODE_AS_ROOM_MODEL_TEXT`: a model for questions without pictures; it needs no eyes.
- `CODE_AS_ROOM_AT_ONCE`: most questions side by side, 1 to 4.
- `CODE_AS_ROOM_TIMEOUT`: most seconds that one question may take, and that the service may be silent for.
- `CODE_AS_ROOM_PROXY`, `CODE_AS_ROOM_CA_BUNDLE`: an HTTP proxy, and a file with the certificates to trust. Where
  they are not set, HTTPS_PROXY, NO_PROXY and REQUESTS_CA_BUNDLE hold.
- `CODE_AS_ROOM_SPENDING_CAP`: most US dollars for one room.
"""

from __future__ import annotations

import math
import os
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

from ..errors import ModelError
from .addresses import is_own_network
from .base import ModelClient
from .limits import Limits, checked_route
from .pace import Pace
from .presets import PRESETS, ClientKind, own_key_variable, preset
from .routing import GROUPS, TEXT, RoutingClient

if TYPE_CHECKING:
    from .http_client import HttpClient
    from .retry import RetryPolicy

SERVICES = ("openai", "anthropic", "gemini", "ollama")
"""Kinds that send questions to a service."""
BY_HAND = ModelError("A chat can only be asked by hand in Blender's window.", "Choose another provider.")


@dataclass(frozen=True)
class ClientSettings:
    """Which client answers.

    Attributes:
        kind: "builtin" needs nothing else; "recorded" needs `folder`, "manual" takes one for pictures; the others need
            `base_url` and `model`.
        api_key: never shown in `repr`.
        models: another model for a group of stages (see `routing.GROUPS`); the main one where none is given. The one
            of "text" answers what has no picture.
        at_once: most questions side by side, 0 for what suits the service.
        proxy: address of an HTTP proxy, "" for the environment's; may hold a password, so never shown either.
        ca_bundle: file with certificates to trust, "" for the usual ones.
        read_timeout: seconds a streaming service may be silent; total_timeout: seconds for one question in all.
        spending_cap: most US dollars for one room, 0 for no cap.
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
    models: Mapping[str, str] = field(default_factory=dict)
    proxy: str = field(default="", repr=False)
    spending_cap: float = 0.0
    at_once: int = 0

    @property
    def is_service(self) -> bool:
        """Whether questions are sent to a service at all."""
        return self.kind in SERVICES


def settings_from_environment(environment: Mapping[str, str] | None = None) -> ClientSettings:
    """The settings that the environment variables describe; the built-in analysis when there are none.

    Raises:
        ModelError: a model or key is given without a service, the provider is not known, or a number is none.
    """
    given = os.environ if environment is None else environment

    def value(name: str) -> str:
        return given.get(f"CODE_AS_ROOM_{name}", "").strip()

    provider, base_url = value("PROVIDER"), value("BASE_URL")
    chosen = preset(provider) if provider else preset("CUSTOM" if base_url else "BUILTIN")
    if provider and chosen.id == "CUSTOM" and provider.lower() != "custom":
        names = ", ".join(p.id.lower() for p in PRESETS if p.id not in ("RECORDED", "MANUAL"))
        raise ModelError(f"CODE_AS_ROOM_PROVIDER names no provider: {provider!r}.", f"Choose one of {names}.")
    if chosen.kind == "manual":
        raise ModelError(BY_HAND.message, BY_HAND.fix)
    if chosen.kind not in SERVICES:
        if not provider and (value("MODEL") or value("API_KEY")):
            raise ModelError(
                "A model or key is set, but not the service's address.",
                "Set CODE_AS_ROOM_PROVIDER or CODE_AS_ROOM_BASE_URL, or clear CODE_AS_ROOM_MODEL and CODE_AS_ROOM_API_KEY.",
            )
        return ClientSettings()
    base_url = base_url or chosen.base_url
    settings = ClientSettings(
        kind=chosen.kind,
        base_url=base_url,
        model=value("MODEL"),
        api_key=value("API_KEY") or given.get(own_key_variable(chosen, base_url), "").strip(),
        models={group: value(f"MODEL_{group.upper()}") for group in (*GROUPS, TEXT) if value(f"MODEL_{group.upper()}")},
        proxy=value("PROXY"),
        ca_bundle=value("CA_BUNDLE"),
        spending_cap=_number(value("SPENDING_CAP"), "CODE_AS_ROOM_SPENDING_CAP", 0.0, 1e6, "US dollars") or 0.0,
    )
    at_once = _number(value("AT_ONCE"), "CODE_AS_ROOM_AT_ONCE", 1.0, 4.0, "questions")
    settings = replace(settings, at_once=int(at_once or chosen.at_once))
    seconds = _number(value("TIMEOUT"), "CODE_AS_ROOM_TIMEOUT", 1.0, 86_400.0, "seconds")
    return settings if seconds is None else replace(settings, read_timeout=seconds, total_timeout=seconds)


def _number(text: str, name: str, low: float, high: float, what: str) -> float | None:
    if not text:
        return None
    try:
        number = float(text)
    except ValueError:
        number = math.nan
    if not low <= number <= high:
        raise ModelError(f"{name} is not a number of {what} between {low:g} and {high:.0f}.", "Set it anew.")
    return number


def make_client(settings: ClientSettings) -> ModelClient:
    """The client that the settings describe. Nothing is sent until it is asked something.

    Raises:
        ModelError: the settings are not complete or cannot be right.
    """
    if settings.kind == "builtin":
        from .builtin.client import BuiltinClient

        return BuiltinClient()
    if settings.kind == "manual":
        # Somebody has to copy and paste: the add-on makes this client itself, where it has a window.
        raise ModelError(BY_HAND.message, BY_HAND.fix)
    if settings.kind == "recorded":
        from .recorded import RecordedClient

        if not settings.folder:
            raise ModelError("No folder with recorded answers is given.", "Choose one.")
        return RecordedClient(settings.folder)
    # The service's limits are those of the account: its models share one pace.
    pace = Pace(settings.at_once or usual_at_once(settings.base_url))
    main = service_client(settings, pace=pace)
    others = {
        group: service_client(settings, model, pace=pace)
        for group, model in settings.models.items()
        if model.strip() and model.strip() != main.model
    }
    return RoutingClient(main, others) if others else main


def usual_at_once(base_url: str) -> int:
    """Questions side by side: one on a computer of one's own, where the others would only wait and run out of time."""
    return 1 if is_own_network(base_url) else 4


def service_client(
    settings: ClientSettings, model: str = "", retries: RetryPolicy | None = None, pace: Pace | None = None
) -> HttpClient:
    """The client of one model of a service.

    Args:
        model: another model than the settings' main one; retries: how often to try, None for the usual.
        pace: how many questions may be under way, shared with other clients of the service.

    Raises:
        ModelError: the settings are not complete or cannot be right.
    """
    if settings.kind not in SERVICES:
        raise ModelError(f"There is no model client of the kind {settings.kind!r}.", "Choose another in the settings.")
    limits = Limits(settings.connect_timeout, settings.read_timeout, settings.total_timeout)
    route = checked_route(settings.proxy, settings.ca_bundle)
    return _client_class(settings.kind)(
        settings.base_url, model or settings.model, settings.api_key, limits, retries, route, pace
    )


def _client_class(kind: str) -> type[HttpClient]:
    """Imported only when needed: `requests` takes its time."""
    if kind == "anthropic":
        from .anthropic import AnthropicClient

        return AnthropicClient
    if kind == "gemini":
        from .gemini import GeminiClient

        return GeminiClient
    if kind == "ollama":
        from .ollama import OllamaClient

        return OllamaClient
    from .openai_style import OpenAIStyleClient

    return OpenAIStyleClient
