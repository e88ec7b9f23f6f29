# SPDX-License-Identifier: GPL-3.0-or-later
"""What the preferences say of the chosen models' prices, worked out whenever a setting changes and never while drawing."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..pipeline.errors import RoomError
from . import clients

if TYPE_CHECKING:
    from ..pipeline.models.prices import Price
    from ..pipeline.models.registry import ClientSettings

_lines: tuple[str, ...] = ()
_missing: tuple[str, ...] = ()


def lines() -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Sentences on what the models cost, and the models whose price is not known."""
    return _lines, _missing


def look_up() -> None:
    """Work out what the preferences say of prices."""
    global _lines, _missing
    try:
        settings = clients.client_settings()
        if not settings.is_service:
            _lines, _missing = (), ()
            return
        _take_listed(settings)
        found = clients.model_prices(settings)
    except RoomError as error:
        _lines, _missing = (str(error),), ()
        return
    _lines = tuple(_sentence(model, price) for model, price in found)
    _missing = tuple(model for model, price in found if price is None)


def _take_listed(settings: ClientSettings) -> None:
    """A chosen model whose price the service told: keep it."""
    from .connection import models_at

    listed = {info.id: info.price for info in models_at(settings)}
    for model, known in clients.model_prices(settings):
        told = listed.get(model)
        if told is not None and (known is None or (known.input, known.output) != (told.input, told.output)):
            clients.keep_price(settings.base_url, model, told)


def _sentence(model: str, price: Price | None) -> str:
    if price is None:
        return f"The price of {model} is not known, so what it costs cannot be told."
    if price.is_free:
        return f"{model} costs nothing."
    since = f" (as of {price.date}; what the service bills is what holds)" if price.date else ""
    kept = f" (${price.cached:g} for what it kept of earlier prompts)" if price.cached is not None else ""
    return f"{model} costs ${price.input:g} for a million tokens sent{kept}, ${price.output:g} answered{since}."
