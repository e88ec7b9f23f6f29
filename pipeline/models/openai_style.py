# SPDX-License-Identifier: GPL-3.0-or-later
"""Any service with an OpenAI-style `/chat/completions`: OpenAI, OpenRouter, LM Studio, llama.cpp, vLLM and the like."""

from __future__ import annotations

from typing import Any

from .base import Prompt
from .chat_reply import ChatReader
from .http_client import Habits, HttpClient, picture_kind, picture_text, with_schema


class OpenAIStyleClient(HttpClient):
    """Bearer key, `messages` with `image_url` parts, `response_format`."""

    vendor = "openai"
    endpoints = ("/chat/completions",)
    reader = ChatReader
    structure_words = ("response_format", "json_schema", "json schema", "json_object", "schema", "structured")

    def url(self, habits: Habits) -> str:
        """Where a prompt is sent."""
        return f"{self.base_url}/chat/completions"

    def body(self, prompt: Prompt, habits: Habits) -> dict[str, Any]:
        """The request's body."""
        content: list[dict[str, Any]] = [
            {"type": "image_url", "image_url": {"url": f"data:{picture_kind(image)};base64,{picture_text(image)}"}}
            for image in prompt.images
        ]
        content.append({"type": "text", "text": prompt.text if habits.structure == "schema" else with_schema(prompt)})
        body: dict[str, Any] = {"model": self.model, "messages": [{"role": "user", "content": content}]}
        if habits.structure == "schema":
            schema = {"name": prompt.schema_name[:64], "strict": True, "schema": dict(prompt.schema)}
            body["response_format"] = {"type": "json_schema", "json_schema": schema}
        elif habits.structure == "object":
            body["response_format"] = {"type": "json_object"}
        if habits.stream:
            body["stream"] = True
            if habits.stream_usage:
                body["stream_options"] = {"include_usage": True}
        if self.host.endswith("openrouter.ai"):
            # What the answer cost; and no backend that would ignore the schema.
            body["usage"] = {"include": True}
            if habits.structure == "schema":
                body["provider"] = {"require_parameters": True}
        return body
