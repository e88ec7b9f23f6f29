# SPDX-License-Identifier: GPL-3.0-or-later
"""Scripted peers on loopback (`tests/faults/fault_server.py`), and OpenAI-style replies for them."""

from __future__ import annotations

import json
import sys
import threading
import time
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from code_as_room.pipeline.models.base import Prompt
from code_as_room.pipeline.models.exchange import THREAD_NAME

sys.path.append(str(Path(__file__).resolve().parent.parent / "faults"))  # tests are imported by their paths

import fault_envelopes
from fault_envelopes import OpenAI
from fault_server import Peer, Received, start_peer, stop


def chat(text: str, **extra: Any) -> dict[str, Any]:
    """A whole reply in one piece."""
    return {**OpenAI.whole(text), **extra}


def event(text: str | None = None, reason: str | None = None, **extra: Any) -> bytes:
    """One chunk of a streamed reply."""
    return (
        b"data: "
        + json.dumps(OpenAI.chunk({} if text is None else {"content": text}, reason, **extra)).encode()
        + b"\n\n"
    )


USAGE = b'data: {"choices": [], "usage": {"prompt_tokens": 11, "completion_tokens": 7}}\n\n'
DONE = b"data: [DONE]\n\n"


def stream(received: Received, *texts: str, reason: str = "stop") -> None:
    """A whole streamed reply."""
    received.start_stream()
    for text in texts:
        received.send(event(text))
    received.send(event(None, reason) + USAGE + DONE)


@pytest.fixture
def make_peer() -> Iterator[Callable[[], Peer]]:
    """Starts peers; stops them at the end."""
    servers = []

    def make() -> Peer:
        peer, server = start_peer()
        servers.append(server)
        return peer

    yield make
    for server in servers:
        stop(server)


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
    return replace(fault_envelopes.a_prompt(), images=(b"\x89PNG fake",))


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
