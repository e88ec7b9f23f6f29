# SPDX-License-Identifier: GPL-3.0-or-later
"""Faults on the way to a service, for every client: no connection, certificates, TLS, proxies; and a stop in every state."""

from __future__ import annotations

import socket
import threading
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from typing import Any

import pytest
from code_as_room.pipeline.errors import Cancelled, ModelError
from code_as_room.pipeline.models.faults import ServiceError
from code_as_room.pipeline.models.limits import Limits, checked_route
from code_as_room.pipeline.models.retry import RetryPolicy
from fault_cases import USUAL, good, http, whole_body
from fault_envelopes import KEY, VENDORS, Vendor, a_prompt
from fault_server import (
    AUTHORITY,
    Peer,
    Received,
    deaf_port,
    free_port,
    read_head,
    serve,
    start_secure,
    start_tunnel,
)
from test_fault_exchanges import clear

ONCE = RetryPolicy(tries=1)
SHORT = Limits(connect=0.3, read=0.3, total=20.0, size=1_000_000)
PASSWORD = "secretword"
Keep = Callable[[Any], Any]
EVERY_CLIENT = pytest.mark.parametrize("vendor", VENDORS, ids=lambda vendor: vendor.name)


def failure(
    vendor: type[Vendor], origin: str, proxy: str = "", ca_bundle: str = "", limits: Limits = USUAL
) -> ServiceError:
    """The error of one exchange, which must be a clear one."""
    client = vendor.make(origin, limits=limits, retries=ONCE, route=checked_route(proxy, ca_bundle))
    with pytest.raises(ServiceError) as caught:
        vendor.ask(client, a_prompt())
    problems = list(clear(caught.value))
    assert not problems and PASSWORD not in repr(caught.value) + str(caught.value)
    return caught.value


def answering(vendor: type[Vendor]) -> Callable[[Any], None]:
    raw = http(whole_body(vendor))
    return lambda connection: connection.sendall(raw)


# No connection --------------------------------------------------------------------------------------------------


@EVERY_CLIENT
def test_a_service_that_cannot_be_reached_is_named(vendor: type[Vendor]) -> None:
    assert failure(vendor, f"http://127.0.0.1:{free_port()}").kind == "refused"
    assert failure(vendor, f"https://127.0.0.1:{free_port()}").kind == "refused"
    assert failure(vendor, "http://no-such-host.invalid").kind == "name"
    assert failure(vendor, f"http://{'a' * 64}.example").kind == "name"
    with deaf_port() as port:
        if port is not None:
            assert failure(vendor, f"http://127.0.0.1:{port}", limits=SHORT).kind == "timeout"


# Certificates ---------------------------------------------------------------------------------------------------


@EVERY_CLIENT
@pytest.mark.parametrize(
    ("certificate", "trusted", "words"),
    [
        ("server", "", "authority that this computer does not know"),
        ("othername", AUTHORITY, "belongs to another name"),
        ("expired", AUTHORITY, "not valid today"),
    ],
)
def test_a_certificate_that_cannot_be_trusted_gets_no_request(
    vendor: type[Vendor], certificate: str, trusted: str, words: str, keep: Keep
) -> None:
    port, heads = keep(start_secure(answering(vendor), certificate))
    error = failure(vendor, f"https://127.0.0.1:{port}", ca_bundle=trusted)
    assert error.kind == "tls" and words in error.message and heads == []


@EVERY_CLIENT
def test_a_trusted_one_is_asked(vendor: type[Vendor], keep: Keep) -> None:
    port, heads = keep(start_secure(answering(vendor)))
    client = vendor.make(f"https://127.0.0.1:{port}", limits=USUAL, route=checked_route("", AUTHORITY))
    assert vendor.ask(client, a_prompt()) == good(vendor) and len(heads) == 1


HANDSHAKES: dict[str, Callable[[socket.socket], None]] = {
    "closed": lambda connection: None,
    "plain http": lambda connection: connection.sendall(b"HTTP/1.1 400 Bad Request\r\n\r\n"),
    "rubbish": lambda connection: connection.sendall(bytes(range(256)) * 40),
    "an alert": lambda connection: connection.sendall(b"\x15\x03\x03\x00\x02\x02\x28"),
    "half a record": lambda connection: connection.sendall(b"\x16\x03\x03\x40\x00\x02"),
    "a huge record": lambda connection: connection.sendall(b"\x16\x03\x03\xff\xff" + bytes(70_000)),
}


@EVERY_CLIENT
@pytest.mark.parametrize("name", HANDSHAKES)
def test_a_handshake_that_fails_is_told(vendor: type[Vendor], name: str, keep: Keep) -> None:
    def handle(connection: socket.socket) -> None:
        connection.recv(10)
        HANDSHAKES[name](connection)

    (port,) = keep(serve(handle))
    assert failure(vendor, f"https://127.0.0.1:{port}").kind in ("tls", "network")


@EVERY_CLIENT
def test_a_handshake_that_never_ends_is_given_up(vendor: type[Vendor], keep: Keep) -> None:
    leave = threading.Event()
    (port,) = keep(serve(lambda connection: bool(leave.wait(20)) and None))
    try:
        assert failure(vendor, f"https://127.0.0.1:{port}", limits=SHORT).kind == "timeout"
    finally:
        leave.set()


# Proxies --------------------------------------------------------------------------------------------------------

REFUSALS = {
    "407": b"HTTP/1.1 407 Proxy Authentication Required\r\nProxy-Authenticate: Basic realm=x\r\n\r\n",
    "407 page": b"HTTP/1.1 407 X\r\nContent-Length: 30\r\n\r\n<html>secretword</html>       ",
    "403": b"HTTP/1.1 403 Forbidden\r\n\r\n",
    "502": b"HTTP/1.1 502 Bad Gateway\r\nConnection: close\r\n\r\n",
    "204": b"HTTP/1.1 204 No Content\r\n\r\n",
    "302": b"HTTP/1.1 302 Found\r\nLocation: http://127.0.0.1/login\r\n\r\n",
    "nothing": b"",
    "rubbish": b"\x00\x01\x02 secretword\r\n\r\n",
    "half a line": b"HTTP/1.1 20",
    "open and closed": b"HTTP/1.1 200 Connection established\r\n\r\n",
    "open and rubbish": b"HTTP/1.1 200 Connection established\r\n\r\nHTTP/1.1 200 OK\r\n\r\n{}",
    "headers": b"HTTP/1.1 200 OK\r\n" + b"X: y\r\n" * 500 + b"\r\n",
}


@EVERY_CLIENT
@pytest.mark.parametrize("name", REFUSALS)
def test_a_proxy_that_does_not_let_us_through_is_told(vendor: type[Vendor], name: str, keep: Keep) -> None:
    port, asked = keep(start_tunnel(9, answer=lambda connection: connection.sendall(REFUSALS[name])))
    error = failure(vendor, "https://model.invalid", f"http://user:{PASSWORD}@127.0.0.1:{port}")
    assert error.kind in ("proxy", "tls", "network") and KEY not in str(asked)
    if name[:3] in ("407", "403", "502"):
        assert error.kind == "proxy"


@EVERY_CLIENT
def test_a_proxy_that_asks_for_other_credentials_is_told(vendor: type[Vendor], keep: Keep) -> None:
    far, heads = keep(start_secure(answering(vendor)))
    port, asked = keep(start_tunnel(far, PASSWORD))
    error = failure(vendor, "https://model.invalid", f"http://user:wrong-{PASSWORD}@127.0.0.1:{port}", AUTHORITY)
    assert error.kind == "proxy" and "password" in error.message and heads == [] and KEY not in str(asked)
    error = failure(vendor, "https://model.invalid", f"http://user:{PASSWORD}@127.0.0.1:{port}")
    assert error.kind == "tls" and heads == []
    route = checked_route(f"http://user:{PASSWORD}@127.0.0.1:{port}", AUTHORITY)
    client = vendor.make("https://model.invalid", limits=USUAL, retries=ONCE, route=route)
    assert vendor.ask(client, a_prompt()) == good(vendor)
    assert len(heads) == 1 and "Proxy-Authorization" not in str(heads) and KEY not in str(asked)


@EVERY_CLIENT
def test_a_plain_service_behind_a_proxy_that_asks_for_a_password_is_told(vendor: type[Vendor], peer: Peer) -> None:
    peer.script = lambda received: received.reply(407, {}, {"Proxy-Authenticate": "Basic"})
    error = failure(vendor, "http://model.invalid", f"http://user:{PASSWORD}@127.0.0.1:{peer.port}")
    assert error.kind == "proxy"


# Stopping -------------------------------------------------------------------------------------------------------


def _wait_in_head(received: Received) -> None:
    received.send(b"HTTP/1.1 200 OK\r\nX: ")


def _wait_in_body(received: Received) -> None:
    received.send(b"HTTP/1.1 200 OK\r\nContent-Length: 1000\r\n\r\n{")


def _wait_in_chunk(received: Received) -> None:
    received.send(b"HTTP/1.1 200 OK\r\nTransfer-Encoding: chunked\r\n\r\n40\r\n{")


def _wait_in_event(received: Received) -> None:
    received.send(b'HTTP/1.1 200 OK\r\nContent-Type: text/event-stream\r\n\r\ndata: {"a')


def _wait_packed(received: Received) -> None:
    received.send(b"HTTP/1.1 200 OK\r\nContent-Encoding: gzip\r\nContent-Length: 1000\r\n\r\n\x1f\x8b\x08")


def _wait_again(received: Received) -> None:
    received.reply(503, {}, {"Retry-After": "60"})


def _wait_after_redirect(received: Received) -> None:
    if received.number == 0:
        received.reply(307, {}, {"Location": received.line.split()[1] + "?again"})


STATES: dict[str, Callable[[Received], None]] = {
    "waiting": lambda received: None,
    "head": _wait_in_head,
    "body": _wait_in_body,
    "chunk": _wait_in_chunk,
    "event": _wait_in_event,
    "packed": _wait_packed,
    "between tries": _wait_again,
    "redirected": _wait_after_redirect,
}


@EVERY_CLIENT
def test_it_stops_in_every_state_and_sends_nothing_more(vendor: type[Vendor], peer: Peer) -> None:
    """The peer itself presses Stop once it has got the client into the state."""

    def one(name: str) -> None:
        cancel = threading.Event()
        last = 1 if name == "redirected" else 0

        def script(received: Received) -> None:
            STATES[name](received)
            if received.number == last:
                cancel.set()
                received.gone()

        place = peer.place(f"stop-{vendor.name}-{name.replace(' ', '-')}", script)
        client = vendor.make(place.url, limits=replace(USUAL, total=600.0), retries=RetryPolicy(3, 60.0))
        with pytest.raises(Cancelled):
            vendor.ask(client, a_prompt(), cancel)
        assert len(place.received) == last + 1

    with ThreadPoolExecutor(len(STATES)) as pool:
        list(pool.map(one, STATES))


@EVERY_CLIENT
@pytest.mark.parametrize("where", ["handshake", "proxy", "behind the proxy"])
def test_it_stops_on_the_way(vendor: type[Vendor], where: str, keep: Keep) -> None:
    cancel, leave = threading.Event(), threading.Event()

    def hang(connection: Any) -> None:
        cancel.set()
        leave.wait(20)

    if where == "behind the proxy":
        far, _ = keep(start_secure(hang))
        port, _ = keep(start_tunnel(far))
    elif where == "proxy":
        port, _ = keep(start_tunnel(9, answer=hang))
    else:
        (port,) = keep(serve(hang))
    origin = f"https://127.0.0.1:{port}" if where == "handshake" else "https://model.invalid"
    proxy = "" if where == "handshake" else f"http://127.0.0.1:{port}"
    client = vendor.make(origin, limits=USUAL, retries=ONCE, route=checked_route(proxy, AUTHORITY))
    try:
        with pytest.raises(Cancelled):
            vendor.ask(client, a_prompt(), cancel)
    finally:
        leave.set()


@EVERY_CLIENT
def test_it_stops_while_connecting_and_while_sending(vendor: type[Vendor], keep: Keep) -> None:
    sent, leave = threading.Event(), threading.Event()

    def take_little(connection: socket.socket) -> None:
        connection.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
        read_head(connection)
        sent.set()
        leave.wait(20)

    (port,) = keep(serve(take_little))
    large = replace(a_prompt("word " * 4_000_000))
    client = vendor.make(f"http://127.0.0.1:{port}", limits=USUAL, retries=ONCE)
    try:
        with pytest.raises(Cancelled):
            vendor.ask(client, large, sent)
    finally:
        leave.set()
    with deaf_port() as deaf:
        if deaf is not None:
            cancel = threading.Event()
            client = vendor.make(f"http://127.0.0.1:{deaf}", limits=USUAL, retries=ONCE)
            timer = threading.Timer(0.05, cancel.set)
            timer.start()
            with pytest.raises((Cancelled, ModelError)) as caught:
                vendor.ask(client, a_prompt(), cancel)
            timer.join()
            assert caught.type is Cancelled
