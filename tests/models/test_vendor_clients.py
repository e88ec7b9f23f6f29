# SPDX-License-Identifier: GPL-3.0-or-later
"""Anthropic, Gemini and Ollama: envelopes as the vendors' documentation has them, from a server on loopback."""

import base64
import json
import threading
from dataclasses import replace

import pytest
from code_as_room.pipeline.errors import Cancelled, CutReplyError, ModelError, ReplyError
from code_as_room.pipeline.models.anthropic import AnthropicClient
from code_as_room.pipeline.models.exchange import Limits
from code_as_room.pipeline.models.faults import ServiceError
from code_as_room.pipeline.models.gemini import GeminiClient
from code_as_room.pipeline.models.ollama import OllamaClient, context_length
from code_as_room.pipeline.models.openai_style import OpenAIStyleClient
from code_as_room.pipeline.models.retry import RetryPolicy
from fault_envelopes import KEY, Anthropic, Gemini, Ollama, events

QUICK = RetryPolicy(tries=3, first_pause=0.001)

pytestmark = pytest.mark.usefixtures("no_threads_left")


VENDORS = pytest.mark.parametrize("vendor", [Anthropic, Gemini, Ollama])


def make(vendor, peer, limits=None, retries=QUICK, model="some-model"):
    return vendor.client(
        f"http://127.0.0.1:{peer.port}{vendor.base}", model, KEY, limits or Limits(total=20.0), retries
    )


def send_stream(vendor, received, raw):
    received.send(f"HTTP/1.1 200 OK\r\nContent-Type: {vendor.kind}\r\nConnection: close\r\n\r\n".encode() + raw)


def ask(client, prompt):
    return client.answer(prompt, threading.Event())


@VENDORS
@pytest.mark.parametrize("streamed", [True, False])
def test_a_reply_is_read_with_its_usage_streamed_or_not(vendor, streamed, peer, a_prompt):
    def script(received):
        if streamed:
            send_stream(vendor, received, vendor.stream(['{"a":', " 1}"]))
        else:
            received.reply(200, vendor.whole('{"a": 1}'))

    peer.script = script
    reply = ask(make(vendor, peer), a_prompt)
    assert (reply.text, reply.model, reply.prompt_tokens, reply.completion_tokens) == (
        '{"a": 1}',
        "served-model",
        11,
        7,
    )


@VENDORS
def test_a_stream_cut_at_any_byte_is_a_whole_reply_or_told(vendor, peer, a_prompt):
    raw = vendor.stream(["{", '"a": "größer 😀"}'])
    whole = ask_once(vendor, peer, a_prompt, raw)
    assert json.loads(whole) == {"a": "größer 😀"}
    for end in range(0, len(raw), 23):
        try:
            assert ask_once(vendor, peer, a_prompt, raw[:end]) == whole
        except ModelError as error:
            assert error.message and KEY not in str(error)


def ask_once(vendor, peer, prompt, raw):
    peer.script = lambda received: send_stream(vendor, received, raw)
    return ask(make(vendor, peer, retries=RetryPolicy(1)), prompt).text


@VENDORS
def test_a_stream_that_breaks_off_is_tried_again(vendor, peer, a_prompt):
    raw = vendor.stream(["{}"])

    def script(received):
        send_stream(vendor, received, raw[: len(raw) // 3] if received.number == 0 else raw)

    peer.script = script
    assert ask(make(vendor, peer), a_prompt).text == "{}"
    assert len(peer.received) == 2


@VENDORS
@pytest.mark.parametrize("streamed", [True, False])
def test_an_answer_that_was_cut_is_an_error_of_its_own_kind(vendor, streamed, peer, a_prompt):
    def script(received):
        if streamed:
            send_stream(vendor, received, vendor.stream(['{"a":'], vendor.cut))
        else:
            received.reply(200, vendor.whole('{"a":', vendor.cut))

    peer.script = script
    with pytest.raises(CutReplyError):
        ask(make(vendor, peer), a_prompt)
    assert len(peer.received) == 1


@pytest.mark.parametrize("vendor", [Anthropic, Gemini])
@pytest.mark.parametrize("streamed", [True, False])
def test_a_refusal_is_told_and_not_tried_again(vendor, streamed, peer, a_prompt):
    def script(received):
        if streamed:
            send_stream(vendor, received, vendor.stream(["{"], vendor.refused))
        else:
            received.reply(200, vendor.whole("", vendor.refused))

    peer.script = script
    with pytest.raises(ServiceError) as caught:
        ask(make(vendor, peer), a_prompt)
    assert caught.value.kind == "refusal" and len(peer.received) == 1


def test_a_prompt_that_gemini_blocks_is_told(peer, a_prompt):
    peer.script = lambda r: r.reply(200, {"promptFeedback": {"blockReason": "SAFETY"}, "usageMetadata": {}})
    with pytest.raises(ServiceError) as caught:
        ask(make(Gemini, peer), a_prompt)
    assert caught.value.kind == "refusal"


@VENDORS
def test_an_empty_answer_is_told(vendor, peer, a_prompt):
    peer.script = lambda received: received.reply(200, vendor.whole(" "))
    with pytest.raises(ReplyError, match="empty"):
        ask(make(vendor, peer), a_prompt)


@VENDORS
def test_a_foreign_reply_or_a_web_page_names_the_address(vendor, peer, a_prompt):
    for body in ({"choices": []}, {"hello": 1}, [], b"<html>Sign in</html>", b"null", b"7"):
        peer.script = lambda received, body=body: received.reply(200, body)
        with pytest.raises(ServiceError) as caught:
            ask(make(vendor, peer), a_prompt)
        assert caught.value.kind == "shape" and "URL" in caught.value.fix


@VENDORS
def test_an_error_in_the_middle_of_a_stream_is_shown_without_the_key(vendor, peer, a_prompt):
    begun = vendor.stream(["{"])[:-40].rpartition(b"\n\n" if vendor is not Ollama else b"\n")
    said = vendor.error("overloaded_error", f"busy, {KEY}")
    raw = (
        begun[0]
        + begun[1]
        + (events(said, named="type" in said) if vendor is not Ollama else json.dumps(said).encode())
    )
    peer.script = lambda received: send_stream(vendor, received, raw)
    with pytest.raises(ServiceError, match="busy") as caught:
        ask(make(vendor, peer, retries=RetryPolicy(1)), a_prompt)
    assert KEY not in str(caught.value)


@VENDORS
def test_it_stops_in_the_middle_of_a_reply(vendor, peer, a_prompt):
    leave = threading.Event()

    def script(received):
        send_stream(vendor, received, vendor.stream(["{" * 50])[:200])
        leave.wait(10)

    peer.script = script
    cancel = threading.Event()
    timer = threading.Timer(0.2, cancel.set)
    timer.start()
    with pytest.raises(Cancelled):
        make(vendor, peer).answer(a_prompt, cancel)
    leave.set()
    timer.join()


# What is sent ---------------------------------------------------------------------------------------------------


@VENDORS
def test_the_key_goes_into_its_header_and_nowhere_else(vendor, peer, a_prompt):
    peer.script = lambda received: received.reply(200, vendor.whole("{}"))
    client = make(vendor, peer)
    ask(client, a_prompt)
    [received] = peer.received
    held = {name for name, value in received.headers.items() if KEY in value}
    assert held == {vendor.key_header}
    assert KEY not in received.line + json.dumps(received.body) + repr(client)
    assert not {"temperature", "top_p", "top_k", "seed"} & (set(received.body) | set(received.body.get("options", {})))


def test_what_anthropic_is_sent(peer, a_prompt):
    peer.script = lambda received: received.reply(200, Anthropic.whole("{}"))
    ask(make(Anthropic, peer), a_prompt)
    [received] = peer.received
    assert received.line == "POST /v1/messages HTTP/1.1" and received.headers["anthropic-version"]
    picture, text = received.body["messages"][0]["content"]
    assert picture["source"]["media_type"] == "image/png"
    assert base64.b64decode(picture["source"]["data"]) == a_prompt.images[0]
    assert text == {"type": "text", "text": a_prompt.text}
    assert received.body["output_config"] == {"format": {"type": "json_schema", "schema": a_prompt.schema}}
    assert received.body["max_tokens"] > 8000 and received.body["stream"] is True


def test_what_gemini_is_sent(peer, a_prompt):
    peer.script = lambda received: received.reply(200, Gemini.whole("{}"))
    ask(make(Gemini, peer, model="models/gemini-x"), a_prompt)
    [received] = peer.received
    assert received.line == "POST /v1beta/models/gemini-x:streamGenerateContent?alt=sse HTTP/1.1"
    picture, text = received.body["contents"][0]["parts"]
    assert base64.b64decode(picture["inline_data"]["data"]) == a_prompt.images[0]
    assert text == {"text": a_prompt.text}
    asked = received.body["generationConfig"]
    assert asked == {"responseMimeType": "application/json", "responseJsonSchema": a_prompt.schema}


def test_what_ollama_is_sent(peer, a_prompt):
    peer.script = lambda received: received.reply(200, Ollama.whole("{}"))
    ask(make(Ollama, peer), a_prompt)
    [received] = peer.received
    assert received.line == "POST /api/chat HTTP/1.1"
    [message] = received.body["messages"]
    assert base64.b64decode(message["images"][0]) == a_prompt.images[0]
    assert message["content"].startswith(a_prompt.text) and '"additionalProperties":false' in message["content"]
    assert received.body["format"] == a_prompt.schema and received.body["options"]["num_ctx"] >= 16384


def test_ollamas_context_holds_a_long_prompt_with_many_pictures(a_prompt):
    long = replace(a_prompt, text="word " * 12_000, images=(b"x",) * 5)
    assert context_length(long) >= 60_000 // 4 + 5 * 1500 + 8000 and context_length(long) % 4096 == 0


@pytest.mark.parametrize(
    "client, given, expected",
    [
        (AnthropicClient, "https://api.anthropic.com", "https://api.anthropic.com/v1"),
        (AnthropicClient, "https://api.anthropic.com/v1/messages", "https://api.anthropic.com/v1"),
        (GeminiClient, "https://g.example", "https://g.example/v1beta"),
        (GeminiClient, "https://g.example/v1beta/models/", "https://g.example/v1beta"),
        (OllamaClient, "http://localhost:11434/", "http://localhost:11434"),
        (OllamaClient, "http://localhost:11434/api/chat", "http://localhost:11434"),
        (OllamaClient, "http://localhost:11434/v1", "http://localhost:11434"),
    ],
)
def test_base_urls_as_people_paste_them(client, given, expected):
    assert client(given, "m").base_url == expected


# What services refuse -------------------------------------------------------------------------------------------


def test_an_older_claude_without_structured_output_gets_the_schema_in_words(peer, a_prompt):
    def script(received):
        if "output_config" in received.body:
            said = "output_config: Extra inputs are not permitted"
            received.reply(400, Anthropic.error("invalid_request_error", said))
        else:
            received.reply(200, Anthropic.whole("{}"))

    peer.script = script
    client = make(Anthropic, peer)
    assert ask(client, a_prompt).text == ask(client, a_prompt).text == "{}"
    assert len(peer.received) == 3 and client.structure == "none"
    assert "JSON schema" in peer.received[-1].body["messages"][0]["content"][-1]["text"]


def test_a_model_with_shorter_answers_is_asked_for_as_much_as_it_gives(peer, a_prompt):
    def script(received):
        if received.body["max_tokens"] > 8192:
            said = f"max_tokens: {received.body['max_tokens']} > 8192, which is the maximum allowed number of output tokens"
            received.reply(400, Anthropic.error("invalid_request_error", said))
        else:
            received.reply(200, Anthropic.whole("{}"))

    peer.script = script
    assert ask(make(Anthropic, peer), a_prompt).text == "{}"
    assert [r.body["max_tokens"] for r in peer.received][1:] == [8192]


def test_gemini_falls_back_to_its_older_schema_and_then_to_words(peer, a_prompt):
    def script(received):
        config = received.body.get("generationConfig", {})
        if "responseJsonSchema" in config:
            said = "Invalid JSON payload received. Unknown name \"responseJsonSchema\" at 'generation_config'"
            received.reply(400, Gemini.error("INVALID_ARGUMENT", said))
        elif "responseSchema" in config:
            received.reply(400, Gemini.error("INVALID_ARGUMENT", "The specified schema produces too many states"))
        else:
            received.reply(200, Gemini.whole("{}"))

    peer.script = script
    client = make(Gemini, peer)
    assert ask(client, a_prompt).text == "{}" and client.structure == "object"
    older = peer.received[1].body["generationConfig"]["responseSchema"]
    assert "additionalProperties" not in json.dumps(older) and older["required"] == ["a"]


def test_an_ollama_without_schemas_is_asked_for_any_json(peer, a_prompt):
    def script(received):
        if isinstance(received.body.get("format"), dict):
            received.reply(
                400, {"error": "json: cannot unmarshal object into Go struct field ChatRequest.format of type string"}
            )
        else:
            received.reply(200, Ollama.whole("{}"))

    peer.script = script
    assert ask(make(Ollama, peer), a_prompt).text == "{}"
    assert peer.received[-1].body["format"] == "json"


# Statuses -------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "vendor, status, body, kind",
    [
        (Anthropic, 401, Anthropic.error("authentication_error", "invalid x-api-key"), "key"),
        (Anthropic, 403, Anthropic.error("permission_error", "not allowed"), "key"),
        (Anthropic, 404, Anthropic.error("not_found_error", "model: claude-nope"), "model"),
        (Anthropic, 400, Anthropic.error("invalid_request_error", "Your credit balance is too low"), "money"),
        (Gemini, 400, Gemini.error("INVALID_ARGUMENT", "API key not valid. Please pass a valid API key."), "key"),
        (Gemini, 403, Gemini.error("PERMISSION_DENIED", "Generative Language API has not been used"), "key"),
        (Gemini, 404, Gemini.error("NOT_FOUND", "models/nope is not found for API version v1beta"), "model"),
        (Gemini, 429, Gemini.error("RESOURCE_EXHAUSTED", "You exceeded your current quota"), "money"),
        (Ollama, 404, Ollama.error("", "model 'nope' not found"), "model"),
        (Ollama, 400, Ollama.error("", '"nope" does not support images'), "pictures"),
    ],
)
def test_refusals_are_named_in_the_services_words_and_not_tried_again(vendor, status, body, kind, peer, a_prompt):
    peer.script = lambda received: received.reply(status, body)
    with pytest.raises(ServiceError) as caught:
        ask(make(vendor, peer), a_prompt)
    said = body["error"]["message"] if isinstance(body["error"], dict) else body["error"]
    assert (
        caught.value.kind == kind and said.split('"')[-1].strip(" .") in str(caught.value) and len(peer.received) == 1
    )


def test_an_overloaded_claude_is_asked_again(peer, a_prompt):
    def script(received):
        if received.number < 2:
            received.reply(529, Anthropic.error("overloaded_error", "Overloaded"))
        else:
            received.reply(200, Anthropic.whole("{}"))

    peer.script = script
    assert ask(make(Anthropic, peer), a_prompt).text == "{}"


def test_geminis_limit_of_a_minute_is_waited_for_and_not_taken_for_money(peer, a_prompt):
    quota = {"violations": [{"quotaId": "GenerateRequestsPerMinutePerProjectPerModel-FreeTier"}]}
    limit = Gemini.error("RESOURCE_EXHAUSTED", "You exceeded your current quota, please check your plan and billing")
    limit["error"]["details"] = [quota, {"retryDelay": "0.01s"}]

    def script(received):
        received.reply(*((429, limit) if received.number == 0 else (200, Gemini.whole("{}"))))

    peer.script = script
    assert ask(make(Gemini, peer), a_prompt).text == "{}"
    day = json.loads(json.dumps(limit).replace("PerMinute", "PerDay"))
    peer.script = lambda received: received.reply(429, day)
    with pytest.raises(ServiceError) as caught:
        ask(make(Gemini, peer), a_prompt)
    assert caught.value.kind == "money"


def test_openrouter_is_asked_for_the_cost_and_for_a_backend_that_keeps_to_the_schema(a_prompt):
    client = OpenAIStyleClient("https://openrouter.ai/api/v1", "maker/model", KEY)
    body = client.body(a_prompt, client.first_habits)
    assert body["usage"] == {"include": True} and body["provider"] == {"require_parameters": True}
