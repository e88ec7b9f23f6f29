# SPDX-License-Identifier: GPL-3.0-or-later
"""What all clients of model services share: one prompt, asked with retries, in the best form that the service accepts.

No sampling parameters are sent (reasoning models refuse them). A structured reply by JSON schema and streaming are
asked for first; what a service refuses is remembered and left out from then on.
"""

from __future__ import annotations

import base64
import json
import threading
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Any, Literal

from .base import Prompt, Reply
from .endpoint import Endpoint
from .exchange import Call, exchange
from .faults import Fault
from .hearing import Hearing
from .limits import Limits, Route
from .pace import Pace
from .reply_reader import ReplyReader
from .retry import RetryPolicy
from .schema import shape_text
from .sight import Sight, fitted
from .warming import Warming

Structure = Literal["schema", "older", "object", "none"]


@dataclass(frozen=True)
class Habits:
    """What a service has been found to accept.

    Attributes:
        structure: how a structured reply is asked for: by schema, by the service's older kind of schema, as any JSON
            object, or in words only. stream, stream_usage: streaming, with token counts.
        most_tokens: longest answer to ask for, 0 where none has to be given.
        cache: the beginning that prompts share is marked, so that the service keeps it.
    """

    structure: Structure = "schema"
    stream: bool = True
    stream_usage: bool = True
    most_tokens: int = 0
    cache: bool = True


class HttpClient(Endpoint):
    """A client for one service and model. Safe to use from several threads. Subclasses know one service's envelope.

    Args:
        base_url: such as "http://localhost:1234/v1"; api_key: "" for services that need none.
        route: proxy and certificates; pace: how many requests may be under way, shared with the service's other clients.

    Raises:
        ModelError: the address, the model's name or the key cannot be right.
    """

    reader: type[ReplyReader] = ReplyReader
    structures: tuple[Structure, ...] = ("schema", "object", "none")
    structure_words: tuple[str, ...] = ("schema",)
    first_habits = Habits()

    def __init__(
        self,
        base_url: str,
        model: str,
        api_key: str = "",
        limits: Limits | None = None,
        retries: RetryPolicy | None = None,
        route: Route | None = None,
        pace: Pace | None = None,
    ) -> None:
        super().__init__(base_url, model, api_key, limits, retries, route, pace)
        self._warming = Warming()
        self._habits = self.first_habits
        self._lock = threading.Lock()

    @property
    def structure(self) -> Structure:
        """How a structured reply is asked for, as far as this service has been found to accept it."""
        return self._habits.structure

    @property
    def keeps_marked(self) -> bool:
        """Whether the service keeps beginnings that are marked, from the moment on when it begins to answer."""
        return False

    @property
    def sight(self) -> Sight:
        """What the service's models see of a picture."""
        return Sight()

    def url(self, habits: Habits) -> str:
        """Where a prompt is sent."""
        raise NotImplementedError

    def body(self, prompt: Prompt, habits: Habits) -> dict[str, Any]:
        """The request's body."""
        raise NotImplementedError

    def headers(self) -> Mapping[str, str]:
        """Further headers; never the key."""
        return {}

    def plain_call(self, path: str, body: bytes | None = None) -> Call:
        """A request beside the questions, such as for the list of models: a GET, or a POST of this body."""
        return self.call(self.base_url + path, body, headers=self.headers())

    def answer(self, prompt: Prompt, cancel: threading.Event, progress: Callable[[str], None] | None = None) -> Reply:
        """Ask the service; see `ModelClient.answer`.

        Raises:
            ServiceError: in the service's own words where it gave any, never with the key.
            CutReplyError: the answer hit the model's length limit.
            ReplyError: the answer is empty.
            Cancelled: `cancel` was set.
        """
        prompt = replace(prompt, images=fitted(prompt.images, self.sight))
        reply, seconds = self.in_turn(
            lambda deadline: self._negotiate(prompt, deadline, cancel, progress), cancel, progress
        )
        return replace(reply, seconds=seconds)

    def _negotiate(
        self, prompt: Prompt, deadline: float, cancel: threading.Event, progress: Callable[[str], None] | None
    ) -> Reply:
        """Ask, and on a refusal of streaming or structured output ask at once again without it."""
        while True:
            habits = self._habits
            try:
                return self._once(prompt, habits, deadline, cancel, progress)
            except Fault as fault:
                humbler = self.humbler(habits, fault)
                if humbler is None or (prompt.plain and humbler.structure != habits.structure):
                    # What was not asked for was not refused.
                    raise
            with self._lock:
                # Another request may have learnt more in the meantime; never go back.
                if self._habits == habits:
                    self._habits = humbler

    def _once(
        self,
        prompt: Prompt,
        habits: Habits,
        deadline: float,
        cancel: threading.Event,
        progress: Callable[[str], None] | None,
    ) -> Reply:
        beginning = prompt.halves()[0] if self.keeps_marked else ""
        with self._warming.turn(beginning, cancel) as answering:
            return self._exchanged(prompt, habits, deadline, cancel, progress, answering)

    def _exchanged(
        self,
        prompt: Prompt,
        habits: Habits,
        deadline: float,
        cancel: threading.Event,
        progress: Callable[[str], None] | None,
        answering: Callable[[], None],
    ) -> Reply:
        """Send it and read the reply; `answering` is called when the reply begins."""
        reader, hearing = self.reader(self.host, self._key, prompt.plain), Hearing(prompt)

        def take(piece: bytes) -> bool:
            answering()
            return reader.feed(piece)

        accept = "text/event-stream, application/json" if habits.stream else "application/json"
        call = self.call(
            self.url(habits),
            json.dumps(self.body(prompt, habits)).encode(),
            headers={"Accept": accept, **self.headers()},
            enough=take,
            meanwhile=lambda: hearing.so_far(reader.so_far),
        )
        # A one-shot answer sends nothing until it is complete, so only the total limit can end it.
        limits = self._limits if habits.stream else replace(self._limits, read=self._limits.total)
        answer = exchange(call, limits, deadline, cancel, progress)
        if answer.status != 200:
            raise self.fault(answer)
        reply = reader.finish(answer.headers.get("Content-Type", ""), self.model)
        hearing.whole(reply.text)
        return reply

    def humbler(self, habits: Habits, fault: Fault) -> Habits | None:
        """What to ask for instead after a refusal that names a feature; None when it names none."""
        if fault.error.status not in (400, 404, 415, 422, 501) or fault.error.kind == "money":
            return None
        said = fault.sentence.lower()
        if habits.stream and habits.stream_usage and ("stream_options" in said or "include_usage" in said):
            return replace(habits, stream_usage=False)
        if habits.structure != "none" and any(word in said for word in self.structure_words):
            return replace(habits, structure=self.structures[self.structures.index(habits.structure) + 1])
        if habits.stream and "stream" in said:
            return replace(habits, stream=False)
        return None


def halves(prompt: Prompt, in_words: bool) -> tuple[str, str]:
    """The prompt's shared beginning, "" when there is none, and the rest, with the schema in words where asked for."""
    text = with_schema(prompt) if in_words else prompt.text
    return text[: prompt.shared], text[prompt.shared :]


def picture_kind(image: bytes) -> str:
    """The media type of an encoded picture."""
    return "image/png" if image.startswith(b"\x89PNG") else "image/webp" if image[8:12] == b"WEBP" else "image/jpeg"


def picture_text(image: bytes) -> str:
    """An encoded picture in base64."""
    return base64.b64encode(image).decode()


def with_schema(prompt: Prompt) -> str:
    """The prompt's text with the answer's schema in words, for services that do not take it otherwise."""
    if prompt.plain:
        return prompt.text
    return f"{prompt.text}\n\nAnswer with one JSON object that fits this JSON schema:\n{shape_text(prompt.schema)}"
