# SPDX-License-Identifier: GPL-3.0-or-later
"""Google's Gemini: `models/NAME:generateContent` and `:streamGenerateContent`."""

from __future__ import annotations

import json
import re
from typing import Any
from urllib.parse import quote

from .base import Prompt
from .exchange import Answer
from .faults import Fault, ServiceError, quoted
from .http_client import Habits, HttpClient, halves, picture_kind, picture_text
from .reply_reader import Ending, ReplyReader, count
from .schema import older_schema
from .sight import Sight

_STOPPED: dict[str, Ending] = {"STOP": "stop", "MAX_TOKENS": "cut"}


class GeminiReader(ReplyReader):
    """Knows `candidates`, `finishReason`, `promptFeedback` and `usageMetadata`."""

    shape_fix = "Check that the base URL is https://generativelanguage.googleapis.com/v1beta."

    def chunk(self, data: Any) -> None:
        """One chunk of a stream, or a whole reply; without events a stream comes as one list."""
        for part in data if isinstance(data, list) else [data]:
            super().chunk(part)

    def take(self, data: dict[str, Any]) -> bool:
        """One chunk of a stream, or a whole reply."""
        if isinstance(data.get("modelVersion"), str):
            self.model = data["modelVersion"]
        usage = data.get("usageMetadata")
        if isinstance(usage, dict):
            self.prompt_tokens = count(usage.get("promptTokenCount"))
            self.cached_tokens = count(usage.get("cachedContentTokenCount"))
            # Thinking is paid for like the answer.
            self.completion_tokens = count(usage.get("candidatesTokenCount")) + count(usage.get("thoughtsTokenCount"))
        feedback = data.get("promptFeedback")
        if isinstance(feedback, dict) and feedback.get("blockReason"):
            self.ending = "filter"
            return True
        candidates = data.get("candidates")
        if not isinstance(candidates, list):
            return isinstance(usage, dict)
        for candidate in candidates:
            if isinstance(candidate, dict) and candidate.get("index", 0) in (0, None):
                self._candidate(candidate)
        return True

    def _candidate(self, candidate: dict[str, Any]) -> None:
        content = candidate.get("content")
        parts = content.get("parts") if isinstance(content, dict) else None
        for part in parts if isinstance(parts, list) else []:
            if isinstance(part, dict) and isinstance(part.get("text"), str) and not part.get("thought"):
                self.text.append(part["text"])
        reason = candidate.get("finishReason")
        if isinstance(reason, str) and reason and reason != "FINISH_REASON_UNSPECIFIED":
            # Every other reason (SAFETY, RECITATION, BLOCKLIST, ...) is a filter of the service.
            self.ending = _STOPPED.get(reason, "filter")


class GeminiClient(HttpClient):
    """`x-goog-api-key`, `inline_data`, `responseJsonSchema` (older: `responseSchema`)."""

    vendor = "gemini"
    default_path = "/v1beta"
    endpoints = ("/models",)
    key_header = "x-goog-api-key"
    reader = GeminiReader
    structures = ("schema", "older", "object", "none")
    structure_words = (
        "responsejsonschema",
        "response_json_schema",
        "responseschema",
        "response_schema",
        "responsemimetype",
        "response_mime_type",
        "schema",
        "json mode",
    )

    @property
    def sight(self) -> Sight:
        """Requests with their pictures inside must stay under 20 MB, in base64."""
        return Sight(request_bytes=14_000_000)

    def url(self, habits: Habits) -> str:
        """Where a prompt is sent."""
        name = quote(self.model.removeprefix("models/"), safe="-._/")
        verb = "streamGenerateContent?alt=sse" if habits.stream else "generateContent"
        return f"{self.base_url}/models/{name}:{verb}"

    def body(self, prompt: Prompt, habits: Habits) -> dict[str, Any]:
        """The request's body."""
        # What other prompts begin with too comes first: Gemini keeps beginnings by itself.
        shared, rest = halves(prompt, in_words=habits.structure in ("object", "none"))
        parts: list[dict[str, Any]] = [{"text": shared}] if shared else []
        parts += [
            {"inline_data": {"mime_type": picture_kind(image), "data": picture_text(image)}} for image in prompt.images
        ]
        parts.append({"text": rest})
        body: dict[str, Any] = {"contents": [{"role": "user", "parts": parts}]}
        if prompt.plain:
            return body
        if habits.structure != "none":
            body["generationConfig"] = {"responseMimeType": "application/json"}
        if habits.structure == "schema":
            body["generationConfig"]["responseJsonSchema"] = dict(prompt.schema)
        elif habits.structure == "older":
            body["generationConfig"]["responseSchema"] = older_schema(prompt.schema)
        return body

    def fault(self, answer: Answer) -> Fault:
        """Gemini says 400 for a wrong key, and speaks of quota where a minute's limit is meant."""
        fault = super().fault(answer)
        if answer.status == 400 and "api key" in fault.sentence.lower():
            message = f"The service at {self.host} does not accept the API key.{quoted(fault.sentence)}"
            return Fault(ServiceError(message, "Check the API key in the preferences.", "key", 400), False, 0.0, "")
        pause = _pause_of(answer.body) if answer.status == 429 else None
        if pause is not None:
            message = f"The service at {self.host} is asked too often.{quoted(fault.sentence)}"
            error = ServiceError(message, "Try again in a while.", "rate", 429)
            return Fault(error, retry=True, after=pause, sentence=fault.sentence)
        return fault


def _pause_of(body: bytes) -> float | None:
    """Seconds to wait where only a minute's limit was reached; None where it is a day's, or money."""
    try:
        details = json.loads(body)["error"]["details"]
        quotas = [str(v.get("quotaId", "")) for d in details for v in d.get("violations", [])]
        delays = [d["retryDelay"] for d in details if "retryDelay" in d]
    except (ValueError, KeyError, TypeError, AttributeError, RecursionError):
        return None
    if not quotas or any("PerMinute" not in quota for quota in quotas):
        return None
    match = re.fullmatch(r"(\d+(?:\.\d+)?)s", str(delays[0])) if delays else None
    return min(86_400.0, float(match.group(1))) if match else 0.0
