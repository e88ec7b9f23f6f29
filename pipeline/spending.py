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
from .models.pace import WAITING
from .models.prices import Price, PriceList, bundled_prices
from .models.registry import ClientSettings
from .models.routing import model_of
from .models.schema import shape_text
from .spending_estimate import RunEstimate, StageWork, estimate_run, money, stage_work

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
_ANSWER_TOKENS = {"s01_analysis": 9_000, "s02_graph": 4_000, "s03_layout": 3_000, "s04_auxiliary": 3_000,
                  "s05_descriptions": 2_000, "s06_geometry": 12_000}  # fmt: skip
"""Expected length of an answer, thinking included."""
_ANSWER_ELSE = 6_000


class PriceOf(Protocol):
    """The model that answers a stage's question, and its price, None when it is not known."""

    def __call__(self, stage: str, pictures: int = 1) -> tuple[str, Price | None]:
        """For a stage's id, and how many pictures the question has."""
        ...


class SpendingError(ModelError):
    """The request was not sent: it would pass the spending cap, or its price is not known."""


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


class Meter:
    """The running total of one room.

    Args:
        cap: most US dollars, 0 for no cap; spent: what was spent before, as memory knows it.
    """

    def __init__(self, cap: float = 0.0, spent: float = 0.0) -> None:
        self.cap = cap
        self._spent = spent
        self._reserved = 0.0
        self._unpriced: set[str] = set()
        self._tokens = [0, 0]
        self._cached = 0
        self._longest: dict[str, int] = {}
        self._lock = threading.Lock()

    @property
    def spent(self) -> float:
        """US dollars so far, as far as prices are known."""
        with self._lock:
            return self._spent

    @property
    def tokens(self) -> tuple[int, int]:
        """Tokens sent and answered since this meter began."""
        with self._lock:
            return self._tokens[0], self._tokens[1]

    @property
    def cached(self) -> int:
        """Of the tokens sent, those that services had kept from earlier prompts."""
        with self._lock:
            return self._cached

    @property
    def unpriced(self) -> tuple[str, ...]:
        """Models that answered without a known price; the total does not have them."""
        with self._lock:
            return tuple(sorted(self._unpriced))

    def raise_to(self, spent: float) -> None:
        """Memory knows of more than this meter, as after a load. What was lost with an undo stays spent."""
        with self._lock:
            self._spent = max(self._spent, spent)

    def longest(self, stage: str) -> int:
        """Tokens of the longest answer of a stage so far."""
        with self._lock:
            return self._longest.get(stage, 0)

    def reserve(self, dollars: float) -> None:
        """Set the money of a request aside before it is sent.

        Raises:
            SpendingError: it would pass the cap; nothing is set aside.
        """
        with self._lock:
            expected = self._spent + self._reserved + dollars
            if self.cap > 0 and expected > self.cap:
                before = f"{money(self._spent)} of {money(self.cap)} is spent"
                raise SpendingError(
                    f"The next question may cost about {money(dollars)} and would pass the room's spending cap: {before}.",
                    "Raise the cap in the preferences, or choose a cheaper model. What was answered is kept.",
                )
            self._reserved += dollars

    def settle(self, reserved: float, spent: float) -> None:
        """A request has ended: its money is free again, and what it really cost is counted."""
        with self._lock:
            self._reserved = max(0.0, self._reserved - reserved)
            self._spent += spent

    def note(self, stage: str, reply: Reply, model: str, priced: bool) -> None:
        """Remember what an answer took."""
        with self._lock:
            self._tokens[0] += reply.prompt_tokens
            self._tokens[1] += reply.completion_tokens
            self._cached += reply.cached_tokens
            self._longest[stage] = max(self._longest.get(stage, 0), reply.completion_tokens)
            if not priced:
                self._unpriced.add(model)


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
        if price is None and self.meter.cap > 0:
            raise SpendingError(
                f"The price of {model} is not known, so the spending cap cannot be kept.",
                "Set its price in the preferences, or set the cap to 0.",
            )
        estimate = estimate_prompt(prompt, price, self.meter.longest(prompt.stage))
        reserved = estimate.dollars or 0.0
        self.meter.reserve(reserved)
        spent, sent = 0.0, threading.Event()

        def tell(text: str) -> None:
            if text != WAITING:
                sent.set()
            if progress:
                progress(text)

        try:
            reply = self.inner.answer(prompt, cancel, tell)
            if reply.cost is None and price is not None:
                reply = replace(reply, cost=_cost(reply, price, estimate))
            spent = reply.cost or 0.0
            self.meter.note(prompt.stage, reply, model, reply.cost is not None)
        except ReplyError:
            # It was answered, so it is paid for; how long the answer was is not known.
            spent = reserved
            raise
        except ModelError as error:
            if getattr(error, "kind", "") == "timeout" and sent.is_set():
                spent = _sent_only(price, estimate)
            raise
        except Cancelled:
            # A service that has begun to read bills that, whoever hangs up.
            spent = _sent_only(price, estimate) if sent.is_set() else 0.0
            raise
        finally:
            self.meter.settle(reserved, spent)
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
