# SPDX-License-Identifier: GPL-3.0-or-later
"""Changes of single places of a program's text, so that everything else stays as it was written, comments too."""

from __future__ import annotations

import ast


class Spots:
    """A text and what is to stand in some of its places."""

    def __init__(self, text: str) -> None:
        self._rows = [row.encode() for row in text.split("\n")]
        self._changes: list[tuple[int, int, bytes]] = []
        self._starts = [0]
        for row in self._rows:
            self._starts.append(self._starts[-1] + len(row) + 1)

    def _span(self, node: ast.expr) -> tuple[int, int]:
        start = self._starts[node.lineno - 1] + node.col_offset
        return start, self._starts[(node.end_lineno or node.lineno) - 1] + (node.end_col_offset or 0)

    def text_of(self, node: ast.expr) -> str:
        """What a node is written as."""
        start, end = self._span(node)
        return b"\n".join(self._rows)[start:end].decode()

    def replace(self, node: ast.expr, text: str) -> None:
        """Let something else stand in a node's place."""
        start, end = self._span(node)
        self._changes.append((start, end, text.encode()))

    def replace_word(self, line: int, column: int, old: str, new: str) -> None:
        """Let another word stand at a place given by its 1-based line and its column in UTF-8 bytes."""
        start = self._starts[line - 1] + column
        self._changes.append((start, start + len(old.encode()), new.encode()))

    def text(self) -> str:
        """The text with all changes; where two overlap the outer one counts."""
        whole, at = b"\n".join(self._rows), 0
        found = []
        for start, end, new in sorted(set(self._changes), key=lambda c: (c[0], -c[1])):
            if start < at:
                continue
            found += [whole[at:start], new]
            at = end
        return b"".join([*found, whole[at:]]).decode()
