# SPDX-License-Identifier: GPL-3.0-or-later
"""Any service with an OpenAI-style `/chat/completions`: OpenAI, OpenRouter, LM Studio, llama.cpp, vLLM and the like.

No sampling parameters are sent (reasoning models refuse them). A structured reply by JSON schema and streaming are
asked for first; what a service refuses is remembered and left out from then on.
"""

from __future__ import annotations

import base64
import json
import threading
import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any, Literal
from urllib.parse import urlsplit

from ..errors import ModelError
from .addresses import is_local_url, normal_base_url
from .base import Prompt, Reply
from .chat_reply import ChatReader
from .exchange import Answer, Call, Limits, exchange
from .faults import Fault, status_fault
from .retry import RetryPolicy, with_retries
from .schema import shape_text


@dataclass(frozen=True)
class _Habits:
    """What a service has been found to accept."""

    structure: Literal["schema", "object", "none"] = "schema"
    stream: bool = True
    stream_usage: bool = True


class OpenAIStyleClient:
    """A client for one base URL and model. Safe to use from several threads.

    Args:
        base_url: such as "http://localhost:1234/v1"; api_key: "" for services that need none.
        ca_bundle: file with certificates to trust instead of the usual ones.

    Raises:
        ModelError: the address, the model's name or the key cannot be right.
    """

    def __init__(
        self,
        base_url: str,
        model: str,
        api_key: str = "",
        limits: Limits | None = None,
        retries: RetryPolicy | None = None,
        ca_bundle: str = "",
    ) -> None:
        self.base_url = normal_base_url(base_url)
        self.model = model.strip()
        if not self.model:
            raise ModelError("No model is named.", "Give the model's name as the service spells it.")
        self._key = _checked_key(api_key)
        self._limits = limits or Limits()
        self._retries = retries or RetryPolicy()
        self._ca_bundle = ca_bundle
        self._habits = _Habits()
        self._lock = threading.Lock()
        self.host = urlsplit(self.base_url).hostname or ""
        self.name = f"openai:{self.model}"
        where = "on this computer" if is_local_url(self.base_url) else f"at {self.host}"
        self.describes = f"The model {self.model} {where}"

    def __repr__(self) -> str:
        return f"OpenAIStyleClient({self.base_url!r}, {self.model!r})"

    def answer(self, prompt: Prompt, cancel: threading.Event, progress: Callable[[str], None] | None = None) -> Reply:
        """Ask the service; see `ModelClient.answer`.

        Raises:
            ServiceError: in the service's own words where it gave any, never with the key.
            CutReplyError: the answer hit the model's length limit.
            ReplyError: the answer is empty.
            Cancelled: `cancel` was set.
        """
        started = time.monotonic()
        deadline = started + self._limits.total
        reply = with_retries(
            lambda: self._negotiate(prompt, deadline, cancel, progress), self._retries, deadline, cancel, progress
        )
        return replace(reply, seconds=time.monotonic() - started)

    def _negotiate(
        self,
        prompt: Prompt,
        deadline: float,
        cancel: threading.Event,
        progress: Callable[[str], None] | None,
    ) -> Reply:
        """Ask, and on a refusal of streaming or structured output ask at once again without it."""
        while True:
            habits = self._habits
            try:
                return self._once(prompt, habits, deadline, cancel, progress)
            except Fault as fault:
                humbler = _humbler(habits, fault)
                if humbler is None:
                    raise
            with self._lock:
                # Another request may have learnt more in the meantime; never go back.
                if self._habits == habits:
                    self._habits = humbler

    def _once(
        self,
        prompt: Prompt,
        habits: _Habits,
        deadline: float,
        cancel: threading.Event,
        progress: Callable[[str], None] | None,
    ) -> Reply:
        reader = ChatReader(self.host, self._key)
        call = Call(
            url=f"{self.base_url}/chat/completions",
            body=json.dumps(self._body(prompt, habits)).encode(),
            key=self._key,
            headers={"Accept": "text/event-stream, application/json" if habits.stream else "application/json"},
            ca_bundle=self._ca_bundle,
            enough=reader.feed,
        )
        # A one-shot answer sends nothing until it is complete, so only the total limit can end it.
        limits = self._limits if habits.stream else replace(self._limits, read=self._limits.total)
        answer: Answer = exchange(call, limits, deadline, cancel, progress)
        if answer.status != 200:
            raise status_fault(answer.status, answer.body, answer.headers, self.host, self._key)
        return reader.finish(answer.headers.get("Content-Type", ""), self.model)

    def _body(self, prompt: Prompt, habits: _Habits) -> dict[str, Any]:
        text = prompt.text
        if habits.structure != "schema":
            text += f"\n\nAnswer with one JSON object that fits this JSON schema:\n{shape_text(prompt.schema)}"
        content: list[dict[str, Any]] = [
            {"type": "image_url", "image_url": {"url": _data_url(image)}} for image in prompt.images
        ]
        content.append({"type": "text", "text": text})
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
        return body


def _checked_key(key: str) -> str:
    """The key without surrounding space.

    Raises:
        ModelError: it holds what no key holds; HTTP libraries would quote it in their errors.
    """
    key = key.strip()
    if any(not 33 <= ord(char) <= 126 for char in key):
        raise ModelError("The API key holds spaces or characters that no key has.", "Copy the key again.")
    return key


def _data_url(image: bytes) -> str:
    kind = "png" if image.startswith(b"\x89PNG") else "webp" if image[8:12] == b"WEBP" else "jpeg"
    return f"data:image/{kind};base64,{base64.b64encode(image).decode()}"


def _humbler(habits: _Habits, fault: Fault) -> _Habits | None:
    """What to ask for instead after a refusal that names a feature; None when it names none."""
    if fault.error.status not in (400, 404, 415, 422, 501) or fault.error.kind == "money":
        return None
    said = fault.sentence.lower()
    if habits.stream and habits.stream_usage and ("stream_options" in said or "include_usage" in said):
        return replace(habits, stream_usage=False)
    if habits.structure != "none" and any(
        word in said
        for word in ("response_format", "json_schema", "json schema", "json_object", "schema", "structured")
    ):
        return replace(habits, structure="object" if habits.structure == "schema" else "none")
    if habits.stream and "stream" in said:
        return replace(habits, stream=False)
    return None
