# SPDX-License-Identifier: GPL-3.0-or-later
"""Server-sent events (HTML Living Standard, section 9.2), as far as model services use them: the data of each event."""

from __future__ import annotations

import re

_LINE_END = re.compile(rb"\r\n|\n|\r")


class EventReader:
    """Fed with the bytes of a stream in pieces of any size, gives the data of each finished event."""

    def __init__(self) -> None:
        self._rest: list[bytes] = []
        self._held = False
        self._data: list[str] = []

    def feed(self, piece: bytes) -> list[str]:
        """The data of the events that this piece finishes."""
        self._rest.append(piece)
        if not self._held and not _LINE_END.search(piece):
            # Put together once: looking at a long line again with each piece would take the square of its length.
            return []
        buffer = b"".join(self._rest)
        # A carriage return at the end may be the first half of a line end.
        self._held = buffer.endswith(b"\r")
        *lines, rest = _LINE_END.split(buffer[:-1] if self._held else buffer)
        self._rest = [rest + b"\r" if self._held else rest]
        return [event for line in lines for event in self._line(line)]

    def finish(self) -> list[str]:
        """The data of a last event that the stream's end finishes (some services leave out the empty line)."""
        rest = b"".join(self._rest)
        events = self._line(rest.rstrip(b"\r")) if rest else []
        self._rest, self._held = [], False
        return events + self._line(b"")

    def _line(self, line: bytes) -> list[str]:
        if not line:
            data, self._data = self._data, []
            return ["\n".join(data)] if data else []
        name, _, value = line.decode("utf-8", "replace").lstrip("\ufeff").partition(":")
        if name == "data":
            self._data.append(value.removeprefix(" "))
        return []
