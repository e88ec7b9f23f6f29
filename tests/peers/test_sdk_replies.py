# SPDX-License-Identifier: GPL-3.0-or-later
"""What the vendors' own libraries read in our server's good answers, our clients read alike."""

from __future__ import annotations

import base64
import functools
import json
import threading
from collections.abc import Callable
from typing import Any

import anthropic
import ollama
import openai
import pytest
from code_as_room.pipeline.errors import CutReplyError
from code_as_room.pipeline.models.faults import ServiceError
from code_as_room.pipeline.models.image_base import ImageRequest
from code_as_room.pipeline.models.retry import RetryPolicy
from fault_bodies import TEXTS
from fault_cases import PICTURE, TEXT, chunked, http, sends
from fault_envelopes import CHATS, IMAGES, KEY, MODEL, Anthropic, Gemini, GeminiImages, Ollama, OpenAI, Vendor, a_prompt
from fault_server import Peer, Received
from google import genai
from google.genai import types as google
from openai.types import ImagesResponse
from openai.types.chat import ChatCompletion, ChatCompletionChunk
from pydantic import TypeAdapter

Read = tuple[str, str, int, int, str]
"""Text, model, tokens in, tokens out, why it ended."""
ASK = "What is a?"
ALL_CHATS = pytest.mark.parametrize("vendor", CHATS, ids=lambda vendor: vendor.name)


@functools.cache
def openai_client(url: str) -> openai.OpenAI:
    return openai.OpenAI(base_url=f"{url}/v1", api_key=KEY, max_retries=0)


def openai_reads(url: str, streamed: bool) -> Read:
    client = openai_client(url)
    asked: Any = {"model": "m", "messages": [{"role": "user", "content": ASK}]}
    if not streamed:
        whole = client.chat.completions.create(**asked)
        [choice], used = whole.choices, whole.usage
        assert used is not None
        return (
            choice.message.content or "",
            whole.model,
            used.prompt_tokens,
            used.completion_tokens,
            choice.finish_reason,
        )
    text, ending, tokens, model = "", "", (0, 0), ""
    for chunk in client.chat.completions.create(**asked, stream=True, stream_options={"include_usage": True}):
        model = chunk.model
        tokens = (chunk.usage.prompt_tokens, chunk.usage.completion_tokens) if chunk.usage else tokens
        for choice in chunk.choices:
            text += choice.delta.content or ""
            ending = choice.finish_reason or ending
    return text, model, *tokens, ending


@functools.cache
def anthropic_client(url: str) -> anthropic.Anthropic:
    return anthropic.Anthropic(base_url=url, api_key=KEY, max_retries=0)


def anthropic_reads(url: str, streamed: bool) -> Read:
    client = anthropic_client(url)
    asked: Any = {"model": "m", "max_tokens": 1000, "messages": [{"role": "user", "content": ASK}]}
    if streamed:
        with client.messages.stream(**asked) as stream:
            message = stream.get_final_message()
    else:
        message = client.messages.create(**asked)
    used = message.usage
    tokens = used.input_tokens + (used.cache_creation_input_tokens or 0) + (used.cache_read_input_tokens or 0)
    text = "".join(block.text for block in message.content if block.type == "text")
    return text, message.model, tokens, used.output_tokens, message.stop_reason or ""


@functools.cache
def gemini_client(url: str) -> genai.Client:
    return genai.Client(api_key=KEY, http_options=google.HttpOptions(base_url=url, api_version="v1beta"))


def gemini_reads(url: str, streamed: bool) -> Read:
    client = gemini_client(url)
    if streamed:
        parts = list(client.models.generate_content_stream(model="m", contents=ASK))
    else:
        parts = [client.models.generate_content(model="m", contents=ASK)]
    last = parts[-1]
    used = last.usage_metadata
    assert used is not None and last.candidates
    text = "".join(
        part.text or ""
        for reply in parts
        for candidate in reply.candidates or []
        for part in (candidate.content.parts if candidate.content else None) or []
        if not part.thought
    )
    out = (used.candidates_token_count or 0) + (used.thoughts_token_count or 0)
    ending = last.candidates[0].finish_reason
    return text, last.model_version or "", used.prompt_token_count or 0, out, ending.value if ending else ""


@functools.cache
def ollama_client(url: str) -> ollama.Client:
    return ollama.Client(host=url)


def ollama_reads(url: str, streamed: bool) -> Read:
    client = ollama_client(url)
    messages = [{"role": "user", "content": ASK}]
    parts = list(client.chat("m", messages, stream=True)) if streamed else [client.chat("m", messages)]
    text = "".join(part.message.content or "" for part in parts)
    last = parts[-1]
    return text, last.model or "", last.prompt_eval_count or 0, last.eval_count or 0, last.done_reason or ""


READS: dict[str, Callable[[str, bool], Read]] = {
    "openai": openai_reads,
    "anthropic": anthropic_reads,
    "gemini": gemini_reads,
    "ollama": ollama_reads,
}


def good_answers(vendor: type[Vendor], text: str) -> dict[str, tuple[Callable[[Received], None], bool]]:
    """Ways to send one text, and whether each is a stream."""
    raw = vendor.stream([text[:3], text[3:9], text[9:]])
    cut = http(raw, vendor.kind, length=False)
    return {
        "whole": (lambda received: received.reply(200, vendor.whole(text)), False),
        "chunks": (sends(chunked(_json(vendor.whole(text)), size=7)), False),
        "stream": (sends(cut), True),
        "stream chunks": (sends(chunked(raw, vendor.kind, size=11)), True),
        "dripping": (lambda received: received.drip(cut, 1 if len(raw) < 5000 else 1000), True),
        "lines": (sends(http(raw.replace(b"\n", b"\r\n"), vendor.kind, length=False)), True),
    }


def _json(payload: Any) -> bytes:
    return json.dumps(payload, ensure_ascii=False).encode()


@ALL_CHATS
@pytest.mark.parametrize("name", TEXTS)
def test_both_read_the_same(vendor: type[Vendor], name: str, peer: Peer) -> None:
    text = TEXTS[name]
    for way, (script, streamed) in good_answers(vendor, text).items():
        place = peer.place(vendor.name, script)
        theirs = READS[vendor.name](place.url, streamed)
        ours = vendor.make(place.url).answer(a_prompt(ASK), threading.Event())
        assert (ours.text, ours.model, ours.prompt_tokens, ours.completion_tokens) == theirs[:4], way
        assert theirs[:2] == (text, MODEL)


@ALL_CHATS
def test_what_they_call_cut_is_cut(vendor: type[Vendor], peer: Peer) -> None:
    for streamed in (False, True):
        body = vendor.stream([TEXT], vendor.cut) if streamed else _json(vendor.whole(TEXT, vendor.cut))
        place = peer.place(vendor.name, sends(http(body, vendor.kind, length=False)))
        assert READS[vendor.name](place.url, streamed)[4] == vendor.cut
        with pytest.raises(CutReplyError):
            vendor.make(place.url).answer(a_prompt(), threading.Event())


def test_our_servers_answers_are_of_the_libraries_own_types() -> None:
    """Strictly: the libraries themselves let almost anything pass."""
    ChatCompletion.model_validate(OpenAI.whole(TEXT), strict=True)
    for line in OpenAI.stream([TEXT]).decode().split("\n\n"):
        if line.startswith("data: {"):
            ChatCompletionChunk.model_validate_json(line[6:], strict=True)
    anthropic.types.Message.model_validate(Anthropic.whole(TEXT))
    events: Any = TypeAdapter(anthropic.types.RawMessageStreamEvent)
    for block in Anthropic.stream([TEXT]).decode().split("\n\n"):
        data = block.partition("data: ")[2]
        if data and '"ping"' not in data:
            events.validate_json(data)
    for reply in (Gemini.whole(TEXT), GeminiImages.whole(PICTURE)):
        google.GenerateContentResponse.model_validate(reply)
    ollama.ChatResponse.model_validate(Ollama.whole(TEXT))
    ImagesResponse.model_validate(IMAGES[0].whole(PICTURE), strict=True)


def test_both_take_the_same_image(peer: Peer) -> None:
    place = peer.place("image", lambda received: received.reply(200, IMAGES[0].whole(PICTURE)))
    made = openai_client(place.url).images.generate(model="m", prompt="oak").data
    assert made is not None and base64.b64decode(made[0].b64_json or "") == PICTURE
    assert IMAGES[0].make(place.url).paint(ImageRequest("oak"), threading.Event()).data == PICTURE
    place = peer.place("gemini-image", lambda received: received.reply(200, GeminiImages.whole(PICTURE)))
    reply = gemini_client(place.url).models.generate_content(model="m", contents="oak")
    assert [part.inline_data.data for part in reply.parts or [] if part.inline_data] == [PICTURE]
    assert GeminiImages.make(place.url).paint(ImageRequest("oak"), threading.Event()).data == PICTURE


STATUSES = {400: "request", 401: "key", 403: "key", 404: "model", 429: "rate", 500: "server", 503: "server"}
OPENAI_ERRORS: dict[int, type[Exception]] = {
    400: openai.BadRequestError,
    401: openai.AuthenticationError,
    403: openai.PermissionDeniedError,
    404: openai.NotFoundError,
    429: openai.RateLimitError,
    500: openai.InternalServerError,
    503: openai.InternalServerError,
}
THEIR_ERRORS: dict[str, Any] = {
    "openai": openai.APIStatusError,
    "anthropic": anthropic.APIStatusError,
    "gemini": genai.errors.APIError,
    "ollama": ollama.ResponseError,
}


@ALL_CHATS
@pytest.mark.parametrize("status", STATUSES)
def test_both_find_the_services_sentence(vendor: type[Vendor], status: int, peer: Peer) -> None:
    said = "The bench is being painted"
    place = peer.place(vendor.name, lambda r: r.reply(status, vendor.error("api_error", said)))
    with pytest.raises(THEIR_ERRORS[vendor.name], match=said) as theirs:
        READS[vendor.name](place.url, False)
    if vendor is OpenAI:
        assert isinstance(theirs.value, OPENAI_ERRORS[status])
    with pytest.raises(ServiceError, match=said) as ours:
        vendor.make(place.url, retries=RetryPolicy(1)).answer(a_prompt(), threading.Event())
    assert ours.value.kind == STATUSES[status]
