# SPDX-License-Identifier: GPL-3.0-or-later
"""The OpenAI-style client against a real server on loopback: replies, refusals, retries."""

import base64
import gzip
import json
import threading

import pytest
from code_as_room.pipeline.errors import CutReplyError, ModelError, ReplyError
from code_as_room.pipeline.models.exchange import Limits
from code_as_room.pipeline.models.faults import ServiceError
from code_as_room.pipeline.models.openai_style import OpenAIStyleClient
from code_as_room.pipeline.models.retry import RetryPolicy

KEY = "sk-test-0123456789abcdef"
QUICK = RetryPolicy(tries=3, first_pause=0.001)

pytestmark = pytest.mark.usefixtures("no_threads_left")


@pytest.fixture
def client(peer):
    return OpenAIStyleClient(peer.url, "some-model", KEY, Limits(total=20.0), QUICK)


@pytest.fixture
def ask(client, a_prompt):
    return lambda progress=None: client.answer(a_prompt, threading.Event(), progress)


def test_a_streamed_reply_is_read_with_its_usage(peer, ask, wire):
    peer.script = lambda received: wire.stream(received, '{"a":', " 1}")
    said = []
    reply = ask(said.append)
    assert (reply.text, reply.model) == ('{"a": 1}', "served-model")
    assert (reply.prompt_tokens, reply.completion_tokens, reply.cost) == (11, 7, None)
    assert said


def test_what_is_sent(peer, ask, wire, a_prompt):
    peer.script = lambda received: wire.stream(received, "{}")
    ask()
    [received] = peer.received
    assert received.line == "POST /v1/chat/completions HTTP/1.1"
    assert received.headers["authorization"] == f"Bearer {KEY}"
    body = received.body
    assert not {"temperature", "top_p", "max_tokens", "seed"} & set(body)
    picture, text = body["messages"][0]["content"]
    assert base64.b64decode(picture["image_url"]["url"].removeprefix("data:image/png;base64,")) == a_prompt.images[0]
    assert text == {"type": "text", "text": a_prompt.text}
    asked = body["response_format"]
    assert asked["type"] == "json_schema" and asked["json_schema"]["strict"] is True
    assert asked["json_schema"]["schema"] == a_prompt.schema


def test_the_end_mark_ends_the_reply_though_the_connection_stays_open(peer, ask, wire):
    leave = threading.Event()

    def script(received):
        wire.stream(received, "{}")
        leave.wait(10)

    peer.script = script
    try:
        assert ask().text == "{}"
    finally:
        leave.set()


def test_chunked_streams_cut_at_any_byte_are_put_together(peer, ask, wire):
    text = '{"a": "größer – 😀"}'
    payload = b": ping\r\n\r\n" + wire.event(text).replace(b"\n\n", b"\r\n\r\n") + wire.event(None, "stop") + wire.done
    assert "\\u" in payload.decode()
    raw = payload.replace(json.dumps(text).encode(), json.dumps(text, ensure_ascii=False).encode())

    def script(received):
        received.start_stream(chunked=True)
        for place in range(0, len(raw), 3):
            piece = raw[place : place + 3]
            received.send(b"%x\r\n%s\r\n" % (len(piece), piece))
        received.send(b"0\r\n\r\n")

    peer.script = script
    assert ask().text == text


def test_a_reply_in_one_piece_is_read_though_a_stream_was_asked_for(peer, ask, wire):
    peer.script = lambda received: received.reply(200, wire.chat('{"a": 1}', usage={"prompt_tokens": 3, "cost": 0.02}))
    reply = ask()
    assert (reply.text, reply.prompt_tokens, reply.completion_tokens, reply.cost) == ('{"a": 1}', 3, 0, 0.02)


def test_a_compressed_reply_is_read(peer, ask, wire):
    data = gzip.compress(json.dumps(wire.chat("{}")).encode())
    peer.script = lambda received: received.reply(200, data, {"Content-Encoding": "gzip"})
    assert ask().text == "{}"


def test_content_given_as_parts_is_joined(peer, ask, wire):
    whole = wire.chat("")
    whole["choices"][0]["message"]["content"] = [{"type": "text", "text": "{"}, {"type": "text", "text": "}"}]
    peer.script = lambda received: received.reply(200, whole)
    assert ask().text == "{}"


def test_a_reply_without_a_key_sends_none(peer, a_prompt, wire):
    peer.script = lambda received: wire.stream(received, "{}")
    OpenAIStyleClient(peer.url, "m").answer(a_prompt, threading.Event())
    assert "authorization" not in peer.received[0].headers


def test_credentials_of_a_netrc_file_are_never_sent(peer, a_prompt, wire, tmp_path, monkeypatch):
    (tmp_path / "netrc").write_text("machine 127.0.0.1 login someone password secret\n")
    monkeypatch.setenv("NETRC", str(tmp_path / "netrc"))
    peer.script = lambda received: wire.stream(received, "{}")
    OpenAIStyleClient(peer.url, "m").answer(a_prompt, threading.Event())
    OpenAIStyleClient(peer.url, "m", KEY).answer(a_prompt, threading.Event())
    assert "authorization" not in peer.received[0].headers
    assert peer.received[1].headers["authorization"] == f"Bearer {KEY}"


def test_a_local_server_is_asked_past_the_environments_proxy(peer, ask, wire, monkeypatch):
    monkeypatch.setenv("HTTP_PROXY", "http://127.0.0.1:9")
    monkeypatch.setenv("http_proxy", "http://127.0.0.1:9")
    peer.script = lambda received: wire.stream(received, "{}")
    assert ask().text == "{}"


# What services refuse -------------------------------------------------------------------------------------------


def refusing(wire, *features):
    """A service that answers 400 as long as the body holds one of the features, naming it."""

    def script(received):
        for feature, sentence in features:
            if feature(received.body):
                received.reply(400, {"error": {"message": sentence}})
                return
        if received.body.get("stream"):
            wire.stream(received, "{}")
        else:
            received.reply(200, wire.chat("{}"))

    return script


def has_schema(body):
    return body.get("response_format", {}).get("type") == "json_schema"


def has_object(body):
    return body.get("response_format", {}).get("type") == "json_object"


def test_without_json_schema_the_plain_json_mode_is_used_and_remembered(peer, ask, wire):
    peer.script = refusing(wire, (has_schema, "response_format type json_schema is not supported"))
    assert ask().text == "{}"
    assert ask().text == "{}"
    assert [has_object(received.body) for received in peer.received] == [False, True, True]
    text = peer.received[1].body["messages"][0]["content"][-1]["text"]
    assert '"additionalProperties":false' in text


def test_without_any_json_mode_the_schema_stands_in_the_prompt_only(peer, ask, wire):
    peer.script = refusing(
        wire, (has_schema, "Invalid schema for response_format"), (has_object, "unknown field: response_format")
    )
    assert ask().text == "{}"
    last = peer.received[-1].body
    assert "response_format" not in last and "JSON schema" in last["messages"][0]["content"][-1]["text"]


def test_without_streaming_the_reply_is_asked_for_in_one_piece(peer, ask, wire):
    peer.script = refusing(
        wire,
        (lambda body: "stream_options" in body, "stream_options is not permitted"),
        (lambda body: body.get("stream"), "streaming is not supported by this model"),
    )
    assert ask().text == "{}"
    assert [received.body.get("stream") for received in peer.received] == [True, True, None]


def test_other_refusals_are_not_taken_for_a_missing_feature(peer, ask):
    peer.script = lambda received: received.reply(400, {"error": {"message": "this model takes no pictures"}})
    with pytest.raises(ServiceError, match="this model takes no pictures"):
        ask()
    assert len(peer.received) == 1


# Answers that cannot be used ------------------------------------------------------------------------------------


@pytest.mark.parametrize("streamed", [True, False])
def test_a_reply_cut_by_length_is_an_error_of_its_own_kind(peer, ask, wire, streamed):
    whole = wire.chat('{"a":')
    whole["choices"][0]["finish_reason"] = "length"
    peer.script = lambda r: wire.stream(r, '{"a":', reason="length") if streamed else r.reply(200, whole)
    with pytest.raises(CutReplyError):
        ask()
    assert len(peer.received) == 1


def test_an_empty_answer_a_refusal_and_a_filter_are_told(peer, ask, wire):
    peer.script = lambda received: wire.stream(received, "", "  ")
    with pytest.raises(ReplyError, match="empty"):
        ask()
    refused = wire.chat("")
    refused["choices"][0]["message"] = {"content": None, "refusal": "I will not."}
    peer.script = lambda received: received.reply(200, refused)
    with pytest.raises(ServiceError, match="I will not"):
        ask()
    peer.script = lambda received: wire.stream(received, "{", reason="content_filter")
    with pytest.raises(ServiceError, match="filter"):
        ask()


@pytest.mark.parametrize(
    "url", ["", "localhost:1234", "ftp://x/v1", "http://", "http://user:pw@host/v1", "http://a b/", "http://h:99999/"]
)
def test_impossible_addresses_are_refused_without_repeating_secrets(url):
    with pytest.raises(ModelError) as caught:
        OpenAIStyleClient(url, "m")
    assert "pw" not in str(caught.value)


@pytest.mark.parametrize("key", ["two words", "line\nbreak", "schlüssel", "a\x00b"])
def test_impossible_keys_are_refused_without_repeating_them(key):
    with pytest.raises(ModelError) as caught:
        OpenAIStyleClient("http://localhost:1/v1", "m", key)
    assert key not in str(caught.value)


@pytest.mark.parametrize(
    "given, expected",
    [
        ("http://localhost:1234", "http://localhost:1234/v1"),
        ("http://localhost:1234/v1/", "http://localhost:1234/v1"),
        ("https://x.example/api/v1/chat/completions", "https://x.example/api/v1"),
        (" https://x.example/openai ", "https://x.example/openai"),
    ],
)
def test_base_urls_are_brought_into_one_form(given, expected):
    assert OpenAIStyleClient(given, "m").base_url == expected


def test_the_key_is_in_no_representation():
    client = OpenAIStyleClient("http://localhost:1/v1", "m", KEY)
    assert KEY not in repr(client) + client.name + client.describes
