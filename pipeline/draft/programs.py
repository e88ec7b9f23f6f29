# SPDX-License-Identifier: GPL-3.0-or-later
"""The program of one object out of a draft: its def, and what that uses, under names that nothing else in the room has.

What several objects use (a rail, a thickness) is called shared_... in each of them, so that the room's text has it once.
"""

from __future__ import annotations

import ast
import builtins
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import lru_cache
from typing import Any

from ..artifacts.common import Metres3, Placement
from ..artifacts.layout import ProxyLine
from ..errors import ProgramError
from ..library import catalogue
from ..objects.checks import check
from ..objects.choose import Choice, literal, parameter_value
from ..objects.colours import clean_code
from ..objects.mending import mended
from ..objects.text import function_name
from ..objects.written import FAR, SHARED, STRETCH, Written, take_program
from ..program.evaluate import call_function
from ..program.prelude.registry import RESERVED
from .calls import LIMITS
from .looks import Palette, with_roles
from .spots import Spots
from .things import Thing


@dataclass(frozen=True)
class Made:
    """What an object is made of.

    Attributes:
        source: its program, ready for `take_program`. written: that, evaluated. mended: whether it had to be rewritten.
        notes: what could not be taken as it was.
    """

    source: str
    written: Written
    mended: bool = False
    notes: tuple[str, ...] = ()


@dataclass
class Defs:
    """The defs and numbers of a draft.

    Attributes:
        defs: text by name. numbers: statements that bind other values, by name, in their order; values: what those are
            that are plain numbers or short texts.
    """

    palette: Palette
    defs: dict[str, str] = field(default_factory=dict)
    numbers: dict[str, str] = field(default_factory=dict)
    values: dict[str, float | str] = field(default_factory=dict)

    @property
    def names(self) -> frozenset[str]:
        """All names that mean something of the draft's own."""
        return frozenset(self.defs) | frozenset(self.numbers)

    def bind_number(self, name: str, text: str) -> None:
        """A value that defs may use."""
        self.numbers[name] = text
        self.palette.numbers = "\n".join(dict.fromkeys(self.numbers.values()))
        self.values.pop(name, None)
        value = _value_of(self.palette.numbers, name)
        if isinstance(value, (int, float, str)) and not isinstance(value, bool) and len(str(value)) < 40:
            self.values[name] = value

    def closure(self, name: str) -> list[str]:
        """The names that a def uses of the draft, each after what it needs, itself last."""
        ordered: list[str] = []
        open_names: set[str] = set()

        def add(one: str, depth: int) -> None:
            if one in ordered or one in open_names or depth > 60:
                return
            open_names.add(one)
            for used in sorted(_names(self.defs.get(one) or self.numbers[one]) & self.names):
                add(used, depth + 1)
            ordered.append(one)

        add(name, 0)
        return ordered

    def program(self, name: str, main: str, call: str = "") -> tuple[str, tuple[str, ...]]:
        """The text of an object's program.

        Args:
            name: of the draft's def. main: what the object's def is to be called. call: an expression that makes the object of
                `made`, what the def is called then; "" where the def is the object's itself.

        Raises:
            ProgramError: a def cannot be read.
        """
        used = self.closure(name)
        last = f"{SHARED}{name.removeprefix(SHARED)}" if call else main
        names = {n: f"{SHARED}{n.removeprefix(SHARED)}" for n in used if n != name} | {name: last}
        pieces, notes = [], list[str]()
        uses = {n: f"{new}()" for n, new in names.items() if n in self.numbers and not _is_lambda(self.numbers[n])}
        uses |= {n: _literal(v) for n, v in self.values.items() if n in uses}
        for one in used:
            if one in self.values:
                continue
            text = self.defs.get(one) or _as_def(one, self.numbers[one])
            with_materials, more = _with_roles(text, self.palette, self.names)
            pieces.append(_renamed(with_materials, names, uses))
            notes += more
        if call:
            pieces.append(f"def {main}(size):\n    return {call.replace('MADE', f'{last}(size)')}")
        return "\n\n\n".join(pieces), tuple(notes)


def make(source: str, proxy: ProxyLine, notes: tuple[str, ...] = ()) -> Made:
    """Evaluate an object's program, rewritten where that is a matter of writing.

    Raises:
        ProgramError: it cannot be used.
    """
    name = function_name(proxy.id, ())
    try:
        return _sound(source, proxy, name, notes)
    except ProgramError as error:
        first = error
    rewritten = mended(source)
    if rewritten is None:
        raise first
    return replace(_sound(rewritten, proxy, name, notes), mended=True)


def _sound(source: str, proxy: ProxyLine, name: str, notes: tuple[str, ...]) -> Made:
    """A program that makes something of use; in its box, into which it may have to be stretched."""
    try:
        made = _taken(source, name, proxy.size, proxy.placement, STRETCH)
    except ProgramError as error:
        made = _taken(source, name, proxy.size, proxy.placement, FAR)
        notes = (*notes, f"It was stretched to its box: {error.message}"[:200])
    if made.checked.penalty >= 1.0:
        # What was measured is of the time before it was fitted into its box.
        fitted = check(made.shapes, proxy.size, proxy.placement)
        if fitted.penalty >= 1.0:
            raise ProgramError(fitted.findings[0])
    return Made(source, made, bool(notes), notes)


@lru_cache(maxsize=512)
def _taken(source: str, name: str, size: Metres3, placement: Placement, stretch: float) -> Written:
    """A draft is read while it grows, when it has ended, and whenever a stage asks for what it says."""
    proxy = ProxyLine(id=name, category="object", centre=(0, 0, size[2] / 2), size=size, placement=placement)
    return take_program(source, proxy, name, (), stretch)


def piece_call(thing: Thing) -> str:
    """The call of the library's piece that a proxy line names, "" where there is no such piece."""
    piece = catalogue.pieces().get(thing.piece)
    if piece is None:
        return ""
    given = {n: v for n, value in thing.options.items() if (v := parameter_value(piece, n, str(value))) is not None}
    return tinted(Choice(piece, 1.0, given).call(), thing.colours)


def piece_program(thing: Thing, main: str) -> str:
    """The program of an object that a library's piece stands for; "" where there is none."""
    call = piece_call(thing)
    return f"def {main}(size):\n    return {call}" if call else ""


def tinted(call: str, colours: Mapping[str, str]) -> str:
    """A call with colours for its roles; what is no colour is left out."""
    codes = {role: clean_code(value) for role, value in colours.items()}
    pairs = ", ".join(
        f"{literal(role)}: {literal(f'#{code}')}" for role, code in codes.items() if code and '"' not in role
    )
    return f"tint({call}, {{{pairs}}})" if pairs else call


@lru_cache(maxsize=1024)
def _names(text: str) -> frozenset[str]:
    try:
        return frozenset({n.id for n in ast.walk(ast.parse(text)) if isinstance(n, ast.Name)})
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        return frozenset()


def _with_roles(text: str, palette: Palette, own: frozenset[str]) -> tuple[str, list[str]]:
    try:
        return with_roles(text, palette, own)
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        raise ProgramError("this is not Python") from None


def _renamed(source: str, names: Mapping[str, str], uses: Mapping[str, str]) -> str:
    """A def under its new name, and with other names for what it uses; what it calls so itself stays.

    Args:
        uses: what stands where a value of the draft is used: its literal, or the call of the def that makes it.
    """
    tree = ast.parse(source)
    spots = Spots(source)
    local: set[str] = set()
    for node in tree.body:
        if not isinstance(node, ast.FunctionDef):
            continue
        if node.name in RESERVED:
            # def rug(size) that calls rug(size) means the language's.
            local.add(node.name)
        inner = list(ast.walk(node))
        local |= {a.arg for n in inner if isinstance(n, ast.arguments) for a in [*n.args, *n.kwonlyargs]}
        local |= {n.id for n in inner if isinstance(n, ast.Name) and isinstance(n.ctx, ast.Store)}
        local |= {n.name for n in inner if isinstance(n, ast.FunctionDef) and n is not node}
        new = names.get(node.name)
        if new is not None:
            row = source.split("\n")[node.lineno - 1]
            at = row.index(node.name, row.index("def") + 3)
            spots.replace_word(node.lineno, len(row[:at].encode()), node.name, new)
    for n in ast.walk(tree):
        if isinstance(n, ast.Name) and n.id in names and n.id not in local:
            spots.replace(n, uses.get(n.id, names[n.id]))
    return spots.text()


def _as_def(name: str, text: str) -> str:
    """A value as a def that makes it: what a room makes of defs alone need not be made twice (`program/reuse.py`)."""
    node = ast.parse(text).body[0]
    if isinstance(node, ast.Assign) and isinstance(node.value, ast.Lambda):
        return f"def {name}({ast.unparse(node.value.args)}):\n    return {ast.unparse(node.value.body)}"
    if isinstance(node, ast.Assign) and len(node.targets) == 1 and isinstance(node.targets[0], ast.Name):
        return f"def {name}():\n    return {ast.unparse(node.value)}"
    made = "the_value"
    tree = ast.parse(text)
    for part in ast.walk(tree):
        if isinstance(part, ast.Name) and part.id == name:
            part.id = made
    body = "\n".join(f"    {row}" for row in ast.unparse(tree).split("\n"))
    return f"def {name}():\n{body}\n    return {made}"


def _is_lambda(text: str) -> bool:
    node = ast.parse(text).body[0]
    return isinstance(node, ast.Assign) and isinstance(node.value, ast.Lambda)


def _value_of(statements: str, name: str) -> Any:
    try:
        (value,) = call_function(f"{statements}\ndef value_of():\n    return [{name}]\n", "value_of", (), LIMITS)
    except (ProgramError, TypeError, ValueError):
        return None
    return value


def _literal(value: float | str) -> str:
    return literal(value) if isinstance(value, str) else f"({value!r})" if value < 0 else repr(value)


def may_be_bound(name: str) -> bool:
    """Whether a draft may call something of its own so."""
    return name not in RESERVED and name not in vars(builtins)
