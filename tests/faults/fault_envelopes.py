# SPDX-License-Identifier: GPL-3.0-or-later
"""Replies as the services write them, by hand from the vendors' documentation: whole, streamed, and as errors.

All of them say the same: the text that was asked for, from "served-model", with 11 tokens in and 7 out.
"""

from __future__ import annotations

import base64
import io
import json
import threading
from collections.abc import Sequence
from typing import Any

from code_as_room.pipeline.models.anthropic import AnthropicClient
from code_as_room.pipeline.models.base import Prompt
from code_as_room.pipeline.models.gemini import GeminiClient
from code_as_room.pipeline.models.image_base import ImageRequest
from code_as_room.pipeline.models.image_gemini import GeminiImageClient
from code_as_room.pipeline.models.image_openai import OpenAIImageClient
from code_as_room.pipeline.models.ollama import OllamaClient
from code_as_room.pipeline.models.openai_style import OpenAIStyleClient
from PIL import Image

KEY = "sk-test-0123456789abcdef"
MODEL = "served-model"


def events(*payloads: Any, named: bool = False) -> bytes:
    """Server-sent events with these data."""
    lines = [(f"event: {p['type']}\n" if named else "") + f"data: {json.dumps(p)}\n\n" for p in payloads]
    return "".join(lines).encode()


class Vendor:
    """What a test needs of one kind of service; subclasses are used as they are, without instances."""

    name = ""
    client: Any = None
    base = "/v1"
    key_header = "authorization"
    kind = "text/event-stream"
    cut, refused = "", ""
    chat = True

    @classmethod
    def make(cls, url: str, **options: Any) -> Any:
        """A client of the service at `url` (a server's address without the vendor's own path)."""
        return cls.client(f"{url}{cls.base}", "some-model", KEY, **options)

    @classmethod
    def ask(cls, client: Any, prompt: Prompt, cancel: threading.Event | None = None) -> Any:
        """What the client gives: a text, or an image's bytes."""
        return client.answer(prompt, cancel or threading.Event()).text

    @staticmethod
    def whole(text: Any, ending: str = "") -> dict[str, Any]:
        """A reply in one piece."""
        raise NotImplementedError

    @staticmethod
    def stream(texts: Sequence[Any], ending: str = "") -> bytes:
        """The body of a streamed reply."""
        raise NotImplementedError

    @staticmethod
    def error(kind: str, said: str) -> dict[str, Any]:
        """An error's body."""
        raise NotImplementedError


class OpenAI(Vendor):
    name, client = "openai", OpenAIStyleClient
    cut, refused = "length", "content_filter"

    @staticmethod
    def whole(text: Any, ending: str = "stop") -> dict[str, Any]:
        message = {"role": "assistant", "content": text, "refusal": None, "annotations": []}
        return {
            "id": "chatcmpl-1",
            "object": "chat.completion",
            "created": 1_790_000_000,
            "model": MODEL,
            "choices": [{"index": 0, "message": message, "logprobs": None, "finish_reason": ending}],
            "usage": {
                "prompt_tokens": 11,
                "completion_tokens": 7,
                "total_tokens": 18,
                "prompt_tokens_details": {"cached_tokens": 0, "audio_tokens": 0},
                "completion_tokens_details": {"reasoning_tokens": 0, "audio_tokens": 0},
            },
            "service_tier": "default",
            "system_fingerprint": "fp_1",
        }

    @staticmethod
    def chunk(delta: dict[str, Any] | None, ending: str | None = None, **extra: Any) -> dict[str, Any]:
        """One chunk of a stream; without a delta the last one, which has the usage."""
        choice = {"index": 0, "delta": delta, "logprobs": None, "finish_reason": ending}
        return {
            "id": "chatcmpl-1",
            "object": "chat.completion.chunk",
            "created": 1_790_000_000,
            "model": MODEL,
            "system_fingerprint": "fp_1",
            "choices": [] if delta is None else [choice],
            "usage": None,
            **extra,
        }

    @staticmethod
    def stream(texts: Sequence[Any], ending: str = "stop") -> bytes:
        usage = {"prompt_tokens": 11, "completion_tokens": 7, "total_tokens": 18}
        chunks = [OpenAI.chunk({"role": "assistant", "content": "", "refusal": None})]
        chunks += [OpenAI.chunk({"content": text}) for text in texts]
        return events(*chunks, OpenAI.chunk({}, ending), OpenAI.chunk(None, usage=usage)) + b"data: [DONE]\n\n"

    @staticmethod
    def error(kind: str, said: str) -> dict[str, Any]:
        return {"error": {"message": said, "type": kind, "param": None, "code": None}}


class Anthropic(Vendor):
    name, client, key_header = "anthropic", AnthropicClient, "x-api-key"
    cut, refused = "max_tokens", "refusal"

    @staticmethod
    def whole(text: Any, ending: str = "end_turn") -> dict[str, Any]:
        return {
            "id": "msg_1",
            "type": "message",
            "role": "assistant",
            "model": MODEL,
            "content": [{"type": "thinking", "thinking": "hm", "signature": "s"}, {"type": "text", "text": text}],
            "stop_reason": ending,
            "stop_sequence": None,
            "usage": {
                "input_tokens": 8,
                "cache_creation_input_tokens": 2,
                "cache_read_input_tokens": 1,
                "output_tokens": 7,
            },
        }

    @staticmethod
    def stream(texts: Sequence[Any], ending: str = "end_turn") -> bytes:
        start = {**Anthropic.whole("", ""), "content": [], "stop_reason": None}
        start["usage"] = {**start["usage"], "output_tokens": 1}
        thinking = {"type": "thinking", "thinking": "", "signature": ""}
        thought = {"type": "thinking_delta", "thinking": "{"}
        deltas = [{"type": "text_delta", "text": text} for text in texts]
        return events(
            {"type": "message_start", "message": start},
            {"type": "ping"},
            {"type": "content_block_start", "index": 0, "content_block": thinking},
            {"type": "content_block_delta", "index": 0, "delta": thought},
            {"type": "content_block_stop", "index": 0},
            {"type": "content_block_start", "index": 1, "content_block": {"type": "text", "text": ""}},
            *({"type": "content_block_delta", "index": 1, "delta": delta} for delta in deltas),
            {"type": "content_block_stop", "index": 1},
            {
                "type": "message_delta",
                "delta": {"stop_reason": ending, "stop_sequence": None},
                "usage": {"output_tokens": 7},
            },
            {"type": "message_stop"},
            named=True,
        )

    @staticmethod
    def error(kind: str, said: str) -> dict[str, Any]:
        return {"type": "error", "error": {"type": kind, "message": said}, "request_id": "req_1"}


class Gemini(Vendor):
    name, client, base, key_header = "gemini", GeminiClient, "/v1beta", "x-goog-api-key"
    cut, refused = "MAX_TOKENS", "SAFETY"

    @staticmethod
    def whole(text: Any, ending: str = "STOP") -> dict[str, Any]:
        parts = [{"text": "thinking of {", "thought": True}, {"text": text}]
        return {
            "candidates": [{"content": {"parts": parts, "role": "model"}, "finishReason": ending, "index": 0}],
            "usageMetadata": {
                "promptTokenCount": 11,
                "candidatesTokenCount": 4,
                "thoughtsTokenCount": 3,
                "totalTokenCount": 18,
            },
            "modelVersion": MODEL,
            "responseId": "x",
        }

    @staticmethod
    def stream(texts: Sequence[Any], ending: str = "STOP") -> bytes:
        chunks = []
        for text in texts:
            chunk = Gemini.whole(text, ending)
            del chunk["candidates"][0]["finishReason"]
            chunks.append(chunk)
        return events(*chunks, Gemini.whole("", ending))

    @staticmethod
    def error(kind: str, said: str) -> dict[str, Any]:
        return {"error": {"code": 400, "message": said, "status": kind}}


class Ollama(Vendor):
    name, client, base = "ollama", OllamaClient, ""
    kind = "application/x-ndjson"
    cut = "length"

    @staticmethod
    def whole(text: Any, ending: str = "stop") -> dict[str, Any]:
        return {
            "model": MODEL,
            "created_at": "2026-11-22T00:00:00Z",
            "message": {"role": "assistant", "content": text, "thinking": "{"},
            "done": True,
            "done_reason": ending,
            "total_duration": 5_000_000,
            "load_duration": 1_000_000,
            "prompt_eval_count": 11,
            "prompt_eval_duration": 1_000_000,
            "eval_count": 7,
            "eval_duration": 3_000_000,
        }

    @staticmethod
    def stream(texts: Sequence[Any], ending: str = "stop") -> bytes:
        begun = {"model": MODEL, "created_at": "2026-11-22T00:00:00Z", "done": False}
        lines = [{**begun, "message": {"role": "assistant", "content": text}} for text in texts]
        return "".join(json.dumps(line) + "\n" for line in [*lines, Ollama.whole("", ending)]).encode()

    @staticmethod
    def error(kind: str, said: str) -> dict[str, Any]:
        return {"error": said}


def png(size: tuple[int, int] = (64, 64), kind: str = "PNG", colour: str = "#AA8866") -> bytes:
    """An encoded picture of one colour."""
    buffer = io.BytesIO()
    Image.new("RGB", size, colour).save(buffer, kind)
    return buffer.getvalue()


class _Images(Vendor):
    chat = False

    @classmethod
    def ask(cls, client: Any, prompt: Prompt, cancel: threading.Event | None = None) -> Any:
        return client.paint(ImageRequest(prompt.text), cancel or threading.Event()).data


class OpenAIImages(_Images):
    name, client = "openai_images", OpenAIImageClient

    @staticmethod
    def whole(text: Any, ending: str = "") -> dict[str, Any]:
        """`text` is an image's bytes, or what stands in the place of their base64."""
        data = base64.b64encode(text).decode() if isinstance(text, bytes) else text
        return {
            "created": 1_790_000_000,
            "data": [{"b64_json": data}],
            "usage": {
                "input_tokens": 11,
                "output_tokens": 1056,
                "total_tokens": 1067,
                "input_tokens_details": {"image_tokens": 0, "text_tokens": 11},
            },
        }

    error = staticmethod(OpenAI.error)


class GeminiImages(_Images):
    name, client, base, key_header = "gemini_images", GeminiImageClient, "/v1beta", "x-goog-api-key"

    @staticmethod
    def whole(text: Any, ending: str = "STOP") -> dict[str, Any]:
        """`text` is an image's bytes, or what stands in the place of their base64."""
        data = base64.b64encode(text).decode() if isinstance(text, bytes) else text
        parts = [{"text": "Here it is."}, {"inlineData": {"mimeType": "image/png", "data": data}}]
        return {
            **Gemini.whole("", ending),
            "candidates": [{**_CANDIDATE, "content": {"parts": parts, "role": "model"}}],
        }

    error = staticmethod(Gemini.error)


_CANDIDATE: dict[str, Any] = {"finishReason": "STOP", "index": 0}
CHATS: tuple[type[Vendor], ...] = (OpenAI, Anthropic, Gemini, Ollama)
IMAGES: tuple[type[Vendor], ...] = (OpenAIImages, GeminiImages)
VENDORS = CHATS + IMAGES


def a_prompt(text: str = "What is a?") -> Prompt:
    """A small prompt with one picture and a schema."""
    schema = {
        "type": "object",
        "properties": {"a": {"type": "number"}},
        "required": ["a"],
        "additionalProperties": False,
    }
    return Prompt("s01", "01_test", text, (png((8, 8)),), "Answer", schema, "0" * 64)
