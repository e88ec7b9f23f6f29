# SPDX-License-Identifier: GPL-3.0-or-later
"""One HTTP exchange in a thread of its own, so that the caller can stop within a second whatever the network does.

Redirects are followed on the same host only, certificates are always verified, sizes and times are limited, and no
error carries a header or a proxy's address.
"""

from __future__ import annotations

import io
import queue
import threading
import time
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any
from urllib.parse import urljoin, urlsplit

import requests

from ..errors import Cancelled
from .addresses import is_loopback
from .faults import Fault, FaultKind, ServiceError
from .leash import Leash, LeashedAdapter
from .limits import Limits, Route
from .network_faults import network_fault

__all__ = ["Answer", "Call", "Limits", "Route", "exchange"]

THREAD_NAME = "code-as-room-exchange"
_TICK = 0.05
_JOIN = 0.5
_MOST_REDIRECTS = 3
_PIECE = 16_384
_HEADERS = {"Content-Type": "application/json", "Accept-Encoding": "identity", "User-Agent": "Code-as-Room"}


@dataclass(frozen=True)
class Call:
    """A request: where to, what (None for a GET), and the headers.

    `key` is sent in the header `key_header`, as a bearer token where that is "Authorization"; not at all when it is
    empty. `enough` is fed every piece of a successful reply and says when the rest need not be waited for; `meanwhile` is
    called again and again on the calling thread while the reply is waited for.
    """

    url: str
    body: bytes | None = None
    key: str = field(default="", repr=False)
    key_header: str = "Authorization"
    headers: Mapping[str, str] = field(default_factory=dict)
    route: Route = Route()
    enough: Callable[[bytes], bool] = lambda piece: False
    meanwhile: Callable[[], None] = lambda: None


@dataclass(frozen=True)
class Answer:
    """What came back: status, headers with names in any case, and the body (decoded, cut only by `enough`)."""

    status: int
    headers: Mapping[str, str]
    body: bytes


def exchange(
    call: Call,
    limits: Limits,
    deadline: float,
    cancel: threading.Event,
    progress: Callable[[str], None] | None = None,
) -> Answer:
    """Perform the request; `progress` is called on the calling thread.

    Args:
        deadline: `time.monotonic()` at which to give up.

    Raises:
        Cancelled: `cancel` was set.
        Fault: no answer came back, or one that is too large or leads elsewhere.
    """
    leash = Leash()
    outcome: queue.SimpleQueue[str | Answer | Fault] = queue.SimpleQueue()
    worker = threading.Thread(target=_work, args=(call, limits, leash, outcome), name=THREAD_NAME, daemon=True)
    host = _host(call.url)
    # Before the thread begins: on a quick machine the request would be out before the loop below looks for the first time.
    if cancel.is_set():
        raise Cancelled
    worker.start()
    try:
        while True:
            if cancel.is_set():
                raise Cancelled
            if time.monotonic() >= deadline:
                raise _fault(f"The service at {host} took longer than the time limit.", _LONGER, "timeout")
            call.meanwhile()
            try:
                item = outcome.get(timeout=_TICK)
            except queue.Empty:
                continue
            if isinstance(item, Answer):
                return item
            if isinstance(item, Fault):
                raise item
            if progress:
                progress(item)
    finally:
        leash.cut()
        worker.join(_JOIN)


_LONGER = "Raise the time limit in the settings, or choose a faster model."


def _host(url: str) -> str:
    """An address's host for a sentence; a redirect's may be anything."""
    try:
        host = urlsplit(url).hostname or ""
    except ValueError:
        host = ""
    return host if host.isprintable() and 0 < len(host) < 254 else "an address that cannot be right"


def _fault(message: str, fix: str, kind: FaultKind, retry: bool = False) -> Fault:
    return Fault(ServiceError(message, fix, kind), retry=retry)


class _Session(requests.Session):
    """Leaves redirects alone. `requests` would look at them even when told not to follow: read their body whole,
    whatever its size, and stumble over addresses that are none.
    """

    def get_redirect_target(self, resp: requests.Response) -> str | None:
        """Never anywhere."""
        return None


def _work(call: Call, limits: Limits, leash: Leash, outcome: queue.SimpleQueue[str | Answer | Fault]) -> None:
    """The worker thread: everything that may block."""
    result: Answer | Fault
    try:
        with _Session() as session:
            adapter = LeashedAdapter(leash)
            session.mount("http://", adapter)
            session.mount("https://", adapter)
            result = _follow(session, call, limits, outcome.put)
    except Fault as fault:
        result = fault
    except Exception as error:
        result = network_fault(error, leash, limits, _host(call.url), bool(call.route.proxy))
    finally:
        leash.release()
    outcome.put(result)


def _follow(session: requests.Session, call: Call, limits: Limits, tell: Callable[[str], None]) -> Answer:
    """Send the request, and again where the same host redirects it to."""
    url = call.url
    for _ in range(_MOST_REDIRECTS + 1):
        answer = _send(session, url, call, limits, tell)
        if answer.status not in (301, 302, 303, 307, 308):
            return answer
        target = _target(url, answer.headers.get("Location", ""))
        if not _same_place(url, target):
            raise _fault(
                f"The service at {_host(url)} sends us on to {_host(target)}; the key was not sent there.",
                "Check the base URL.",
                "redirect",
            )
        url = target
    raise _fault(f"The service at {_host(url)} redirects in a circle.", "Check the base URL.", "redirect")


def _target(url: str, location: str) -> str:
    """Where a redirect leads, "" where that is no address."""
    try:
        return urljoin(url, location)
    except ValueError:
        return ""


def _same_place(old: str, new: str) -> bool:
    """Same host and port, or the same host's step from http to https on the usual ports."""
    try:
        a, b = urlsplit(old), urlsplit(new)
        if a.hostname != b.hostname or b.scheme not in ("http", "https"):
            return False
        if a.scheme == b.scheme:
            return a.port == b.port
        return (a.scheme, b.scheme) == ("http", "https") and a.port in (None, 80) and b.port in (None, 443)
    except ValueError:
        return False


def _send(session: requests.Session, url: str, call: Call, limits: Limits, tell: Callable[[str], None]) -> Answer:
    tell("waiting for the model")
    host = urlsplit(url).hostname or ""

    def authorise(request: requests.PreparedRequest) -> requests.PreparedRequest:
        # An explicit callable also keeps requests from taking credentials out of a .netrc file.
        if call.key:
            bearer = call.key_header == "Authorization"
            request.headers[call.key_header] = f"Bearer {call.key}" if bearer else call.key
        return request

    with session.request(
        "GET" if call.body is None else "POST",
        url,
        # Sent in blocks: a socket's time-out covers one whole send, and large pictures take longer on slow lines.
        data=None if call.body is None else io.BytesIO(call.body),
        headers={**_HEADERS, **call.headers},
        auth=authorise,
        timeout=(limits.connect, limits.read),
        stream=True,
        allow_redirects=False,
        verify=call.route.ca_bundle or True,
        proxies=_proxies(host, call.route),
    ) as response:
        good = response.status_code == 200
        body = bytearray()
        told = 0
        for piece in _pieces(response.raw):
            body += piece
            if len(body) > limits.size:
                size = f"{limits.size / 1e6:g} MB"
                raise _fault(f"The reply of {_host(url)} is larger than {size}.", "Check the base URL.", "size")
            if good and call.enough(piece):
                break
            if len(body) - told >= 1000:
                told = len(body)
                tell(f"received {told / 1000:.0f} kB")
        return Answer(response.status_code, response.headers, bytes(body))


def _proxies(host: str, route: Route) -> dict[str, str]:
    """What `requests` shall know of proxies; it asks the environment where this is empty."""
    if is_loopback(host):
        # A local server is never behind a proxy, whatever the settings and the environment say.
        return {"no_proxy": host}
    return {"http": route.proxy, "https": route.proxy} if route.proxy else {}


def _pieces(raw: Any) -> Iterator[bytes]:
    """The body's pieces as they arrive, decompressed."""
    if getattr(raw, "chunked", False) and raw.supports_chunked_reads():
        yield from raw.stream(_PIECE, decode_content=True)
        return
    # `stream` would wait until a whole block is there; `read1` gives what there is.
    read = getattr(raw, "read1", None)
    while True:
        piece: bytes = read(_PIECE, decode_content=True) if read else raw.read(256, decode_content=True)
        if not piece:
            return
        yield piece
