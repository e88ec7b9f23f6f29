# SPDX-License-Identifier: GPL-3.0-or-later
"""What our clients send fits the vendors' own types of a request, in every form that a service can bring them to."""

from __future__ import annotations

import base64
import json
import threading
from dataclasses import replace
from typing import Any

from anthropic.types import message_create_params as messages
from code_as_room.pipeline.artifacts import objects, replies
from code_as_room.pipeline.models.anthropic import VERSION
from code_as_room.pipeline.models.base import Prompt
from code_as_room.pipeline.models.image_base import ImageRequest
from code_as_room.pipeline.models.schema import strict_schema
from fault_cases import PICTURE, TEXT
from fault_envelopes import KEY, Anthropic, Gemini, GeminiImages, Ollama, OpenAI, OpenAIImages, Vendor, a_prompt
from fault_server import Peer, Received
from google.genai import types as google
from ollama._types import ChatRequest
from openai.types import image_generate_params as images
from openai.types.chat import completion_create_params as completions
from sdk_types import misfits
from test_sdk_replies import anthropic_client, gemini_client

KINDS = (
    *(
        replies.AnalysisReply,
        replies.SecondLookReply,
        replies.GraphReply,
        replies.CritiqueReply,
        replies.AuxiliaryReply,
    ),
    *(objects.DescriptionsReply, objects.PiecesReply, objects.ProgramsReply),
)


def prompts() -> list[Prompt]:
    """A prompt for each type of answer, some without pictures, and one whose beginning others share."""
    plain = a_prompt()
    kinds = [
        replace(plain, schema_name=kind.__name__, schema=strict_schema(kind), images=(PICTURE,) * (number % 3))
        for number, kind in enumerate(KINDS)
    ]
    return [plain, replace(plain, shared=len(plain.text) // 2), *kinds]


def sent(vendor: type[Vendor], peer: Peer) -> list[dict[str, Any]]:
    """The bodies of requests in every form: with all habits, and after each refusal that leads to a humbler one."""
    client = vendor.make(peer.place("x", lambda received: received.reply(200, vendor.whole(TEXT))).url)
    structures = client.structures
    bodies = []
    for prompt in prompts():
        for structure in structures:
            for stream in (True, False):
                habits = replace(client.first_habits, structure=structure, stream=stream)
                bodies.append(json.loads(json.dumps(client.body(prompt, habits))))
    client.answer(prompts()[0], threading.Event())
    bodies.append(peer.places["x"].received[-1].body)
    return bodies


def test_openai_style(peer: Peer) -> None:
    for body in sent(OpenAI, peer):
        kind = (
            completions.CompletionCreateParamsStreaming
            if body.get("stream")
            else completions.CompletionCreateParamsNonStreaming
        )
        assert misfits(body, kind) == []


def test_anthropic(peer: Peer) -> None:
    for body in sent(Anthropic, peer):
        kind = messages.MessageCreateParamsStreaming if body.get("stream") else messages.MessageCreateParamsNonStreaming
        assert misfits(body, kind) == []


def test_gemini(peer: Peer) -> None:
    for body in sent(Gemini, peer):
        assert set(body) <= {"contents", "generationConfig", "systemInstruction"}
        for content in body["contents"]:
            google.Content.model_validate(content)
        google.GenerationConfig.model_validate(body.get("generationConfig", {}))


def test_ollama(peer: Peer) -> None:
    for body in sent(Ollama, peer):
        read = ChatRequest.model_validate(body).model_dump(exclude_none=True, mode="json")
        assert read == body


def test_images(peer: Peer) -> None:
    for shape in ("square", "wide", "tall"):
        request = ImageRequest("oak", shape)  # type: ignore[arg-type]
        body = OpenAIImages.make("http://127.0.0.1:9").body(request)
        assert misfits(body, images.ImageGenerateParamsNonStreaming) == []
        body = GeminiImages.make("http://127.0.0.1:9").body(request)
        google.GenerateContentConfig.model_validate(body["generationConfig"])
        [content] = body["contents"]
        google.Content.model_validate(content)


def _camel(value: Any) -> Any:
    """Names as Google's services take them either way, in one spelling."""
    if isinstance(value, dict):
        spelt = {}
        for key, item in value.items():
            first, *rest = key.split("_")
            spelt[first + "".join(word.capitalize() for word in rest)] = _camel(item)
        return spelt
    return [_camel(item) for item in value] if isinstance(value, list) else value


def test_gemini_is_sent_what_its_own_library_sends(peer: Peer) -> None:
    """The library is asked the same question; the two bodies are the same."""
    prompt = a_prompt()
    place = peer.place("gemini", lambda received: received.reply(200, Gemini.whole(TEXT)))
    gemini_client(place.url).models.generate_content(
        model="some-model",
        contents=[
            google.Part.from_bytes(data=prompt.images[0], mime_type="image/png"),
            google.Part.from_text(text=prompt.text),
        ],
        config=google.GenerateContentConfig(
            response_mime_type="application/json", response_json_schema=dict(prompt.schema)
        ),
    )
    client = Gemini.make(place.url)
    client.answer(prompt, threading.Event())
    theirs, ours = place.received
    assert _camel(ours.body) == _camel(theirs.body)
    assert ours.headers["x-goog-api-key"] == theirs.headers["x-goog-api-key"] == KEY
    image = GeminiImages.make(place.url)
    shown = google.GenerateContentConfig(
        response_modalities=["IMAGE"], image_config=google.ImageConfig(aspect_ratio="1:1")
    )
    gemini_client(place.url).models.generate_content(model="some-model", contents="oak", config=shown)
    assert _camel(image.body(ImageRequest("oak"))) == _camel(place.received[-1].body)


def test_anthropic_is_sent_what_its_own_library_sends(peer: Peer) -> None:
    prompt = a_prompt()
    place = peer.place("anthropic", lambda received: received.reply(200, Anthropic.whole(TEXT)))
    data = base64.b64encode(prompt.images[0]).decode()
    anthropic_client(place.url).messages.create(
        model="some-model",
        max_tokens=1000,
        messages=[
            {
                "role": "user",
                "content": [
                    {"type": "image", "source": {"type": "base64", "media_type": "image/png", "data": data}},
                    {"type": "text", "text": prompt.text},
                ],
            }
        ],
        output_config={"format": {"type": "json_schema", "schema": dict(prompt.schema)}},
    )
    Anthropic.make(place.url).answer(prompt, threading.Event())
    theirs, ours = place.received
    assert without(ours, "max_tokens", "stream") == without(theirs, "max_tokens")
    assert ours.line == theirs.line.replace("?beta=true", "")
    # Two differences that are known: the library (2.12) sends the key as a bearer token, while the vendor's guide shows
    # x-api-key with every version; and it asks for interface version 2026-10-21, we for the one of VERSION.
    assert ours.headers["x-api-key"] == KEY and KEY in " ".join(theirs.headers.values())
    assert ours.headers["anthropic-version"] == VERSION <= theirs.headers["anthropic-version"]


def without(received: Received, *names: str) -> dict[str, Any]:
    """A body without some of its fields, and without marks for the cache, which change nothing of what is asked."""

    def plain(value: Any) -> Any:
        if isinstance(value, dict):
            return {key: plain(item) for key, item in value.items() if key != "cache_control"}
        return [plain(item) for item in value] if isinstance(value, list) else value

    found = plain({key: value for key, value in received.body.items() if key not in names})
    assert isinstance(found, dict)
    return found


def test_the_check_itself_sees_what_does_not_fit() -> None:
    kind = completions.CompletionCreateParamsStreaming
    body = OpenAI.make("http://127.0.0.1:9").body(a_prompt(), OpenAI.client.first_habits)
    assert misfits({**body, "oops": 1}, kind) and misfits({**body, "messages": "hello"}, kind)
    assert misfits({**body, "model": 7}, kind) and misfits({k: v for k, v in body.items() if k != "model"}, kind)
