# SPDX-License-Identifier: GPL-3.0-or-later
"""The running total of one room, and the cap that holds before the request that would pass it. Thread-safe."""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager

from .errors import Cancelled, ModelError, RoomError
from .models.base import Reply
from .models.pace import WAITING
from .spending_estimate import money

_HUNG_UP = ("timeout", "offline")


class SpendingError(ModelError):
    """The request was not sent: it would pass the spending cap, or its price is not known."""


class Spending:
    """One request's money on its way.

    Attributes:
        reserved: US dollars that are set aside for it; spent: what it cost, to be said before it ends.
    """

    def __init__(self, reserved: float, progress: Callable[[str], None] | None) -> None:
        self.reserved, self._progress = reserved, progress
        self.spent, self._sent = 0.0, threading.Event()

    def is_billed(self, error: RoomError) -> bool:
        """Whether a request that ended so may be billed although nothing came back.

        A service that has begun to work bills that, whoever hangs up: the artist, the time limit or the online access.
        """
        return self._sent.is_set() and (isinstance(error, Cancelled) or getattr(error, "kind", "") in _HUNG_UP)

    def tell(self, text: str) -> None:
        """The progress that it is asked with; tells that it has left."""
        if text != WAITING:
            self._sent.set()
        if self._progress:
            self._progress(text)


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

    @contextmanager
    def request(
        self, dollars: float | None, what: str, fix: str, progress: Callable[[str], None] | None
    ) -> Iterator[Spending]:
        """Set the money of a request aside while it is under way, then count what it says that it spent.

        Args:
            dollars: None where the price is not known; what: whose price that is, "the price of X"; fix: what to do then.

        Raises:
            SpendingError: it would pass the cap, or there is a cap and the price is not known. Nothing is set aside.
        """
        if dollars is None and self.cap > 0:
            raise SpendingError(f"{what} is not known, so the spending cap cannot be kept.", fix)
        spending = Spending(dollars or 0.0, progress)
        self.reserve(spending.reserved)
        try:
            yield spending
        finally:
            self.settle(spending.reserved, spending.spent)

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
