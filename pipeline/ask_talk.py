# SPDX-License-Identifier: GPL-3.0-or-later
"""What was asked and answered in this session, for the artist to read. Pictures are noted by hash and size only.

Nothing of it is written to a file by itself, and what is too much is forgotten, the oldest first.
"""

from __future__ import annotations

import hashlib
import io
import threading
from collections import OrderedDict
from collections.abc import Iterable
from dataclasses import dataclass, field

from PIL import Image

from .memory import Entry
from .models.base import Prompt, Reply

_MOST_BYTES = 24_000_000
_MOST_REPLY = 2_000_000
_LINE = 1000
"""The text editor wraps lines itself, but is slow with very long ones."""


@dataclass
class Exchange:
    """One prompt of this session and what was answered to it.

    Attributes:
        pictures: a line for each: hash, size, bytes. replies: model and text, in their order; repairs: the prompts of the
            repair round, each with its own replies.
    """

    room: str
    stage: str
    key: str
    hash: str
    text: str
    schema_name: str
    pictures: tuple[str, ...]
    replies: list[tuple[str, str]] = field(default_factory=list)
    repairs: list[Exchange] = field(default_factory=list)

    @property
    def size(self) -> int:
        """Characters, about."""
        own = len(self.text) + sum(len(text) for _, text in self.replies)
        return own + sum(repair.size for repair in self.repairs)


class Talk:
    """The prompts and answers of a session, by the prompt's hash. Thread-safe."""

    def __init__(self, most_bytes: int = _MOST_BYTES) -> None:
        self._most = most_bytes
        self._known: OrderedDict[tuple[str, str, str], Exchange] = OrderedDict()
        self._by_hash: dict[str, Exchange] = {}
        self._lock = threading.Lock()

    def note_prompt(self, room: str, prompt: Prompt) -> None:
        """A prompt is about to be answered, by a model or by an earlier answer."""
        name = room, prompt.stage, prompt.hash
        with self._lock:
            found = self._known.get(name)
            if found is None:
                found = self._known[name] = _exchange(room, prompt)
            self._known.move_to_end(name)
            self._by_hash[prompt.hash] = found
            self._forget()

    def note_repair(self, first: Prompt, second: Prompt) -> None:
        """A prompt's answer could not be used; it is asked once more."""
        with self._lock:
            found = self._by_hash.get(first.hash)
            if found is not None:
                repair = _exchange(found.room, second)
                found.repairs.append(repair)
                self._by_hash[second.hash] = repair

    def note_reply(self, prompt: Prompt, reply: Reply) -> None:
        """An answer came, usable or not."""
        with self._lock:
            found = self._by_hash.get(prompt.hash)
            if found is not None and (reply.model, reply.text) not in found.replies:
                found.replies.append((reply.model, reply.text[:_MOST_REPLY]))

    def of_room(self, room: str) -> list[Exchange]:
        """What was asked of one room, in its order."""
        with self._lock:
            return [exchange for exchange in self._known.values() if exchange.room == room]

    def forget(self) -> None:
        """Everything."""
        with self._lock:
            self._known.clear()
            self._by_hash.clear()

    def _forget(self) -> None:
        """The oldest, while there is too much of it."""
        total = sum(exchange.size for exchange in self._known.values())
        while total > self._most and len(self._known) > 1:
            _, gone = self._known.popitem(last=False)
            total -= gone.size
            for exchange in (gone, *gone.repairs):
                self._by_hash.pop(exchange.hash, None)


TALK = Talk()
"""This session's."""


def talk_text(exchanges: Iterable[Exchange], answers: Iterable[Entry]) -> str:
    """Prompts and answers as one readable text.

    Args:
        exchanges: of this session. answers: memory's entries of the type "Answer"; those whose prompt is not of this
            session are shown with the prompt's hash only.
    """
    parts = [
        "Prompts and answers of this room, for reading; a change here changes nothing.",
        "Of pictures there is only the hash. Prompts of earlier sessions are not kept, their answers are.",
    ]
    kept: dict[str, list[Entry]] = {}
    for entry in answers:
        kept.setdefault(entry.meta.prompt_hash, []).append(entry)
    shown = list(exchanges)
    known = {exchange.hash for exchange in shown}
    for hash_, entries in kept.items():
        if hash_ not in known:
            for entry in entries:
                parts += _heading(entry.stage, str(entry.output.get("key", "")))
                parts.append(f"(prompt {hash_[:16] or 'unknown'} of an earlier session)")
                parts += _said(entry.meta.model, str(entry.output.get("text", "")), _took(entry))
    for exchange in shown:
        parts += _heading(exchange.stage, exchange.key)
        parts += _asked(exchange)
        entries = kept.get(exchange.hash, [])
        told = {text for _, text in exchange.replies}
        for model, text in exchange.replies:
            took = next((_took(entry) for entry in entries if entry.output.get("text") == text), "")
            parts += _said(model, text, took)
        for repair in exchange.repairs:
            parts += ["", "-- asked once more, since the answer could not be used", *_asked(repair)]
            for model, text in repair.replies:
                told.add(text)
                parts += _said(model, text, "")
        for entry in entries:
            if entry.output.get("text") not in told:
                parts += _said(entry.meta.model, str(entry.output.get("text", "")), _took(entry) + ", used again")
        if not told and not entries:
            parts.append("-- not answered")
    return "\n".join(_wrapped("\n".join(parts))) + "\n"


def _exchange(room: str, prompt: Prompt) -> Exchange:
    pictures = tuple(_picture_line(number, image) for number, image in enumerate(prompt.images, 1))
    return Exchange(room, prompt.stage, prompt.key, prompt.hash, prompt.text, prompt.schema_name, pictures)


def _picture_line(number: int, image: bytes) -> str:
    try:
        with Image.open(io.BytesIO(image)) as opened:
            size = f"{opened.width} x {opened.height} pixels"
    except Exception:  # whatever Pillow raises on bytes that are no picture
        size = "not readable"
    return f"picture {number}: sha256 {hashlib.sha256(image).hexdigest()[:16]}, {size}, {len(image) / 1000:.0f} kB"


def _heading(stage: str, key: str) -> list[str]:
    return ["", "=" * 80, f"{stage}: {key}", "=" * 80]


def _asked(exchange: Exchange) -> list[str]:
    return [
        f"-- prompt {exchange.hash[:16]}, to be answered as {exchange.schema_name}",
        *exchange.pictures,
        exchange.text,
    ]


def _said(model: str, text: str, took: str) -> list[str]:
    return ["", f"-- answer of {model or 'an unknown model'}{': ' + took if took else ''}", text]


def _took(entry: Entry) -> str:
    meta = entry.meta
    words = [f"{meta.seconds:.1f} s", f"{meta.prompt_tokens} tokens sent, {meta.completion_tokens} answered"]
    if meta.cost is not None:
        words.append(f"${meta.cost:.4f}")
    return ", ".join(words)


def _wrapped(text: str) -> list[str]:
    """Lines that Blender's text editor can show: long ones, such as JSON in one line, are broken anywhere."""
    lines: list[str] = []
    for line in text.splitlines():
        lines += [line[i : i + _LINE] for i in range(0, len(line), _LINE)] or [""]
    return lines
