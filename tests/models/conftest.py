# SPDX-License-Identifier: GPL-3.0-or-later
"""A scripted HTTP peer on loopback: it reads whole requests and writes exactly the bytes a test wants."""

from __future__ import annotations

import contextlib
import json
import socket
import socketserver
import threading
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from typing import Any

import pytest
from code_as_room.pipeline.models.base import Prompt
from code_as_room.pipeline.models.exchange import THREAD_NAME


@dataclass
class Received:
    """One request as the peer read it, and the socket to answer on."""

    line: str
    headers: dict[str, str]
    body: dict[str, Any]
    socket: socket.socket
    number: int

    def send(self, data: bytes) -> None:
        self.socket.sendall(data)

    def reply(self, status: int, payload: Any, headers: dict[str, str] | None = None) -> None:
        data = payload if isinstance(payload, bytes) else json.dumps(payload).encode()
        given = {"Content-Type": "application/json", "Content-Length": str(len(data)), **(headers or {})}
        lines = "".join(f"{name}: {value}\r\n" for name, value in given.items())
        self.send(f"HTTP/1.1 {status} Status\r\n{lines}Connection: close\r\n\r\n".encode() + data)

    def start_stream(self, chunked: bool = False) -> None:
        extra = "Transfer-Encoding: chunked\r\n" if chunked else ""
        self.send(f"HTTP/1.1 200 OK\r\nContent-Type: text/event-stream\r\n{extra}Connection: close\r\n\r\n".encode())


Script = Callable[[Received], None]


@dataclass
class Peer:
    """The server's address, what it received, and its script."""

    url: str
    port: int
    script: Script | None = None
    received: list[Received] = field(default_factory=list)
    open_now: int = 0


def chat(text: str, **extra: Any) -> dict[str, Any]:
    """A whole reply in one piece."""
    return {
        "id": "x",
        "object": "chat.completion",
        "model": "served-model",
        "choices": [{"index": 0, "message": {"role": "assistant", "content": text}, "finish_reason": "stop"}],
        "usage": {"prompt_tokens": 11, "completion_tokens": 7},
        **extra,
    }


def event(text: str | None = None, reason: str | None = None, **extra: Any) -> bytes:
    """One chunk of a streamed reply."""
    choice = {"index": 0, "delta": {} if text is None else {"content": text}, "finish_reason": reason}
    return b"data: " + json.dumps({"model": "served-model", "choices": [choice], **extra}).encode() + b"\n\n"


USAGE = b'data: {"choices": [], "usage": {"prompt_tokens": 11, "completion_tokens": 7}}\n\n'
DONE = b"data: [DONE]\n\n"


def stream(received: Received, *texts: str, reason: str = "stop") -> None:
    """A whole streamed reply."""
    received.start_stream()
    for text in texts:
        received.send(event(text))
    received.send(event(None, reason) + USAGE + DONE)


def _read_request(connection: socket.socket) -> tuple[str, dict[str, str], dict[str, Any]] | None:
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


def _start_peer() -> tuple[Peer, socketserver.ThreadingTCPServer]:
    class Handler(socketserver.BaseRequestHandler):
        def handle(self) -> None:
            # A client that hangs up while a test's script is writing is the point of many of them.
            with contextlib.suppress(OSError, ValueError):
                read = _read_request(self.request)
                if read is None:
                    return
                received = Received(*read, self.request, len(peer.received))
                peer.received.append(received)
                assert peer.script is not None
                peer.open_now += 1
                try:
                    peer.script(received)
                finally:
                    peer.open_now -= 1

    class Server(socketserver.ThreadingTCPServer):
        allow_reuse_address = True
        daemon_threads = True
        request_queue_size = 64

    server = Server(("127.0.0.1", 0), Handler)
    port = server.server_address[1]
    peer = Peer(f"http://127.0.0.1:{port}/v1", port)
    threading.Thread(target=server.serve_forever, args=(0.05,), daemon=True, name="test-peer").start()
    return peer, server


@pytest.fixture
def make_peer() -> Iterator[Callable[[], Peer]]:
    """Starts peers; stops them at the end."""
    servers = []

    def make() -> Peer:
        peer, server = _start_peer()
        servers.append(server)
        return peer

    yield make
    for server in servers:
        server.shutdown()
        server.server_close()


@pytest.fixture
def peer(make_peer: Callable[[], Peer]) -> Peer:
    """One peer."""
    return make_peer()


@pytest.fixture
def no_threads_left() -> Iterator[None]:
    """Fails when an exchange's thread outlives the test by more than a moment."""
    yield
    end = time.monotonic() + 3.0
    while exchange_threads() and time.monotonic() < end:
        time.sleep(0.02)
    assert exchange_threads() == 0


def exchange_threads() -> int:
    return sum(thread.name == THREAD_NAME for thread in threading.enumerate())


@pytest.fixture
def a_prompt() -> Prompt:
    """A small prompt with one picture and a schema."""
    schema = {
        "type": "object",
        "properties": {"a": {"type": "number"}},
        "required": ["a"],
        "additionalProperties": False,
    }
    return Prompt("s01", "01_test", "What is a?", (b"\x89PNG fake",), "Answer", schema, "0" * 64)


@pytest.fixture
def wire() -> Any:
    """The helpers above for tests, which cannot import this file by name."""

    class Wire:
        chat = staticmethod(chat)
        event = staticmethod(event)
        stream = staticmethod(stream)
        threads = staticmethod(exchange_threads)
        usage = USAGE
        done = DONE

    return Wire
