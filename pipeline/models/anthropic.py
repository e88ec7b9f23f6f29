# SPDX-License-Identifier: GPL-3.0-or-later
"""Anthropic's `/v1/messages`."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from .base import Prompt
from .faults import Fault
from .http_client import Habits, HttpClient, halves, picture_kind, picture_text
from .reply_reader import Ending, ReplyReader, count
from .sight import Sight, sight_of_claude

VERSION = "2023-06-01"
_MOST_TOKENS = 32_000
"""On models that think, this covers thinking and answer. Older models take less, and say how much."""
_LIMIT = re.compile(r"max_tokens\D{1,20}\d+\s*>\s*(\d+)")
_ENDINGS: dict[str, Ending] = {
    "max_tokens": "cut",
    "model_context_window_exceeded": "cut",
    "refusal": "refused",
}


class AnthropicReader(ReplyReader):
    """Knows `content` blocks, `message_start`, `content_block_delta`, `message_delta` and `message_stop`."""

    shape_fix = "Check that the base URL is https://api.anthropic.com, or choose another provider."

    def take(self, data: dict[str, Any]) -> bool:
        """One event of a stream, or a whole message."""
        kind = data.get("type")
        if kind == "message" and isinstance(data.get("content"), list):
            self._message(data)
            self.text += [b["text"] for b in data["content"] if _is_text(b)]
            return True
        if kind == "message_start" and isinstance(data.get("message"), dict):
            self._message(data["message"])
        elif kind == "content_block_start" and _is_text(data.get("content_block")):
            self.text.append(data["content_block"]["text"])
        elif kind == "content_block_delta" and isinstance(data.get("delta"), dict):
            delta = data["delta"]
            if delta.get("type") == "text_delta" and isinstance(delta.get("text"), str):
                self.text.append(delta["text"])
        elif kind == "message_delta":
            self._end(data.get("delta"))
            self._usage(data.get("usage"))
        elif kind == "message_stop":
            self.done = True
        return isinstance(kind, str)

    def _message(self, message: dict[str, Any]) -> None:
        if isinstance(message.get("model"), str):
            self.model = message["model"]
        self._end(message)
        self._usage(message.get("usage"))

    def _end(self, holder: Any) -> None:
        reason = holder.get("stop_reason") if isinstance(holder, dict) else None
        if isinstance(reason, str):
            self.ending = _ENDINGS.get(reason, "stop")

    def _usage(self, usage: Any) -> None:
        if not isinstance(usage, dict):
            return
        names = ("input_tokens", "cache_creation_input_tokens", "cache_read_input_tokens")
        sent, written, cached = (count(usage.get(name)) for name in names)
        # The last event repeats what the first one counted, with the answer's tokens so far.
        self.prompt_tokens = max(self.prompt_tokens, sent + written + cached)
        self.cached_tokens = max(self.cached_tokens, cached)
        self.written_tokens = max(self.written_tokens, written)
        self.completion_tokens = max(self.completion_tokens, count(usage.get("output_tokens")))


class AnthropicClient(HttpClient):
    """`x-api-key`, pictures before text, `output_config.format`, a longest answer that has to be given."""

    vendor = "anthropic"
    endpoints = ("/messages",)
    key_header = "x-api-key"
    reader = AnthropicReader
    structures = ("schema", "none")
    structure_words = ("output_config", "output_format", "json_schema", "json schema", "schema", "structured")
    first_habits = Habits(most_tokens=_MOST_TOKENS)

    def url(self, habits: Habits) -> str:
        """Where a prompt is sent."""
        return f"{self.base_url}/messages"

    def headers(self) -> Mapping[str, str]:
        """The version of the interface that this client was written for."""
        return {"anthropic-version": VERSION}

    def body(self, prompt: Prompt, habits: Habits) -> dict[str, Any]:
        """The request's body."""
        shared, rest = halves(prompt, in_words=habits.structure != "schema")
        content: list[dict[str, Any]] = [
            {
                "type": "image",
                "source": {"type": "base64", "media_type": picture_kind(image), "data": picture_text(image)},
            }
            for image in prompt.images
        ]
        content.append({"type": "text", "text": rest})
        body: dict[str, Any] = {
            "model": self.model,
            "max_tokens": habits.most_tokens,
            "messages": [{"role": "user", "content": content}],
        }
        if shared:
            # What is kept must come first, and pictures stand before the text of their message: so it is a system prompt.
            marked = {"cache_control": {"type": "ephemeral"}} if habits.cache else {}
            body["system"] = [{"type": "text", "text": shared, **marked}]
        if habits.structure == "schema" and not prompt.plain:
            body["output_config"] = {"format": {"type": "json_schema", "schema": dict(prompt.schema)}}
        if habits.stream:
            body["stream"] = True
        return body

    @property
    def sight(self) -> Sight:
        """What this model sees of a picture."""
        return sight_of_claude(self.model)

    @property
    def keeps_marked(self) -> bool:
        """A marked beginning is kept from the first answer's begin on."""
        return self._habits.cache

    def humbler(self, habits: Habits, fault: Fault) -> Habits | None:
        """Also a shorter answer, where the model says that it cannot write such a long one; and no mark for its cache."""
        if habits.cache and fault.error.status == 400 and "cache_control" in fault.sentence.lower():
            return replace(habits, cache=False)
        most = _LIMIT.search(fault.sentence) if fault.error.status == 400 else None
        if most and 256 <= int(most.group(1)) < habits.most_tokens:
            return replace(habits, most_tokens=int(most.group(1)))
        return super().humbler(habits, fault)


def _is_text(block: Any) -> bool:
    return isinstance(block, dict) and block.get("type") == "text" and isinstance(block.get("text"), str)
