# SPDX-License-Identifier: GPL-3.0-or-later
"""Reads a model service's reply, streamed or in one piece, whichever it turns out to be.

What all services share is here: telling a stream from a whole reply, putting pieces together, and the errors of their
own kind (broken off, cut by the length limit, refused, filtered, empty). A subclass knows one service's words.
"""

from __future__ import annotations

import json
from typing import Any, Literal

from ..errors import CutReplyError, ReplyError
from .base import Reply
from .error_bodies import body_fault
from .faults import Fault, ServiceError, plain, without_key
from .sse import EventReader

CUT_NOTE = "The model's length limit cut the answer; what came before is used."
Ending = Literal["", "stop", "cut", "filter", "refused"]
_EVENT_STARTS = (b"data:", b":", b"event:", b"id:", b"retry:")


class ReplyReader:
    """Collects one reply: fed with pieces as they arrive, then finished. Subclasses implement `take`.

    Args:
        host: for messages; key: to be kept out of them, and out of the answer.
        plain: the answer is a plain text, of which the beginning is of use too.
    """

    kind = "chat"
    """What kind of reply this is, for messages."""
    shape_fix = "Check that the base URL is that of an OpenAI-style service."

    def __init__(self, host: str, key: str, plain: bool = False) -> None:
        self._host, self._key, self._plain = host, key, plain
        self._events = EventReader()
        self._head = b""
        self._streamed: bool | None = None
        self._body = bytearray()
        self._error: Fault | None = None
        self._known = False
        # What `take` fills in.
        self.text: list[str] = []
        self.refusal: list[str] = []
        self.ending: Ending = ""
        self.done = False
        self.model = ""
        self.prompt_tokens = self.completion_tokens = 0
        self.cached_tokens = self.written_tokens = 0
        self.cost: float | None = None

    def take(self, data: dict[str, Any]) -> bool:
        """One chunk of a stream, or a whole reply; False when it is nothing this service sends."""
        raise NotImplementedError

    def so_far(self) -> str:
        """The answer as far as it has arrived; may be called from another thread."""
        return without_key("".join(self.text), self._key)

    def feed(self, piece: bytes) -> bool:
        """Take a piece of the body; True when the reply is complete and the rest need not be waited for."""
        if self._streamed is None:
            # What stands before it is dropped at once: a reply of spaces only would take the square of its length.
            self._head = start = (self._head + piece).lstrip(b"\xef\xbb\xbf \t\r\n")
            if not start or (len(start) < 6 and any(sign.startswith(start) for sign in (b"data:", b"event:"))):
                return False
            self._streamed = start.startswith(_EVENT_STARTS)
            piece = self._head
        if not self._streamed:
            self._body += piece
            return False
        for event in self._events.feed(piece):
            self._event(event)
        return self.done or self._error is not None

    def finish(self, content_type: str, model: str) -> Reply:
        """The reply, once the body has ended.

        Raises:
            Fault: the body is an error, is not a reply, or ends before the reply does; the model refused.
            CutReplyError: the model's own length limit cut the answer.
            ReplyError: the answer is empty.
        """
        if self._streamed:
            for event in self._events.finish():
                self._event(event)
            if self._error is None and not self.done and not self.ending:
                raise self.broken()
        else:
            self._whole(bytes(self._body) or self._head, content_type)
        if self._error is not None:
            raise self._error
        return self._reply(model)

    def _event(self, data: str) -> None:
        if self.done or self._error is not None or not data.strip():
            return
        if data.strip() == "[DONE]":
            self.done = True
            return
        try:
            chunk = json.loads(data)
        except (ValueError, RecursionError):
            self._error = self.broken()
            return
        self.chunk(chunk)

    def _whole(self, body: bytes, content_type: str) -> None:
        """A reply in one piece."""
        try:
            data = json.loads(body)
        except (ValueError, RecursionError):
            if not body.strip() or body.lstrip()[:1] == b"{":
                # It begins like a reply and does not end like one.
                raise self.broken() from None
            page = "html" in content_type.lower() or body.lstrip()[:1] == b"<"
            raise self._foreign("a web page" if page else "something else") from None
        self.chunk(data)
        if self._error is None and not self._known:
            self._error = Fault(
                ServiceError(
                    f"The service at {self._host} answered in a form that is not a {self.kind} reply.",
                    self.shape_fix,
                    "shape",
                )
            )

    def _foreign(self, what: str) -> Fault:
        return Fault(
            ServiceError(
                f"The service at {self._host} answered with {what}, not with a model's reply.",
                "Check the base URL; it usually ends in /v1.",
                "shape",
            )
        )

    def chunk(self, data: Any) -> None:
        """One chunk of a stream, or a whole reply."""
        if not isinstance(data, dict):
            return
        if data.get("error"):
            self.fail(data["error"])
        elif self.take(data):
            self._known = True

    def fail(self, error: Any) -> None:
        """An error that came with status 200."""
        self._error = body_fault(error, self._host, self._key)

    def broken(self) -> Fault:
        """The reply ended in the middle."""
        message = f"The reply of {self._host} broke off in the middle."
        return Fault(ServiceError(message, "Check the connection and try again.", "network"), retry=True)

    def _reply(self, model: str) -> Reply:
        text = "".join(self.text)
        refusal = plain("".join(self.refusal), self._key)
        if self.ending == "refused" or (refusal and not text.strip()):
            said = f": {refusal}" if refusal else " to answer."
            raise Fault(ServiceError(f"The model refused{said}", "Try another model or picture.", "refusal"))
        if self.ending == "filter":
            raise Fault(
                ServiceError(
                    "The service's content filter stopped the answer.", "Try another model or picture.", "refusal"
                )
            )
        cut = self.ending == "cut"
        if cut and not (self._plain and text.strip()):
            raise CutReplyError(
                f"The model's answer was cut by its length limit after {len(text)} characters.",
                "Choose a model with a longer answer, or raise the limit where the model is served.",
                ("The answer was cut by the length limit. Answer more briefly: no comments, no spaces for layout.",),
            )
        if not text.strip():
            raise ReplyError("The model's answer is empty.", "Try again.", ("The answer was empty.",))
        return Reply(
            # A service that echoes what it was sent must not get the key into memory.
            text=without_key(text, self._key),
            model=plain(self.model, self._key) or model,
            prompt_tokens=self.prompt_tokens,
            completion_tokens=self.completion_tokens,
            cost=self.cost,
            cached_tokens=self.cached_tokens,
            written_tokens=self.written_tokens,
            notes=(CUT_NOTE,) if cut else (),
        )


def count(value: Any) -> int:
    """A number of tokens as a service gives it, 0 when it is none."""
    return value if isinstance(value, int) and not isinstance(value, bool) and value >= 0 else 0


def text_of(content: Any) -> str:
    """The text of a message's content: a string, or a list of parts."""
    if isinstance(content, str):
        return content
    if isinstance(content, list):
        return "".join(part["text"] for part in content if isinstance(part, dict) and isinstance(part.get("text"), str))
    return ""
