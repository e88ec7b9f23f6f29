# SPDX-License-Identifier: GPL-3.0-or-later
"""Reads the reply of an OpenAI-style chat service, streamed or in one piece, whichever it turns out to be."""

from __future__ import annotations

import json
from typing import Any

from ..errors import CutReplyError, ReplyError
from .base import Reply
from .faults import Fault, ServiceError, error_codes, fault_for, plain
from .sse import EventReader

_DONE = "[DONE]"
_SNIFF = 64


class ChatReader:
    """Collects one reply: fed with pieces as they arrive, then finished.

    Args:
        host: for messages; key: to be kept out of them.
    """

    def __init__(self, host: str, key: str) -> None:
        self._host = host
        self._key = key
        self._events = EventReader()
        self._head = b""
        self._streamed: bool | None = None
        self._body = bytearray()
        self._text: list[str] = []
        self._refusal: list[str] = []
        self._reason = ""
        self._model = ""
        self._usage: dict[str, Any] = {}
        self._error: Fault | None = None
        self._done = False
        self._chunks = 0

    def feed(self, piece: bytes) -> bool:
        """Take a piece of the body; True when the reply is complete and the rest need not be waited for."""
        if self._streamed is None:
            self._head += piece
            start = self._head.lstrip(b"\xef\xbb\xbf \t\r\n")
            if not start or (len(start) < 6 and b"data:".startswith(start[:5])):
                return False
            self._streamed = start.startswith((b"data:", b":", b"event:", b"id:", b"retry:"))
            piece = self._head
        if not self._streamed:
            self._body += piece
            return False
        for event in self._events.feed(piece):
            self._event(event)
        return self._done or self._error is not None

    def finish(self, content_type: str, model: str) -> Reply:
        """The reply, once the body has ended.

        Raises:
            Fault: the body is an error, is not a chat reply, or ends before the reply does.
            CutReplyError: the model's own length limit cut the answer.
            ReplyError: the answer is empty.
        """
        if self._streamed:
            for event in self._events.finish():
                self._event(event)
            if self._error is None and not self._done and not self._reason:
                raise self._broken()
        else:
            self._whole(bytes(self._body) or self._head, content_type)
        if self._error is not None:
            raise self._error
        return self._reply(model)

    def _event(self, data: str) -> None:
        if self._done or self._error is not None or not data.strip():
            return
        if data.strip() == _DONE:
            self._done = True
            return
        try:
            chunk = json.loads(data)
        except (ValueError, RecursionError):
            self._error = self._broken()
            return
        self._take(chunk)

    def _whole(self, body: bytes, content_type: str) -> None:
        """A reply in one piece."""
        try:
            data = json.loads(body)
        except (ValueError, RecursionError):
            if not body.strip() or body.lstrip()[:1] == b"{":
                # It begins like a reply and does not end like one.
                raise self._broken() from None
            what = "a web page" if "html" in content_type.lower() or body.lstrip()[:1] == b"<" else "something else"
            raise Fault(
                ServiceError(
                    f"The service at {self._host} answered with {what}, not with a model's reply.",
                    "Check the base URL; it usually ends in /v1.",
                    "shape",
                )
            ) from None
        self._take(data)
        if self._error is None and not self._chunks:
            self._error = Fault(
                ServiceError(
                    f"The service at {self._host} answered in a form that is not a chat reply.",
                    "Check that the base URL is that of an OpenAI-style service.",
                    "shape",
                )
            )

    def _take(self, data: Any) -> None:
        """One chunk of a stream, or a whole reply."""
        if not isinstance(data, dict):
            return
        if data.get("error"):
            self._error = self._error_in(data["error"])
            return
        if isinstance(data.get("model"), str) and data["model"]:
            self._model = data["model"]
        if isinstance(data.get("usage"), dict):
            self._usage = data["usage"]
        choices = data.get("choices")
        if not isinstance(choices, list):
            return
        self._chunks += 1
        for choice in choices:
            if isinstance(choice, dict) and choice.get("index", 0) in (0, None):
                self._choice(choice)

    def _choice(self, choice: dict[str, Any]) -> None:
        message = choice.get("delta") or choice.get("message") or {}
        if isinstance(message, dict):
            self._text.append(_content(message.get("content")))
            self._refusal.append(_content(message.get("refusal")))
        if isinstance(choice.get("finish_reason"), str):
            self._reason = choice["finish_reason"]
        if choice.get("error"):
            self._error = self._error_in(choice["error"])

    def _error_in(self, error: Any) -> Fault:
        """An error that came with status 200."""
        message = error.get("message", "") if isinstance(error, dict) else error
        sentence = plain(str(message), self._key)
        code = error.get("code") if isinstance(error, dict) else None
        text = str(code or "")
        status = int(text) if text.isdigit() and len(text) == 3 else _STATUS_OF.get(text.lower(), 0)
        kind = str(error.get("type", "")).lower() if isinstance(error, dict) else ""
        return fault_for(status or _STATUS_OF.get(kind, 0), sentence, error_codes(error), 0.0, self._host)

    def _broken(self) -> Fault:
        error = ServiceError(
            f"The reply of {self._host} broke off in the middle.", "Check the connection and try again.", "network"
        )
        return Fault(error, retry=True)

    def _reply(self, model: str) -> Reply:
        text = "".join(self._text)
        refusal = plain("".join(self._refusal), self._key)
        if refusal and not text.strip():
            raise Fault(ServiceError(f"The model refused: {refusal}", "Try another model or picture."))
        if self._reason == "content_filter":
            raise Fault(
                ServiceError("The service's content filter stopped the answer.", "Try another model or picture.")
            )
        if self._reason == "length":
            raise CutReplyError(
                f"The model's answer was cut by its length limit after {len(text)} characters.",
                "Choose a model with a longer answer, or raise the limit where the model is served.",
                ("The answer was cut by the length limit. Answer more briefly: no comments, no spaces for layout.",),
            )
        if not text.strip():
            raise ReplyError("The model's answer is empty.", "Try again.", ("The answer was empty.",))
        cost = self._usage.get("cost")
        return Reply(
            text=text,
            model=self._model or model,
            prompt_tokens=_count(self._usage.get("prompt_tokens")),
            completion_tokens=_count(self._usage.get("completion_tokens")),
            cost=float(cost) if isinstance(cost, (int, float)) and not isinstance(cost, bool) and cost >= 0 else None,
        )


_STATUS_OF = {
    "insufficient_quota": 402,
    "billing_hard_limit_reached": 402,
    "rate_limit_exceeded": 429,
    "rate_limit_error": 429,
    "server_error": 500,
    "internal_server_error": 500,
    "api_error": 500,
    "overloaded_error": 529,
    "timeout": 504,
    "invalid_api_key": 401,
    "authentication_error": 401,
    "model_not_found": 404,
    "invalid_request_error": 400,
}


def _content(content: Any) -> str:
    """The text of a message's content: a string, or a list of parts."""
    if isinstance(content, str):
        return content
    if isinstance(content, list):
        return "".join(part["text"] for part in content if isinstance(part, dict) and isinstance(part.get("text"), str))
    return ""


def _count(value: Any) -> int:
    return value if isinstance(value, int) and not isinstance(value, bool) and value >= 0 else 0
