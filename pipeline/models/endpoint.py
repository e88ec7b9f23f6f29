# SPDX-License-Identifier: GPL-3.0-or-later
"""What every client over HTTP knows of its service: address, model, key and route, checked before anything is sent; and how
it asks: in its turn, within its time, tried again by the same rules.
"""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from typing import Any, TypeVar
from urllib.parse import urlsplit

from ..errors import ModelError
from .addresses import is_local_url, normal_base_url
from .exchange import Answer, Call
from .faults import Fault, status_fault
from .limits import Limits, Route
from .pace import MOST, Pace
from .retry import RetryPolicy, with_retries

_Result = TypeVar("_Result")


class Endpoint:
    """One service and one of its models.

    Args:
        base_url: such as "http://localhost:1234/v1"; api_key: "" for services that need none.
        route: proxy and certificates; pace: how many requests may be under way, shared with the service's other clients.

    Raises:
        ModelError: the address, the model's name or the key cannot be right.
    """

    vendor = ""
    endpoints: tuple[str, ...] = ()
    """Ends of addresses that people paste along with the base URL."""
    default_path = "/v1"
    key_header = "Authorization"
    what = "model"
    """What the model is called in sentences for the artist."""
    usual_limits = Limits()
    usual_retries = RetryPolicy()
    usual_pace = MOST

    def __init__(
        self,
        base_url: str,
        model: str,
        api_key: str = "",
        limits: Limits | None = None,
        retries: RetryPolicy | None = None,
        route: Route | None = None,
        pace: Pace | None = None,
    ) -> None:
        self.base_url = normal_base_url(base_url, self.default_path, self.endpoints)
        self.model = model.strip()
        if not self.model:
            raise ModelError(f"No {self.what} is named.", "Give the model's name as the service spells it.")
        self._key = checked_key(api_key)
        self._route = route or Route()
        self.pace = pace or Pace(self.usual_pace)
        self._limits, self._retries = limits or self.usual_limits, retries or self.usual_retries
        self.host = urlsplit(self.base_url).hostname or ""
        self.name = f"{self.vendor}:{self.model}"
        where = "on this computer" if is_local_url(self.base_url) else f"at {self.host}"
        self.describes = f"The {self.what} {self.model} {where}"

    def call(self, url: str, body: bytes | None = None, **more: Any) -> Call:
        """A request with the key: a GET, or a POST of this body. `more` are further fields of the `Call`."""
        headers = {"Accept": "application/json", **more.pop("headers", {})}
        return Call(
            url=url, body=body, key=self._key, key_header=self.key_header, headers=headers, route=self._route, **more
        )

    def fault(self, answer: Answer) -> Fault:
        """The fault for an answer with a status other than 200."""
        return status_fault(answer.status, answer.body, answer.headers, self.host, self._key)

    def in_turn(
        self,
        attempt: Callable[[float], _Result],
        cancel: threading.Event,
        progress: Callable[[str], None] | None,
    ) -> tuple[_Result, float]:
        """What `attempt` gives when its turn comes, after as many tries as are worth it, and how many seconds that took.

        All clients of the service learn from every try. `attempt` is called with the time (of `time.monotonic`) until
        which it may take.

        Raises:
            ServiceError: what the last try ended with.
            Cancelled: `cancel` was set.
        """
        with self.pace.turn(cancel, progress):
            # Waiting for a turn is not the service's slowness.
            started = time.monotonic()
            deadline = started + self._limits.total

            def paced() -> _Result:
                with self.pace.noting(self._retries.patience):
                    return attempt(deadline)

            result = with_retries(paced, self._retries, deadline, cancel, progress)
            return result, time.monotonic() - started

    def __repr__(self) -> str:
        return f"{type(self).__name__}({self.base_url!r}, {self.model!r})"


def checked_key(key: str) -> str:
    """The key without surrounding space.

    Raises:
        ModelError: it holds what no key holds; HTTP libraries would quote it in their errors.
    """
    key = key.strip()
    if any(not 33 <= ord(char) <= 126 for char in key):
        raise ModelError("The API key holds spaces or characters that no key has.", "Copy the key again.")
    return key
