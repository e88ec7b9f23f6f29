# SPDX-License-Identifier: GPL-3.0-or-later
"""The models that a service offers now, as it tells them itself, with what it says of pictures and prices."""

from __future__ import annotations

import difflib
import json
import threading
import time
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from typing import Any

from .exchange import exchange
from .faults import Fault, ServiceError, status_fault, without_key
from .http_client import HttpClient
from .limits import Limits
from .prices import Price
from .registry import ClientSettings, service_client

_SECONDS = 30.0
_MOST = 5000
_NAME_MOST = 200


@dataclass(frozen=True)
class ModelInfo:
    """One model.

    Attributes:
        id: as it has to be asked for; pictures, structured: whether it takes pictures and keeps to a schema, None where
            the service does not say; price: None where the service does not say.
    """

    id: str
    pictures: bool | None = None
    structured: bool | None = None
    price: Price | None = None

    def hint(self) -> str:
        """What is known of it, in a few words for a list."""
        # Most of those that are offered see pictures, and they come first.
        words = ["no pictures"] if self.pictures is False else []
        if self.price is not None:
            words.append("free" if self.price.is_free else f"${self.price.input:g}/${self.price.output:g}")
        return ", ".join(words)


def list_models(
    settings: ClientSettings, cancel: threading.Event, progress: Callable[[str], None] | None = None
) -> tuple[ModelInfo, ...]:
    """Ask a service which models it offers, those that take pictures first.

    Raises:
        ServiceError: it cannot be reached, refuses, or offers no such list; ModelError: the settings are not complete.
        Cancelled: `cancel` was set.
    """
    client = service_client(settings, settings.model or "any")
    path = {"gemini": "/models?pageSize=1000", "anthropic": "/models?limit=1000", "ollama": "/api/tags"}
    data = _get(client, settings, path.get(settings.kind, "/models"), cancel, progress)
    key = settings.api_key.strip()
    infos = (info for info in _read(settings.kind, data) if 0 < len(info.id) <= _NAME_MOST)
    found = {info.id: info for info in infos if info.id.isprintable() and without_key(info.id, key) == info.id}
    if not found:
        raise ServiceError(f"The service at {client.host} lists no models.", "Type the model's name.", "shape")
    order = {True: 0, None: 1, False: 2}
    return tuple(sorted(found.values(), key=lambda info: (order[info.pictures], info.id.lower())))[:_MOST]


def takes_pictures(settings: ClientSettings, cancel: threading.Event) -> bool | None:
    """What Ollama says of one model; None where nothing is said. Other services tell it in their list.

    Raises:
        ServiceError, Cancelled: as `list_models`.
    """
    if settings.kind != "ollama":
        return None
    client = service_client(settings)
    body = json.dumps({"model": settings.model}).encode()
    data = _get(client, settings, "/api/show", cancel, None, body)
    able = data.get("capabilities") if isinstance(data, dict) else None
    return "vision" in able if isinstance(able, list) else None


def close_names(wanted: str, offered: Sequence[ModelInfo], most: int = 4) -> tuple[str, ...]:
    """Models to suggest for a name that is not known: those spelled alike, else the first that are offered."""
    names = [info.id for info in offered if info.pictures is not False]
    plainly = {name.lower(): name for name in names}
    low = wanted.lower().strip()
    inside = [name for key, name in plainly.items() if low and (low in key or key in low)]
    alike = [plainly[key] for key in difflib.get_close_matches(low, list(plainly), most, 0.55)]
    found = list(dict.fromkeys([*alike, *inside])) or names
    return tuple(found[:most])


def _get(
    client: HttpClient,
    settings: ClientSettings,
    path: str,
    cancel: threading.Event,
    progress: Callable[[str], None] | None,
    body: bytes | None = None,
) -> Any:
    limits = Limits(settings.connect_timeout, _SECONDS, _SECONDS)
    call = client.plain_call(path, body)
    try:
        answer = exchange(call, limits, time.monotonic() + _SECONDS, cancel, progress)
        if answer.status != 200:
            raise status_fault(answer.status, answer.body, answer.headers, client.host, settings.api_key)
    except Fault as fault:
        raise fault.error from None
    try:
        return json.loads(answer.body)
    except (ValueError, RecursionError):
        page = answer.body.lstrip()[:1] == b"<"
        what = "a web page" if page else "something else"
        raise ServiceError(
            f"The service at {client.host} answered with {what}, not with a list of models.",
            "Check the base URL.",
            "shape",
        ) from None


def _read(kind: str, data: Any) -> Iterable[ModelInfo]:
    """The models in a list of any service's shape."""
    rows = data if isinstance(data, list) else _rows(data)
    for row in rows:
        if isinstance(row, str):
            yield ModelInfo(row)
        elif isinstance(row, dict):
            info = _gemini(row) if kind == "gemini" else _model(row)
            if info is not None:
                yield info


def _rows(data: Any) -> list[Any]:
    if isinstance(data, dict):
        for name in ("data", "models"):
            if isinstance(data.get(name), list):
                return list(data[name])
    return []


def _model(row: dict[str, Any]) -> ModelInfo | None:
    name = row.get("id") or row.get("model") or row.get("name")
    if not isinstance(name, str):
        return None
    shape = row.get("architecture")
    inputs = shape.get("input_modalities") if isinstance(shape, dict) else None
    able = row.get("supported_parameters")
    pictures = "image" in inputs if isinstance(inputs, list) else None
    if row.get("type") in ("vlm", "llm", "embeddings"):
        pictures = row["type"] == "vlm"
    capabilities = row.get("capabilities")
    if isinstance(capabilities, dict) and isinstance(capabilities.get("image_input"), dict):
        pictures = bool(capabilities["image_input"].get("supported"))
    return ModelInfo(
        name,
        pictures,
        "structured_outputs" in able or "response_format" in able if isinstance(able, list) else None,
        _price(row.get("pricing")),
    )


def _gemini(row: dict[str, Any]) -> ModelInfo | None:
    verbs = row.get("supportedGenerationMethods")
    if not isinstance(row.get("name"), str) or (isinstance(verbs, list) and "generateContent" not in verbs):
        return None
    return ModelInfo(row["name"].removeprefix("models/"))


def _price(pricing: Any) -> Price | None:
    """OpenRouter gives US dollars for one token, as text."""
    if not isinstance(pricing, dict):
        return None
    low, high = _dollars(pricing.get("prompt")), _dollars(pricing.get("completion"))
    if low is None or high is None:
        return None
    kept = _dollars(pricing.get("input_cache_read")), _dollars(pricing.get("input_cache_write"))
    return Price(low, high, datetime.now(UTC).date().isoformat(), True, *kept)


def _dollars(text: Any) -> float | None:
    """US dollars for a million tokens; None where nothing, or nothing that can be right, is told."""
    try:
        dollars = float(text) * 1e6
    except (TypeError, ValueError):
        return None
    return round(dollars, 6) if 0 <= dollars < 1e4 else None
