# SPDX-License-Identifier: GPL-3.0-or-later
"""What of a joined text some names need: found by following names from statement to statement, never by lists.

The text is taken apart into its statements at module level, and its classes into their methods. A statement is needed
when a needed one looks up a name that it binds, a method when any needed statement asks something for an attribute of its
name. What is left keeps its order, its headings and the comments that stand right above it.
"""

from __future__ import annotations

import ast
import functools
import re
import symtable
import textwrap
from collections.abc import Collection, Iterable, Sequence
from dataclasses import dataclass, field

HEADING = re.compile(r"# ---- .+ -{4,}$")
"""A comment that begins a section: "# ---- shapes ----", with many dashes for one that holds others."""
_LONG = 60
_DEF = re.compile(r"^(?=def )", re.MULTILINE)


@dataclass(frozen=True)
class Piece:
    """A statement of a module, or a method of a class of it.

    Attributes:
        text: its lines with the comments right above them, "" for a class that is its methods' `owner` only.
        names: what it binds in the module; a method binds nothing.
        uses: names that it looks up in the module.
        attributes: names that it asks things for.
        owner: of a method: its class and its own name.
        calls_any: whether it looks up attributes whose names are worked out, so that no method of its class is spare.
        above: blank lines above it.
    """

    text: str
    names: frozenset[str]
    uses: frozenset[str]
    attributes: frozenset[str]
    owner: tuple[str, str] | None = None
    calls_any: bool = False
    above: int = 2


@dataclass(frozen=True)
class Heading:
    """A section's heading, with the comment that belongs to it."""

    text: str
    is_long: bool


@dataclass
class Pieces:
    """A module's text, taken apart.

    Attributes:
        items: its pieces and headings in their order.
        binds: which pieces bind a name.
    """

    items: list[Piece | Heading] = field(default_factory=list)
    binds: dict[str, list[Piece]] = field(default_factory=dict)

    @staticmethod
    def of(text: str, titles: bool = True) -> Pieces:
        """Take a module apart. Without `titles`, only joined modules have headings, with nothing below them."""
        found = Pieces()
        lines = text.split("\n")
        last = 0
        for node in ast.parse(text).body:
            start = _first_line(node)
            comment = _comment_above(lines, last, start)
            found.items += _headings(lines[last:comment], titles)
            for piece in _taken_apart(node, lines, comment):
                found.items.append(piece)
                for name in piece.names:
                    found.binds.setdefault(name, []).append(piece)
            last = node.end_lineno or node.lineno
        return found

    def needed(self, names: Iterable[str]) -> set[int]:
        """The places in `items` of all that these names need, directly or not."""
        methods = [(at, item) for at, item in enumerate(self.items) if isinstance(item, Piece) and item.owner]
        places = {id(item): at for at, item in enumerate(self.items)}
        attributes: set[str] = set()
        whole: set[str] = set()
        kept: set[int] = set()
        waiting = [piece for name in names for piece in self.binds.get(name, ())]
        while waiting:
            while waiting:
                piece = waiting.pop()
                if places[id(piece)] in kept:
                    continue
                kept.add(places[id(piece)])
                attributes |= piece.attributes
                if piece.calls_any and piece.owner:
                    whole.add(piece.owner[0])
                waiting += [other for name in piece.uses for other in self.binds.get(name, ())]
            for at, item in methods:
                owner, name = item.owner or ("", "")
                asked = name in attributes or owner in whole or (name.startswith("__") and name.endswith("__"))
                if asked and at not in kept and places[id(self.binds[owner][0])] in kept:
                    waiting.append(item)
        return kept

    def text(self, kept: Collection[int]) -> str:
        """The needed pieces as a module's text, with the headings of sections that have any."""
        blocks: list[str] = []
        headings: list[Heading] = []
        above = 0
        for at, item in enumerate(self.items):
            if isinstance(item, Heading):
                headings = [*([] if item.is_long else [h for h in headings if h.is_long]), item]
                continue
            above = max(above, item.above)
            if at in kept:
                blocks += [f"\n\n{heading.text}" for heading in headings]
                blocks.append("\n" * (1 if headings else above) + item.text)
                headings, above = [], 0
        return "\n".join(blocks).strip("\n") + "\n"


def global_names(text: str) -> set[str]:
    """The names that a module looks up at its top level or from its functions, as Python's own rules of scope have it.

    Raises:
        SyntaxError, ValueError, RecursionError: it is not Python, or too deeply nested.
    """
    try:
        return set().union(*map(_names_of_part, _DEF.split(text)))
    except SyntaxError:  # a string or a bracket goes on past what begins like a function, or it is not Python
        return set(_names_of_part.__wrapped__(text))


@functools.lru_cache(maxsize=2048)
def _names_of_part(text: str) -> frozenset[str]:
    """As `global_names`: most functions of a room are the same from one version to the next."""
    found: set[str] = set()
    tables = [symtable.symtable(text, "room", "exec")]
    while tables:
        table = tables.pop()
        if isinstance(table, symtable.Function):
            found.update(table.get_globals())
        else:
            top = table.get_type() == "module"
            found |= {s.get_name() for s in table.get_symbols() if (s.is_referenced() if top else s.is_global())}
        tables += table.get_children()
    return frozenset(found)


# ---- taking apart ----


def _first_line(node: ast.stmt) -> int:
    """The line (from 0) that a statement begins in, decorators included."""
    decorators = node.decorator_list if isinstance(node, (ast.FunctionDef, ast.ClassDef)) else []
    return min([node.lineno, *(d.lineno for d in decorators)]) - 1


def _comment_above(lines: Sequence[str], low: int, start: int) -> int:
    """Where the comment right above a statement begins; headings do not belong to it."""
    at = start
    while at > low and lines[at - 1].lstrip().startswith("#") and not HEADING.match(lines[at - 1]):
        at -= 1
    return start if at > low and HEADING.match(lines[at - 1]) else at


def _headings(lines: Sequence[str], titles: bool) -> list[Heading]:
    """The headings among lines between two statements; without titles those of modules, and as short as they can be."""
    found: list[list[str]] = []
    for line in lines:
        if HEADING.match(line):
            found.append([line])
        elif titles and found and line.startswith("#"):
            found[-1].append(line)
    if titles:
        return [Heading("\n".join(block), len(block[0]) > _LONG) for block in found]
    return [Heading(re.sub(r"-{4,}$", "----", line), True) for [line] in found if len(line) > _LONG]


def _taken_apart(node: ast.stmt, lines: Sequence[str], start: int) -> list[Piece]:
    """The piece or pieces of one statement at module level."""
    if not isinstance(node, ast.ClassDef):
        return [_piece(node, lines, start, frozenset(_bound(node)))]
    methods = [child for child in node.body if isinstance(child, ast.FunctionDef)]
    taken: set[int] = set()
    found: list[Piece] = []
    for method in methods:
        first = _comment_above(lines, node.lineno, _first_line(method))
        taken |= set(range(first, method.end_lineno or method.lineno))
        found.append(_piece(method, lines, first, frozenset(), (node.name, method.name)))
    rest = [child for child in node.body if child not in methods] or [ast.Pass()]
    head = ast.ClassDef(node.name, node.bases, node.keywords, rest, node.decorator_list)
    own = [line for at, line in enumerate(lines[start : node.end_lineno], start) if at not in taken]
    text = re.sub(r"\n{3,}", "\n\n", "\n".join(own)).rstrip()
    return [
        Piece(text, frozenset({node.name}), _looked_up(ast.unparse(head)), _asked(head), above=_blank(lines, start)),
        *found,
    ]


def _piece(
    node: ast.stmt, lines: Sequence[str], start: int, names: frozenset[str], owner: tuple[str, str] | None = None
) -> Piece:
    text = "\n".join(lines[start : node.end_lineno])
    return Piece(text, names, _looked_up(text), _asked(node), owner, _calls_any(node), _blank(lines, start))


def _blank(lines: Sequence[str], start: int) -> int:
    """How many blank lines are above a line."""
    at = start
    while at > 0 and not lines[at - 1].strip():
        at -= 1
    return min(2, start - at)


def _bound(node: ast.stmt) -> set[str]:
    """Names that a statement binds in its module."""
    if isinstance(node, (ast.Import, ast.ImportFrom)):
        return {alias.asname or alias.name for alias in node.names}
    if isinstance(node, ast.FunctionDef):
        return {node.name}
    return {n.id for n in ast.walk(node) if isinstance(n, ast.Name) and isinstance(n.ctx, ast.Store)}


def _looked_up(text: str) -> frozenset[str]:
    """Names that a statement looks up in its module; local names may be spelt as others are there."""
    return frozenset(global_names(textwrap.dedent(text)))


def _asked(node: ast.AST) -> frozenset[str]:
    """Attributes that a statement asks things for."""
    return frozenset(n.attr for n in ast.walk(node) if isinstance(n, ast.Attribute))


def _calls_any(node: ast.AST) -> bool:
    return any(
        isinstance(n, ast.Call)
        and isinstance(n.func, ast.Name)
        and n.func.id == "getattr"
        and not isinstance(n.args[1], ast.Constant)
        for n in ast.walk(node)
    )
