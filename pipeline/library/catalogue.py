# SPDX-License-Identifier: GPL-3.0-or-later
"""The furniture library: pieces written in the room language, found by name or by words, and handed out as text.

A piece is a def in a file of `pieces/` whose first parameter is `size` (width, depth, height in metres). It returns
shapes that fill exactly that size: standing on z = 0, centred on x and y, front towards -Y. Its docstring says what it
is, then has lines `words:` (what it is called, most usual first), `typical:` (three metres), `placement:`, and one line
for each further parameter. Defs without `words:` are the pieces' own helpers.
"""

from __future__ import annotations

import ast
import functools
import re
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

FOLDER = Path(__file__).resolve().parent / "pieces"
SUFFIX = ".room"
RESERVED = ("words", "typical", "placement")


@dataclass(frozen=True)
class Piece:
    """A piece of the library.

    Attributes:
        name: of its def. title: what it is, one line. words: what it may be called. typical: usual size in metres.
        parameters: name -> (default as written, what it means).
        group: the file that it is in.
    """

    name: str
    title: str
    words: tuple[str, ...]
    typical: tuple[float, float, float]
    placement: str
    group: str
    parameters: dict[str, tuple[str, str]] = field(default_factory=dict)


@dataclass(frozen=True)
class Definition:
    """One def of the library: its text and the names it uses."""

    name: str
    text: str
    uses: frozenset[str]
    doc: str
    node: ast.FunctionDef
    group: str


@functools.lru_cache(maxsize=1)
def definitions() -> dict[str, Definition]:
    """Every def of the library by name, in the order of files and lines."""
    found: dict[str, Definition] = {}
    for path in sorted(FOLDER.glob(f"*{SUFFIX}")):
        text = path.read_text(encoding="utf-8")
        lines = text.split("\n")
        for node in ast.parse(text).body:
            if isinstance(node, ast.FunctionDef):
                source = "\n".join(lines[node.lineno - 1 : node.end_lineno])
                bound = {n.id for n in ast.walk(node) if isinstance(n, ast.Name) and not isinstance(n.ctx, ast.Load)}
                bound |= {a.arg for a in ast.walk(node) if isinstance(a, ast.arg)}
                # A def's own names may be spelt as other defs are.
                uses = frozenset(n.id for n in ast.walk(node) if isinstance(n, ast.Name)) - bound
                doc = ast.get_docstring(node) or ""
                found[node.name] = Definition(node.name, source, uses, doc, node, path.stem)
    return found


@functools.lru_cache(maxsize=1)
def pieces() -> dict[str, Piece]:
    """Every piece by name."""
    return {d.name: _piece(d) for d in definitions().values() if re.search(r"^words:", d.doc, re.MULTILINE)}


def _piece(definition: Definition) -> Piece:
    lines = definition.doc.splitlines()
    said = dict(re.findall(r"^(\w+): *(.+)$", definition.doc, re.MULTILINE))
    arguments = definition.node.args
    names = [a.arg for a in arguments.args][1:]
    defaults = [ast.unparse(d) for d in arguments.defaults]
    width, depth, height = (float(v) for v in said["typical"].split())
    return Piece(
        name=definition.name,
        title=lines[0].rstrip("."),
        words=tuple(word.strip() for word in said["words"].split(",")),
        typical=(width, depth, height),
        placement=said.get("placement", "floor"),
        group=definition.group,
        parameters={n: (d, said.get(n, "")) for n, d in zip(names, defaults, strict=True)},
    )


def source(names: Sequence[str]) -> str:
    """The text of these defs and all that they use, each once and after what it needs.

    Raises:
        KeyError: there is no def of this name.
    """
    known = definitions()
    ordered: dict[str, str] = {}

    def add(name: str) -> None:
        if name in ordered:
            return
        for used in sorted(known[name].uses & known.keys() - {name}):
            add(used)
        ordered[name] = known[name].text

    for name in names:
        add(name)
    return "\n\n\n".join(ordered.values()) + "\n" if ordered else ""


def find(category: str, label: str = "", placement: str = "") -> list[tuple[float, Piece]]:
    """Pieces that fit a category and a label, best first, each with a score above 0 (1 is a word for word match).

    The head noun of the category (its last word, as in English) weighs most; `placement` breaks ties.
    """
    wanted, hints = _words(category), frozenset(_words(label))
    scored = []
    for piece in pieces().values():
        best = max((_fit(wanted, hints, _words(word)) for word in piece.words), default=0.0)
        if best > 0:
            scored.append((best + (0.02 if placement and piece.placement == placement else 0.0), piece))
    return sorted(scored, key=lambda item: (-item[0], item[1].name))


@functools.lru_cache(maxsize=4096)
def _words(text: str) -> tuple[str, ...]:
    return tuple(_singular(word) for word in re.findall(r"[a-z0-9]+", text.lower()))


def _singular(word: str) -> str:
    if word.endswith("ves") and len(word) > 4:
        return word[:-3] + "f"
    if word.endswith(("ches", "shes", "xes", "sses")):
        return word[:-2]
    return word[:-1] if len(word) > 3 and word.endswith("s") and not word.endswith(("ss", "us")) else word


def _fit(wanted: tuple[str, ...], hints: frozenset[str], name: tuple[str, ...]) -> float:
    """How well the name of a piece fits, 0 to 1."""
    if not wanted or not name:
        return 0.0
    if wanted == name:
        return 1.0
    head = 0.5 if wanted[-1] == name[-1] else 0.0
    if not head and name[0] not in wanted and name[0] not in hints:
        return 0.0
    own = set(name)
    if not head and not own <= set(wanted):
        return 0.35 + 0.15 * len(hints & own) / len(name) if own <= hints else 0.0
    shared = len(own.intersection(wanted))
    said = 0.3 * shared / max(len(wanted), len(name)) + (0.05 if own <= set(wanted) else 0.0)
    return head + said + 0.15 * len(hints & own) / len(name)
