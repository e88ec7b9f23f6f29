# SPDX-License-Identifier: GPL-3.0-or-later
"""What all clients of image services share: words in, one checked image out. Requests, limits and redaction as elsewhere."""

from __future__ import annotations

import base64
import binascii
import io
import json
import threading
import warnings
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Any, Literal, Protocol
from urllib.parse import urlsplit

from PIL import Image

from .addresses import is_local_url
from .endpoint import Endpoint
from .error_bodies import body_fault
from .exchange import Answer, Call, exchange
from .faults import Fault, FaultKind, ServiceError, plain, quoted
from .limits import Limits
from .retry import RetryPolicy

Proportions = Literal["square", "wide", "tall"]
LARGEST_REPLY = 40_000_000
MOST_PIXELS = 20_000_000
LEAST_SIDE = 64
SIDE_BY_SIDE = 3
_FORMATS = ("PNG", "JPEG", "WEBP")
IMAGE_LIMITS = Limits(read=300.0, total=420.0, size=LARGEST_REPLY)
IMAGE_RETRIES = RetryPolicy(tries=2)
"""Fewer than for questions: an image is dear, and a service that breaks off may have made it."""


@dataclass(frozen=True)
class ImageRequest:
    """What is to be painted: words, and the proportions of the image."""

    text: str
    proportions: Proportions = "square"


@dataclass(frozen=True)
class PaintedImage:
    """An image as the service made it, checked to be one: PNG, JPEG or WebP bytes.

    `cost` is in US dollars, None when unknown.
    """

    data: bytes
    model: str
    cost: float | None = None
    seconds: float = 0.0
    tokens: int = 0


class ImageClient(Protocol):
    """Something that paints. `paint` is called from worker threads, several at once.

    Attributes:
        name: for memory and report, such as "openai-images:gpt-image-x"; describes: one sentence for the artist.
    """

    name: str
    describes: str

    def paint(
        self, request: ImageRequest, cancel: threading.Event, progress: Callable[[str], None] | None = None
    ) -> PaintedImage:
        """Paint one image.

        Raises:
            ServiceError: the service failed, or refused (kind "refusal"), in its own words where it gave any.
            Cancelled: `cancel` was set.
        """
        ...


class ImageHttpClient(Endpoint):
    """A client for one image service and model. Safe to use from several threads. Subclasses know one envelope.

    Args:
        base_url: such as "https://api.openai.com/v1"; api_key: "" for services that need none.
        route: proxy and certificates; pace: how many images may be under way.

    Raises:
        ModelError: the address, the model's name or the key cannot be right.
    """

    what = "image model"
    usual_limits = IMAGE_LIMITS
    usual_retries = IMAGE_RETRIES
    usual_pace = SIDE_BY_SIDE

    def url(self) -> str:
        """Where a request is sent."""
        raise NotImplementedError

    def body(self, request: ImageRequest) -> dict[str, Any]:
        """The request's body."""
        raise NotImplementedError

    def read(self, data: Mapping[str, Any], get: Callable[[str], bytes]) -> PaintedImage:
        """The image in a reply; `get` fetches what is only linked to. Raises Fault where there is none."""
        raise NotImplementedError

    def paint(
        self, request: ImageRequest, cancel: threading.Event, progress: Callable[[str], None] | None = None
    ) -> PaintedImage:
        """See `ImageClient.paint`."""
        made, seconds = self.in_turn(lambda deadline: self._once(request, deadline, cancel, progress), cancel, progress)
        return replace(made, seconds=seconds)

    def _once(
        self,
        request: ImageRequest,
        deadline: float,
        cancel: threading.Event,
        progress: Callable[[str], None] | None,
    ) -> PaintedImage:
        call = self.call(self.url(), json.dumps(self.body(request)).encode())
        answer = exchange(call, self._limits, deadline, cancel, progress)
        if answer.status != 200:
            raise self.fault(answer)
        data = self._json(answer)
        if data.get("error"):
            raise self._told(body_fault(data["error"], self.host, self._key), answer)
        made = self.read(data, lambda url: self._linked(url, deadline, cancel, progress))
        return replace(made, data=self.checked(made.data))

    def fault(self, answer: Answer) -> Fault:
        """The fault for an answer with a status other than 200; what a safety filter says is a refusal."""
        return self._told(super().fault(answer), answer)

    def _told(self, fault: Fault, answer: Answer) -> Fault:
        """The fault, or a refusal where the service's words are those of a safety filter."""
        said = f"{fault.sentence} {answer.body[:4000].decode('utf-8', 'replace')}".lower()
        filtered = any(word in said for word in _FILTERED)
        if filtered and fault.error.status in (0, 400, 403, 422) and fault.error.kind != "money":
            return self.refused(fault.sentence)
        return fault

    def refused(self, sentence: str = "") -> Fault:
        """The fault for words that the service will not paint."""
        message = f"The image model at {self.host} refused to paint this.{quoted(plain(sentence, self._key))}"
        return Fault(ServiceError(message, "Simpler words are tried next.", "refusal"), sentence=sentence)

    def foreign(self, what: str) -> Fault:
        """The fault for a reply that holds no image."""
        message = f"The image model at {self.host} answered with {what} instead of an image."
        return Fault(ServiceError(message, "Check that the model's name is that of an image model.", "shape"))

    def _json(self, answer: Answer) -> Mapping[str, Any]:
        try:
            data = json.loads(answer.body)
        except (ValueError, RecursionError):
            page = "html" in answer.headers.get("Content-Type", "").lower() or answer.body.lstrip()[:1] == b"<"
            raise self.foreign("a web page" if page else "something unreadable") from None
        if not isinstance(data, dict):
            raise self.foreign("something else")
        return data

    def _linked(
        self, url: str, deadline: float, cancel: threading.Event, progress: Callable[[str], None] | None
    ) -> bytes:
        """What lies at a link of the reply. The key is not sent there."""
        try:
            parts = urlsplit(url)
            own = is_local_url(self.base_url) and parts.hostname == self.host and parts.scheme == "http"
            good = own or (parts.scheme == "https" and bool(parts.hostname) and not is_local_url(url))
        except ValueError:
            good = False
        if not good:
            raise self.foreign("a link that cannot be followed")
        answer = exchange(Call(url=url, route=self._route), self._limits, deadline, cancel, progress)
        if answer.status != 200:
            raise self.foreign("a link that leads nowhere")
        return answer.body

    def checked(self, data: bytes) -> bytes:
        """The bytes, once they are known to be an image that can be opened whole. Raises Fault."""
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                with Image.open(io.BytesIO(data), formats=_FORMATS) as image:
                    size = image.size
                    if size[0] * size[1] > MOST_PIXELS:
                        raise self.foreign(f"an image of {size[0]} x {size[1]} pixels")
                    image.load()
        except Fault:
            raise
        except Exception:
            # Decoders raise almost anything on damaged bytes.
            raise self.foreign("bytes that are no image") from None
        if min(size) < LEAST_SIDE:
            raise self.foreign(f"an image of {size[0]} x {size[1]} pixels")
        return data


_FILTERED = (
    "content_policy",
    "content policy",
    "moderation",
    "safety",
    "content_filter",
    "blocked by",
    "responsible ai",
)


def from_base64(text: Any) -> bytes | None:
    """Bytes written as base64, with or without a data URL's head; None where it is none."""
    if not isinstance(text, str) or not text:
        return None
    if text.startswith("data:"):
        text = text.partition(",")[2]
    try:
        return base64.b64decode(text, validate=False) or None
    except (binascii.Error, ValueError):
        return None


FINAL_KINDS: frozenset[FaultKind] = frozenset(
    ("money", "key", "model", "network", "name", "refused", "timeout", "tls", "proxy", "redirect", "rate", "server")
)
"""Kinds of failure that another request would meet again."""
