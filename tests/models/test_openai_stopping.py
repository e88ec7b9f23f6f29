# SPDX-License-Identifier: GPL-3.0-or-later
"""The OpenAI-style client when the artist stops it, in any state: a clean stop, nothing left behind."""

import os
import random
import socket
import threading
import time
from dataclasses import replace

import pytest
from code_as_room.pipeline.errors import Cancelled, ModelError
from code_as_room.pipeline.models.exchange import Limits
from code_as_room.pipeline.models.openai_style import OpenAIStyleClient
from code_as_room.pipeline.models.retry import RetryPolicy
from fault_server import deaf_port

SOON = 2.0
"""Generous bound for what must happen within a second."""

pytestmark = pytest.mark.usefixtures("no_threads_left")


def make(url, limits=None, retries=None):
    return OpenAIStyleClient(
        url, "m", "sk-test-0123456789abcdef", limits or Limits(total=20.0), retries or RetryPolicy(1)
    )


def stopped_after(client, prompt, seconds):
    """Set the cancel event after a while; how long the client then takes to stop."""
    cancel = threading.Event()
    stopped = []

    def stop():
        stopped.append(time.monotonic())
        cancel.set()

    timer = threading.Timer(seconds, stop)
    timer.start()
    with pytest.raises(Cancelled):
        client.answer(prompt, cancel)
    end = time.monotonic()
    timer.join()
    return end - stopped[0]


@pytest.fixture
def deaf():
    """A port where connecting hangs."""
    with deaf_port() as port:
        if port is None:
            pytest.skip("this system takes connections beyond the queue")
        yield port


def test_it_stops_while_connecting(deaf, a_prompt, wire):
    assert stopped_after(make(f"http://127.0.0.1:{deaf}/v1"), a_prompt, 0.2) < SOON
    end = time.monotonic() + 3
    while wire.threads() and time.monotonic() < end:
        time.sleep(0.02)
    assert wire.threads() == 0


def test_connecting_ends_at_its_limit(deaf, a_prompt):
    client = make(f"http://127.0.0.1:{deaf}/v1", Limits(connect=0.3))
    with pytest.raises(ModelError, match="within 0.3 s"):
        client.answer(a_prompt, threading.Event())


def test_it_stops_while_waiting_for_the_first_byte(peer, a_prompt, wire):
    leave = threading.Event()
    peer.script = lambda received: leave.wait(10)
    assert stopped_after(make(peer.url), a_prompt, 0.2) < SOON
    leave.set()


@pytest.mark.parametrize("streamed", [True, False])
def test_it_stops_in_the_middle_of_a_reply(peer, a_prompt, wire, streamed):
    leave = threading.Event()

    def script(received):
        if streamed:
            received.start_stream()
            while not leave.wait(0.01):
                received.send(wire.event("x"))
        else:
            received.send(b"HTTP/1.1 200 OK\r\nContent-Length: 1000\r\n\r\n{")
            leave.wait(10)

    peer.script = script
    assert stopped_after(make(peer.url), a_prompt, 0.2) < SOON
    leave.set()


def test_it_stops_between_two_tries(peer, a_prompt):
    peer.script = lambda received: received.reply(503, {"error": "busy"}, {"Retry-After": "60"})
    assert stopped_after(make(peer.url, Limits(), RetryPolicy(5, 60.0)), a_prompt, 0.2) < SOON
    assert len(peer.received) == 1


def test_it_stops_while_a_large_picture_is_not_taken(a_prompt, wire):
    with socket.socket() as listener:
        listener.bind(("127.0.0.1", 0))
        listener.listen(1)
        client = make(f"http://127.0.0.1:{listener.getsockname()[1]}/v1")
        assert stopped_after(client, replace(a_prompt, images=(b"\x00" * 20_000_000,)), 0.5) < SOON


def test_stopped_before_it_began_nothing_is_sent(peer, a_prompt):
    cancel = threading.Event()
    cancel.set()
    with pytest.raises(Cancelled):
        make(peer.url).answer(a_prompt, cancel)
    assert peer.received == []


def test_stopping_many_at_random_moments_leaves_nothing_behind(peer, a_prompt, wire):
    def script(received):
        received.start_stream()
        for _ in range(10):
            received.send(wire.event("x"))
            time.sleep(0.01)
        received.send(wire.event(None, "stop") + wire.done)

    peer.script = script
    client = make(peer.url)
    moments = random.Random(3)
    files_before = len(os.listdir("/proc/self/fd")) if os.path.isdir("/proc/self/fd") else 0
    for _ in range(40):
        cancel = threading.Event()
        timer = threading.Timer(moments.uniform(0.0, 0.12), cancel.set)
        timer.start()
        try:
            assert client.answer(a_prompt, cancel).text == "x" * 10
        except Cancelled:
            assert cancel.is_set()
        timer.join()
    end = time.monotonic() + 3
    while (wire.threads() or peer.open_now) and time.monotonic() < end:
        time.sleep(0.02)
    assert wire.threads() == 0 and peer.open_now == 0
    if files_before:
        time.sleep(0.1)
        assert len(os.listdir("/proc/self/fd")) <= files_before + 3
