# SPDX-License-Identifier: GPL-3.0-or-later
"""What a room costs: an estimate before anything is sent, a running total, and a cap that holds before the request
that would pass it. Pure data and locks; thread-safe.

Costs are worked out from token counts and a dated price list, unless a service says itself what an answer cost. What is
not known is told as not known, never as nothing.
"""

from __future__ import annotations

import io
import threading
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

from PIL import Image

from .errors import Cancelled, ModelError, ReplyError
from .models.base import ModelClient, Prompt, Reply, name_of
from .models.prices import Price, PriceList, bundled_prices
from .models.registry import ClientSettings
from .models.routing import group_of
from .models.schema import shape_text

BYTES_A_TOKEN = 3.4
"""Of prompts in English and JSON; rather few, so that an estimate is rather high."""
_PIXELS_A_TOKEN = 700.0
_PICTURE_LEAST, _PICTURE_MOST = 260, 4800
_ANSWER_TOKENS = {"s01_analysis": 9_000, "s02_graph": 4_000, "s03_layout": 3_000, "s04_auxiliary": 3_000,
                  "s05_descriptions": 2_000, "s06_geometry": 12_000}  # fmt: skip
"""Expected length of an answer, thinking included."""
_ANSWER_ELSE = 6_000


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
    return Estimate(sent, answered, None if price is None else price.of(sent, answered))


@dataclass(frozen=True)
class StageWork:
    """What a stage asks, for the estimate before a run: calls, and tokens of one call."""

    fewest: int
    most: int
    prompt_tokens: int
    completion_tokens: int


def stage_work(stage: str, rounds: int) -> StageWork:
    """What a stage asks.

    Args:
        rounds: most rounds of the layout loop.
    """
    known = {
        "s01_analysis": StageWork(2, 4, 9_000, 5_000),
        "s02_graph": StageWork(1, 2, 4_000, 2_500),
        "s03_layout": StageWork(min(1, rounds), max(0, rounds), 7_000, 2_000),
        "s04_auxiliary": StageWork(0, 2, 4_000, 2_000),
        "s05_descriptions": StageWork(2, 6, 4_500, 1_200),
        "s06_geometry": StageWork(1, 11, 12_000, 7_000),
    }
    return known.get(stage, StageWork(1, 6, 8_000, 5_000))


@dataclass(frozen=True)
class RunEstimate:
    """What a run may cost: fewest and most calls, tokens and US dollars; `unpriced` names models without a price."""

    calls: tuple[int, int]
    tokens: tuple[int, int]
    dollars: tuple[float, float] | None
    unpriced: tuple[str, ...] = ()

    def sentence(self) -> str:
        """One line for the artist."""
        few, many = self.calls
        calls = f"{few} to {many} questions" if few != many else f"{many} question{'' if many == 1 else 's'}"
        tokens = f"about {_round(self.tokens[0])} to {_round(self.tokens[1])} tokens"
        if self.dollars is None:
            return f"{calls}, {tokens}; the price of {', '.join(self.unpriced)} is not known"
        if self.dollars[1] == 0.0:
            return f"{calls}, {tokens}, free"
        return f"{calls}, {tokens}, {money(self.dollars[0])} to {money(self.dollars[1])}"


def estimate_run(
    stages: Sequence[str], rounds: int, price_of: Callable[[str], tuple[str, Price | None]]
) -> RunEstimate:
    """What a run of these stages may cost.

    Args:
        stages: ids of the stages that will be run; rounds: most rounds of the layout loop.
        price_of: model and price for a stage.
    """
    calls, tokens, dollars = [0, 0], [0, 0], [0.0, 0.0]
    unpriced: list[str] = []
    for stage in stages:
        work = stage_work(stage, rounds)
        model, price = price_of(stage)
        for end, number in enumerate((work.fewest, work.most)):
            calls[end] += number
            # The most: every answer twice as long as usual, with thinking.
            answered = work.completion_tokens * (1 + 2 * end)
            tokens[end] += number * (work.prompt_tokens + answered)
            dollars[end] += price.of(number * work.prompt_tokens, number * answered) if price else 0.0
        if price is None and model not in unpriced and work.most:
            unpriced.append(model)
    known = None if unpriced else (dollars[0], dollars[1])
    return RunEstimate((calls[0], calls[1]), (tokens[0], tokens[1]), known, tuple(unpriced))


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
            self._longest[stage] = max(self._longest.get(stage, 0), reply.completion_tokens)
            if not priced:
                self._unpriced.add(model)


class CappedClient:
    """A client whose every question is priced before it is sent and counted after it was answered.

    Args:
        inner: who answers; price_of: the model that answers a stage, and its price (None when not known).
    """

    def __init__(self, inner: ModelClient, meter: Meter, price_of: Callable[[str], tuple[str, Price | None]]) -> None:
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
        model, price = self._price_of(prompt.stage)
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
        return price.of(reply.prompt_tokens, reply.completion_tokens)
    return price.of(estimate.prompt_tokens, int(len(reply.text.encode()) / BYTES_A_TOKEN) + 1)


def _sent_only(price: Price | None, estimate: Estimate) -> float:
    return price.of(estimate.prompt_tokens, 0) if price else 0.0


def price_lookup(prices: PriceList, settings: ClientSettings) -> Callable[[str], tuple[str, Price | None]]:
    """For a stage: the model that answers it and its price."""
    found: dict[str, tuple[str, Price | None]] = {}

    def look(stage: str) -> tuple[str, Price | None]:
        model = settings.models.get(group_of(stage), "").strip() or settings.model.strip()
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


def begin_total(client: ModelClient, spent: float) -> None:
    """Tell a client's meter what the room has cost before, in US dollars."""
    found: Any = client
    while found is not None:
        if isinstance(found, CappedClient):
            found.meter.raise_to(spent)
        found = getattr(found, "inner", None)


def money(dollars: float) -> str:
    """An amount for the artist: "$0.042", "$1.30"."""
    if dollars and dollars < 0.1:
        return f"${dollars:.3f}" if dollars >= 0.0005 else "less than $0.001"
    return f"${dollars:.2f}"


def _round(tokens: int) -> str:
    return f"{round(tokens / 1000)}k" if tokens >= 1000 else str(tokens)
