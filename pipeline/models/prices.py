# SPDX-License-Identifier: GPL-3.0-or-later
"""What models cost: a dated list that comes with the add-on, and the artist's own prices, which go first.

A price that is not known stays unknown; it is never guessed from a similar model.
"""

from __future__ import annotations

import json
import math
import os
import re
import tempfile
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from importlib.resources import files
from pathlib import Path
from typing import Any
from urllib.parse import urlsplit

from ..errors import OutputError, RoomError
from .addresses import is_own_network

FILE_NAME = "prices.json"
# What may follow a model's name without making it another model: a date, "latest", "preview", a small version number.
_SAME_MODEL = re.compile(r"(?:[-@](?:\d{4}-\d{2}-\d{2}|\d{8}|\d{3}|latest|preview(?:-\d{2}-\d{2,4})?))?")
_MOST = 10_000.0


@dataclass(frozen=True)
class Price:
    """US dollars for a million tokens.

    Attributes:
        input, output: of what is sent, and of what is answered (thinking included).
        cached: of what the service kept of earlier prompts; written: of what it keeps for later ones; None: as input.
        date: when it was true, such as "2026-11"; "" where it is always true. own: given by the artist or the service.
    """

    input: float
    output: float
    date: str = ""
    own: bool = False
    cached: float | None = None
    written: float | None = None

    @property
    def is_free(self) -> bool:
        """Whether nothing is asked for."""
        return self.input == self.output == 0.0

    def of(self, prompt_tokens: int, completion_tokens: int, cached: int = 0, written: int = 0) -> float:
        """The price of one answer in US dollars.

        Args:
            cached, written: how many of the prompt's tokens came from the service's cache, and went into it.
        """
        cached = min(cached, prompt_tokens)
        written = min(written, prompt_tokens - cached)
        sent = self.input * (prompt_tokens - cached - written)
        sent += (self.input if self.cached is None else self.cached) * cached
        sent += (self.input if self.written is None else self.written) * written
        return (sent + self.output * completion_tokens) / 1e6


FREE = Price(0.0, 0.0)


class PriceList:
    """Prices by host and model. Later entries win over earlier ones."""

    def __init__(self, entries: Iterable[Mapping[str, Any]] = ()) -> None:
        self._prices: dict[tuple[str, str], Price] = {}
        for entry in entries:
            price = _price(entry)
            if price is not None:
                self._prices[(str(entry.get("host", "")).lower(), _plain(str(entry.get("model", ""))))] = price

    def find(self, base_url: str, model: str) -> Price | None:
        """The price of a model at a service; free on one's own computer and network; None where it is not known."""
        try:
            host = (urlsplit(base_url).hostname or "").lower()
        except ValueError:
            return None
        name = _plain(model)
        fitting = [
            (own, price)
            for (place, own), price in self._prices.items()
            if place == host and name.startswith(own) and _SAME_MODEL.fullmatch(name[len(own) :])
        ]
        if fitting:
            return max(fitting, key=lambda pair: len(pair[0]))[1]
        return FREE if is_own_network(base_url) else None

    def with_price(self, base_url: str, model: str, price: Price) -> PriceList:
        """A list with one more price."""
        result = PriceList()
        host = (urlsplit(base_url).hostname or "").lower()
        result._prices = {**self._prices, (host, _plain(model)): price}
        return result

    def merged(self, other: PriceList) -> PriceList:
        """Both lists; the other one's prices win."""
        result = PriceList()
        result._prices = {**self._prices, **other._prices}
        return result

    def entries(self) -> list[dict[str, Any]]:
        """The list as JSON-like data."""
        return [
            {"host": host, "model": model, "input": p.input, "output": p.output, "date": p.date, "own": p.own}
            | {name: value for name, value in (("cached", p.cached), ("written", p.written)) if value is not None}
            for (host, model), p in sorted(self._prices.items())
        ]


def bundled_prices() -> PriceList:
    """The list that comes with the add-on."""
    text = files(__package__ or "").joinpath(FILE_NAME).read_text(encoding="utf-8")
    return _parsed(text, "of the add-on")


def load_prices(folder: Path | None) -> PriceList:
    """The bundled list with the artist's own prices over it, which lie in this folder.

    Raises:
        RoomError: the artist's file is not readable; it is left as it is.
    """
    bundled = bundled_prices()
    return bundled if folder is None else bundled.merged(own_prices(folder))


def own_prices(folder: Path) -> PriceList:
    """The artist's own prices; none where there is no file.

    Raises:
        RoomError: the file is not readable.
    """
    try:
        text = (folder / FILE_NAME).read_text(encoding="utf-8")
    except FileNotFoundError:
        return PriceList()
    except (OSError, UnicodeError):
        raise RoomError("Your list of prices cannot be read.", f"Mend or delete {FILE_NAME}.") from None
    return _parsed(text, "of your own")


def save_own_price(folder: Path, base_url: str, model: str, price: Price) -> None:
    """Keep one price of the artist's own.

    Raises:
        OutputError: the folder cannot be written. RoomError: the file that is there is not readable.
    """
    entries = own_prices(folder).with_price(base_url, model, price).entries()
    text = json.dumps({"about": "US dollars for a million tokens", "prices": entries}, indent=1) + "\n"
    temporary = ""
    try:
        folder.mkdir(parents=True, exist_ok=True)
        handle, temporary = tempfile.mkstemp(dir=folder, prefix=".prices-")
        with os.fdopen(handle, "w", encoding="utf-8") as file:
            file.write(text)
        os.replace(temporary, folder / FILE_NAME)
    except OSError as error:
        if temporary:
            Path(temporary).unlink(missing_ok=True)
        reason = error.strerror or "unknown reason"
        raise OutputError(f"The price cannot be kept: {reason}.", "Check the add-on's user folder.") from None


def _parsed(text: str, whose: str) -> PriceList:
    try:
        data = json.loads(text)
        entries = data["prices"]
        return PriceList(entry for entry in entries if isinstance(entry, dict))
    except (ValueError, KeyError, TypeError, RecursionError):
        raise RoomError(f"The list of prices {whose} is not readable JSON.", f"Mend or delete {FILE_NAME}.") from None


def _price(entry: Mapping[str, Any]) -> Price | None:
    """An entry's price; None where its numbers are none."""
    numbers = [entry.get("input"), entry.get("output")]
    if any(not isinstance(n, (int, float)) or isinstance(n, bool) for n in numbers):
        return None
    low, high = (float(n) for n in numbers if n is not None)
    if not (math.isfinite(low) and math.isfinite(high) and 0 <= low <= _MOST and 0 <= high <= _MOST):
        return None
    kept = [_dollars(entry.get(name)) for name in ("cached", "written")]
    return Price(low, high, str(entry.get("date", "")), bool(entry.get("own", False)), *kept)


def _dollars(value: Any) -> float | None:
    """A price that may be left out; None where it is none."""
    if not isinstance(value, (int, float)) or isinstance(value, bool) or not 0 <= value <= _MOST:
        return None
    return float(value)


def _plain(model: str) -> str:
    return model.strip().lower().removeprefix("models/")
