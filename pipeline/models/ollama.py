# SPDX-License-Identifier: GPL-3.0-or-later
"""Ollama's own `/api/chat`. Unlike its OpenAI-style address it takes the context's length, which is short otherwise."""

from __future__ import annotations

import json
from typing import Any

from .base import Prompt
from .http_client import Habits, HttpClient, picture_text, with_schema
from .reply_reader import ReplyReader, count

_LEAST_CONTEXT = 16_384
_ANSWER_TOKENS, _PLAIN_ANSWER_TOKENS = 10_000, 24_000
_PICTURE_TOKENS = 2_500
_BYTES_A_TOKEN = 3


class OllamaReader(ReplyReader):
    """One JSON object a line, the last one with `done`; or one object in all."""

    shape_fix = "Check that the base URL is that of Ollama, such as http://localhost:11434."

    def __init__(self, host: str, key: str, plain: bool = False) -> None:
        super().__init__(host, key, plain)
        self._begin = 0
        """Where in the body the line begins that is not whole yet."""

    def feed(self, piece: bytes) -> bool:
        """Take a piece of the body; True when the reply is complete."""
        self._body += piece
        end = self._body.rfind(b"\n", len(self._body) - len(piece))
        if end >= 0:
            lines, self._begin = bytes(self._body[self._begin : end]).split(b"\n"), end + 1
            for line in lines:
                self._take_line(line)
        return self.done or self._error is not None

    def finish(self, content_type: str, model: str) -> Any:
        """As `ReplyReader.finish`."""
        if not self.done and self._error is None:
            self._take_line(bytes(self._body[self._begin :]))
        if self._known or self._error is not None:
            if self._error is None and not self.done:
                raise self.broken()
            if self._error is not None:
                raise self._error
            return self._reply(model)
        # Not a line of it was Ollama's: say what it is.
        self._streamed = False
        reply = super().finish(content_type, model)
        return reply

    def _take_line(self, line: bytes) -> None:
        if self.done or not line.strip():
            return
        try:
            data = json.loads(line)
        except (ValueError, RecursionError):
            if self._known:
                self._error = self._error or self.broken()
            return
        self.chunk(data)

    def take(self, data: dict[str, Any]) -> bool:
        """One line, or a whole reply."""
        message = data.get("message")
        if not isinstance(message, dict) and "done" not in data:
            return False
        if isinstance(data.get("model"), str):
            self.model = data["model"]
        if isinstance(message, dict) and isinstance(message.get("content"), str):
            self.text.append(message["content"])
        if data.get("done") is True:
            self.done = True
            self.ending = "cut" if data.get("done_reason") == "length" else "stop"
            self.prompt_tokens = count(data.get("prompt_eval_count"))
            self.completion_tokens = count(data.get("eval_count"))
        return True


class OllamaClient(HttpClient):
    """No key (unless given), `images` beside the text, `format`, and a context long enough for the question."""

    vendor = "ollama"
    default_path = ""
    endpoints = ("/api/chat", "/api", "/v1")
    reader = OllamaReader
    structures = ("schema", "object", "none")
    structure_words = ("format", "schema", "grammar", "structured")

    def url(self, habits: Habits) -> str:
        """Where a prompt is sent."""
        return f"{self.base_url}/api/chat"

    def body(self, prompt: Prompt, habits: Habits) -> dict[str, Any]:
        """The request's body. The schema stands in the text as well: models follow it better when they see it."""
        message: dict[str, Any] = {"role": "user", "content": with_schema(prompt)}
        if prompt.images:
            message["images"] = [picture_text(image) for image in prompt.images]
        body: dict[str, Any] = {
            "model": self.model,
            "messages": [message],
            "stream": habits.stream,
            "options": {"num_ctx": context_length(prompt)},
        }
        if prompt.plain:
            return body
        if habits.structure == "schema":
            body["format"] = dict(prompt.schema)
        elif habits.structure == "object":
            body["format"] = "json"
        return body


def context_length(prompt: Prompt) -> int:
    """Tokens of context that a question and its answer need, in steps of 4096; Ollama cuts a longer prompt silently.

    A change of it makes Ollama load the model anew, hence the steps and the large least.
    """
    text = len(with_schema(prompt).encode()) // _BYTES_A_TOKEN
    answer = _PLAIN_ANSWER_TOKENS if prompt.plain else _ANSWER_TOKENS
    needed = text + _PICTURE_TOKENS * len(prompt.images) + answer
    return max(_LEAST_CONTEXT, -(-needed // 4096) * 4096)
