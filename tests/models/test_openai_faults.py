# SPDX-License-Identifier: GPL-3.0-or-later
"""The OpenAI-style client when the network fails: a clear error, nothing left behind."""

import json
import random
import threading
import traceback

import pytest
from code_as_room.pipeline.errors import ModelError, ReplyError
from code_as_room.pipeline.models.exchange import Limits
from code_as_room.pipeline.models.openai_style import OpenAIStyleClient
from code_as_room.pipeline.models.retry import RetryPolicy
from fault_server import free_port

KEY = "sk-test-0123456789abcdef"
ONCE = RetryPolicy(tries=1)

pytestmark = pytest.mark.usefixtures("no_threads_left")


def make(url, limits=None, retries=ONCE):
    return OpenAIStyleClient(url, "m", KEY, limits or Limits(total=20.0), retries)


def failure(client, prompt):
    with pytest.raises(ModelError) as caught:
        client.answer(prompt, threading.Event())
    told = "".join(traceback.format_exception(caught.value))
    assert KEY not in told
    assert caught.value.message and caught.value.fix
    return caught.value


# Broken replies -------------------------------------------------------------------------------------------------


def test_a_stream_that_breaks_off_is_tried_again(peer, a_prompt, wire):
    def script(received):
        received.start_stream()
        received.send(wire.event('{"a":'))
        if received.number == 1:
            received.send(wire.event(" 1}") + wire.event(None, "stop") + wire.done)

    peer.script = script
    client = make(peer.url, retries=RetryPolicy(3, 0.001))
    assert client.answer(a_prompt, threading.Event()).text == '{"a": 1}'
    assert len(peer.received) == 2


def test_a_stream_without_the_end_mark_is_whole_when_the_model_said_stop(peer, a_prompt, wire):
    def script(received):
        received.start_stream()
        received.send(wire.event("{}") + wire.event(None, "stop").rstrip())

    peer.script = script
    assert make(peer.url).answer(a_prompt, threading.Event()).text == "{}"


@pytest.mark.parametrize("streamed", [True, False])
def test_a_reset_at_any_byte_is_an_error_or_a_whole_reply(peer, a_prompt, wire, streamed):
    if streamed:
        head = b"HTTP/1.1 200 OK\r\nContent-Type: text/event-stream\r\nTransfer-Encoding: chunked\r\n\r\n"
        pieces = [wire.event('{"a":'), wire.event(" 1}"), wire.event(None, "stop"), wire.done]
        whole = head + b"".join(b"%x\r\n%s\r\n" % (len(piece), piece) for piece in pieces) + b"0\r\n\r\n"
    else:
        body = json.dumps(wire.chat('{"a": 1}')).encode()
        whole = b"HTTP/1.1 200 OK\r\nContent-Type: application/json\r\nContent-Length: %d\r\n\r\n" % len(body) + body
    client = make(peer.url)
    for end in sorted(random.Random(5).sample(range(len(whole)), 40)) + [len(whole)]:

        def script(received, end=end):
            received.send(whole[:end])
            if end % 2:
                received.reset()

        peer.script = script
        try:
            reply = client.answer(a_prompt, threading.Event())
        except ModelError as error:
            assert not isinstance(error, ReplyError)
            assert end < len(whole)
        else:
            assert reply.text == '{"a": 1}'


@pytest.mark.parametrize(
    "raw",
    [
        b"",
        b"garbage\r\n\r\n",
        b"HTTP/1.1 200 OK\r\n\r\n",
        b"HTTP/1.1 abc OK\r\n\r\n{}",
        b"HTTP/1.1 200 OK\r\nContent-Length: many\r\n\r\n{}",
        b"HTTP/1.1 200 OK\r\nTransfer-Encoding: chunked\r\n\r\nzz\r\n{}\r\n0\r\n\r\n",
        b"HTTP/1.1 200 OK\r\nTransfer-Encoding: chunked\r\n\r\n2\r\n{}",
        b"HTTP/1.1 200 OK\r\nContent-Encoding: gzip\r\nContent-Length: 2\r\n\r\n{}",
        b"HTTP/1.1 200 OK\r\n" + b"X: y\r\n" * 500 + b"\r\n{}",
        b"HTTP/1.1 200 OK\r\nContent-Type: text/html\r\nContent-Length: 20\r\n\r\n<html>hello</html>  ",
        b"HTTP/1.1 200 OK\r\nContent-Length: 5\r\n\r\nhello",
        b"HTTP/1.1 200 OK\r\nContent-Length: 2\r\n\r\n[]",
        b'HTTP/1.1 200 OK\r\nContent-Length: 14\r\n\r\n{"choices": 3}',
        b"HTTP/1.1 200 OK\r\nContent-Length: 4\r\n\r\nnull",
        b'HTTP/1.1 200 OK\r\nContent-Type: text/event-stream\r\n\r\ndata: {"choi\n\n',
        b'HTTP/1.1 200 OK\r\nContent-Type: text/event-stream\r\n\r\ndata: 7\n\ndata: {"error": "no"}\n\n',
        b"HTTP/1.1 204 No Content\r\n\r\n",
        b"HTTP/1.1 302 Found\r\n\r\n",
        b"HTTP/1.1 302 Found\r\nLocation: http://[::1\r\n\r\n",
        b"HTTP/1.1 200 OK\r\nContent-Length: 9999\r\n\r\n" + b'{"a":' * 1999,
    ],
)
def test_no_malformed_reply_gets_out_as_anything_but_a_model_error(peer, a_prompt, raw):
    peer.script = lambda received: received.send(raw)
    failure(make(peer.url), a_prompt)


def test_a_web_page_and_a_foreign_reply_are_named(peer, a_prompt):
    peer.script = lambda received: received.reply(200, b"<html></html>", {"Content-Type": "text/html"})
    assert "web page" in str(failure(make(peer.url), a_prompt))
    peer.script = lambda received: received.reply(200, {"candidates": []})
    assert "not a chat reply" in str(failure(make(peer.url), a_prompt))


@pytest.mark.parametrize("streamed", [True, False])
def test_an_error_inside_a_good_status_is_shown(peer, a_prompt, wire, streamed):
    error = {"error": {"message": f"the model {KEY} fell over", "code": "server_error"}}

    def script(received):
        if streamed:
            received.start_stream()
            received.send(wire.event("{") + b"data: " + json.dumps(error).encode() + b"\n\n")
        else:
            received.reply(200, error)

    peer.script = script
    client = make(peer.url, retries=RetryPolicy(2, 0.001))
    assert "fell over" in str(failure(client, a_prompt))
    assert len(peer.received) == 2


def test_a_reply_over_the_size_limit_is_stopped(peer, a_prompt, wire):
    sent = []

    def script(received):
        received.start_stream()
        for _ in range(2000):
            received.send(wire.event("x" * 10_000))
            sent.append(1)

    peer.script = script
    error = failure(make(peer.url, Limits(size=1_000_000)), a_prompt)
    assert "larger than 1 MB" in str(error)
    assert len(sent) < 2000


# Time-outs ------------------------------------------------------------------------------------------------------


def test_silence_between_pieces_ends_at_the_read_limit_and_is_not_tried_again(peer, a_prompt, wire):
    leave = threading.Event()

    def script(received):
        received.start_stream()
        received.send(wire.event("{"))
        leave.wait(10)

    peer.script = script
    error = failure(make(peer.url, Limits(read=0.3), RetryPolicy(3, 0.001)), a_prompt)
    leave.set()
    assert error.kind == "timeout" and "silent" in str(error)
    assert len(peer.received) == 1


def test_a_dripping_reply_ends_at_the_total_limit(peer, a_prompt, wire):
    leave = threading.Event()

    def script(received):
        received.start_stream()
        while not leave.wait(0.05):
            received.send(b": ping\n\n")

    peer.script = script
    error = failure(make(peer.url, Limits(read=5.0, total=0.6)), a_prompt)
    leave.set()
    assert error.kind == "timeout" and "time limit" in str(error)


def test_a_server_that_is_not_there_is_named(a_prompt, monkeypatch):
    for name in ("http_proxy", "HTTP_PROXY", "all_proxy", "ALL_PROXY"):
        monkeypatch.delenv(name, raising=False)
    error = failure(make(f"http://127.0.0.1:{free_port()}/v1"), a_prompt)
    assert error.kind == "refused" and "nothing answers there" in str(error)
    error = failure(make("http://no-such-host.invalid/v1"), a_prompt)
    assert error.kind == "name" and "name cannot be found" in str(error)


def test_a_server_that_speaks_no_tls_gets_no_request(peer, a_prompt):
    peer.script = lambda received: received.reply(200, {})
    error = failure(make(peer.url.replace("http:", "https:")), a_prompt)
    assert error.kind in ("tls", "network")
    assert peer.received == []


# Redirects ------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("status", [301, 302, 303, 307, 308])
def test_a_redirect_to_another_place_is_not_followed(make_peer, a_prompt, status):
    first, second = make_peer(), make_peer()
    second.script = lambda received: received.reply(200, {})
    for target in (second.url, f"http://localhost:{first.port}/v1", "https://example.invalid/", "ftp://127.0.0.1/"):
        first.script = lambda received, target=target: received.reply(status, {}, {"Location": target})
        assert failure(make(first.url), a_prompt).kind == "redirect"
    assert second.received == []


def test_a_redirect_on_the_same_host_is_followed_with_the_whole_request(peer, a_prompt, wire):
    def script(received):
        if received.line.split()[1] == "/v1/chat/completions":
            received.reply(307, {}, {"Location": "/api/v1/chat"})
        else:
            received.reply(200, wire.chat("{}"))

    peer.script = script
    assert make(peer.url).answer(a_prompt, threading.Event()).text == "{}"
    assert peer.received[1].body == peer.received[0].body


def test_a_redirect_loop_ends(peer, a_prompt):
    peer.script = lambda received: received.reply(302, {}, {"Location": received.line.split()[1]})
    assert failure(make(peer.url), a_prompt).kind == "redirect"
    assert len(peer.received) <= 5


def test_many_requests_side_by_side_are_answered(peer, a_prompt, wire):
    peer.script = lambda received: received.reply(200, wire.chat("{}"))
    client = make(peer.url)
    texts = []
    threads = [
        threading.Thread(target=lambda: texts.append(client.answer(a_prompt, threading.Event()).text)) for _ in range(8)
    ]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert texts == ["{}"] * 8


# Proxies --------------------------------------------------------------------------------------------------------


@pytest.fixture
def proxied(peer, monkeypatch):
    """All traffic to other hosts goes through the peer."""
    for name in ("http_proxy", "https_proxy"):
        monkeypatch.setenv(name, f"http://user:secretword@127.0.0.1:{peer.port}")
        monkeypatch.setenv(name.upper(), f"http://user:secretword@127.0.0.1:{peer.port}")
    for name in ("no_proxy", "NO_PROXY", "all_proxy", "ALL_PROXY"):
        monkeypatch.delenv(name, raising=False)
    return peer


def test_the_environments_proxy_is_used_for_other_hosts(proxied, a_prompt, wire):
    proxied.script = lambda received: received.reply(200, wire.chat("{}"))
    assert make("http://model.invalid/v1").answer(a_prompt, threading.Event()).text == "{}"
    assert proxied.received[0].line.startswith("POST http://model.invalid/v1/chat/completions")


@pytest.mark.parametrize("scheme", ["http", "https"])
def test_a_proxy_that_asks_for_a_password_is_named_without_the_given_one(proxied, a_prompt, scheme):
    proxied.script = lambda received: received.reply(407, {}, {"Proxy-Authenticate": "Basic"})
    error = failure(make(f"{scheme}://model.invalid/v1"), a_prompt)
    assert error.kind == "proxy" and "secretword" not in str(error)
    assert all(KEY not in str(received.headers) for received in proxied.received) or scheme == "http"
