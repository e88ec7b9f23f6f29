# SPDX-License-Identifier: GPL-3.0-or-later
"""HTTP connections that another thread can cut at any moment: while connecting, waiting or in the middle of a reply.

`requests` gives no handle on a connection before the reply's headers are there. So the transport adapter here makes
connections that hang on the `Leash` of the thread that opens them; cutting the leash shuts the sockets down, and the
blocked call returns at once with an error. Only looking up a name cannot be interrupted.
"""

from __future__ import annotations

import contextlib
import selectors
import socket
import threading
import time
from typing import Any, Literal

from requests.adapters import HTTPAdapter
from urllib3.connection import HTTPConnection, HTTPSConnection
from urllib3.connectionpool import HTTPConnectionPool, HTTPSConnectionPool
from urllib3.exceptions import ConnectTimeoutError, NewConnectionError

_TICK = 0.05


class Leash:
    """Holds the sockets of one exchange.

    Attributes:
        problem: why no connection came about, in a few words, "" when one did or none was tried; kind: the same for
            a connection test.
    """

    def __init__(self) -> None:
        self.problem = ""
        self.kind: Literal["name", "refused", "timeout", "network"] = "network"
        self._cut = threading.Event()
        self._lock = threading.Lock()
        self._held: list[socket.socket] = []

    def cut(self) -> None:
        """Stop everything that hangs on this leash; safe from any thread, any number of times."""
        self._cut.set()
        with self._lock:
            for held in self._held:
                with contextlib.suppress(OSError):
                    held.shutdown(socket.SHUT_RDWR)

    def release(self) -> None:
        """Let go of the sockets; they are closed by whoever opened them."""
        with self._lock:
            for held in self._held:
                held.close()
            self._held.clear()

    def open(self, connection: HTTPConnection) -> socket.socket:
        """A connected socket for an HTTP connection, trying each of the host's addresses in turn.

        Raises:
            urllib3's NewConnectionError or ConnectTimeoutError; `problem` then says why in words.
        """
        host = connection.host.strip("[]")
        seconds = connection.timeout if isinstance(connection.timeout, (int, float)) else 10.0
        deadline = time.monotonic() + seconds
        try:
            addresses = socket.getaddrinfo(host, connection.port, 0, socket.SOCK_STREAM)
        except (OSError, UnicodeError):
            self.problem, self.kind = "its name cannot be found", "name"
            raise NewConnectionError(connection, self.problem) from None
        self.problem, self.kind = "it cannot be reached", "network"
        for family, kind, protocol, _, address in addresses:
            try:
                opened = socket.socket(family, kind, protocol)
            except OSError:
                continue
            try:
                self._connect(opened, address, connection, deadline)
            except OSError as error:
                opened.close()
                if isinstance(error, ConnectionRefusedError):
                    self.problem, self.kind = "nothing answers there", "refused"
                if self._cut.is_set() or isinstance(error, TimeoutError):
                    break
                continue
            opened.settimeout(seconds)
            self.problem = ""
            return opened
        if time.monotonic() >= deadline:
            self.problem, self.kind = f"it did not answer within {seconds:g} s", "timeout"
            raise ConnectTimeoutError(connection, self.problem)
        raise NewConnectionError(connection, self.problem)

    def _connect(self, opened: socket.socket, address: Any, connection: HTTPConnection, deadline: float) -> None:
        """Connect without blocking for longer than a tick; the socket is held once it is connected."""
        for option in connection.socket_options or ():
            opened.setsockopt(*option)
        if connection.source_address:
            opened.bind(connection.source_address)
        opened.setblocking(False)
        with contextlib.suppress(BlockingIOError, InterruptedError):
            opened.connect(address)
        with selectors.DefaultSelector() as selector:
            selector.register(opened, selectors.EVENT_WRITE)
            while not selector.select(_TICK):
                if self._cut.is_set():
                    raise ConnectionAbortedError
                if time.monotonic() >= deadline:
                    raise TimeoutError
        code = opened.getsockopt(socket.SOL_SOCKET, socket.SO_ERROR)
        if code:
            raise ConnectionRefusedError(code, "") if code in _REFUSED else OSError(code, "")
        self._hold(opened)

    def _hold(self, opened: socket.socket) -> None:
        """Keep a second handle on the connection: TLS takes the first one over."""
        with self._lock:
            self._held.append(opened.dup())
        if self._cut.is_set():
            self.cut()


def _refused_codes() -> frozenset[int]:
    import errno

    return frozenset({errno.ECONNREFUSED, getattr(errno, "WSAECONNREFUSED", errno.ECONNREFUSED)})


_REFUSED = _refused_codes()
_of_thread = threading.local()


class _Connection(HTTPConnection):
    def _new_conn(self) -> socket.socket:
        leash: Leash = _of_thread.leash
        return leash.open(self)


class _SecureConnection(HTTPSConnection):
    def _new_conn(self) -> socket.socket:
        leash: Leash = _of_thread.leash
        return leash.open(self)


class _Pool(HTTPConnectionPool):
    ConnectionCls = _Connection


class _SecurePool(HTTPSConnectionPool):
    ConnectionCls = _SecureConnection


_POOLS: dict[str, Any] = {"http": _Pool, "https": _SecurePool}


class LeashedAdapter(HTTPAdapter):
    """A `requests` adapter whose connections hang on a leash. Use it only in the thread that made it.

    SOCKS proxies keep their own connections; there a cut takes effect when the socket times out.
    """

    def __init__(self, leash: Leash) -> None:
        _of_thread.leash = leash
        super().__init__(max_retries=0)

    def init_poolmanager(self, *args: Any, **kwargs: Any) -> None:
        """As in `HTTPAdapter`, with leashed pools."""
        super().init_poolmanager(*args, **kwargs)
        self.poolmanager.pool_classes_by_scheme = _POOLS

    def proxy_manager_for(self, proxy: str, **kwargs: Any) -> Any:
        """As in `HTTPAdapter`, with leashed pools for HTTP proxies."""
        manager: Any = super().proxy_manager_for(proxy, **kwargs)
        if not proxy.lower().startswith("socks"):
            manager.pool_classes_by_scheme = _POOLS
        return manager
