# SPDX-License-Identifier: GPL-3.0-or-later
"""The reply of an OpenAI-style chat service."""

from __future__ import annotations

from typing import Any

from .reply_reader import Ending, ReplyReader, count, text_of

_ENDINGS: dict[str, Ending] = {"length": "cut", "content_filter": "filter"}


class ChatReader(ReplyReader):
    """Knows `choices`, `delta` and `message`, `finish_reason`, `refusal` and `usage`."""

    kind = "chat"

    def take(self, data: dict[str, Any]) -> bool:
        """One chunk of a stream, or a whole reply."""
        if isinstance(data.get("model"), str) and data["model"]:
            self.model = data["model"]
        if isinstance(data.get("usage"), dict):
            self._usage(data["usage"])
        choices = data.get("choices")
        if not isinstance(choices, list):
            return False
        for choice in choices:
            if isinstance(choice, dict) and choice.get("index", 0) in (0, None):
                self._choice(choice)
        return True

    def _usage(self, usage: dict[str, Any]) -> None:
        self.prompt_tokens = count(usage.get("prompt_tokens"))
        self.completion_tokens = count(usage.get("completion_tokens"))
        details = usage.get("prompt_tokens_details")
        self.cached_tokens = count(details.get("cached_tokens")) if isinstance(details, dict) else 0
        cost = usage.get("cost")
        if isinstance(cost, (int, float)) and not isinstance(cost, bool) and cost >= 0:
            self.cost = float(cost)

    def _choice(self, choice: dict[str, Any]) -> None:
        message = choice.get("delta") or choice.get("message") or {}
        if isinstance(message, dict):
            self.text.append(text_of(message.get("content")))
            self.refusal.append(text_of(message.get("refusal")))
        if isinstance(choice.get("finish_reason"), str):
            self.ending = _ENDINGS.get(choice["finish_reason"], "stop")
        if choice.get("error"):
            self.fail(choice["error"])
