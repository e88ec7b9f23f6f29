# SPDX-License-Identifier: GPL-3.0-or-later
"""What a room costs: an estimate before anything is sent, a running total, and a cap that holds before the request
that would pass it. Pure data and locks; thread-safe.

Costs are worked out from token counts and a dated price list, unless a service says itself what an answer cost. What is
not known is told as not known, never as nothing.
"""

from __future__ import annotations

import io
import threading
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any, Protocol

from PIL import Image

from .errors import Cancelled, ModelError, ReplyError
from .models.base import ModelClient, Prompt, Reply, name_of
from .models.prices import Price, PriceList, bundled_prices
from .models.registry import ClientSettings
from .models.routing import model_of
from .models.schema import shape_text
from .spending_estimate import RunEstimate, StageWork, estimate_run, money, stage_work
from .spending_meter import Meter, SpendingError

__all__ = [
    "CappedClient",
    "Estimate",
    "Meter",
    "RunEstimate",
    "SpendingError",
    "StageWork",
    "begin_total",
    "estimate_prompt",
    "estimate_run",
    "meter_of",
    "metered",
    "money",
    "picture_tokens",
    "price_lookup",
    "stage_work",
]

BYTES_A_TOKEN = 3.4
"""Of prompts in English and JSON; rather few, so that an estimate is rather high."""
_PIXELS_A_TOKEN = 700.0
_PICTURE_LEAST, _PICTURE_MOST = 260, 4800
_ANSWER_TOKENS = {"s00_draft": 24_000, "s01_analysis": 9_000, "s02_graph": 4_000, "s03_layout": 3_000, "s04_auxiliary": 3_000,
                  "s05_descriptions": 2_000, "s06_geometry": 12_000}  # fmt: skip
"""Expected length of an answer, thinking included."""
_ANSWER_ELSE = 6_000


class PriceOf(Protocol):
    """The model that answers a stage's question, and its price, None when it is not known."""

    def __call__(self, stage: str, pictures: int = 1) -> tuple[str, Price | None]:
        """For a stage's id, and how many pictures the question has."""
        ...


@dataclass(frozen=True)
class Estimate:
    """What a request may take: tokens, and US dollars (None when the price is not known)."""

    prompt_tokens: int
    completion_tokens: int
    dollars: float | None


def picture_tokens(image: bytes) -> int:
    """Tokens of an encoded picture, going by its size; rather too many than too few."""
    try:
        with Image.open(io.BytesIO(image)) as picture:
            width, height = picture.size
    except Exception:  # whatever Pillow raises: the size is not known
        return _PICTURE_MOST
    return int(min(_PICTURE_MOST, max(_PICTURE_LEAST, width * height / _PIXELS_A_TOKEN)))


def estimate_prompt(prompt: Prompt, price: Price | None, longest_answer: int = 0) -> Estimate:
    """What a prompt may cost.

    Args:
        longest_answer: tokens of the longest answer of this stage so far.
    """
    text = len(prompt.text.encode()) + len(shape_text(prompt.schema).encode())
    sent = int(text / BYTES_A_TOKEN) + sum(picture_tokens(image) for image in prompt.images)
    answered = max(_ANSWER_TOKENS.get(prompt.stage, _ANSWER_ELSE), longest_answer)
    # The shared beginning may have to be kept first, which costs more than just reading it.
    kept = int(len(prompt.halves()[0].encode()) / BYTES_A_TOKEN) if price is not None and price.written else 0
    return Estimate(sent, answered, None if price is None else price.of(sent, answered, written=kept))


class CappedClient:
    """A client whose every question is priced before it is sent and counted after it was answered.

    Args:
        inner: who answers; price_of: for a stage and a number of pictures the model that answers, and its price (None
            when not known).
    """

    def __init__(self, inner: ModelClient, meter: Meter, price_of: PriceOf) -> None:
        self.inner, self.meter, self._price_of = inner, meter, price_of
        self.name, self.describes = inner.name, inner.describes

    def name_for(self, stage: str) -> str:
        """The name of who answers a stage."""
        return name_of(self.inner, stage)

    def answer(self, prompt: Prompt, cancel: threading.Event, progress: Callable[[str], None] | None = None) -> Reply:
        """As `ModelClient.answer`; the reply's `cost` is filled in where the price is known.

        Raises:
            SpendingError: the question would pass the cap, or there is a cap and the price is not known. Nothing was sent.
        """
        model, price = self._price_of(prompt.stage, len(prompt.images))
        estimate = estimate_prompt(prompt, price, self.meter.longest(prompt.stage))
        fix = "Set its price in the preferences, or set the cap to 0."
        with self.meter.request(estimate.dollars, f"The price of {model}", fix, progress) as spending:
            try:
                reply = self.inner.answer(prompt, cancel, spending.tell)
            except ReplyError:
                # It was answered, so it is paid for; how long the answer was is not known.
                spending.spent = spending.reserved
                raise
            except (Cancelled, ModelError) as error:
                if spending.is_billed(error):
                    spending.spent = _sent_only(price, estimate)
                raise
            if reply.cost is None and price is not None:
                reply = replace(reply, cost=_cost(reply, price, estimate))
            spending.spent = reply.cost or 0.0
            self.meter.note(prompt.stage, reply, model, reply.cost is not None)
            return reply


def _cost(reply: Reply, price: Price, estimate: Estimate) -> float:
    """What an answer cost; by our own count where the service gives none."""
    if reply.prompt_tokens or reply.completion_tokens:
        return price.of(reply.prompt_tokens, reply.completion_tokens, reply.cached_tokens, reply.written_tokens)
    return price.of(estimate.prompt_tokens, int(len(reply.text.encode()) / BYTES_A_TOKEN) + 1)


def _sent_only(price: Price | None, estimate: Estimate) -> float:
    return price.of(estimate.prompt_tokens, 0) if price else 0.0


def price_lookup(prices: PriceList, settings: ClientSettings) -> PriceOf:
    """For a stage and a number of pictures: the model that answers and its price."""
    found: dict[str, tuple[str, Price | None]] = {}

    def look(stage: str, pictures: int = 1) -> tuple[str, Price | None]:
        model = model_of(settings.models, settings.model, stage, pictures)
        if model not in found:
            found[model] = (model, prices.find(settings.base_url, model))
        return found[model]

    return look


def metered(
    client: ModelClient, settings: ClientSettings, meter: Meter | None = None, prices: PriceList | None = None
) -> ModelClient:
    """The client with every question priced and held against the cap; as it is where no service is asked.

    Args:
        meter: the room's running total, a new one when None; prices: the bundled ones when None.
    """
    if not settings.is_service:
        return client
    meter = meter or Meter()
    meter.cap = settings.spending_cap
    return CappedClient(client, meter, price_lookup(prices or bundled_prices(), settings))


def meter_of(client: ModelClient) -> Meter | None:
    """The running total that a client counts on, however it is wrapped; None where nothing is counted."""
    found: Any = client
    while found is not None and not isinstance(found, CappedClient):
        found = getattr(found, "inner", None)
    return found.meter if found is not None else None


def begin_total(client: ModelClient, spent: float) -> None:
    """Tell a client's meter what the room has cost before, in US dollars."""
    meter = meter_of(client)
    if meter is not None:
        meter.raise_to(spent)
