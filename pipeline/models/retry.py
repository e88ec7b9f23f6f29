# SPDX-License-Identifier: GPL-3.0-or-later
"""Tries again what may pass by itself, with jittered, growing pauses that the artist can end at any moment."""

from __future__ import annotations

import random
import threading
import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import TypeVar

from ..errors import Cancelled
from .faults import Fault, ServiceError

_Result = TypeVar("_Result")


@dataclass(frozen=True)
class RetryPolicy:
    """How often and how long.

    Attributes:
        tries: most tries in all; first_pause: seconds before the second, doubled each time;
        longest_pause: limit of our own pauses; patience: longest wait that a service may ask for.
    """

    tries: int = 4
    first_pause: float = 1.0
    longest_pause: float = 30.0
    patience: float = 120.0


def with_retries(
    attempt: Callable[[], _Result],
    policy: RetryPolicy,
    deadline: float,
    cancel: threading.Event,
    progress: Callable[[str], None] | None = None,
) -> _Result:
    """Call `attempt` until it gives a result, its fault is not worth another try, or time or tries are used up.

    Raises:
        ServiceError: the last fault's error.
        Cancelled: `cancel` was set.
    """
    tried = 0
    while True:
        tried += 1
        try:
            return attempt()
        except Fault as fault:
            error, retry, asked = fault.error, fault.retry, fault.after
        if not retry or tried >= policy.tries:
            raise error
        grown = min(policy.longest_pause, policy.first_pause * 2.0 ** (tried - 1))
        pause = max(asked, grown * random.uniform(0.5, 1.5))
        if asked > policy.patience or time.monotonic() + pause >= deadline:
            wait = f"It asks to wait {asked:.0f} s; try again then." if asked else "Try again in a while."
            raise ServiceError(error.message, wait, error.kind, error.status)
        if progress:
            progress(f"trying again in {pause:.0f} s: {error.message}")
        if cancel.wait(pause):
            raise Cancelled
