# SPDX-License-Identifier: GPL-3.0-or-later
"""What can go wrong with a model service, which of it is worth another try, and how it is told without leaking a key."""

from __future__ import annotations

import base64
import email.utils
import json
import re
import time
from collections.abc import Mapping
from typing import Any, Literal
from urllib.parse import quote

from ..errors import ModelError

FaultKind = Literal[
    "network",
    "name",
    "refused",
    "timeout",
    "tls",
    "proxy",
    "redirect",
    "size",
    "key",
    "model",
    "money",
    "rate",
    "server",
    "request",
    "refusal",
    "shape",
    "pictures",
]
RETRIED_STATUSES = frozenset({408, 429, 500, 502, 503, 504, 529})
_LONGEST_SENTENCE = 400
_BODY_READ = 65_536
_MONEY = re.compile(
    r"insufficient[_ ](?:\w+[_ ])?(?:quota|credits?|balance|funds)|billing|spend(?:ing)?[_ ]limit|credit balance"
    r"|exceeded your current quota|out of credits|not enough credits|payment[_ ]required|quota[_ ]exceeded|usage limit",
    re.IGNORECASE,
)
_BLIND_STATUSES = frozenset({0, 400, 404, 415, 422, 500, 501})
"""llama.cpp says with a 500 that its model is one for text only; 0 is an error without a status."""
_PICTURES = re.compile(r"image|picture|vision|multi-?modal", re.IGNORECASE)
_TAKES_NONE = re.compile(
    r"not (?:currently )?(?:support|a (?:vision|multi-?modal))|unsupported|mmproj|(?:does not|doesn't|cannot|can't) "
    r"(?:support|take|accept|see|have)|text[- ]only|only (?:supports )?text|only supported by|no endpoints",
    re.IGNORECASE,
)
_OF_A_PICTURE = re.compile(
    r"format|media type|mime|size|dimension|too (?:large|many)|more than|\burls?\b", re.IGNORECASE
)
"""Words on one picture's faults, not on pictures as such."""
_KEY_LIKE = re.compile(
    r"\b(?:sk|pk|key|xai|gsk|hf|r8)[-_][A-Za-z0-9_\-]{8,}|\bAIza[A-Za-z0-9_\-]{8,}|(?i:bearer)\s+[^\s\"',;}]+"
)
_LEAST_KEY = 8
"""Shorter "keys", such as "none" for a local service, are no secrets, and may be words of an answer."""


class ServiceError(ModelError):
    """A model service failed or refused.

    Attributes:
        kind: what failed, for a connection test that names it; status: the HTTP status, 0 when there was none.
    """

    def __init__(self, message: str, fix: str = "", kind: FaultKind = "request", status: int = 0) -> None:
        super().__init__(message, fix)
        self.kind: FaultKind = kind
        self.status = status


class Fault(Exception):
    """One failed try: the error to show if it is the last, and whether another try may help.

    Attributes:
        retry: another try may help; after: seconds that the service asks to wait at least.
        sentence: the service's own words, "" when it gave none.
    """

    def __init__(self, error: ServiceError, retry: bool = False, after: float = 0.0, sentence: str = "") -> None:
        super().__init__(str(error))
        self.error = error
        self.retry = retry
        self.after = after
        self.sentence = sentence


def redact(text: str, key: str | None) -> str:
    """The text without the key, and without anything else that looks like one."""
    if key:
        text = without_key(text, key).replace(key, "[key]")
        if len(key) >= 12:
            # Services quote keys in part ("sk-abcd...wxyz"); a long enough beginning is as telling.
            text = re.sub(re.escape(key[:8]) + r"[^\s\"'<>]*", "[key]", text, flags=re.IGNORECASE)
    return _KEY_LIKE.sub("[key]", text)


def without_key(text: str, key: str | None) -> str:
    """The text without this key, in whatever form a service may have echoed it. Nothing else is changed."""
    if not key or len(key) < _LEAST_KEY:
        return text
    forms = {key, quote(key, safe=""), json.dumps(key)[1:-1], base64.b64encode(key.encode()).decode().rstrip("=")}
    for form in sorted(forms, key=len, reverse=True):
        text = re.sub(re.escape(form), "[key]", text, flags=re.IGNORECASE)
    return text


def plain(text: str, key: str | None) -> str:
    """A service's words as one short printable line without keys."""
    line = " ".join("".join(char if char.isprintable() else " " for char in text).split())
    line = redact(line, key)
    return line if len(line) <= _LONGEST_SENTENCE else line[: _LONGEST_SENTENCE - 3] + "..."


def provider_sentence(body: bytes, key: str | None) -> str:
    """The service's own sentence in an error body, "" when there is none to be read."""
    text = body[:_BODY_READ].decode("utf-8", "replace").strip()
    try:
        data = json.loads(text)
    except (ValueError, RecursionError):
        if text.startswith("<"):
            title = re.search(r"<title[^>]*>(.*?)</title>", text, re.IGNORECASE | re.DOTALL)
            return plain(title.group(1), key) if title else ""
        return plain(text, key)
    return plain(message_in(data), key)


def message_in(data: Any, depth: int = 0) -> str:
    """The most telling text in an error object of any vendor's shape."""
    if isinstance(data, str):
        return data
    if isinstance(data, list):
        return message_in(data[0], depth + 1) if data and depth < 4 else ""
    if not isinstance(data, dict) or depth > 4:
        return ""
    for name in ("error", "message", "detail", "msg", "errors", "error_description", "title"):
        found = message_in(data.get(name), depth + 1)
        if found:
            # OpenRouter wraps the vendor's own words.
            raw = data.get("metadata", {}).get("raw") if isinstance(data.get("metadata"), dict) else None
            return f"{found}: {raw}" if isinstance(raw, str) else found
    return ""


def quoted(sentence: str) -> str:
    """A service's own words as an end to a sentence of ours, "" when there are none."""
    return f' It says: "{sentence.rstrip(". ")}".' if sentence.strip(". ") else ""


def status_fault(status: int, body: bytes, headers: Mapping[str, str], host: str, key: str | None) -> Fault:
    """The fault for an HTTP status other than success, by the table in the reference.

    Money is never retried, whatever the status it comes with.
    """
    sentence = provider_sentence(body, key)
    return fault_for(status, sentence, _codes(body), retry_after(headers.get("Retry-After")), host)


def fault_for(status: int, sentence: str, codes: str, after: float, host: str) -> Fault:
    """The fault for a status (from HTTP or from inside an error body), the service's sentence and its error codes."""
    said = quoted(sentence)
    if status == 402 or (status in (400, 403, 429, 0) and _MONEY.search(f"{codes} {sentence}")):
        error = ServiceError(
            f"The account at {host} has no credit or has reached its limit.{said}",
            "Check the account's credit and limits; nothing is sent again by itself.",
            "money",
            status,
        )
        return Fault(error, sentence=sentence)
    if status in _BLIND_STATUSES and takes_none(sentence):
        error = ServiceError(f"The model at {host} takes no pictures.{said}", _EYES, "pictures", status)
        return Fault(error, sentence=sentence)
    if status in RETRIED_STATUSES:
        kind: FaultKind = "rate" if status == 429 else "server"
        what = "is asked too often" if status == 429 else f"is in trouble (status {status})"
        error = ServiceError(f"The service at {host} {what}.{said}", "Try again in a while.", kind, status)
        return Fault(error, retry=True, after=after, sentence=sentence)
    what, fix, kind = _REFUSALS.get(status, ("refused the request", "Check the settings of the model.", "request"))
    suffix = f" (status {status})" if status else ""
    return Fault(ServiceError(f"The service at {host} {what}{suffix}.{said}", fix, kind, status), sentence=sentence)


_EYES = "Choose a model that sees pictures."


def takes_none(sentence: str) -> bool:
    """Whether a service says that its model is one for text only, and not that it cannot use this one picture."""
    return bool(_PICTURES.search(sentence) and _TAKES_NONE.search(sentence) and not _OF_A_PICTURE.search(sentence))


_REFUSALS: dict[int, tuple[str, str, FaultKind]] = {
    400: ("refused the request", "Check the model's name and whether it takes pictures.", "request"),
    401: ("does not accept the API key", "Check the API key in the preferences.", "key"),
    403: ("does not allow this", "Check what the API key may do and which models it may use.", "key"),
    404: ("does not know this address or model", "Check the base URL and the model's name.", "model"),
    405: ("does not take requests at this address", "Check the base URL.", "model"),
    407: ("is behind a proxy that asks for a password", "Check the proxy settings.", "proxy"),
    413: ("finds the request too large", "Use a smaller picture.", "size"),
    422: ("refused the request", "Check the model's name and whether it takes pictures.", "request"),
}


def _codes(body: bytes) -> str:
    """The error codes in a body, joined, for telling money from rate."""
    try:
        data = json.loads(body[:_BODY_READ])
    except (ValueError, RecursionError):
        return ""
    error = data.get("error", data) if isinstance(data, dict) else None
    return error_codes(error)


def error_codes(error: Any) -> str:
    """The `code`, `type` and `status` of an error object, joined."""
    if not isinstance(error, dict):
        return ""
    return " ".join(str(error[name]) for name in ("code", "type", "status") if error.get(name) is not None)


def retry_after(value: str | None) -> float:
    """Seconds in a Retry-After header, which gives seconds or a date; 0 when it says nothing."""
    if not value:
        return 0.0
    try:
        seconds = float(value)
    except ValueError:
        try:
            seconds = email.utils.parsedate_to_datetime(value).timestamp() - time.time()
        except (ValueError, TypeError, OverflowError):
            return 0.0
    return min(max(0.0, seconds), 86_400.0) if seconds == seconds else 0.0
