# SPDX-License-Identifier: GPL-3.0-or-later
"""Which names mean the same kind of thing.

Similarity of two names: 1 for the same kind, 0.95 where one is the general word for the other ("bed" for a double bed),
0.5 for kinds of one group that do the same work (sofa and armchair), else 0. `STRICT` and above count as the same thing.

A name is looked up by its longest known phrase, the end first, since the last word of an English compound says what the
thing is; what follows "with", "on", "for" is left out, and so is "a stack of". Names that the table does not know are
compared by their own words: the same last word 0.95, any word in common 0.5. So the table decides nothing about what may
exist; it only forgives other words for the same thing.

Sources: the table (`categories.txt`) was written by hand; general words are the hypernyms that WordNet 3.1 has for the
nouns (an armchair is a chair, a sofa is not), groups follow the super-categories of 3D-FRONT (bed, chair, sofa, table,
cabinet/shelf, lighting). The page of definitions that this library started from has one with 141 kinds; this is another.
"""

from __future__ import annotations

import functools
import re
from pathlib import Path

STRICT = 0.95
TABLE = Path(__file__).with_name("categories.txt")

_STACKS = {"stack", "pile", "set", "pair", "row", "group", "bunch", "piece", "cluster"}
_BREAKS = {"with", "on", "for", "in", "by", "and", "under", "of"}


class _Kind:
    """One row of the table."""

    def __init__(self, row: str) -> None:
        fields = [*(field.strip() for field in row.split("|")), "", ""]
        self.name, self.groups = fields[0], frozenset(fields[2].split())
        self.general = {word.strip() for word in fields[1].split(",") if word.strip()}
        self.names = [fields[0], *(name.strip() for name in fields[3].split(",") if name.strip())]
        self.symmetry = int(fields[4]) if fields[4] else 1


@functools.cache
def _kinds() -> dict[str, _Kind]:
    rows = TABLE.read_text(encoding="utf-8").splitlines()
    return {kind.name: kind for kind in (_Kind(row) for row in rows if row and not row.startswith("#"))}


@functools.cache
def _phrases() -> dict[tuple[str, ...], str]:
    found: dict[tuple[str, ...], str] = {}
    for kind in _kinds().values():
        for name in kind.names:
            found.setdefault(tuple(words(name)), kind.name)
    return found


def words(name: str) -> list[str]:
    """A name's words in lower case, without the plural's s."""
    return [_singular(word) for word in re.findall(r"[a-z]+", name.lower().replace("'s", "").replace("_", " "))]


def _singular(word: str) -> str:
    if word.endswith("ies") and len(word) > 4:
        return word[:-3] + "y"
    if word.endswith(("ches", "shes", "xes", "sses")):
        return word[:-2]
    if word.endswith("ves") and len(word) > 4:
        return word[:-3] + "f"
    return word[:-1] if len(word) > 3 and word.endswith("s") and not word.endswith(("ss", "us")) else word


def _head(name: str) -> list[str]:
    """The words up to what only describes: "vase of flowers" is a vase, "stack of books" is books."""
    rest = words(name)
    while "of" in rest and set(rest[: rest.index("of")]) & _STACKS:
        rest = rest[rest.index("of") + 1 :]
    cut = next((i for i, word in enumerate(rest) if i and word in _BREAKS), len(rest))
    return rest[:cut]


@functools.cache
def kind_of(name: str) -> str | None:
    """The table's kind for a name, None when it knows none of its words."""
    phrases = _phrases()
    whole = phrases.get(tuple(words(name)))
    if whole is not None:
        return whole
    rest = _head(name)
    for end in range(len(rest), 0, -1):
        for start in range(end):
            found = phrases.get(tuple(rest[start:end]))
            if found is not None:
                return found
    return None


def kinds(name: str) -> frozenset[str]:
    """The kind of a name, its general words, and its groups; empty when unknown."""
    kind = _kinds().get(kind_of(name) or "")
    return frozenset() if kind is None else frozenset({kind.name, *kind.general, *kind.groups})


def symmetry(name: str) -> int:
    """Symmetry class to assume: 1 has a front, 2 looks the same turned by 180 degrees, 4 by 90, 0 from everywhere."""
    kind = _kinds().get(kind_of(name) or "")
    return 1 if kind is None else kind.symmetry


@functools.cache
def similarity(a: str, b: str) -> float:
    """How alike two names are, 0, 0.5, 0.95 or 1; symmetric."""
    if a == b or words(a) == words(b):
        return 1.0
    first, second = _kinds().get(kind_of(a) or ""), _kinds().get(kind_of(b) or "")
    if first is not None and second is not None:
        if first is second:
            return 1.0
        if second.name in first.general or first.name in second.general:
            return STRICT
        return 0.5 if first.groups & second.groups else 0.0
    head, other = _head(a), _head(b)
    if head and other and head[-1] == other[-1]:
        return STRICT
    return 0.5 if set(head) & set(other) else 0.0
