# SPDX-License-Identifier: GPL-3.0-or-later
"""Peers on loopback that do exactly what a test wants: HTTP, TLS and proxies. The standard library only.

A script is handed a whole request and writes the bytes of the answer, good or bad. One server can hold many places, each
with a path, a script and a list of requests of its own, so that hundreds of exchanges run side by side.
"""

from __future__ import annotations

import base64
import contextlib
import json
import socket
import socketserver
import ssl
import struct
import threading
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

CERTIFICATES = Path(__file__).resolve().parent.parent / "models" / "tls"
AUTHORITY = str(CERTIFICATES / "authority.pem")
_LONGEST = 30.0


@dataclass
class Received:
    """One request as the peer read it, and the socket to answer on; `number` counts the requests before it."""

    line: str
    headers: dict[str, str]
    body: dict[str, Any]
    socket: socket.socket
    number: int

    def send(self, data: bytes) -> None:
        """These bytes and no others."""
        self.socket.sendall(data)

    def reply(self, status: int, payload: Any, headers: dict[str, str] | None = None) -> None:
        """A whole answer; `payload` is bytes, or anything that JSON can hold."""
        data = payload if isinstance(payload, bytes) else json.dumps(payload).encode()
        given = {"Content-Type": "application/json", "Content-Length": str(len(data)), **(headers or {})}
        lines = "".join(f"{name}: {value}\r\n" for name, value in given.items())
        self.send(f"HTTP/1.1 {status} Status\r\n{lines}Connection: close\r\n\r\n".encode() + data)

    def start_stream(self, chunked: bool = False, kind: str = "text/event-stream") -> None:
        """The head of an answer that comes in pieces and ends with the connection."""
        extra = "Transfer-Encoding: chunked\r\n" if chunked else ""
        self.send(f"HTTP/1.1 200 OK\r\nContent-Type: {kind}\r\n{extra}Connection: close\r\n\r\n".encode())

    def reset(self) -> None:
        """Close with a reset rather than an orderly end."""
        self.socket.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))
        self.socket.close()

    def drip(self, data: bytes, size: int = 1) -> None:
        """Piece by piece, each in a packet of its own."""
        self.socket.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        for at in range(0, len(data), size):
            self.socket.sendall(data[at : at + size])

    def gone(self, seconds: float = _LONGEST) -> bool:
        """Wait until the client hangs up, at most so long; whether it did."""
        self.socket.settimeout(seconds)
        try:
            while self.socket.recv(65_536):
                pass
        except TimeoutError:
            return False
        except OSError:
            pass
        finally:
            with contextlib.suppress(OSError):
                self.socket.settimeout(_LONGEST)
        return True


Script = Callable[[Received], None]


@dataclass
class Place:
    """An address of a peer: what it received, and its script."""

    url: str
    script: Script | None = None
    received: list[Received] = field(default_factory=list)


@dataclass
class Peer(Place):
    """A server; `url` ends in /v1. `places` are found by the first part of their path, everything else is its own.

    `open_now` counts the requests that are being answered.
    """

    port: int = 0
    open_now: int = 0
    places: dict[str, Place] = field(default_factory=dict)

    def place(self, name: str, script: Script | None = None) -> Place:
        """A new address on this server, without a path of its own behind the name."""
        self.places[name] = Place(f"http://127.0.0.1:{self.port}/{name}", script)
        return self.places[name]


def read_request(connection: socket.socket) -> tuple[str, dict[str, str], dict[str, Any]] | None:
    """First line, headers in small letters, and the JSON body of a request; None when nothing came."""
    file = connection.makefile("rb")
    line = file.readline().decode().strip()
    if not line:
        return None
    headers: dict[str, str] = {}
    while True:
        header = file.readline().decode().strip()
        if not header:
            break
        name, _, value = header.partition(":")
        headers[name.lower()] = value.strip()
    raw = file.read(int(headers.get("content-length", 0)))
    return line, headers, json.loads(raw) if raw else {}


class Server(socketserver.ThreadingTCPServer):
    """Threads that end with the program, and no word on clients that hang up."""

    allow_reuse_address = True
    daemon_threads = True
    request_queue_size = 128

    def handle_error(self, request: Any, client_address: Any) -> None:
        """A peer that hangs up is the point of many tests."""


def serve(handle: Callable[[socket.socket], None]) -> tuple[Server, int]:
    """A server whose connections are handled by a function; returns it and its port."""

    class Handler(socketserver.BaseRequestHandler):
        def handle(self) -> None:
            # A client that hangs up while a script is writing is the point of many tests.
            with contextlib.suppress(OSError, ValueError):
                handle(self.request)

    server = Server(("127.0.0.1", 0), Handler)
    threading.Thread(target=server.serve_forever, args=(0.05,), daemon=True, name="test-peer").start()
    return server, server.server_address[1]


def start_peer() -> tuple[Peer, Server]:
    """A peer, and the server to shut down in the end."""

    def handle(connection: socket.socket) -> None:
        read = read_request(connection)
        if read is None:
            return
        parts = read[0].split()
        name = parts[1].lstrip("/").partition("/")[0] if len(parts) > 1 else ""
        place = peer.places.get(name, peer)
        received = Received(*read, connection, len(place.received))
        place.received.append(received)
        assert place.script is not None
        peer.open_now += 1
        try:
            place.script(received)
        finally:
            peer.open_now -= 1

    server, port = serve(handle)
    peer = Peer(f"http://127.0.0.1:{port}/v1", port=port)
    return peer, server


def stop(server: Server) -> None:
    """Close a server; connections that are being handled end by themselves."""
    server.shutdown()
    server.server_close()


def read_head(connection: socket.socket) -> tuple[list[str], bytes]:
    """The lines of a request's head, and what came behind it."""
    data = b""
    while b"\r\n\r\n" not in data:
        piece = connection.recv(4096)
        if not piece:
            return [], b""
        data += piece
    head, _, rest = data.partition(b"\r\n\r\n")
    return head.decode().split("\r\n"), rest


def start_secure(
    answer: Callable[[ssl.SSLSocket], None], certificate: str = "server"
) -> tuple[Server, int, list[list[str]]]:
    """A TLS service with one of the certificates: `answer` is called once a request has been read whole.

    Returns the server, its port, and the list of the heads that it received.
    """
    context = ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER)
    context.load_cert_chain(CERTIFICATES / f"{certificate}.pem")
    heads: list[list[str]] = []

    def handle(raw: socket.socket) -> None:
        with context.wrap_socket(raw, server_side=True) as connection:
            lines, rest = read_head(connection)
            heads.append(lines)
            wanted = next(int(line[16:]) for line in lines if line.lower().startswith("content-length: "))
            while len(rest) < wanted:
                rest += connection.recv(65_536)
            answer(connection)

    server, port = serve(handle)
    return server, port, heads


def start_tunnel(
    port: int, password: str = "", answer: Callable[[socket.socket], None] | None = None
) -> tuple[Server, int, list[list[str]]]:
    """A proxy that leads every CONNECT to one port of this computer.

    Args:
        password: of the user "user", "" for none; answer: what it does instead of letting anybody through.

    Returns the server, its own port, and the list of the heads that it received.
    """
    asked: list[list[str]] = []

    def handle(connection: socket.socket) -> None:
        lines, _ = read_head(connection)
        asked.append(lines)
        given = base64.b64encode(f"user:{password}".encode()).decode()
        if answer is not None:
            answer(connection)
        elif password and f"Proxy-Authorization: Basic {given}" not in lines:
            connection.sendall(b"HTTP/1.1 407 Proxy Authentication Required\r\nConnection: close\r\n\r\n")
        else:
            with socket.create_connection(("127.0.0.1", port)) as far:
                connection.sendall(b"HTTP/1.1 200 Connection established\r\n\r\n")
                back = threading.Thread(target=pump, args=(far, connection), daemon=True)
                back.start()
                pump(connection, far)
                back.join()

    server, own = serve(handle)
    return server, own, asked


def pump(source: socket.socket, target: socket.socket) -> None:
    """Pass on everything until one side is closed."""
    with contextlib.suppress(OSError):
        while piece := source.recv(65_536):
            target.sendall(piece)
    for end in (source, target):
        with contextlib.suppress(OSError):
            end.shutdown(socket.SHUT_RDWR)


@contextlib.contextmanager
def deaf_port() -> Iterator[int | None]:
    """A port where connecting hangs, as behind a firewall: a listener whose queue is full. None where there is no such."""
    with socket.socket() as listener:
        listener.bind(("127.0.0.1", 0))
        listener.listen(0)
        port: int = listener.getsockname()[1]
        fillers = [socket.socket() for _ in range(8)]
        for filler in fillers:
            filler.setblocking(False)
            filler.connect_ex(("127.0.0.1", port))
        with socket.socket() as probe:
            probe.settimeout(0.3)
            try:
                probe.connect(("127.0.0.1", port))
            except TimeoutError:
                yield port
            else:
                yield None
            finally:
                for filler in fillers:
                    filler.close()


def free_port() -> int:
    """A port of this computer where nothing listens."""
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port: int = free.getsockname()[1]
        return port
