# SPDX-License-Identifier: GPL-3.0-or-later
"""How many requests a service is sent side by side: fewer when it says that it is asked too often, slowly more again.

All clients of one service share one pace, since its limits are those of the account, not of a model.
"""

from __future__ import annotations

import copy
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager

from ..errors import Cancelled, ModelError
from .faults import Fault

MOST = 8
"""Side by side at most, whatever is set."""
TOO_OFTEN = frozenset({429, 503, 529})
"""Statuses of a service that is asked too often, or by too many."""
REFUSES_ALL = frozenset({"money", "key", "model", "tls", "proxy", "redirect"})
"""Kinds of failure that every other request would meet."""
WAITING = "waiting for its turn"
"""What is told while nothing was sent yet."""
_TICK = 0.05
_LONGEST_REST = 120.0


class Pace:
    """One service's pace. Thread-safe.

    Args:
        most: requests side by side when all is well.

    Attributes:
        allowed: requests side by side now.
    """

    def __init__(self, most: int, clock: Callable[[], float] = time.monotonic) -> None:
        self._most = max(1, min(MOST, most))
        self._clock = clock
        self._limit = float(self._most)
        self._running = 0
        self._rest_until = 0.0
        self._slowed = float("-inf")
        self._refusals = 0
        self._refusal: ModelError | None = None
        self._lock = threading.Lock()

    @property
    def allowed(self) -> int:
        """Requests side by side now."""
        with self._lock:
            return int(self._limit)

    @contextmanager
    def turn(self, cancel: threading.Event, progress: Callable[[str], None] | None = None) -> Iterator[None]:
        """Wait for a turn, and have it.

        Raises:
            Cancelled: `cancel` was set while waiting. ModelError: the service has refused others for a reason that
                holds for all (`refused`) while this one waited; nothing was sent.
        """
        told, refusals = False, self._refusals
        while not self._take(refusals):
            if progress and not told:
                progress(WAITING)
                told = True
            if cancel.wait(_TICK):
                raise Cancelled
        try:
            yield
        finally:
            with self._lock:
                self._running -= 1

    def _take(self, refusals: int) -> bool:
        with self._lock:
            if self._refusals != refusals and self._refusal is not None:
                raise copy.copy(self._refusal)
            if self._running >= int(self._limit) or self._clock() < self._rest_until:
                return False
            self._running += 1
            return True

    def too_often(self, began: float, after: float = 0.0) -> None:
        """The service said that it is asked too often: half as many side by side, and none before it may be asked again.

        Requests that were under way together are refused together; that counts as one refusal.

        Args:
            began: when the refused request began, by the same clock; after: seconds that the service asks to wait.
        """
        with self._lock:
            now = self._clock()
            self._rest_until = max(self._rest_until, now + min(max(0.0, after), _LONGEST_REST))
            if began > self._slowed:
                self._limit = max(1.0, self._limit / 2)
                self._slowed = now

    def refused(self, error: ModelError) -> None:
        """The service does not take requests, such as for a wrong key: those that wait for their turn are not sent."""
        with self._lock:
            self._refusals, self._refusal = self._refusals + 1, error

    @contextmanager
    def noting(self, patience: float) -> Iterator[None]:
        """Learn from one try that is made within: its faults are raised all the same.

        Args:
            patience: longest wait that a service may ask for; one that asks for more is not waited for.
        """
        began = self._clock()
        try:
            yield
        except Fault as fault:
            if fault.retry and fault.error.status in TOO_OFTEN:
                self.too_often(began, fault.after if fault.after <= patience else 0.0)
            elif fault.error.kind in REFUSES_ALL:
                self.refused(fault.error)
            raise
        self.went_well()

    def went_well(self) -> None:
        """An answer came: a little more is allowed, one more side by side after as many answers as are allowed now."""
        with self._lock:
            self._limit = min(float(self._most), self._limit + 1.0 / max(1, int(self._limit)))
