# SPDX-License-Identifier: GPL-3.0-or-later
"""Server-sent events (HTML Living Standard, section 9.2), as far as model services use them: the data of each event."""

from __future__ import annotations

import re

_LINE_END = re.compile(rb"\r\n|\n|\r")


class EventReader:
    """Fed with the bytes of a stream in pieces of any size, gives the data of each finished event."""

    def __init__(self) -> None:
        self._rest = b""
        self._data: list[str] = []

    def feed(self, piece: bytes) -> list[str]:
        """The data of the events that this piece finishes."""
        buffer = self._rest + piece
        # A carriage return at the end may be the first half of a line end.
        held = b"\r" if buffer.endswith(b"\r") else b""
        *lines, rest = _LINE_END.split(buffer[: len(buffer) - len(held)])
        self._rest = rest + held
        return [event for line in lines for event in self._line(line)]

    def finish(self) -> list[str]:
        """The data of a last event that the stream's end finishes (some services leave out the empty line)."""
        events = self._line(self._rest.rstrip(b"\r")) if self._rest else []
        self._rest = b""
        return events + self._line(b"")

    def _line(self, line: bytes) -> list[str]:
        if not line:
            data, self._data = self._data, []
            return ["\n".join(data)] if data else []
        name, _, value = line.decode("utf-8", "replace").lstrip("\ufeff").partition(":")
        if name == "data":
            self._data.append(value.removeprefix(" "))
        return []
