# SPDX-License-Identifier: GPL-3.0-or-later
"""A forgiving JSON parser for one value; see `tolerant` for what it forgives and why."""

from __future__ import annotations

import re
from typing import Any

_SPACE = re.compile(r"(?:\s+|//[^\n]*|/\*.*?\*/)*", re.DOTALL)
_NUMBER = re.compile(r"[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?")
_WORD = re.compile(r"[+-]?[A-Za-z_$][A-Za-z0-9_$]*")
_PLAIN = {quote: re.compile(rf"[^{quote}\\]*") for quote in ('"', "'", '\u201c\u201d"')}
_ESCAPES = {"n": "\n", "t": "\t", "r": "\r", "b": "\b", "f": "\f"}
_HEX4 = re.compile(r"[0-9A-Fa-f]{4}")
_CONSTANTS: dict[str, Any] = {
    "true": True,
    "false": False,
    "null": None,
    "none": None,
    "nil": None,
    "undefined": None,
    "nan": None,
    "infinity": None,
    "inf": None,
}
_SMART = "\u201c\u201d\u201e"
_LONGEST_NUMBER = 400


class Unreadable(Exception):
    """What stands at `at` is not JSON; `expected` says what would be."""

    def __init__(self, expected: str, at: int) -> None:
        super().__init__(expected)
        self.expected = expected
        self.at = at

    def describe(self, text: str) -> str:
        """The problem in words, with the line in `text`. Made on demand: counting lines takes time."""
        line = text.count("\n", 0, self.at) + 1
        return f"line {line}: expected {self.expected} before {text[self.at : self.at + 20]!r}"


class Cut(Exception):
    """The text ended inside the value."""


class TooDeep(Exception):
    """The value is nested too deeply."""


class LooseParser:
    """Parses the value that starts at `at`; afterwards `at` is the place after it.

    Args:
        text: the whole text; at: where the value starts; max_depth: deepest nesting allowed.
    """

    def __init__(self, text: str, at: int, max_depth: int) -> None:
        self.text = text
        self.at = at
        self.max_depth = max_depth
        self._depth = 0

    def value(self) -> Any:
        """Parse one value.

        Raises:
            Unreadable, Cut, TooDeep: see there. Numbers may still be non-finite.
        """
        char = self._peek()
        if char == "{":
            return self._nested(self._members)
        if char == "[":
            return self._nested(self._items)
        if char in "\"'" or char in _SMART:
            return self._string()
        return self._literal()

    def _nested(self, parse: Any) -> Any:
        self._depth += 1
        if self._depth > self.max_depth:
            raise TooDeep
        self.at += 1
        result = parse()
        self._depth -= 1
        return result

    def _members(self) -> dict[str, Any]:
        members: dict[str, Any] = {}
        while True:
            if self._peek() == "}":
                self.at += 1
                return members
            key = self._key()
            if self._peek() != ":":
                raise self._unreadable("a colon after the key")
            self.at += 1
            members[key] = self.value()
            self._separator("}")

    def _items(self) -> list[Any]:
        items: list[Any] = []
        while True:
            if self._peek() == "]":
                self.at += 1
                return items
            items.append(self.value())
            self._separator("]")

    def _separator(self, closing: str) -> None:
        char = self._peek()
        if char == ",":
            self.at += 1
        elif char != closing:
            raise self._unreadable(f"a comma or {closing}")

    def _peek(self) -> str:
        """The next character that is neither space nor comment."""
        match = _SPACE.match(self.text, self.at)
        if match:
            self.at = match.end()
        if self.at >= len(self.text) or self.text.startswith("/*", self.at):
            raise Cut
        return self.text[self.at]

    def _key(self) -> str:
        char = self._peek()
        if char in "\"'" or char in _SMART:
            return self._string()
        match = _WORD.match(self.text, self.at)
        if not match or char in "+-":
            raise self._unreadable("a key")
        self.at = match.end()
        return match.group()

    def _string(self) -> str:
        opening = self.text[self.at]
        closing = '\u201c\u201d"' if opening in _SMART else opening
        plain = _PLAIN[closing]
        self.at += 1
        pieces: list[str] = []
        while True:
            match = plain.match(self.text, self.at)
            pieces.append(match.group() if match else "")
            self.at += len(pieces[-1])
            if "\n" in pieces[-1] and closing == "'":
                # An apostrophe in prose, not a string: neither Python nor JavaScript lets one run over a line's end.
                raise self._unreadable("the end of the string")
            if self.at >= len(self.text):
                raise Cut
            if self.text[self.at] in closing:
                self.at += 1
                return "".join(pieces)
            pieces.append(self._escape())

    def _escape(self) -> str:
        if self.at + 1 >= len(self.text):
            raise Cut
        char = self.text[self.at + 1]
        self.at += 2
        if char != "u":
            return _ESCAPES.get(char, char)
        match = _HEX4.match(self.text, self.at)
        if not match:
            if len(self.text) - self.at < 4:
                raise Cut
            raise self._unreadable("four hexadecimal digits")
        self.at = match.end()
        return chr(int(match.group(), 16))

    def _literal(self) -> Any:
        number = _NUMBER.match(self.text, self.at)
        if number:
            self.at = number.end()
            return _to_number(number.group())
        word = _WORD.match(self.text, self.at)
        if word:
            name = word.group().lstrip("+-").lower()
            if word.end() == len(self.text) and any(known.startswith(name) for known in _CONSTANTS):
                raise Cut
            if name in _CONSTANTS:
                self.at = word.end()
                return _CONSTANTS[name]
        if not self.text[self.at : self.at + 3].strip("+-.") and self.at + 3 > len(self.text):
            raise Cut
        raise self._unreadable("a value")

    def _unreadable(self, expected: str) -> Unreadable:
        return Unreadable(expected, self.at)


def _to_number(digits: str) -> int | float | None:
    """The number, None when it is absurdly long (Python itself refuses to convert such texts)."""
    if len(digits) > _LONGEST_NUMBER:
        return None
    try:
        return int(digits)
    except ValueError:
        return float(digits)
