# SPDX-License-Identifier: GPL-3.0-or-later
"""Lets one prompt go ahead of others with the same beginning, so that these find it in the service's cache.

A service keeps a beginning from the moment on when it begins to answer. Prompts that are sent at the same time would all
be charged for writing it, and none would read it.
"""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager

from ..errors import Cancelled

LONGEST_WAIT = 30.0
"""Seconds that a prompt waits for the one ahead; then it is sent all the same."""
KEPT_SECONDS = 240.0
"""How long a beginning stays in the cache at least, if it is not used; vendors say five minutes."""
_TICK = 0.05


class Warming:
    """Which beginnings a service keeps. Thread-safe."""

    def __init__(self, clock: Callable[[], float] = time.monotonic) -> None:
        self._clock = clock
        self._lock = threading.Lock()
        self._begun: dict[int, threading.Event] = {}
        self._used: dict[int, float] = {}

    @contextmanager
    def turn(self, beginning: str, cancel: threading.Event) -> Iterator[Callable[[], None]]:
        """Wait until the beginning is kept, or go ahead with it. Gives what is to be called when an answer begins.

        Raises:
            Cancelled: `cancel` was set.
        """
        if not beginning:
            yield lambda: None
            return
        name = hash(beginning)
        event, ahead = self._enter(name)
        if not ahead:
            self._wait(event, cancel)
        try:
            yield event.set
        finally:
            # Whatever became of it, nobody waits for it any longer.
            event.set()

    def _enter(self, name: int) -> tuple[threading.Event, bool]:
        with self._lock:
            now = self._clock()
            known = self._begun.get(name)
            fresh = known is not None and (not known.is_set() or now - self._used[name] < KEPT_SECONDS)
            self._used[name] = now
            if known is not None and fresh:
                return known, False
            self._begun[name] = threading.Event()
            return self._begun[name], True

    def _wait(self, event: threading.Event, cancel: threading.Event) -> None:
        end = time.monotonic() + LONGEST_WAIT
        while not event.wait(_TICK) and time.monotonic() < end:
            if cancel.is_set():
                raise Cancelled
