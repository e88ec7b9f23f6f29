# SPDX-License-Identifier: GPL-3.0-or-later
"""Reads the JSON in a model's answer, forgiving what is safe to forgive.

Forgiven: code fences, prose and reasoning around the value, a byte order mark, trailing commas, comments, Python's and
JavaScript's spellings (`None`, `True`, single quotes, bare keys), typographic quotes used as string delimiters, and
non-finite numbers, which become null. Duplicate keys: the last wins. A text that ends in the middle of a value is a
`CutReplyError`; everything else that cannot be read is a `ReplyError`. Nothing else is ever raised.
"""

from __future__ import annotations

import json
import math
import re
from typing import Any

from ..errors import CutReplyError, ReplyError
from .loose_json import Cut, LooseParser, TooDeep, Unreadable

MAX_CHARACTERS = 5_000_000
"""Longest text that is read; the longest honest answer is far below a tenth of it."""
MAX_DEPTH = 64
_LOOSE_CHARACTERS = 1_000_000
"""Longest text that the slower, forgiving parser takes on."""
_THINKING_END = "</think>"
_FENCE = re.compile(r"```[A-Za-z0-9_-]*[ \t]*\r?\n?")
_OPENING = re.compile(r"[{\[]")
_BRACKETS = re.compile(r'[{}\[\]]|"(?:[^"\\\n]|\\.)*"')
_LIKE_JSON = re.compile(r"""[{\[]\s*["'{\[\u201c]""")
_BIG = 1e300


def read_json(text: str) -> Any:
    """The JSON value in a model's answer: dicts, lists, strings, finite numbers, booleans and None.

    When the text holds several values, the last that is at least half as long as the longest is taken: a model that
    corrects itself does so at the end.

    Raises:
        CutReplyError: the answer ends in the middle of the value.
        ReplyError: there is no readable JSON in it, or it is too long or too deeply nested.
    """
    return read_json_noted(text)[0]


def read_json_noted(text: str) -> tuple[Any, tuple[str, ...]]:
    """As `read_json`, with sentences on what had to be forgiven."""
    if len(text) > MAX_CHARACTERS:
        raise ReplyError("The answer is too long to be a description of a room.", "Ask again.")
    body = text.replace("\ufeff", "").strip()
    # A text that begins with JSON has no reasoning before it; the tag is then part of a string.
    if _THINKING_END in body and body[0] not in "{[":
        body = body.rsplit(_THINKING_END, 1)[1].strip()
    if not body:
        raise ReplyError("The answer is empty.", "Ask again.", ("The answer is empty.",))
    notes: list[str] = []
    try:
        data = json.loads(body, strict=False, parse_constant=lambda _: None)
    except RecursionError:
        raise _too_deep() from None
    except ValueError:
        data = _read_loosely(body, notes)
    cleaner = _Cleaner()
    data = cleaner.clean(data, 0)
    return data, (*notes, *cleaner.notes())


def _too_deep() -> ReplyError:
    sentence = f"The answer is nested more than {MAX_DEPTH} levels deep."
    return ReplyError(sentence, "Ask again.", (sentence,))


def _read_loosely(body: str, notes: list[str]) -> Any:
    """Find the value in a text that is not strict JSON from end to end."""
    if len(body) > _LOOSE_CHARACTERS:
        raise ReplyError("The answer is not JSON and too long to be mended.", "Ask again.", ("It is not JSON.",))
    search = _Search(_FENCE.sub("\n", body) if "```" in body else body)
    search.run()
    longest = max((length for _, length in search.found), default=0)
    if search.cut > longest:
        sentence = "The answer ends in the middle of the JSON."
        raise CutReplyError("The model's answer was cut off.", "Ask again.", (sentence,))
    if search.broken >= longest:
        sentence = f"The answer is not JSON: {search.reason}."
        raise ReplyError("The answer holds no readable JSON.", "Ask again.", (sentence,))
    chosen = [value for value, length in search.found if 2 * length >= longest][-1]
    notes.append("The answer was not strict JSON and was read tolerantly.")
    if len(search.found) > 1:
        notes.append(f"The answer held {len(search.found)} JSON values; one was taken.")
    return chosen


class _Search:
    """Looks for every readable object or list in a text.

    A part of an object that itself cannot be read is never taken for the answer: that would lose the rest silently.

    Attributes:
        found: values with their lengths; cut: length of a value that the text's end cuts, 0 when there is none;
        broken: length of the longest value that cannot be read; reason: what is wrong with it.
    """

    def __init__(self, body: str) -> None:
        self.body = body
        self.found: list[tuple[Any, int]] = []
        self.cut = 0
        self.broken = 0
        self.reason = "there is no { or [ in it"

    def run(self) -> None:
        """Walk over the text once; prose with many stray brackets ends the search early."""
        effort = 4 * len(self.body) + 100_000
        start = self._next_opening(0)
        while start >= 0 and effort > 0:
            parser = LooseParser(self.body, start, MAX_DEPTH)
            try:
                value = parser.value()
            except TooDeep:
                raise _too_deep() from None
            except Cut:
                self.cut = len(self.body) - start
                return
            except Unreadable as problem:
                end = self._closing(start)
                effort -= (end or len(self.body)) - start
                self._note_broken(start, end, problem)
                if self.cut:
                    return
                start = self._next_opening(end or start + 1)
            else:
                self.found.append((value, parser.at - start))
                start = self._next_opening(parser.at)

    def _note_broken(self, start: int, end: int, problem: Unreadable) -> None:
        if not end and _LIKE_JSON.match(self.body, start):
            self.cut = len(self.body) - start
        length = max(1, end - start)
        if length > self.broken:
            self.broken, self.reason = length, problem.describe(self.body)

    def _next_opening(self, position: int) -> int:
        match = _OPENING.search(self.body, position)
        return match.start() if match else -1

    def _closing(self, start: int) -> int:
        """The place after the bracket that closes the one at `start`, 0 when none does."""
        depth = 0
        for match in _BRACKETS.finditer(self.body, start):
            char = match.group()[0]
            if char in "{[":
                depth += 1
            elif char in "}]":
                depth -= 1
                if depth == 0:
                    return match.end()
        return 0


class _Cleaner:
    """Makes parsed data safe to keep: finite numbers, encodable text, bounded depth."""

    def __init__(self) -> None:
        self.non_finite = 0

    def clean(self, value: Any, depth: int) -> Any:
        if depth > MAX_DEPTH:
            raise _too_deep()
        if isinstance(value, dict):
            return {_text(key): self.clean(item, depth + 1) for key, item in value.items()}
        if isinstance(value, list):
            return [self.clean(item, depth + 1) for item in value]
        if isinstance(value, str):
            return _text(value)
        if isinstance(value, (int, float)) and not isinstance(value, bool):
            return self._number(value)
        return value

    def _number(self, value: int | float) -> int | float | None:
        if isinstance(value, float) and not math.isfinite(value) or abs(value) > _BIG:
            self.non_finite += 1
            return None
        return value

    def notes(self) -> tuple[str, ...]:
        if not self.non_finite:
            return ()
        return (f"{self.non_finite} numbers were not finite and were read as missing.",)


def _text(value: str) -> str:
    """The string without lone surrogates, which no file could keep."""
    if value.isascii():
        return value
    return value.encode("utf-16", "surrogatepass").decode("utf-16", "replace")
