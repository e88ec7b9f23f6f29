# SPDX-License-Identifier: GPL-3.0-or-later
"""Any service with an OpenAI-style `/chat/completions`: OpenAI, OpenRouter, LM Studio, llama.cpp, vLLM and the like."""

from __future__ import annotations

from typing import Any

from .base import Prompt
from .chat_reply import ChatReader
from .http_client import Habits, HttpClient, halves, picture_kind, picture_text
from .sight import Sight, sight_of_openai


class OpenAIStyleClient(HttpClient):
    """Bearer key, `messages` with `image_url` parts, `response_format`."""

    vendor = "openai"
    endpoints = ("/chat/completions",)
    reader = ChatReader
    structure_words = ("response_format", "json_schema", "json schema", "json_object", "schema", "structured")

    @property
    def sight(self) -> Sight:
        """What OpenAI's own models see of a picture; others are as they are."""
        return sight_of_openai(self.model) if self.host == "api.openai.com" else Sight()

    def url(self, habits: Habits) -> str:
        """Where a prompt is sent."""
        return f"{self.base_url}/chat/completions"

    def body(self, prompt: Prompt, habits: Habits) -> dict[str, Any]:
        """The request's body."""
        shared, rest = halves(prompt, in_words=habits.structure != "schema")
        content: list[dict[str, Any]] = []
        if shared and prompt.images:
            # What other prompts begin with too comes first: services keep beginnings by themselves.
            content.append({"type": "text", "text": shared, **self._marked()})
        elif shared:
            rest = shared + rest
        content += [
            {"type": "image_url", "image_url": {"url": f"data:{picture_kind(image)};base64,{picture_text(image)}"}}
            for image in prompt.images
        ]
        content.append({"type": "text", "text": rest})
        body: dict[str, Any] = {"model": self.model, "messages": [{"role": "user", "content": content}]}
        if prompt.plain:
            pass
        elif habits.structure == "schema":
            schema = {"name": prompt.schema_name[:64], "strict": True, "schema": dict(prompt.schema)}
            body["response_format"] = {"type": "json_schema", "json_schema": schema}
        elif habits.structure == "object":
            body["response_format"] = {"type": "json_object"}
        if habits.stream:
            body["stream"] = True
            if habits.stream_usage:
                body["stream_options"] = {"include_usage": True}
        if self._is_openrouter:
            # What the answer cost; and no backend that would ignore the schema.
            body["usage"] = {"include": True}
            if habits.structure == "schema" and not prompt.plain:
                body["provider"] = {"require_parameters": True}
        return body

    @property
    def _is_openrouter(self) -> bool:
        return self.host == "openrouter.ai" or self.host.endswith(".openrouter.ai")

    def _marked(self) -> dict[str, Any]:
        """Claude keeps only beginnings that are marked, behind OpenRouter too."""
        claude = self._is_openrouter and self.model.startswith("anthropic/")
        return {"cache_control": {"type": "ephemeral"}} if claude else {}
